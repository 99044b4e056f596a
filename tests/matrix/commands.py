"""The program's half of the table: every command, what it writes, and what has no meaning.

A `Row` is a command with options that change its answer. The runner makes a cell of each row, each
door of `doors.DOORS`, each set of `sets.point_sets` and each output of the row.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Callable, Optional

import texts
from doors import always, of_dimensions
from sets import PointSet

Reason = Callable[[PointSet], Optional[str]]


@dataclass(frozen=True)
class Output:
    """What a row is asked to write: words of the command line, where {} is the file."""

    name: str
    words: tuple[str, ...]
    ending: Optional[str]  #: of the file; None: standard output
    read: texts.Reader
    reason: Reason = always
    #: How two doors are compared: 'bytes', 'scalar' (all but the scalar type), 'values' (numbers of
    #: any type), 'survivors' (in blocks or by another filter others may survive), 'report', 'page'.
    alike: str = "bytes"
    #: Whether its coordinates are those of points.
    of_points: bool = True
    schema: Optional[str] = None  #: the definition in docs/cullhull.schema.json


@dataclass(frozen=True)
class Row:
    name: str
    words: tuple[str, ...]  #: the command with what the row always says
    outputs: tuple[Output, ...]
    #: Sets without meaning.
    reason: Reason = always
    #: Doors without meaning: a name or an option that a door uses, and why.
    without: dict[str, str] = field(default_factory=dict)
    #: What a short run tries. 'every': all doors with all sets; 'all': few doors with all sets and
    #: all doors with few sets; 'main': few with few, as another row of the command has the rest.
    doors: str = "all"
    #: How the points are named: 'input', 'sequence', 'qconvex', 'with hull' (made by the same
    #: door), 'with reference' (made by the reference door).
    shape: str = "input"
    not_finite: int = 1  #: the status for points that are not finite
    #: Options of `WAYS` that do not go with the row, and why.
    ways: dict[str, str] = field(default_factory=dict)
    scalars: Optional[str] = None  #: the scalar type without which doors have no meaning
    extra: Optional[str] = None  #: a file that goes with the points: 'weights', 'edges', 'clip'


def mesh(s: PointSet) -> Optional[str]:
    return None if s.dimension in (2, 3) else "meshes hold points of the plane and of space"


def single_precision(s: PointSet) -> Optional[str]:
    if s.kind in ("huge", "wide"):
        return "32-bit floats do not reach so far"
    return None


def solid(s: PointSet) -> Optional[str]:
    """Formats of triangles, which a segment or a point has none of."""
    if mesh(s):
        return mesh(s)
    if s.finite and s.affine_dimension < 2:
        return "the format holds triangles, and the hull has none"
    return single_precision(s)


def drawn(s: PointSet) -> Optional[str]:
    """Formats of triangles in single precision, of a triangulation of the plane."""
    if PLANE(s):
        return PLANE(s)
    if s.finite and s.affine_dimension < 2:
        return "the format holds triangles, and the triangulation has none"
    return single_precision(s)


def up_to_space(s: PointSet) -> Optional[str]:
    return None if s.dimension <= 3 else "cells are drawn and clipped in up to three dimensions"


def has_hull(s: PointSet) -> Optional[str]:
    return None if s.finite else "there is no hull to check"


PLANE = of_dimensions(2)


def _o(ending: str, read: texts.Reader, reason: Reason = always, **more: object) -> Output:
    return Output(ending, ("-o", "{}"), ending, read, reason, **more)  # type: ignore[arg-type]


def _s(ending: str, read: texts.Reader, reason: Reason = always) -> Output:
    return _o(ending, read, reason, alike="survivors")


def _report(of: str) -> Output:
    return Output(
        "--json",
        ("--json={}",),
        ".report",
        texts.strict_json,
        alike="report",
        schema=f"{of}_report",
    )


def _json(kind: str) -> Output:
    return _o(".json", texts.result_json, alike="scalar", schema=kind)


def _format(word: str, reason: Reason = always) -> Output:
    return Output(f"--format {word}", ("--format", word), None, texts.text, reason)


HULL_MESHES = (
    _o(".ply", texts.ply, mesh),
    _o(".obj", texts.obj, mesh),
    _o(".off", texts.off, mesh),
    _o(".stl", texts.stl, solid, of_points=False),
    _o(".glb", texts.glb, solid, of_points=False),
    _o(".vtp", texts.vtp, mesh),
)
PLANE_SHAPES = (_o(".geojson", texts.geojson, PLANE), _o(".wkt", texts.wkt, PLANE))
IDS = (
    Output("--vertices .npy", ("--vertices", "{}"), ".npy", texts.ids),
    Output("--vertices .csv", ("--vertices", "{}"), ".csv", texts.ids_csv),
    Output("--vertices .txt", ("--vertices", "{}"), ".txt", texts.ids_txt),
)
VERTICES = tuple(
    Output(f"--vertices {e}", ("--vertices", "{}"), e, read, reason, alike)
    for e, read, reason, alike in (
        (".ply", texts.ply, mesh, "values"),
        (".xyz", texts.points_txt, always, "bytes"),
        (".geojson", texts.geojson, mesh, "bytes"),
    )
)
STATE = Output("--partial .npz", ("--partial", "{}"), ".npz", texts.archive, alike="values")

#: Texts as qconvex prints them.
QCONVEX_WORDS = tuple("Fx i o n p f s Fa FA FC FD FF Fi FI Fn FN Fo Fs FS Ft Fv FV".split())

FILES_TAKEN = "a sequence is files of points or an array (frames, n, d): "
SEQUENCE = {
    "--columns": FILES_TAKEN + "track has no --columns",
    "--decimal": FILES_TAKEN + "track has no --decimal",
    "--dim": FILES_TAKEN + "raw records have no frames",
    "--input-format": FILES_TAKEN + "raw records have no frames",
    "gz": FILES_TAKEN + "compressed arrays are read whole, not frame by frame",
    "several": "several files are several frames",
    "pipe": "standard input is one array (frames, n, d): the cell 'array'",
}
ONE_FILE = {
    "several": "TI names one file",
    "--columns": "Qhull's words know no columns",
    "--decimal": "Qhull's words know no decimal marks",
    "--dim": "Qhull's words know no raw records",
    "--input-format": "Qhull's words know no formats",
}

_BLOCKS = "reads in blocks: all points are never in memory"
IN_BLOCKS = dict.fromkeys(("--cull", "--repeat", "--stream", "--backend"), _BLOCKS)

def _row(name: str, *outputs: Output, words: str = "", **more: object) -> Row:
    """A row whose name is its command line, but for -q, if no words are given."""
    command, *options = (words or name).split()
    return Row(name, (command, "-q", *options), outputs, **more)  # type: ignore[arg-type]


def _main(name: str, *outputs: Output, words: str = "", **more: object) -> Row:
    return _row(name, *outputs, words=words, doors="main", **more)


def _track(name: str, *outputs: Output, words: str = "track", **more: object) -> Row:
    return _row(name, *outputs, words=words, shape="sequence", without=SEQUENCE, **more)


PLANE_MESHES = ((".ply", texts.ply), (".obj", texts.obj), (".off", texts.off), (".vtp", texts.vtp))
TRIANGULATION = (_json("triangulation"), _report("triangulation"))
VORONOI = (_json("voronoi"), _report("voronoi"))
ALPHA = (_json("alpha_shape"), *PLANE_SHAPES)


def _measures(ending: str, read: texts.Reader, reason: Reason = always) -> Output:
    return Output(f"--measures {ending}", ("--measures", "{}"), ending, read, reason)


ROWS = (
    _row(
        "hull",
        *(*HULL_MESHES, *PLANE_SHAPES, _json("hull"), _o(".txt", texts.counted_txt)),
        *(*IDS[:1], _report("hull")),
        doors="every",
    ),
    _row(
        "hull --format",
        *(_format(w) for w in QCONVEX_WORDS),
        words="hull",
        ways={"--stream": "--format o prints all points, which are never in memory together"},
    ),
    *(_main(f"hull {o.name}", o, words="hull") for o in VERTICES),
    _main("hull --triangles", *HULL_MESHES[-1:]),
    _main("hull --polygons", *HULL_MESHES[:3]),
    _main("hull --certify", _json("hull"), *IDS[1:2], _report("hull")),
    _row("hull --partial", STATE, *IDS[2:], _report("hull"), words="hull", ways=IN_BLOCKS),
    _row(
        "hull --part",
        _o(".npz", texts.archive, alike="values"),
        words="hull --part 1/1",
        ways=IN_BLOCKS,
        doors="main",
    ),
    _row(
        "hull --only vertices",
        *(*IDS[:1], _report("extreme")),
    ),
    *(
        _row(
            f"cull -o {ids.name} --points {points.name}",
            ids,
            replace(points, name=f"--points {points.name}", words=("--points", "{}")),
            *([_report("cull")] if first else []),
            words="cull",
            ways={"--repeat": "the filter is the same", "--memory": "the filter is the same"},
            doors="all" if first else "main",
        )
        for first, ids, points in (
            (True, _s(".npy", texts.ids), _s(".csv", texts.points_csv)),
            (True, _s(".ply", texts.ply, mesh), _s(".npy", texts.points_npy)),
            (False, _s(".xyz", texts.points_txt), _s(".txt", texts.points_txt)),
            (False, _s(".csv", texts.ids_csv), _s(".xyz", texts.points_txt)),
            (False, _s(".txt", texts.ids_txt), _s(".ply", texts.ply, mesh)),
            (False, _s(".geojson", texts.geojson, mesh), _s(".geojson", texts.geojson, mesh)),
        )
    ),
    _main("cull --partial", STATE, words="cull", ways=IN_BLOCKS),
    _row(
        "delaunay",
        *(_o(e, r, PLANE) for e, r in PLANE_MESHES),
        _o(".stl", texts.stl, drawn, of_points=False),
        _o(".glb", texts.glb, drawn, of_points=False),
        _o(".vtk", texts.vtk, up_to_space),
        *(*PLANE_SHAPES, *TRIANGULATION),
        *(_format(w) for w in ("i", "Fn", "Fx", "p")),
    ),
    _main("delaunay --certify", *TRIANGULATION),
    _main("delaunay --furthest", *TRIANGULATION),
    _row("delaunay --weights", *TRIANGULATION, words="delaunay", extra="weights"),
    _main(
        "delaunay --edges",
        *TRIANGULATION,
        words="delaunay",
        reason=lambda s: PLANE(s)
        or (None if s.count > 3 else "an edge needs two points to part others"),
        extra="edges",
    ),
    _row(
        "voronoi",
        *(_o(e, r, mesh, of_points=False) for e, r in PLANE_MESHES),
        *(_o(o.name, o.read, PLANE, of_points=False) for o in PLANE_SHAPES),
        *(*VORONOI, _measures(".npy", texts.measures, up_to_space)),
        *(_format(w) for w in ("p", "o", "Fv")),
    ),
    _main(
        "voronoi --measures", _measures(".csv", texts.measures_csv, up_to_space), words="voronoi"
    ),
    _main(
        "voronoi --box",
        *(_measures(".txt", texts.measures_csv), _report("voronoi")),
        words="voronoi --box {box}",
        reason=up_to_space,
    ),
    _main(
        "voronoi --clip",
        _o(".geojson", PLANE_SHAPES[0].read, PLANE, of_points=False),
        *(_measures(".npy", texts.measures, PLANE), _report("voronoi")),
        words="voronoi",
        reason=PLANE,
        extra="clip",
    ),
    _main(
        "voronoi --polygons",
        *(_o(e, r, mesh, of_points=False) for e, r in PLANE_MESHES if e in (".ply", ".off")),
    ),
    _main("voronoi --triangles", _o(".vtp", texts.vtp, mesh, of_points=False)),
    _main("voronoi --certify", _report("voronoi")),
    _main("voronoi --furthest", *VORONOI),
    _main("voronoi --weights", *VORONOI, words="voronoi", extra="weights"),
    _row(
        "alpha",
        *(*HULL_MESHES, _o(".vtk", texts.vtk, up_to_space), *PLANE_SHAPES),
        *(_json("alpha_shape"), _report("alpha")),
    ),
    _main("alpha --alpha all-points", *ALPHA),
    _main("alpha --alpha NUMBER", *ALPHA, words="alpha --alpha 20"),
    _row("alpha --ratio", *ALPHA, words="alpha --ratio 0.3", reason=PLANE),
    _row("certify", _report("certify"), shape="with hull", reason=has_hull),
    _row(
        "certify the reference",
        _report("certify"),
        words="certify",
        shape="with reference",
        reason=has_hull,
        scalars="f64",
    ),
    Row("info", ("info",), (_report("info"),), not_finite=0),
    _main("info --plan", _report("info"), not_finite=0),
    _main("view", _o(".html", texts.page, alike="page"), _report("hull")),
    _main(
        "view --delaunay",
        _o(".html", texts.page, alike="page"),
        reason=lambda s: mesh(s) if s.finite else None,
    ),
    _main(
        "view --outline",
        _o(".html", texts.page, alike="page"),
        reason=lambda s: mesh(s) if s.finite else None,
    ),
    _track("track", _report("track"), ways={"--cull": "--json says how each frame was filtered"}),
    _track("track --certify", _report("track"), words="track --certify", doors="main"),
    _track("track --polygons", *HULL_MESHES[:1], words="track --polygons", doors="main"),
    _track("track --triangles", *HULL_MESHES[-1:], words="track --triangles", doors="main"),
    *(
        _track(f"track to {o.name}", o, doors="main")
        for o in (*HULL_MESHES[:4], _json("hull"), _o(".txt", texts.counted_txt))
    ),
    _row(
        "qconvex",
        *(Output(w, (w,), None, texts.text) for w in QCONVEX_WORDS),
        shape="qconvex",
        without=ONE_FILE,
    ),
)

#: Commands that take no points, and where their own cells are.
WITHOUT_POINTS = {
    "generate": "makes points: the cells of across.py",
    "completion": "prints a script: pages_test",
    "man": "prints pages: pages_test",
}

#: Options that no row names, and why. An option of `--help` that is neither here, nor a row's, nor
#: a door's, nor a way's (below) fails the test.
OPTIONS_ELSEWHERE = {
    "--help": "checked against this table",
    "--version": "one line",
    "--licenses": "a text: cli_test",
    "--quiet": "on every command line here",
    "--global-ids": "ids of states: cli_stream_test",
    "--first-id": "ids of states: cli_stream_test",
    "--checkpoint": "resumes a stream: cli_stream_test",
    "--checkpoint-every": "resumes a stream: cli_stream_test",
    "--keep-going": "frames that are not finite: cli_track_test",
    "--inside": "needs rings: the tests of constrained edges",
    "--by": "groups: cli_groups_test and test_groups",
    "--crs": "what programs for maps want: cli_maps_test",
    "--keep": "columns beside points: cli_maps_test and test_maps",
    "--max-edge": "drops cells of a triangulation: cli_triangulation_test",
    "--folder": "of man: pages_test",
    "--edge-length": "the number that --ratio stands for",
    "--raw": "numbers of scans without their scale: cli_las_test",
    "--no-open": "of a page without -o: cli_view_test",
    "--skip-nan": "points without a return: cli_skip_nan_test",
    "--height": "heights of a surface: cli_triangulation_test",
    "--count": "generate",
    "--seed": "generate",
    "--frames": "generate",
    "--motion": "generate",
}

#: Options that must not change a bit of any answer: each is tried with every row that has it.
WAYS = (
    ("--threads", "1"),
    ("--threads", "2"),
    ("--cull", "none"),
    ("--cull", "gauge"),
    ("--cull", "pseudo-hull"),
    ("--backend", "cpu"),
    ("--memory", "1G"),
    ("--stream", "on"),
    ("--stream", "off"),
    ("--repeat", "2"),
)

#: What a short run tries of rows that it does not try whole. (Every row has all sets by the
#: reference door, and every door has all sets with the row `hull`.)
FEW_SETS = tuple(f"{kind}-{d}d" for kind in ("generic", "integers", "nan", "empty") for d in (2, 3))
FEW_DOORS = ("npy-f4", "npy-i2", "csv-named", "las", "las-columns", "pipe-txt", "several", "gz")
