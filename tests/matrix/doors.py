"""The doors of the program: every way in which points reach a command.

A door says for which sets it has no meaning, and why; else it writes files into a folder and
returns the words that name them on a command line, with what comes by standard input.
"""

from __future__ import annotations

import gzip
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Optional

import numpy as np

import files
from sets import PointSet


@dataclass
class Entry:
    """Points on a command line."""

    words: list[str]  #: the inputs
    options: list[str]  #: what has to be said about them
    stdin: bytes | None = None


@dataclass(frozen=True)
class Door:
    name: str
    enter: Callable[[Path, PointSet], Entry]
    reason: Callable[[PointSet], Optional[str]]  #: why a set cannot come by it; None: it can
    single: bool = True  #: one file of this name alone holds the points
    options: frozenset[str] = frozenset()  #: options that it uses
    #: 'exact': the same bits are due. 'close': no double holds the coordinates.
    exact: str = "exact"
    blocks: bool = False  #: whether the program reads it in blocks where it can
    scalar: str = "f64"  #: the type that the program reads
    #: Why the program refuses a set that could come by it, with status 1; None: it does not.
    refuses: Callable[[PointSet], Optional[str]] = lambda _: None


def always(_: PointSet) -> Optional[str]:
    return None


def of_dimensions(*allowed: int) -> Callable[[PointSet], Optional[str]]:
    said = " or ".join(f"{d}D" for d in allowed)
    return lambda s: None if s.dimension in allowed else f"the format holds points of {said}"


def fitting(dtype: str) -> Callable[[PointSet], Optional[str]]:
    return lambda s: None if s.fits(dtype) else f"not all coordinates are exactly {dtype}"


def both(*reasons: Callable[[PointSet], Optional[str]]) -> Callable[[PointSet], Optional[str]]:
    return lambda s: next((r for r in (check(s) for check in reasons) if r), None)


def triangles(s: PointSet) -> Optional[str]:
    if s.count % 3 or not s.count:
        return "STL holds whole triangles, at least one"
    return None


def empty_file(s: PointSet) -> Optional[str]:
    return None if s.count else "an empty file is refused: something went wrong where it was made"


def without_vertices(s: PointSet) -> Optional[str]:
    return None if s.count else "an OBJ without a vertex is refused: it may be another kind of file"


def not_empty(s: PointSet) -> Optional[str]:
    return None if s.count else "a text without a number has no dimension"


def in_json(s: PointSet) -> Optional[str]:
    if not s.finite:
        return "JSON has no NaN and no infinity"
    return None if s.count or s.dimension == 2 else "no position says how many coordinates it has"


def not_on_a_line(s: PointSet) -> Optional[str]:
    return None if s.dimension > 1 else "one column has no separator"


def _file(ending: str, write: Callable[[Any], bytes], *options: str) -> Callable[..., Entry]:
    def enter(folder: Path, s: PointSet) -> Entry:
        path = folder / f"points{ending}"
        path.write_bytes(write(s.points))
        return Entry([str(path)], [o.format(d=s.dimension) for o in options])

    return enter


def _pipe(write: Callable[[Any], bytes], *options: str) -> Callable[..., Entry]:
    def enter(folder: Path, s: PointSet) -> Entry:
        return Entry(["-"], [o.format(d=s.dimension) for o in options], write(s.points))

    return enter


def _zstd(data: bytes) -> bytes:
    return subprocess.run(
        ["zstd", "-q", "-c"], input=data, stdout=subprocess.PIPE, check=True
    ).stdout


def _as(dtype: str) -> Callable[[Any], bytes]:
    return lambda p: files.npy(p.astype(dtype))


def _among_columns(p: Any) -> bytes:
    return files.npy(np.column_stack([np.arange(len(p)) - 3.0, p, np.full(len(p), 1e9)]))


def _several(names: tuple[str, ...], spelled: str) -> Callable[..., Entry]:
    """The set in pieces, a file each, of the formats of these names."""
    writers = {
        ".npy": files.npy,
        ".txt": files.lines,
        ".csv": files.csv_of_names,
        ".ply": files.ply,
        ".f4.npy": _as("f4"),
        ".npy.gz": lambda p: gzip.compress(files.npy(p)),
    }

    def enter(folder: Path, s: PointSet) -> Entry:
        parts = np.array_split(s.points, len(names))
        folder.mkdir(exist_ok=True)
        paths = []
        for i, (ending, part) in enumerate(zip(names, parts)):
            paths.append(folder / f"part-{i}{ending}")
            paths[-1].write_bytes(writers[ending](part))
        if spelled == "folder":
            return Entry([str(folder)], [])
        if spelled == "pattern":
            return Entry([str(folder / "part-*")], [])
        if spelled == "list":
            (folder / "all.lst").write_text("".join(f"{p}\n" for p in paths))
            return Entry([f"@{folder / 'all.lst'}"], [])
        return Entry([str(p) for p in paths], [])

    return enter


#: Steps of the binary grid of the door `las`: unequal, and one of them finer than needed.
GRID = (0.125, 0.0625, 0.03125)
GRID_OFFSET = (16.0, -32.0, 64.0)


def _las_numbers(s: PointSet) -> Any:
    return (s.points - np.array(GRID_OFFSET)[: s.dimension]) / np.array(GRID)[: s.dimension]


def on_grid(s: PointSet) -> Optional[str]:
    if s.dimension != 3:
        return "LAS holds points of space"
    if not s.finite or s.has_minus_zero:
        return "whole numbers hold no NaN, no infinity and one zero"
    numbers = _las_numbers(s)
    back = numbers * GRID + GRID_OFFSET
    if (
        (back != s.points).any()
        or (numbers != np.rint(numbers)).any()
        or (np.abs(numbers) >= 2**31).any()
    ):
        return "not on the grid of 32-bit numbers"
    return None


def _las(folder: Path, s: PointSet) -> Entry:
    path = folder / "points.las"
    path.write_bytes(files.las(_las_numbers(s).astype(np.int32), GRID, GRID_OFFSET))
    return Entry([str(path)], [])


def decimal(s: PointSet) -> Optional[str]:
    if s.grid is None or s.dimension != 3:
        return "only the set of a decimal grid in space"
    return None


def _las_decimal(folder: Path, s: PointSet) -> Entry:
    path = folder / "points.las"
    path.write_bytes(files.las(*s.grid))
    return Entry([str(path)], [])


def _las_tiles(folder: Path, s: PointSet) -> Entry:
    """Two tiles of one grid, an offset each."""
    numbers = _las_numbers(s).astype(np.int64)
    words = []
    for i, part in enumerate(np.array_split(numbers, 2)):
        moved = part - np.array([1000, -300, 50]) * i
        offset = np.array(GRID_OFFSET) + np.array([1000, -300, 50]) * i * GRID
        path = folder / f"tile-{i}.las"
        path.write_bytes(files.las(moved.astype(np.int32), GRID, offset))
        words.append(str(path))
    return Entry(words, [])


def _las_and_npy(folder: Path, s: PointSet) -> Entry:
    half = s.count // 2
    las, npy = folder / "first.las", folder / "second.npy"
    las.write_bytes(files.las(_las_numbers(s)[:half].astype(np.int32), GRID, GRID_OFFSET))
    npy.write_bytes(files.npy(s.points[half:]))
    return Entry([str(las), str(npy)], [])


def _las_columns(folder: Path, s: PointSet) -> Entry:
    """The plane of a scan: x and y of records of three coordinates."""
    path = folder / "points.las"
    numbers = np.column_stack([_las_numbers(s), np.arange(s.count)]).astype(np.int32)
    path.write_bytes(files.las(numbers, GRID, GRID_OFFSET))
    return Entry([str(path)], ["--columns", "x,y"])


def finite(s: PointSet) -> Optional[str]:
    return None if s.finite else "a remark comes before the error"


def missed_nowhere(s: PointSet) -> Optional[str]:
    return "a record of zeros has no return" if (s.points == 0).all(axis=1).any() else None


def on_plane_grid(s: PointSet) -> Optional[str]:
    if s.dimension != 2:
        return "x and y are two columns"
    raised = PointSet(s.kind, np.column_stack([s.points, np.zeros(s.count)]))
    return on_grid(raised)


DIMENSIONS = of_dimensions(2, 3)
SPACE = of_dimensions(3)

#: The door whose answer is every other's. It comes first.
REFERENCE = "npy"

DOORS = [
    Door("npy", _file(".npy", files.npy), always),
    Door("npy-fortran", _file(".npy", lambda p: files.npy(np.asfortranarray(p))), always),
    Door("npy-big-endian", _file(".npy", _as(">f8")), always),
    *(
        Door(f"npy-{t}", _file(".npy", _as(t)), fitting(t), scalar=t)
        for t in ("f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")
    ),
    Door("npz", _file(".npz", files.npz), always),
    Door("ply", _file(".ply", files.ply), DIMENSIONS),
    Door(
        "ply-f4",
        _file(".ply", lambda p: files.ply(p, dtype="f4")),
        both(DIMENSIONS, fitting("f4")),
        scalar="f32",
    ),
    Door("ply-big-endian", _file(".ply", lambda p: files.ply(p, "binary_big_endian")), DIMENSIONS),
    Door("ply-ascii", _file(".ply", lambda p: files.ply(p, "ascii")), DIMENSIONS),
    Door("pcd", _file(".pcd", files.pcd), DIMENSIONS),
    Door("pcd-ascii", _file(".pcd", lambda p: files.pcd(p, "ascii")), DIMENSIONS),
    Door("pcd-compressed", _file(".pcd", lambda p: files.pcd(p, "binary_compressed")), DIMENSIONS),
    Door("obj", _file(".obj", files.obj), SPACE, refuses=without_vertices),
    Door("off", _file(".off", files.off), SPACE),
    Door("stl", _file(".stl", files.stl), both(SPACE, triangles, fitting("f4")), scalar="f32"),
    Door("stl-ascii", _file(".stl", files.stl_ascii), both(SPACE, triangles)),
    Door("xyz", _file(".xyz", files.lines), not_empty),
    Door("txt", _file(".txt", files.lines), not_empty),
    Door("txt-qhull", _file(".txt", files.qhull), always),
    Door("txt-cdd", _file(".ext", files.cdd), always),
    Door("geojson", _file(".geojson", files.geojson), both(DIMENSIONS, in_json)),
    Door("geojson-features", _file(".json", files.geojson_features), both(DIMENSIONS, in_json)),
    Door("wkt", _file(".wkt", files.wkt), DIMENSIONS),
    Door("wkt-lines", _file(".ext", files.wkt_lines), both(DIMENSIONS, not_empty)),
    Door("csv", _file(".csv", lambda p: files.lines(p, ",")), both(not_empty, not_on_a_line)),
    Door("csv-named", _file(".csv", files.csv_of_names), both(not_empty, not_on_a_line)),
    Door(
        "csv-semicolons",
        _file(".csv", lambda p: files.lines(p, ";")),
        both(not_empty, not_on_a_line),
    ),
    Door(
        "csv-decimal-commas",
        _file(".csv", lambda p: files.decimal_commas(p, ";")),
        both(not_empty, not_on_a_line, finite),
    ),
    Door(
        "txt-decimal-commas",
        _file(".txt", lambda p: files.decimal_commas(p, " "), "--decimal", ","),
        not_empty,
        options=frozenset(["--decimal"]),
    ),
    Door("json-rows", _file(".json", files.json_rows), both(not_empty, in_json)),
    Door("pts", _file(".pts", files.pts), both(SPACE, not_empty, finite)),
    Door("ptx", _file(".ptx", files.ptx), both(SPACE, missed_nowhere, finite)),
    Door("node", _file(".node", files.node), DIMENSIONS),
    Door("asc", _file(".asc", files.asc), both(SPACE, not_empty)),
    Door(
        "csv-columns",
        lambda f, s: Entry(
            _file(".csv", files.csv_among_others)(f, s).words,
            ["--columns", ",".join("xyzw"[: s.dimension])],
        ),
        not_empty,
        options=frozenset(["--columns"]),
    ),
    Door(
        "npy-columns",
        lambda f, s: Entry(
            _file(".npy", _among_columns)(f, s).words, ["--columns", f"1:{s.dimension + 1}"]
        ),
        always,
        options=frozenset(["--columns"]),
    ),
    Door(
        "raw",
        _file(".raw", lambda p: p.tobytes(), "--dim", "{d}", "--type", "f64"),
        always,
        refuses=empty_file,
        options=frozenset(["--dim", "--type"]),
    ),
    Door(
        "raw-by-option",
        _file(
            ".bin", lambda p: p.tobytes(), "--input-format", "raw", "--dim", "{d}", "--type", "f64"
        ),
        always,
        refuses=empty_file,
        options=frozenset(["--input-format", "--dim", "--type"]),
    ),
    Door(
        "format-by-option",
        _file(".dat", files.npy, "--input-format", "npy"),
        always,
        options=frozenset(["--input-format"]),
    ),
    Door("las", _las, on_grid, scalar="i32"),
    Door(
        "las-columns",
        _las_columns,
        on_plane_grid,
        scalar="i32",
        options=frozenset(["--columns"]),
    ),
    Door(
        "las-tiles", _las_tiles, both(on_grid, not_empty), single=False, blocks=True
    ),
    Door(
        "las-and-npy",
        _las_and_npy,
        both(on_grid, not_empty),
        single=False,
        blocks=True,
    ),
    Door("las-decimal", _las_decimal, decimal, exact="close", scalar="i32"),
    Door("gz", _file(".npy.gz", lambda p: gzip.compress(files.npy(p))), always, blocks=True),
    Door("zst", _file(".npy.zst", lambda p: _zstd(files.npy(p))), always, blocks=True),
    Door(
        "csv-gz",
        _file(".csv.gz", lambda p: gzip.compress(files.csv_of_names(p))),
        both(not_empty, not_on_a_line),
        blocks=True,
    ),
    Door("ply-zst", _file(".ply.zst", lambda p: _zstd(files.ply(p))), DIMENSIONS, blocks=True),
    Door("pipe-npy", _pipe(files.npy), always),
    Door("pipe-txt", _pipe(files.lines), not_empty),
    Door("pipe-ply", _pipe(files.ply), DIMENSIONS),
    Door("pipe-gz", _pipe(lambda p: gzip.compress(files.npy(p))), always, blocks=True),
    Door(
        "pipe-raw",
        _pipe(lambda p: p.tobytes(), "--input-format", "raw", "--dim", "{d}", "--type", "f64"),
        always,
        refuses=empty_file,
        options=frozenset(["--input-format", "--dim", "--type"]),
    ),
    Door("several", _several((".npy", ".npy", ".npy"), "words"), always, single=False, blocks=True),
    Door(
        "several-kinds",
        _several((".npy", ".ply", ".npy.gz"), "words"),
        DIMENSIONS,
        single=False,
        blocks=True,
    ),
    Door(
        "several-texts",
        _several((".txt", ".csv"), "words"),
        lambda s: (
            None
            if s.count > 1 and s.dimension > 1
            else "each part is to have a row of several columns"
        ),
        single=False,
        blocks=True,
    ),
    Door("folder", _several((".npy", ".npy"), "folder"), always, single=False, blocks=True),
    Door("pattern", _several((".npy", ".npy"), "pattern"), always, single=False, blocks=True),
    Door("list", _several((".npy", ".npy"), "list"), always, single=False, blocks=True),
]


def _frames(s: PointSet) -> Any:
    return np.stack([s.points, s.points[::-1]])


def _array(folder: Path, s: PointSet) -> Entry:
    (folder / "frames.npy").write_bytes(files.npy(_frames(s)))
    return Entry([str(folder / "frames.npy")], [])


def _array_in_pipe(folder: Path, s: PointSet) -> Entry:
    return Entry(["-"], [], files.npy(_frames(s)))


def _frames_in_folder(spelled: str) -> Callable[..., Entry]:
    def enter(folder: Path, s: PointSet) -> Entry:
        (folder / "all").mkdir(exist_ok=True)
        for i, frame in enumerate(_frames(s)):
            (folder / "all" / f"frame-{i + 9}.npy").write_bytes(files.npy(frame))
        return Entry([str(folder / spelled)], [])

    return enter


#: Doors of moving points beside one file a frame: frames are the set and the set turned round.
SEQUENCES = (
    Door("array", _array, always),
    Door(
        "array-f4",
        lambda f, s: _array(f, PointSet(s.kind, s.points.astype(np.float32))),
        fitting("f4"),
        scalar="f32",
    ),
    Door("pipe-array", _array_in_pipe, always),
    Door("folder", _frames_in_folder("all"), always),
    Door("pattern", _frames_in_folder("all/f*.npy"), always),
)

#: What the program reads and the matrix leaves to other tests.
ELSEWHERE = {
    ".xyzrgb": ".asc without its header",
    ".json": "the ending of the doors geojson-features and json-rows",
    ".hullstate": "holds extreme points alone: the tests of streams compare states",
    ".h5 .nc": "needs h5py to be written: foreign_files",
    ".laz .copc": "needs lazrs to be written: foreign_files",
    ".e57 .parquet .zarr .gpkg .shp .fgb .gml .kml": "read by the Python package: its tests",
}
