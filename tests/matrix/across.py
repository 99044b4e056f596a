"""Cells between the program and the package: files that `read` reads, what both write and make."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any, Optional

import numpy as np

from cells import Cells
from doors import DOORS, Door
from package import Raised
from program import Program, Ran
from schema import fault_of
from sets import PointSet

#: What `--help` of generate lists under "Shapes:" and "Motions", and how each is asked for.
SIZES = {"grid": "grid:7", "disk": "disk", "circle": "circle"}


class Across:
    def __init__(self, program: Program, folder: Path, cells: Cells) -> None:
        import cullhull

        self.cullhull, self.program, self.cells = cullhull, program, cells
        self.folder = folder / "across"
        self.folder.mkdir()

    def all_cells(self, sets: list[PointSet]) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for s in sets:
                for door in DOORS:
                    self._read(door, s)
                if s.finite:
                    self._both(s)
        self._made()

    # cullhull.read

    def _read(self, door: Door, s: PointSet) -> None:
        cell = f"python/read/{door.name}/{s.name}"
        if not self.cells.wanted(cell):
            return
        why = door.reason(s)
        if why is None and not door.single:
            why = "read takes one file"
        elif why is None and door.name.startswith("pipe"):
            why = "read takes files"
        elif why is None and door.options - {"--columns"}:
            why = "read knows formats by name and content"
        if why is not None:
            self.cells.no_meaning(cell, why)
            return
        entry = door.enter(self.folder, s)
        columns = _columns(entry.options, s.dimension)
        words = f"cullhull.read('{entry.words[0]}', columns={columns})"
        line = f'python -c "import cullhull; print({words})"'
        try:
            got = self.cullhull.read(entry.words[0], columns=columns)
            if got.shape != s.points.shape:
                fault: Optional[str] = f"shape {got.shape}, not {s.points.shape}"
            else:
                same = np.ascontiguousarray(got, np.float64)
                fault = _difference(same, s.points, door.exact != "close")
            del got
        except Exception as error:
            fault = f"raises {type(error).__name__}: {error}"
        if door.refuses(s) is not None:
            refused = fault is not None and fault.startswith("raises BadFile")
            self.cells.no_meaning(cell, door.refuses(s) or "")
            self.cells.judge(
                f"{cell}/refused", None if refused else f"is not BadFile: {fault}", line
            )
            return
        self.cells.judge(cell, fault, line)

    # What both compute

    def _both(self, s: PointSet) -> None:
        path = self.folder / f"{s.name}.npy"
        np.save(path, s.points)
        for name, words, made in _BOTH:
            cell = f"python/both {name}/{s.name}"
            if not self.cells.wanted(cell):
                continue
            out = self.folder / "both.json"
            ran = self.program.run([*words.format(path).split(), "-q", "-o", str(out)])
            if ran.status != 0:
                self.cells.judge(cell, f"status {ran.status}: {ran.err[:200]!r}", ran.line)
                continue
            self.cells.judge(
                cell, self._alike(made, s.points, json.loads(out.read_text())), ran.line
            )
        for kind, words, save, endings in _SAVED:
            for ending in endings.split():
                if kind.startswith("GroupHulls") and s.count == 0:
                    reason = "a file of no points has no columns for a key and coordinates"
                    self.cells.no_meaning(f"python out/{kind}/save {ending}/{s.name}", reason)
                    continue
                self._saved(kind, words, save, s, path, ending)
        self._state(s)

    def _alike(self, made: Any, points: Any, told: Any) -> Optional[str]:
        try:
            result = made(self.cullhull, points)
            for key, value in result.items():
                want = told[key]
                if isinstance(value, float):
                    if value != want:
                        return f"{key}: {value} in Python, {want} of the program"
                elif [_listed(row) for row in value] != [_listed(row) for row in want]:
                    return (
                        f"{key} differs: {str(_listed(value))[:100]} in Python, {str(want)[:100]}"
                    )
        except Exception as error:
            return f"raises {type(error).__name__}: {error}"
        return None

    def _saved(
        self, kind: str, words: str, save: Any, s: PointSet, path: Path, ending: str
    ) -> None:
        cell = f"python out/{kind}/save {ending}/{s.name}"
        if not self.cells.wanted(cell):
            return
        ours, theirs = self.folder / f"ours{ending}", self.folder / f"theirs{ending}"
        for old in (ours, theirs):
            old.unlink(missing_ok=True)
        line = words.format(path, box=_box(s.points)).split()
        ran = self.program.run([*line, "-q", "-o", str(theirs)])
        error = None
        try:
            save(self.cullhull, s.points, ours)
        except Exception as raised:
            error = Raised(raised)
        if ran.status != 0:
            fault = (
                None
                if error and "ValueError" in error.kinds and not ours.exists()
                else (
                    f"the program refuses it ({ran.err.strip()}), "
                    f"Python {error.text if error else 'writes it'}"
                )
            )
        elif error is not None:
            fault = f"raises {error.text}"
        else:
            same = ours.read_bytes() == theirs.read_bytes()
            fault = None if same else "other bytes than the program's"
        self.cells.judge(cell, fault, ran.line)

    def _state(self, s: PointSet) -> None:
        cell = f"python out/HullState of HullState/save/{s.name}"
        path = self.folder / "state.hullstate"
        try:
            state = self.cullhull.HullState(s.points)
            state.save(path)
            fault = (
                None if self.cullhull.HullState.load(path) == state else "another state is loaded"
            )
        except Exception as error:
            fault = f"raises {type(error).__name__}: {error}"
        self.cells.judge(cell, fault, "cullhull.HullState(points).save(path)")

    # generate

    def _generate(self, words: str, out: Path) -> Ran:
        return self.program.run(["generate", *words.split(), "-q", "-o", str(out)])

    def _made(self) -> None:
        told = self._generate("ball -n 9 --json", self.folder / "t.npy")
        fault = fault_of(self.program.schema, "generate_report", told.out) if told.out else told.err
        self.cells.judge("program/generate/--json", fault, told.line)
        said = self.program.help_of("generate")
        shapes = re.findall(r"^  ([\w-]+) ", said.split("Shapes:")[1].split("Motions")[0], re.M)
        known = set(self.cullhull.shapes())
        for name in sorted(known | set(shapes)):
            for d in (2, 3):
                self._shape(SIZES.get(name, name), d, name in known and name in shapes)
        for ending in (".ply", ".off", ".obj", ".xyz", ".txt", ".csv", ".geojson", ".wkt"):
            self._format(ending)
        motions = re.findall(r"^  ([\w-]+) ", said.split("Motions")[1].split("\nOutput")[0], re.M)
        for name in motions:
            cell = f"program/generate/--motion {name}"
            out = self.folder / "moving.npy"
            ran = self._generate(f"ball -n 50 --frames 3 --motion {name}", out)
            good = ran.status == 0 and np.load(out).shape == (3, 50, 3)
            self.cells.judge(cell, None if good else f"status {ran.status}: {ran.err!r}", ran.line)

    def _format(self, ending: str) -> None:
        cell, out = f"program/generate/{ending}", self.folder / f"made{ending}"
        ran = self._generate("ball -n 100 --seed 7", out)
        fault: Optional[str] = f"status {ran.status}: {ran.err!r}"
        if ran.status == 0:
            got = np.ascontiguousarray(self.cullhull.read(str(out)), np.float64)
            fault = _difference(got, self.cullhull.generate("ball", 100, 3, seed=7), True)
        self.cells.judge(cell, fault, ran.line)

    def _shape(self, shape: str, d: int, both: bool) -> None:
        cell = f"program/generate/{shape}/{d}d"
        if shape in ("disk", "circle") and d != 2:
            self.cells.no_meaning(cell, "a shape of the plane")
            return
        out = self.folder / "made.npy"
        ran = self._generate(f"{shape} -n 100 -d {d} --seed 7", out)
        if ran.status != 0 or not both:
            self.cells.judge(
                cell, f"status {ran.status}; in both lists: {both}; {ran.err!r}", ran.line
            )
            return
        same = np.load(out).tobytes() == self.cullhull.generate(shape, 100, d, seed=7).tobytes()
        self.cells.judge(cell, None if same else "other bits than cullhull.generate", ran.line)
        single = self.folder / "single.npy"
        self._generate(f"{shape} -n 100 -d {d} --seed 7 --type f32", single)
        rounded = np.array_equal(np.load(single), np.load(out).astype(np.float32))
        self.cells.judge(f"{cell}/f32", None if rounded else "not the doubles, rounded", ran.line)


def _columns(options: list[str], d: int) -> Any:
    if "--columns" not in options:
        return None
    said = options[options.index("--columns") + 1]
    return list(range(1, d + 1)) if ":" in said else said.split(",")


def _difference(got: Any, want: Any, exact: bool) -> Optional[str]:
    if exact and got.tobytes() == np.ascontiguousarray(want).tobytes():
        return None
    if np.isnan(want).any() and np.array_equal(got, want, equal_nan=True):
        return None
    if not exact and np.allclose(got, want, rtol=1e-12):
        return None
    at = np.argwhere(got.view(np.int64) != np.ascontiguousarray(want).view(np.int64))[0]
    return f"row {at[0]}: {got[at[0]].tolist()}, not {want[at[0]].tolist()}"


def _listed(row: Any) -> Any:
    return row.tolist() if hasattr(row, "tolist") else row


def _members(result: Any, names: str) -> dict[str, Any]:
    return {name: getattr(result, name) for name in names.split()}


def _hull(cullhull: Any, p: Any) -> dict[str, Any]:
    h = cullhull.convex_hull(p)
    return {
        **_members(h, "vertices facet_planes simplices centroid"),
        "facets": list(h.facets),
        "vertex_coordinates": h.vertex_points,
        "facet_neighbours": list(h.facet_neighbours),
    }


def _cells(cullhull: Any, p: Any) -> dict[str, Any]:
    names = "cells neighbours hull_facets hull_cells duplicates hidden axes"
    return _members(cullhull.delaunay(p), names)


def _diagram(cullhull: Any, p: Any) -> dict[str, Any]:
    v = cullhull.voronoi(p)
    lists = {"ridge_vertices": list(v.ridges), "regions": list(v.regions)}
    return {**_members(v, "vertices ridge_points ray_vertices ray_directions"), **lists}


def _shape(cullhull: Any, p: Any) -> dict[str, Any]:
    return _members(cullhull.alpha_shape(p), "cells facets")


def _corners(points: Any) -> tuple[Any, Any]:
    """Of a box around points: doubles that a text holds exactly."""
    known = np.where(np.isfinite(points), points, 0.0)
    low, high = known.min(axis=0, initial=0.0), known.max(axis=0, initial=1.0)
    return np.floor(low * 2) - 1, np.ceil(high * 2) + 1


def _box(points: Any) -> str:
    low, high = _corners(points)
    return ",".join(repr(float(c)) for c in (*low, *high))


def _save_delaunay(cullhull: Any, p: Any, path: Path) -> None:
    """Where SciPy's class would raise for flat points, the native function writes them."""
    whole = p.size and p.shape[1] > 1 and cullhull.delaunay(p).affine_dimension == p.shape[1]
    (cullhull.Delaunay(p) if whole else cullhull.delaunay(p)).save(path)


def _grouped(cullhull: Any, p: Any, path: Path) -> None:
    """Groups by the first coordinate, whose text is the key, as the program has it."""
    keys = [str(int(x)) if x and x.is_integer() and abs(x) < 1e5 else repr(x).removesuffix(".0")
            for x in p[:, 0].tolist()]  # fmt: skip
    cullhull.hulls_by(p[:, 1:], keys).save(path, by="column 0")


#: Results of Python, the program's words for the same, and how Python writes them: same bytes.
_SAVED = (
    (
        "Hull of convex_hull",
        "hull {}",
        lambda c, p, path: c.convex_hull(p).save(path, p),
        ".ply .obj .off .stl .glb .vtp .geojson .wkt .json .txt",
    ),
    (
        "ConvexHull of ConvexHull",
        "hull {}",
        lambda c, p, path: c.ConvexHull(p).save(path) if p.size and p.shape[1] > 1 else c.convex_hull(p).save(path, p),
        ".ply .wkt .json",
    ),
    (
        "Triangulation of delaunay",
        "delaunay {}",
        lambda c, p, path: c.delaunay(p).save(path),
        ".ply .obj .off .stl .glb .vtp .vtk .geojson .wkt .json",
    ),
    (
        "VoronoiDiagram of voronoi",
        "voronoi {}",
        lambda c, p, path: c.voronoi(p).save(path),
        ".json",
    ),
    (
        "ClippedCells of VoronoiDiagram.clip",
        "voronoi {} --box={box}",
        lambda c, p, path: c.voronoi(p).clip(*_corners(p)).save(path),
        ".ply .obj .off .vtp .geojson .wkt",
    ),
    (
        "AlphaShape of alpha_shape",
        "alpha {}",
        lambda c, p, path: c.alpha_shape(p).save(path),
        ".ply .obj .off .stl .glb .vtp .vtk .geojson .wkt .json",
    ),
    (
        "ConcaveHull of concave_hull",
        "alpha {} --ratio 0.3",
        lambda c, p, path: c.concave_hull(p, 0.3).save(path),
        ".ply .obj .off .stl .glb .vtp .vtk .geojson .wkt .json",
    ),
    ("Delaunay of Delaunay", "delaunay {}", _save_delaunay, ".ply .vtk .json"),
    ("GroupHulls of hulls_by", "hull {} --by 0 --columns 1:", _grouped, ".csv .json .geojson .ply"),
)

#: Name, command line, and the same of the package by the keys of the file.
_BOTH = (
    ("hull", "hull {}", _hull),
    ("delaunay", "delaunay {}", _cells),
    ("voronoi", "voronoi {}", _diagram),
    ("alpha", "alpha {}", _shape),
)
