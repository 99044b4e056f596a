"""``python -m cullhull ...``: the command line, shipped with the package."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def program() -> str:
    """Path of the command-line program."""
    return str(Path(__file__).parent / "bin" / "cullhull")


def main() -> None:
    path = program()
    sys.stdout.flush()
    os.execv(path, [path, *sys.argv[1:]])


if __name__ == "__main__":
    main()
