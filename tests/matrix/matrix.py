"""The matrix: every command and every public name of Python × every input × every set × every output.

    matrix.py PROGRAM ROOT FOLDER [--only CELL] [--large]

ROOT is the source tree, FOLDER is emptied and used. The table is in commands.py and doors.py (the
program), functions.py and arrays.py (Python), sets.py (points). CELL is a cell's name, as failures
print it, with * for anything: only these are tried. CULLHULL_MATRIX=large tries every pair.
"""

from __future__ import annotations

import argparse
import json
import os
import pickle
import shutil
import subprocess
import sys
import time
import zlib
from pathlib import Path

import coverage
import ends
from across import Across
from cells import Cells, forked
from known import EXPECTED
from package import Package
from program import Program
from sets import point_sets


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("root", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only")
    parser.add_argument("--large", action="store_true",
                        default=os.environ.get("CULLHULL_MATRIX") == "large")
    parser.add_argument("--package", type=Path, help=argparse.SUPPRESS)  # a folder: the other process
    given = parser.parse_args()
    if given.package:
        return _all_of_package(given)
    folder = work_folder(given.folder)
    cells = Cells(EXPECTED, given.only)
    start = time.monotonic()
    with subprocess.Popen([sys.executable, *sys.argv, "--package", str(folder)]) as package:
        program = _program(given, folder, cells)
        sets = point_sets(given.large)
        coverage.all_cells(program)
        program.all_cells(sets)
        ends.all_cells(program)
        print(f"program: {program.runs} runs, {time.monotonic() - start:.0f} s", flush=True)
    print(f"with python: {time.monotonic() - start:.0f} s")
    if package.returncode != 0:
        cells.judge("python", f"the process of the package ended with {package.returncode}", "")
    else:
        cells.add(pickle.loads((folder / "package.cells").read_bytes()))
    status = cells.finish(given.only is None)
    if status == 0:
        shutil.rmtree(folder)
    return status


def _program(given: argparse.Namespace, folder: Path, cells: Cells) -> Program:
    schema = json.loads((given.root / "docs" / "cullhull.schema.json").read_text())
    return Program(given.program, folder, cells, schema, given.large)


def _all_of_package(given: argparse.Namespace) -> int:
    """The cells of Python, in a process of its own that forks one for each call."""
    cells = Cells(EXPECTED, given.only)
    sets = point_sets(given.large)
    package = Package(given.package, cells, given.large)
    package.all_cells(sets)
    across = Across(_program(given, given.package, cells), given.package, cells)
    forked(cells, given.package, across.all_cells, sets)
    (given.package / "package.cells").write_bytes(pickle.dumps(cells.taken()))
    return 0


def work_folder(near: Path) -> Path:
    """Emptied, and in memory where there is room: tens of thousands of small files come and go."""
    memory = Path("/dev/shm")
    name = f"cullhull-matrix-{zlib.crc32(str(near.resolve()).encode()):08x}"
    folder = memory / name if os.access(memory, os.W_OK) else near / "work"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


if __name__ == "__main__":
    sys.exit(main())
