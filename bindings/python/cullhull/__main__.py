"""``python -m cullhull ...``: the command line, shipped with the package. It also reads vector
files such as .gpkg and .shp, .parquet and .e57, with other packages: block by block into files of a
temporary folder, so that the program's ``--memory`` holds for them, too. It also writes .gpkg, .shp
and .fgb, from the program's .geojson. The program is told which files are whose, so that it names
the user's (apps/cullhull/converted.hpp)."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from .geo import _vectors

#: Points that are read at a time.
_MANY = 1 << 20
_CANCELLED = 130
#: Endings of files that are converted for the program, which does not read them.
_CONVERTED = (".parquet", ".e57", *_vectors.ENDINGS)
#: Options by what their values are: files that are written, files of polygons or lines, a column or a
#: file of numbers, columns.
_OUTPUTS = ("-o", "--output", "--vertices", "--points")
_SHAPES = ("--clip", "--edges")
_NUMBERS = ("--weights", "--height")
_COLUMNS = ("--by", "--keep")
_WITH_VALUES = (*_OUTPUTS, *_SHAPES, *_NUMBERS, *_COLUMNS, "--crs")


def program() -> str:
    """Path of the command-line program."""
    return str(Path(__file__).parent / "bin" / ("cullhull.exe" if os.name == "nt" else "cullhull"))


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


class _Folder:
    """A temporary folder with what stands for the user's files, and whose files these are."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._files: dict[str, dict[str, Any]] = {}

    def place(self, name: str, ending: str, **about: Any) -> Path:
        """A file for the user's file `name`, of which `about` says more."""
        stem = Path(name).stem
        plain = stem if stem.replace("_", "").replace("-", "").isalnum() else "points"
        place = Path(self.path, str(len(self._files)))
        place.mkdir()
        target = place / (plain + ending)
        self._files[str(target)] = {"name": name, **about}
        return target

    def environment(self) -> dict[str, str]:
        """What tells the program."""
        listed = Path(self.path, "converted.json")
        listed.write_text(json.dumps(self._files), encoding="utf-8")
        return {**os.environ, "CULLHULL_CONVERTED": str(listed)}


def _write_crs(target: Path, crs: str | None) -> None:
    """Beside a file, where the program looks for it."""
    if crs:
        target.with_suffix(".prj").write_text(crs, encoding="utf-8")


def _reported(remarks: list[Any]) -> None:
    """Says what a reader has chosen, as the program does."""
    for remark in remarks:
        print(f"cullhull: {remark.message}; --columns takes others", file=sys.stderr)


def _convert(word: str, folder: _Folder, columns: list[str] | None, asked: list[str]) -> str:
    """The same points as a file in `folder` that the program reads, with the columns that are asked
    for and that the file has."""
    import warnings

    from .geo import _parquet
    from .geo._read import read
    from .geo._rows_file import write_npy, write_ply

    path = _file_of(word)
    ending = os.path.splitext(path)[1].lower()
    if ending in _vectors.ENDINGS:
        about = _vectors.describe(word, all_layers="info" in sys.argv[1:2])
        crs = about.pop("crs")
        fields = _named(asked, [f["name"] for f in about["fields"]], word)
        target = folder.place(word, ".csv" if fields else ".ply", **about)
        _write_crs(target, crs)
        if fields:
            _vectors.write_table(target, word, fields)
            return str(target)
    else:
        target = folder.place(word, ".npy" if ending == ".parquet" else ".ply", format=ending[1:])
        if ending == ".parquet":
            fields = _named(asked, _parquet.column_names(path), word)
            _write_crs(target, _parquet.crs_of(path))
            if fields:
                target = folder.place(word, ".csv", format="parquet")
                _write_crs(target, _parquet.crs_of(path))
                _parquet.write_table(target, path, columns, fields)
                return str(target)
    named = ending != ".parquet"  # columns of x, y and z, which --columns asks for
    with warnings.catch_warnings(record=True) as remarks:
        warnings.simplefilter("always")
        blocks = read(word, columns=columns, chunks=_MANY)
        (write_ply if named else write_npy)(target, blocks, path)
    _reported(remarks)
    return str(target)


def _named(asked: list[str], names: list[str], word: str) -> list[str]:
    """Those of the file's fields that are asked for, in any case where it is clear. x, y and z are
    coordinates."""
    found: list[str] = []
    for name in asked:
        if name.lower() in ("x", "y", "z") and name not in names:
            continue
        same = [n for n in names if n == name] or [n for n in names if n.lower() == name.lower()]
        if len(same) != 1:
            raise ValueError(
                f"{word}: no field {name!r}; there are {', '.join(map(repr, names)) or 'none'}"
            )
        if same[0].lower() in ("x", "y", "z"):
            raise ValueError(f"{word}: field {same[0]!r} has the name of a coordinate; rename it")
        found += [n for n in same if n not in found]
    return found


def _split(text: str) -> list[Any]:
    """Names and numbers of columns, as read() takes them."""
    from .geo._read import split_columns

    return split_columns(text)


def _options(words: list[str]) -> list[tuple[str, str, int]]:
    """The options that matter here, with their values and the places of the words that hold these."""
    found = []
    for i, word in enumerate(words):
        name, equals, value = word.partition("=")
        if equals and name in _WITH_VALUES:
            found.append((name, value, i))
        elif word.startswith("-o") and len(word) > 2:
            found.append(("-o", word[2:], i))
        elif word in _WITH_VALUES and i + 1 < len(words):
            found.append((word, words[i + 1], i + 1))
    return found


def _asked(words: list[str]) -> list[str]:
    """The columns beside the coordinates that options name."""
    asked: list[str] = []
    for name, value, _ in _options(words):
        if name in _COLUMNS or (name in _NUMBERS and not os.path.exists(_file_of(value))):
            asked += [column for column in _split(value) if isinstance(column, str)]
    return asked


def _replaced(word: str, value: str, by: str) -> str:
    """An option's word, or its value alone, with another value."""
    return word[: len(word) - len(value)] + by


def _convert_options(words: list[str], folder: _Folder) -> tuple[list[str], set[int]]:
    """The words with files of shapes as GeoJSON, and the places of all values of options."""
    words = list(words)
    places = set()
    for name, value, i in _options(words):
        places.add(i)
        if name in _NUMBERS and os.path.isfile(_file_of(value)) and _is_converted(value):
            raise ValueError(
                f"{name} {value}: takes a column of the points, or a file of one number per point"
            )
        if name not in _SHAPES or not _is_converted(value):
            continue
        if not os.path.isfile(_file_of(value)):
            continue  # which the program says
        if os.path.splitext(_file_of(value))[1].lower() not in (*_vectors.ENDINGS, ".parquet"):
            raise ValueError(f"{name} {value}: is not a file of polygons or lines")
        target = folder.place(value, ".geojson")
        if value.lower().endswith(".parquet"):
            from .geo import _parquet

            _parquet.write_shapes(target, value)
            _write_crs(target, _parquet.crs_of(value))
        else:
            _vectors.write_shapes(target, value)
            _write_crs(target, _vectors.describe(value)["crs"])
        words[i] = _replaced(words[i], value, str(target))
    return words, places


def _convert_outputs(words: list[str], folder: _Folder) -> tuple[list[str], list[tuple[str, str]]]:
    """The words with .geojson in the place of vector files, and both names of each."""
    words = list(words)
    outputs = []
    for name, value, i in _options(words):
        ending = os.path.splitext(value)[1].lower()
        if name not in _OUTPUTS or ending not in _vectors.DRIVERS:
            continue
        place = os.path.dirname(value) or "."
        if not os.path.isdir(place):
            raise ValueError(f"{name} {value}: there is no folder {place}")
        target = str(folder.place(value, ".geojson", format=_vectors.DRIVERS[ending]))
        words[i] = _replaced(words[i], value, target)
        outputs.append((target, value))
    return words, outputs


def _write_outputs(outputs: list[tuple[str, str]], crs: str | None) -> None:
    """Vector files of what the program has written."""
    from .geo._maps import geojson_crs, move_vector

    for made, path in outputs:
        move_vector(made, path, geojson_crs(made) or crs)


def _refuse_overwriting(outputs: list[tuple[str, str]], inputs: list[str]) -> None:
    for _, path in outputs:
        for word in inputs:
            file = _file_of(word)
            if os.path.exists(path) and os.path.exists(file) and os.path.samefile(path, file):
                raise ValueError(f"-o {path}: would overwrite the input {word}")


def _known_crs(words: list[str], inputs: list[str]) -> str | None:
    """The system of results whose .geojson names none, as WGS 84 has no name there."""
    from . import _core

    for name, value, _ in _options(words):
        if name == "--crs":
            return _core.crs_code(value) or None
    plain = [_file_of(word) for word in inputs]
    return _core.common_crs(plain) or None


def _columns(words: list[str]) -> tuple[list[Any] | None, list[str]]:
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


def _needs_help(words: list[str]) -> bool:
    """Whether the program alone does not do: it reads a file that is converted, or writes one."""
    values = {i for _, _, i in _options(words)}
    return any(
        _is_converted(value)
        for name, value, _ in _options(words)
        if name in (*_OUTPUTS, *_SHAPES, *_NUMBERS)
    ) or any(_inputs(word) for i, word in enumerate(words) if i not in values)


def main() -> None:
    path = program()
    words = sys.argv[1:]
    sys.stdout.flush()
    if not _needs_help(words):
        if os.name == "nt":  # where exec lets the caller go on before the program has ended
            sys.exit(_run([path, *words], dict(os.environ)))
        os.execv(path, [path, *words])
    # In a folder of its own, which is removed when the program has ended.
    with tempfile.TemporaryDirectory(prefix="cullhull-") as name:
        folder = _Folder(name)
        try:
            given, outputs, crs = _converted(words, folder)
        except (ImportError, ValueError, OSError) as error:
            sys.exit(f"cullhull: {error}")
        except KeyboardInterrupt:
            print("cullhull: cancelled", file=sys.stderr)
            sys.exit(_CANCELLED)
        status = _run([path, *given], folder.environment())
        if status == 0 and outputs:
            try:
                _write_outputs(outputs, crs)
            except (ImportError, ValueError, OSError) as error:
                sys.exit(f"cullhull: {error}")
    sys.exit(status if status >= 0 else 128 - status)


def _converted(
    words: list[str], folder: _Folder
) -> tuple[list[str], list[tuple[str, str]], str | None]:
    """The words for the program, the vector files to be written, and the system that these have where
    the program names none."""
    asked = _asked(words)
    values = {i for _, _, i in _options(words)}
    inputs = [file for i, w in enumerate(words) if i not in values for file in _inputs(w)]
    columns = None
    if any(map(_has_columns, inputs)):
        columns, words = _columns(words)
        others = any(_is_plain_input(words, i) for i in range(len(words)))
        if columns is not None and (others or not all(map(_has_columns, inputs))):
            raise ValueError("--columns of .parquet files and others: give them apart")
    shaped, values = _convert_options(words, folder)
    shaped, outputs = _convert_outputs(shaped, folder)
    _refuse_overwriting(outputs, inputs)
    given: list[str] = []
    read: list[str] = []
    for i, word in enumerate(shaped):
        files = [] if i in values else _inputs(word)
        given += [
            _convert(file, folder, columns, asked) if _is_converted(file) else file
            for file in files
        ] or [word]
        if i not in values and (files or os.path.isfile(word)):
            read += given[-max(1, len(files)) :]
    return given, outputs, _known_crs(words, read) if outputs else None


def _run(command: list[str], environment: dict[str, str]) -> int:
    """Runs the program to its end: on Ctrl-C, which a terminal sends to both, it saves its progress
    and says so itself. SIGTERM is passed on."""
    child = subprocess.Popen(command, env=environment)
    signal.signal(signal.SIGINT, lambda *_: None)
    signal.signal(signal.SIGTERM, lambda *_: child.terminate())
    return child.wait()


if __name__ == "__main__":
    main()
