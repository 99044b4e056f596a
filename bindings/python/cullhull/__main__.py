"""``python -m cullhull ...``: the command line, shipped with the package. It also reads .laz, vector
files such as .gpkg and .shp, .parquet and .e57, with other packages: block by block into files of a
temporary folder, so that the program's ``--memory`` holds for them, too."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from . import _vectors

#: Points that are read at a time.
_MANY = 1 << 20
_CANCELLED = 130
#: Of files that the program does not read.
_CONVERTED = (".laz", ".parquet", ".e57", *_vectors.ENDINGS)


def program() -> str:
    """Path of the command-line program."""
    return str(Path(__file__).parent / "bin" / "cullhull")


def _file_of(word: str) -> str:
    """The file that a word names: of FILE.gpkg:LAYER the first part."""
    return word if os.path.exists(word) else _vectors.split_layer(word)[0]


def _is_converted(word: str) -> bool:
    return _file_of(word).lower().endswith(_CONVERTED)


def _inputs(word: str) -> list[str]:
    """The files that a word of the command line stands for, if some of them have to be converted,
    else none: a file, folder, pattern or, after @, a list of such."""
    if os.path.isfile(_file_of(word)):
        return [word] if _is_converted(word) else []
    if word.startswith("-") or not (os.path.isdir(word) or set("@*?[") & set(word)):
        return []
    from ._core import input_files

    try:
        files = list(input_files([word]))
    except Exception:  # the program says what is wrong
        return []
    return files if any(map(_is_converted, files)) else []


def _unpack(path: str, target: Path) -> None:
    """A .laz as a .las."""
    from ._errors import BadFile
    from ._extras import needed

    laspy = needed("laspy", "reading .laz files", "laz")
    try:
        with laspy.open(path) as scan, open(target, "wb") as file:
            with laspy.open(file, mode="w", header=scan.header, closefd=False) as out:
                for points in scan.chunk_iterator(1 << 20):
                    # As records: points with a scale are rescaled where it differs from the file's,
                    # and NaN differs from NaN.
                    out.write_points(laspy.PackedPointRecord(points.array, points.point_format))
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # lazrs panics on some damaged files
        raise BadFile(f"{path}: {error}") from None


def _reported(remarks: list[Any]) -> None:
    """Says what a reader has chosen, as the program does."""
    for remark in remarks:
        print(f"cullhull: {remark.message}; --columns takes others", file=sys.stderr)


def _convert(word: str, folder: str, columns: list[str] | None) -> str:
    """The same points as a file in `folder` that the program reads."""
    import warnings

    from ._read import read
    from ._rows_file import write_npy, write_ply

    path = _file_of(word)
    ending = os.path.splitext(path)[1].lower()
    place = Path(folder, str(len(os.listdir(folder))))
    place.mkdir()
    if ending == ".laz":
        target = place / (Path(path).stem + ".las")
        _unpack(path, target)
        return str(target)
    named = ending != ".parquet"  # columns of x, y and z, which --columns asks for
    target = place / (Path(path).stem + (".ply" if named else ".npy"))
    with warnings.catch_warnings(record=True) as remarks:
        warnings.simplefilter("always")
        blocks = read(word, columns=columns, chunks=_MANY)
        (write_ply if named else write_npy)(target, blocks, path)
    _reported(remarks)
    return str(target)


def _split(text: str) -> list[str]:
    from ._read import split_columns

    return split_columns(text)


def _columns(words: list[str]) -> tuple[list[str] | None, list[str]]:
    """The names of --columns, and the words without that option."""
    for i, word in enumerate(words):
        if word == "--columns" and i + 1 < len(words):
            return _split(words[i + 1]), words[:i] + words[i + 2 :]
        if word.startswith("--columns="):
            return _split(word.partition("=")[2]), words[:i] + words[i + 1 :]
    return None, words


def _has_columns(path: str) -> bool:
    return path.lower().endswith(".parquet")


def _is_plain_input(words: list[str], i: int) -> bool:
    """Whether word i is a file that the program itself reads: not an option's value, as a file
    after ``-o`` is."""
    flags = ("-q", "--quiet", "--certify", "--raw", "--skip-nan")
    value = i > 0 and words[i - 1].startswith("-") and words[i - 1] not in flags
    return not value and os.path.isfile(words[i]) and not _is_converted(words[i])


def main() -> None:
    path = program()
    words = sys.argv[1:]
    sys.stdout.flush()
    if not any(map(_inputs, words)):
        os.execv(path, [path, *words])
    # In a folder of its own, which is removed when the program has ended.
    with tempfile.TemporaryDirectory(prefix="cullhull-") as folder:
        given: list[str] = []
        try:
            files = [file for word in words for file in _inputs(word)]
            columns = None
            if any(map(_has_columns, files)):
                columns, words = _columns(words)
                others = any(_is_plain_input(words, i) for i in range(len(words)))
                if columns is not None and (others or not all(map(_has_columns, files))):
                    sys.exit("cullhull: --columns of .parquet files and others: give them apart")
            for word in words:
                given += [
                    _convert(file, folder, columns) if _is_converted(file) else file
                    for file in _inputs(word)
                ] or [word]
        except (ImportError, ValueError, OSError) as error:
            sys.exit(f"cullhull: {error}")
        except KeyboardInterrupt:
            print("cullhull: cancelled", file=sys.stderr)
            sys.exit(_CANCELLED)
        status = _run([path, *given])
    sys.exit(status if status >= 0 else 128 - status)


def _run(command: list[str]) -> int:
    """Runs the program to its end: on Ctrl-C, which a terminal sends to both, it saves its progress
    and says so itself. SIGTERM is passed on."""
    child = subprocess.Popen(command)
    signal.signal(signal.SIGINT, lambda *_: None)
    signal.signal(signal.SIGTERM, lambda *_: child.terminate())
    return child.wait()


if __name__ == "__main__":
    main()
