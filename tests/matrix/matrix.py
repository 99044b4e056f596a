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
import shutil
import sys
import time
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import coverage
import ends
from across import Across
from cells import Cells
from known import EXPECTED
from package import Package
from program import Program
from sets import PointSet, point_sets


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("root", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only")
    parser.add_argument("--large", action="store_true",
                        default=os.environ.get("CULLHULL_MATRIX") == "large")
    given = parser.parse_args()
    folder = work_folder(given.folder)
    cells = Cells(EXPECTED, given.only)
    schema = json.loads((given.root / "docs" / "cullhull.schema.json").read_text())
    sets = point_sets(given.large)
    start = time.monotonic()
    program = Program(given.program, folder, cells, schema, given.large)
    with ThreadPoolExecutor(1) as beside:
        running = beside.submit(_all_of_program, program, sets)
        Package(folder, cells, given.large).all_cells(sets)
        Across(program, folder, cells, given.large).all_cells(sets)
        print(f"python: {time.monotonic() - start:.0f} s", flush=True)
        running.result()
    print(f"program: {program.runs} runs, {time.monotonic() - start:.0f} s")
    status = cells.finish(given.only is None)
    if status == 0:
        shutil.rmtree(folder)
    return status


def _all_of_program(program: Program, sets: list[PointSet]) -> None:
    coverage.all_cells(program)
    program.all_cells(sets)
    ends.all_cells(program)


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
