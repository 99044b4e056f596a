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
from pathlib import Path

from cells import Cells
from known import EXPECTED
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
    given = parser.parse_args()
    folder = given.folder / "matrix"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    cells = Cells(EXPECTED, given.only)
    schema = json.loads((given.root / "docs" / "cullhull.schema.json").read_text())
    sets = point_sets(given.large)
    start = time.monotonic()
    program = Program(given.program, folder, cells, schema, given.large)
    program.all_cells(sets)
    print(f"program: {program.runs} runs in {time.monotonic() - start:.0f} s")
    return cells.finish(given.only is None)


if __name__ == "__main__":
    sys.exit(main())
