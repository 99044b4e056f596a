"""Interactive pages: those that the program makes, also of what it has no page for."""

from __future__ import annotations

import base64
import html as markup
import json
import os
import re
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_points
from .._errors import BackendUnavailable, Error, InvalidArgument
from ._forms import Surface, Table, Volume, edges_of, following

#: Bytes of a page's arrays; in base64 they take a third more.
_MOST_BYTES = 9_000_000


def _made(arguments: list[str]) -> str:
    """What ``cullhull view`` writes."""
    import subprocess
    import tempfile
    from pathlib import Path

    from ..__main__ import program

    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "page.html")
        done = subprocess.run(
            [program(), "view", "-q", *arguments, "-o", page],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode == 5:
            raise BackendUnavailable(done.stderr.strip())
        if done.returncode != 0:
            raise Error(done.stderr.strip())
        return Path(page).read_text(encoding="utf-8")


def page_of_hull(hull: _core.Solid, points: Any) -> str:
    """The page of a hull, with the points that it was computed from if they are given."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        if points is None:
            source = os.path.join(folder, "hull.json")
            _core.save(source, hull, None, "", None)
        else:
            source = os.path.join(folder, "points.npy")
            np.save(source, as_points(points))
        return _made([source])


class Sites(NamedTuple):
    """The points of a diagram, and the measure of the cell of each."""

    points: npt.NDArray[Any]
    measures: npt.NDArray[np.float64]


def page_of_surface(
    surface: Surface,
    edges: npt.NDArray[np.int64] | None,
    table: Table,
    sites: Sites | None = None,
) -> str:
    """The page of polygons, with their own edges unless others are given, or of the cells of
    sites: then the numbers of the corners are those of the sites."""
    if edges is None:
        corners = np.asarray(surface.polygons.items)
        ahead = corners[following(np.asarray(surface.polygons.offsets))]
        edges = edges_of(np.column_stack([corners, ahead]))
    points, ids, _, triangles, pieces, _ = surface
    return _page(points, ids, edges, triangles, table, facets=pieces, sites=sites)


def page_of_cells(volume: Volume, boundary: npt.NDArray[np.int64], table: Table) -> str:
    """The page of tetrahedra, which a plane cuts, and their boundary."""
    edges = edges_of(boundary)
    numbers = np.arange(len(boundary))
    points, ids, tetrahedra, _ = volume
    return _page(points, ids, edges, boundary, table, facets=numbers, cells=tetrahedra)


class _Bytes:
    """The block of bytes that a page's arrays are in."""

    def __init__(self) -> None:
        self.data = bytearray()

    def add(self, array: npt.NDArray[Any], kind: str) -> list[Any]:
        self.data += b"\0" * (-len(self.data) % 8)
        start = len(self.data)
        numpy_kind = {"u32": "<u4", "f64": "<f8"}[kind]
        self.data += np.ascontiguousarray(array, dtype=numpy_kind).tobytes()
        return [start, array.size, kind]


def _page(
    points: npt.NDArray[np.float64],
    ids: npt.NDArray[Any],
    edges: npt.NDArray[Any],
    triangles: npt.NDArray[Any],
    table: Table,
    *,
    facets: npt.NDArray[Any],
    cells: npt.NDArray[Any] | None = None,
    sites: Sites | None = None,
) -> str:
    count, dimension = points.shape
    held = _Bytes()
    corners = count
    if sites is not None:  # rows behind those of the corners
        points = np.concatenate([points, np.asarray(sites.points, dtype=np.float64)])
        ids = np.concatenate([ids, np.arange(len(sites.points))])
    frame: dict[str, Any] = {
        "index": 0,
        "affine_dimension": dimension,
        "has_points": True,
        "simplified": False,
        "edges_sampled": False,
        "vertices": count,
        "survivors": 0,
        "points": 0,
        "all_vertices": count,
        "all_survivors": 0,
        "all_points": 0,
        "ids": held.add(ids, "u32"),
        "coordinates": held.add(points, "f64"),
        "edges": held.add(edges, "u32"),
        "triangles": held.add(triangles, "u32"),
        "facets": held.add(facets, "u32"),
        "notes": [f"All {count:,} points and {len(edges):,} edges."],
        "report": {
            "affine_dimension": dimension,
            "points": {"count": count, "dimension": dimension},
            "facet_count": int(facets.max(initial=-1)) + 1,
            "rows": list(table.rows),
        },
    }
    if sites is not None:
        given = len(sites.points)
        frame.update(survivors=given, all_survivors=given)
        frame.update(point_name="Site", vertex_name="Corner of cell")
        frame["measures"] = held.add(sites.measures, "f64")
        frame["notes"] = [f"All {given:,} sites and {corners:,} corners of their cells."]
        frame["report"]["points"]["count"] = given
    if cells is not None:
        frame["cell_corners"], frame["cell_points"] = 4, count
        frame["cells"] = held.add(cells, "u32")
        frame["notes"].append("Cells are seen where the clip plane cuts them.")
    if len(held.data) > _MOST_BYTES:
        raise InvalidArgument(
            f"{table.caption} of {count:,} points is too large for a page of 12 MB"
        )
    return _filled(_template(dimension), table.caption, frame, bytes(held.data))


def _template(dimension: int) -> str:
    """A page of a simplex."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "simplex.json")
        corners = np.vstack([np.zeros(dimension), np.eye(dimension)])
        _core.save(source, _core.convex_hull(corners, None), None, "", None)
        return _made([source])


def _filled(page: str, title: str, frame: dict[str, Any], data: bytes) -> str:
    """Another scene in the place of a page's."""
    scene = json.loads(_script(page, "scene"))
    scene["frames"] = [frame]
    page = _replaced(page, "scene", json.dumps(scene).replace("<", "\\u003c"))
    page = _replaced(page, "bytes", base64.b64encode(data).decode())
    return re.sub("<title>.*?</title>", f"<title>{markup.escape(title)}</title>", page, count=1)


def _place(page: str, name: str) -> tuple[int, int]:
    found = re.search(rf'<script[^>]*\bid="{name}"[^>]*>', page)
    if found is None:
        raise Error(f"the viewer's page has no {name}")
    return found.end(), page.index("</script>", found.end())


def _script(page: str, name: str) -> str:
    begin, end = _place(page, name)
    return page[begin:end]


def _replaced(page: str, name: str, text: str) -> str:
    begin, end = _place(page, name)
    return page[:begin] + text + page[end:]
