"""``python -m cullhull ...``: the command line, shipped with the package; it reads .laz, too."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path


def program() -> str:
    """Path of the command-line program."""
    return str(Path(__file__).parent / "bin" / "cullhull")


def _is_packed(name: str) -> bool:
    return name.lower().endswith(".laz")


def _inputs(word: str) -> list[str]:
    """The files that a word of the command line stands for, if .laz are among them, else none: a
    file, folder, pattern or, after @, a list of such."""
    if os.path.isfile(word):
        return [word] if _is_packed(word) else []
    if word.startswith("-") or not (os.path.isdir(word) or set("@*?[") & set(word)):
        return []
    from ._core import input_files

    try:
        files = list(input_files([word]))
    except Exception:  # the program says what is wrong
        return []
    return files if any(map(_is_packed, files)) else []


def _unpack(path: str, folder: str) -> str:
    """The same points as a .las in `folder`."""
    from ._errors import BadFile
    from ._extras import needed

    laspy = needed("laspy", "reading .laz files", "laz")
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
    if not any(map(_inputs, words)):
        os.execv(path, [path, *words])
    # As .las in a folder of its own, which is removed when the program has ended.
    with tempfile.TemporaryDirectory(prefix="cullhull-") as folder:
        given: list[str] = []
        try:
            for word in words:
                given += [
                    _unpack(file, folder) if _is_packed(file) else file for file in _inputs(word)
                ] or [word]
        except (ImportError, ValueError) as error:
            sys.exit(f"cullhull: {error}")
        status = subprocess.call([path, *given])
    sys.exit(status if status >= 0 else 128 - status)


if __name__ == "__main__":
    main()
