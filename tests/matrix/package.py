"""The cells of the Python package: calls × arrays × sets, and every way out of each result."""

from __future__ import annotations

import copy
import inspect
import pickle
import re
import warnings
from pathlib import Path
from typing import Any, Optional

import numpy as np

import arrays
from arrays import ARRAYS, FEW_ARRAYS, Array
from cells import Cells, forked
from commands import FEW_SETS
from functions import CALLS, ELSEWHERE, METHODS_ELSEWHERE, Call
from results import digest, first_difference
from sets import PointSet, generic


#: Packages whose objects are doors, and their names in the doors' expressions.
PACKAGES = {
    "pandas": "pd",
    "polars": "pl",
    "pyarrow": "pa",
    "shapely": "shapely",
    "geopandas": "geopandas",
    "trimesh": "trimesh",
    "pyogrio": "pyogrio",
    "pye57": "pye57",
}


class Raised:
    """An error in the place of a result."""

    def __init__(self, error: BaseException) -> None:
        self.kinds = [kind.__name__ for kind in type(error).__mro__]
        self.text = f"{type(error).__name__}: {error}"


def derived(points: Any, kind: Optional[str]) -> Any:
    """What a call takes in the place of points."""
    if kind == "halfspaces":  # tangent to nothing, around the origin
        return np.column_stack([points, -1 - (points * points).sum(axis=1)])
    if kind == "sphere":
        axes = np.vstack([np.eye(3), -np.eye(3)])
        return axes if np.isfinite(points).all() else axes * np.array([1, 1, np.nan])
    return points


def named(a: Any, d: int) -> dict[str, Any]:
    """What expressions may name beside the points."""
    b = generic(d)
    low = np.where(np.isfinite(a), a, 0.0).min(axis=0, initial=0.0) * 1.25 - 1
    high = np.where(np.isfinite(a), a, 0.0).max(axis=0, initial=1.0) * 1.25 + 1
    return {
        "low": low,
        "high": high,
        "a": a,
        "b": b,
        "d": d,
        "v": np.arange(len(a)) * 0.5,
        "vb": np.arange(len(b)) * 0.5,
        "w": np.arange(len(a)) % 5 / 8.0,
        "hb": derived(b, "halfspaces"),
    }


class Package:
    def __init__(self, folder: Path, cells: Cells, large: bool) -> None:
        import cullhull

        self.cullhull, self.folder, self.cells, self.large = cullhull, folder, cells, large
        self.space: dict[str, Any] = {"np": np, "cullhull": cullhull, **vars(arrays)}
        self.missing: dict[str, str] = {}
        for package, short in PACKAGES.items():
            try:
                self.space[short] = __import__(package)
            except ImportError:
                self.missing[package] = f"PyPI has not given {package}"

    def all_cells(self, sets: list[PointSet]) -> None:
        self._names()
        for call in CALLS:
            if self.cells.wanted(f"python/{call.name}") or self.cells.wanted("python out"):
                forked(self.cells, self.folder, self._all_sets, call, sets)

    def _all_sets(self, call: Call, sets: list[PointSet]) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for s in sets:
                self._call_of_set(call, s)

    def _names(self) -> None:
        """Every public name and every public method has a row, or a reason."""
        texts = " ".join(call.text for call in CALLS)
        for name in sorted(set(self.cullhull.__all__) | set(dir(self.cullhull))):
            if name in ELSEWHERE:
                self.cells.no_meaning(f"python/{name}", ELSEWHERE[name])
                continue
            known = re.search(rf"cullhull\.{name}\b", texts)
            self.cells.judge(
                f"python/names/{name}",
                None if known else "a public name without a row in functions.py, or a reason there",
                "",
            )
            kind = getattr(self.cullhull, name)
        for name in self.cullhull.__all__:
            kind = getattr(self.cullhull, name)
            if not inspect.isclass(kind) or issubclass(kind, BaseException) or "Device" in name:
                continue
            for method in dir(kind):
                if method.startswith("_") or not callable(getattr(kind, method)):
                    continue
                cell = f"{name}.{method}"
                if cell in METHODS_ELSEWHERE:
                    self.cells.no_meaning(f"python/{cell}", METHODS_ELSEWHERE[cell])
                    continue
                known = any(call.name == cell for call in CALLS)
                self.cells.judge(
                    f"python/names/{cell}",
                    (
                        None
                        if known
                        else "a public method without a row in functions.py, or a reason there"
                    ),
                    "",
                )

    def _call_of_set(self, call: Call, s: PointSet) -> None:
        start = f"python/{call.name}"
        reason = call.reason(s)
        if reason is not None:
            self.cells.no_meaning(start, reason)
            return
        given = PointSet(s.kind, derived(s.points, call.derive))
        names = named(s.points, s.dimension) | {"a": given.points}
        if call.derive == "sphere":
            names |= named(given.points, 3)
        want: Any = None
        for array in (ARRAYS[0], *ARRAYS[1:]):
            cell = f"{start}/{array.name}/{s.name}"
            why = (
                array.reason(given)
                or call.without.get(array.name)
                or self.missing.get(array.package)
            )
            if why is not None:
                self.cells.no_meaning(cell, why)
                continue
            if not self._tried(call, array, s):
                continue
            line = self._line(call, array, s)
            self.cells.starts(cell, line)
            got, result = self._outcome(call, array, names)
            if array is ARRAYS[0]:
                want = got
                self.cells.judge(cell, expected(call, s, got), line)
                if not isinstance(got, Raised):
                    self._ways_out(call, s, result, got, line)
                continue
            self.cells.judge(cell, _fault(call, array, s, got, want), line)

    def _tried(self, call: Call, array: Array, s: PointSet) -> bool:
        if self.large or array is ARRAYS[0]:
            return True
        few = array.name in FEW_ARRAYS, s.name in FEW_SETS
        return any(few) if call.arrays == "all" else all(few)

    def _outcome(self, call: Call, array: Array, names: dict[str, Any]) -> tuple[Any, Any]:
        space = self.space | names
        try:
            space["p"] = eval(array.text, space)
        except Exception as error:
            return Raised(AssertionError(f"the door {array.name} itself: {error}")), None
        try:
            result = eval(call.text, space)
        except Exception as error:
            return Raised(error), None
        return digest(result), result

    def _line(self, call: Call, array: Array, s: PointSet) -> str:
        path = self.folder / f"{s.name}.npy"
        if not path.exists():
            np.save(path, s.points)
        extra = "" if call.derive is None else f"a = derived(a, {call.derive!r}); "
        short = PACKAGES.get(array.package)
        packages = f"import {array.package} as {short}; " if short else ""
        here = Path(__file__).parent
        return (
            f'PYTHONPATH={here} python -c "import numpy as np, cullhull; from arrays import *; '
            f"from package import *; {packages}a = np.load('{path}'); {extra}"
            f'globals().update(named(a, {s.dimension})); p = {array.text}; print({call.text})"'
        ).replace("\n", " ")

    # Ways out

    def _ways_out(self, call: Call, s: PointSet, result: Any, want: Any, line: str) -> None:
        for value in result if isinstance(result, list) else [result]:
            kind = type(value)
            if not kind.__module__.startswith("cullhull"):
                continue
            start = f"python out/{kind.__name__} of {call.name}"
            for name, check in (
                ("pickle", _pickled),
                ("copy", copy.copy),
                ("deepcopy", copy.deepcopy),
            ):
                self.cells.judge(f"{start}/{name}/{s.name}", _same_after(check, value), line)
            self.cells.judge(f"{start}/==/{s.name}", _equality(value), line)
            self.cells.judge(f"{start}/repr/{s.name}", _written(value), line)
            if hasattr(value, "_repr_html_"):
                self.cells.judge(f"{start}/html/{s.name}", _html(value), line)
            else:
                self.cells.no_meaning(f"{start}/html/{s.name}", "the class has no HTML of its own")
            self._plot(start, value, s, line)

    def _plot(self, start: str, value: Any, s: PointSet, line: str) -> None:
        draw = getattr(value, "plot", None)
        if type(value).__name__ == "Delaunay" and s.dimension == 2:
            draw = lambda: (value.plot(), self.cullhull.delaunay_plot_2d(value))[-1]
        elif type(value).__name__ == "Voronoi" and s.dimension == 2:
            draw = lambda: (value.plot(), self.cullhull.voronoi_plot_2d(value))[-1]
        if draw is None:
            self.cells.no_meaning(f"{start}/plot/{s.name}", "the class has no picture")
            return
        if not start.endswith(f" of {_PLOTTED.get(type(value).__name__, '')}"):
            self.cells.no_meaning(f"{start}/plot/{s.name}", "drawn where another function made it")
            return
        if s.dimension not in (2, 3):
            self.cells.no_meaning(f"{start}/plot/{s.name}", "pictures are of the plane or of space")
            return
        if s.kind in ("huge", "wide", "tiny"):
            self.cells.no_meaning(f"{start}/plot/{s.name}", "Matplotlib's axes do not reach so far")
            return
        self.cells.judge(f"{start}/plot/{s.name}", _drawn(draw), line)


#: The call after which each class is drawn.
_PLOTTED = {
    "AlphaShape": "alpha_shape",
    "ClippedCells": "VoronoiDiagram.clip",
    "ConcaveHull": "concave_hull",
    "ConstrainedTriangulation": "constrained_delaunay",
    "ConvexHull": "ConvexHull",
    "Delaunay": "Delaunay",
    "GroupHulls": "hulls_by",
    "Hull": "convex_hull",
    "HullBatch": "convex_hulls",
    "HullState": "HullState",
    "TolerantConvexHull": "TolerantConvexHull",
    "TolerantDelaunay": "TolerantDelaunay",
    "TolerantVoronoi": "TolerantVoronoi",
    "Triangulation": "delaunay",
    "Voronoi": "Voronoi",
    "VoronoiDiagram": "voronoi",
}


def expected(call: Call, s: PointSet, got: Any) -> Optional[str]:
    """Whether a set gives a result, or the error that it is to raise."""
    error = call.raises(s)
    if isinstance(got, Raised):
        return (
            None
            if error in got.kinds
            else f"raises {got.text}" + (f", not {error}" if error else "")
        )
    return None if error is None else f"returns {str(got)[:100]}, where {error} is due"


def _fault(call: Call, array: Array, s: PointSet, got: Any, want: Any) -> Optional[str]:
    """Whether a door gives what the reference door gave."""
    if array.refused is not None:
        if isinstance(got, Raised) and array.refused in got.kinds:
            return None
        return (
            f"{got.text if isinstance(got, Raised) else 'is taken'}, where {array.refused} is due"
        )
    if isinstance(want, Raised):
        fault = expected(call, s, got)
        return f"{fault}; by the reference {want.text}" if fault else None
    if isinstance(got, Raised):
        return f"raises {got.text}"
    return None if got == want else first_difference(got, want)


def _pickled(value: Any) -> Any:
    return pickle.loads(pickle.dumps(value))


def _same_after(way: Any, value: Any) -> Optional[str]:
    try:
        again = way(value)
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    a, b = digest(again), digest(value)
    return None if a == b else first_difference(a, b)


def _equality(value: Any) -> Optional[str]:
    try:
        same, other = value == value, value == 3
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    if same is True and other is False:
        return None
    return f"value == value gives {same!r}, value == 3 gives {other!r}"


def _written(value: Any) -> Optional[str]:
    try:
        text = repr(value)
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    if " at 0x" in text:
        return f"says where it lies, not what it is: {text[:120]}"
    return (
        None
        if len(text.splitlines()) == 1 or hasattr(value, "_fields")
        else f"several lines: {text[:120]}"
    )


def _html(value: Any) -> Optional[str]:
    import xml.etree.ElementTree as xml

    try:
        text = value._repr_html_()
        xml.fromstring(text)
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    return f"says nan: {text[:200]}" if re.search(r"\bnan\b", text) else None


def _drawn(draw: Any) -> Optional[str]:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    try:
        found = draw()
        figure = found if hasattr(found, "savefig") else found.figure
        figure.canvas.draw()
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    finally:
        plt.close("all")
    return None
