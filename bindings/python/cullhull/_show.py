"""Pictures of hulls: Matplotlib, and a small one for notebooks."""

from __future__ import annotations

import html as markup
import os
import subprocess
import tempfile
import webbrowser
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_points
from ._errors import BackendUnavailable, Error, InvalidArgument

_SVG_FACETS = 3000
_SVG_SIZE = 220.0


def polygons(hull: _core.Solid) -> list[npt.NDArray[np.float64]]:
    """The facets as (m, d) outlines; a hull in its own plane is one polygon."""
    if hull.affine_dimension == 2:
        return [hull.vertex_points]
    order = np.argsort(hull.vertices)
    places = order[np.searchsorted(hull.vertices, hull.facet_vertices, sorter=order)]
    offsets = hull.facet_offsets
    return [
        hull.vertex_points[places[offsets[i] : offsets[i + 1]]] for i in range(hull.facet_count)
    ]


def plot(hull: _core.Solid, ax: Any, style: dict[str, Any]) -> Any:
    if hull.dimension not in (2, 3):
        raise InvalidArgument(f"plot() draws hulls in 2D and 3D, not {hull.dimension}D")
    try:
        import matplotlib.pyplot as plt
        from matplotlib.collections import PolyCollection
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    except ImportError:
        raise ImportError("plot() draws with Matplotlib; pip install matplotlib") from None
    if ax is None:
        ax = plt.figure().add_subplot(projection="3d" if hull.dimension == 3 else None)
    corners = hull.vertex_points
    if hull.affine_dimension >= 2:
        kind: Any = Poly3DCollection if hull.dimension == 3 else PolyCollection
        look: dict[str, Any] = {"facecolor": "tab:blue", "edgecolor": "black", "linewidth": 0.5, "alpha": 0.4}
        ax.add_collection(kind(polygons(hull), **(look | style)))
    else:
        ax.plot(*corners.T, color="tab:blue", marker="o")
    if len(corners):
        ax.auto_scale_xyz(*corners.T) if hull.dimension == 3 else ax.update_datalim(corners)
        ax.autoscale_view()
    ax.set_aspect("equal")
    return ax


def view(hull: _core.Solid, points: Any, path: Any, show: bool) -> str:
    """By the command line's own viewer, which reads files."""
    from .__main__ import program

    if path is None:
        handle, page = tempfile.mkstemp(prefix="hull-", suffix=".html")
        os.close(handle)
    else:
        page = os.path.abspath(os.fspath(path))
    with tempfile.TemporaryDirectory() as folder:
        if points is None:
            source = os.path.join(folder, "hull.json")
            _core.save(source, hull, None, "")
        else:
            source = os.path.join(folder, "points.npy")
            np.save(source, as_points(points))
        done = subprocess.run(
            [program(), "view", source, "-o", page], capture_output=True, text=True, check=False
        )
    if done.returncode == 5:
        raise BackendUnavailable(done.stderr.strip())
    if done.returncode != 0:
        raise Error(done.stderr.strip())
    if show:
        webbrowser.open(Path(page).as_uri())
    return page


def html(hull: _core.Solid, certificate: _core.Certificate | None) -> str:
    rows = [
        ("points", f"{hull.point_count:,} in {hull.dimension}D"),
        ("affine dimension", str(hull.affine_dimension)),
        ("vertices", f"{len(hull.vertices):,}"),
        ("facets", f"{hull.facet_count:,} ({hull.simplex_count:,} simplices)"),
        ("volume", f"{hull.volume:.6g}"),
        ("area", f"{hull.area:.6g}"),
        ("computed in", f"{hull.statistics['compute_seconds'] * 1e3:.3g} ms"),
    ]
    if certificate is not None:
        rows.append(("certified", "yes" if certificate else "no"))
    cells = "".join(
        f"<tr><th style='text-align:left'>{name}</th><td>{markup.escape(value)}</td></tr>"
        for name, value in rows
    )
    table = f"<table><caption>Convex hull</caption>{cells}</table>"
    return f"<div style='display:flex;align-items:center;gap:2em'>{table}{svg(hull)}</div>"


def svg(hull: _core.Solid) -> str:
    """The facets turned to the viewer, as outlines; empty where there is nothing to draw."""
    if (
        hull.dimension not in (2, 3)
        or hull.affine_dimension < 2
        or hull.facet_count > _SVG_FACETS
    ):
        return ""
    outlines = polygons(hull)
    shades = [0.85] * len(outlines)
    if hull.dimension == 3:
        across, up, towards = np.array(
            [[0.866, -0.5, 0.0], [-0.25, -0.433, 0.866], [0.433, 0.75, 0.5]]
        )
        if hull.affine_dimension == 3:
            facing = hull.facet_planes[:, :3] @ -towards
            outlines = [o for o, f in zip(outlines, facing) if f > 0]
            shades = [0.55 + 0.4 * float(f) for f in facing if f > 0]
        outlines = [np.column_stack([o @ across, o @ up]) for o in outlines]
    everything = np.vstack(outlines)
    low = everything.min(axis=0)
    extent = float((everything.max(axis=0) - low).max())
    if not 0 < extent < np.inf:
        return ""
    shapes = []
    for outline, shade in zip(outlines, shades):
        xy = (outline - low) / extent * (_SVG_SIZE - 4) + 2
        text = " ".join(f"{x:.1f},{_SVG_SIZE - y:.1f}" for x, y in xy)
        shapes.append(f"<polygon points='{text}' fill='hsl(210,60%,{100 * shade:.0f}%)'/>")
    return (
        f"<svg width='{_SVG_SIZE:.0f}' height='{_SVG_SIZE:.0f}' stroke='#224' "
        f"stroke-width='0.5' stroke-linejoin='round'>{''.join(shapes)}</svg>"
    )
