"""``python -m cullhull ...``: the command line, shipped with the package; it reads .laz, too."""

from __future__ import annotations

import glob
import os
import subprocess
import sys
import tempfile
from pathlib import Path


def program() -> str:
    """Path of the command-line program."""
    return str(Path(__file__).parent / "bin" / "cullhull")


def _scans(word: str) -> list[str]:
    """The .laz files that a word of the command line names."""
    if not word.lower().endswith(".laz") or word.startswith("-"):
        return []
    if os.path.exists(word):
        return [word]
    return sorted(glob.glob(word))


def _unpack(path: str, folder: str) -> str:
    """The same points as a .las in `folder`."""
    from ._errors import BadFile
    from ._read import _package

    laspy = _package("laspy", ".laz files", "'laspy[lazrs]'")
    target = os.path.join(folder, f"{len(os.listdir(folder))}", Path(path).stem + ".las")
    os.makedirs(os.path.dirname(target))
    try:
        with laspy.open(path) as scan, open(target, "wb") as file:
            with laspy.open(file, mode="w", header=scan.header, closefd=False) as out:
                for points in scan.chunk_iterator(1 << 20):
                    out.write_points(points)
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # lazrs panics on some damaged files
        raise BadFile(f"{path}: {error}") from None
    return target


def main() -> None:
    path = program()
    words = sys.argv[1:]
    sys.stdout.flush()
    if not any(_scans(word) for word in words):
        os.execv(path, [path, *words])
    # As .las in a folder of its own, which is removed when the program has ended.
    with tempfile.TemporaryDirectory(prefix="cullhull-") as folder:
        given: list[str] = []
        try:
            for word in words:
                given += [_unpack(scan, folder) for scan in _scans(word)] or [word]
        except (ImportError, ValueError) as error:
            sys.exit(f"cullhull: {error}")
        status = subprocess.call([path, *given])
    sys.exit(status if status >= 0 else 128 - status)


if __name__ == "__main__":
    main()
