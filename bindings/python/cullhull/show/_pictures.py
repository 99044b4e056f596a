"""Pictures of results: Matplotlib, small ones for notebooks, and interactive pages."""

from __future__ import annotations

import html as markup
import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .._extras import needed
from ._forms import Picture, Rows, Table

#: A notebook shows no picture of more shapes.
MOST_SHAPES = 3000
_SVG_SIZE = 220.0
_FILLED = {"facecolor": "tab:blue", "edgecolor": "black", "linewidth": 0.5, "alpha": 0.4}
#: From this number of polygons on, translucent faces and black edges look like a heap of lines.
_MANY_POLYGONS = 100
_LINES = {"color": "tab:blue", "linewidth": 0.8}

# Matplotlib


def plot(picture: Picture, ax: Any, style: dict[str, Any]) -> Any:
    pyplot = needed("matplotlib.pyplot", "plot()", "plot")
    everything = _everything(picture)
    solid = everything.shape[1] == 3
    if ax is None:
        ax = pyplot.figure().add_subplot(projection="3d" if solid else None)
    if len(picture.polygons):
        look = {**_FILLED, **(_shaded(picture) if solid else {}), **style}
        ax.add_collection(_filled(picture, solid, look))
        style = {}
    if len(picture.segments):
        collections = needed("matplotlib.collections", "plot()", "plot")
        art = needed("mpl_toolkits.mplot3d.art3d", "plot()", "plot")
        kind = art.Line3DCollection if solid else collections.LineCollection
        ax.add_collection(kind(picture.segments, **{**_LINES, **style}))
        style = {}
    if picture.dots is not None and len(picture.dots):
        ax.plot(*picture.dots.T, **{"color": "tab:blue", "marker": "o", "linestyle": "", **style})
    if len(everything):
        ax.auto_scale_xyz(*everything.T) if solid else ax.update_datalim(everything)
        ax.autoscale_view()
    if picture.frame is not None and len(picture.frame):
        _reach(ax, picture.frame)
    ax.set_aspect("equal")
    return ax


def _everything(picture: Picture) -> Rows:
    """All the coordinates that a picture should have room for."""
    if picture.frame is not None:
        return picture.frame
    rows = [rings[0] for rings in picture.polygons]
    rows += list(picture.segments)
    if picture.dots is not None:
        rows.append(picture.dots)
    return np.concatenate(rows) if rows else np.empty((0, 2))


def _filled(picture: Picture, solid: bool, look: dict[str, Any]) -> Any:
    if solid:
        art = needed("mpl_toolkits.mplot3d.art3d", "plot()", "plot")
        return art.Poly3DCollection([rings[0] for rings in picture.polygons], **look)
    collections = needed("matplotlib.collections", "plot()", "plot")
    path = needed("matplotlib.path", "plot()", "plot").Path
    return collections.PathCollection(
        [
            path.make_compound_path(*(path(np.vstack([r, r[:1]]), closed=True) for r in rings))
            for rings in picture.polygons
        ],
        **look,
    )


def _shaded(picture: Picture) -> dict[str, Any]:
    """The look of a surface of many polygons: opaque, lit from above, with faint edges."""
    if not picture.surface or len(picture.polygons) <= _MANY_POLYGONS:
        return {}
    lit = np.array([_normal(rings[0]) for rings in picture.polygons]) @ [-0.4, -0.55, 0.73]
    shades = (0.55 + 0.45 * np.clip(lit, -0.6, 1))[:, np.newaxis]
    colours = np.clip(shades * [0.42, 0.68, 0.92], 0, 1)
    return {
        "facecolor": colours,
        "edgecolor": (0, 0, 0, 0.25),
        "linewidth": max(0.05, 0.5 * (_MANY_POLYGONS / len(picture.polygons)) ** 0.5),
        "alpha": None,
    }


def _reach(ax: Any, frame: Rows) -> None:
    margin = 0.1 * np.ptp(frame, axis=0)
    low, high = frame.min(axis=0) - margin, frame.max(axis=0) + margin
    for axis, least, most in zip("xyz", low, high):
        if least < most:
            getattr(ax, f"set_{axis}lim")(least, most)


# Pages


class Page(str):
    """The path of a page; a notebook shows the page itself."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        text = Path(self).read_text(encoding="utf-8")
        return (
            f"<iframe srcdoc='{markup.escape(text)}' width='100%' height='600' "
            "style='border:0' allow='fullscreen'></iframe>"
        )


def shown(page: str, path: str | os.PathLike[str] | None, show: bool) -> Page:
    """Writes a page, and opens it in a browser unless a notebook is going to show it."""
    import tempfile
    import webbrowser

    from .._errors import FileError

    if path is None:
        handle, name = tempfile.mkstemp(prefix="cullhull-", suffix=".html")
        os.close(handle)
    else:
        name = os.path.abspath(os.fspath(path))
    try:
        Path(name).write_text(page, encoding="utf-8")
    except OSError as error:
        raise FileError(f"{name}: {error.strerror}") from None
    if show and not _in_notebook():
        webbrowser.open(Path(name).as_uri())
    return Page(name)


def _in_notebook() -> bool:
    """Whether this process is the kernel of a notebook, whose cells show what they end with."""
    import sys

    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None else None
    return getattr(running, "kernel", None) is not None


# Notebooks


def html(table: Table, picture: Picture | None) -> str:
    cells = "".join(
        f"<tr><th style='text-align:left'>{name}</th><td>{markup.escape(value)}</td></tr>"
        for name, value in table.rows
    )
    text = f"<table><caption>{markup.escape(table.caption)}</caption>{cells}</table>"
    drawn = "" if picture is None else svg(picture)
    return f"<div style='display:flex;align-items:center;gap:2em'>{text}{drawn}</div>"


def svg(picture: Picture) -> str:
    """A picture of few shapes; empty where there is nothing to draw."""
    with np.errstate(all="ignore"):
        return _svg(picture)


def _svg(picture: Picture) -> str:
    count = len(picture.polygons) + len(picture.segments)
    if not 0 < count <= MOST_SHAPES:
        return ""
    polygons, shades = [list(rings) for rings in picture.polygons], [0.85] * len(picture.polygons)
    segments = list(picture.segments)
    everything = _everything(picture)
    if everything.shape[1] == 3:
        polygons, shades = _turned(polygons)
        segments = [_projected(rows) for rows in segments]
        everything = _projected(everything)
    low = everything.min(axis=0)
    extent = float((everything.max(axis=0) - low).max())
    if not 0 < extent < np.inf:
        return ""

    def placed(rows: Rows) -> str:
        xy = (rows - low) / extent * (_SVG_SIZE - 4) + 2
        return " ".join(f"{x:.1f},{_SVG_SIZE - y:.1f}" for x, y in xy)

    shapes = []
    for rings, shade in zip(polygons, shades):
        fill = f"fill='hsl(210,60%,{100 * shade:.0f}%)'"
        if len(rings) == 1:
            shapes.append(f"<polygon points='{placed(rings[0])}' {fill}/>")
        else:
            path = "".join(f"M{placed(ring)}Z" for ring in rings)
            shapes.append(f"<path d='{path}' fill-rule='evenodd' {fill}/>")
    shapes += [f"<polyline points='{placed(rows)}' fill='none'/>" for rows in segments]
    return (
        f"<svg width='{_SVG_SIZE:.0f}' height='{_SVG_SIZE:.0f}' stroke='#224' "
        f"stroke-width='0.5' stroke-linejoin='round'>{''.join(shapes)}</svg>"
    )


_AXES = np.array([[0.866, -0.5, 0.0], [-0.25, -0.433, 0.866], [0.433, 0.75, 0.5]])


def _projected(rows: Rows) -> Rows:
    flat: Rows = rows @ _AXES[:2].T
    return flat


def _turned(polygons: list[list[Rows]]) -> tuple[list[list[Rows]], list[float]]:
    """The polygons of space that face the viewer, the farthest first, and their shades."""
    found: list[tuple[float, int, Rows, float]] = []
    for (outline, *_) in polygons:
        facing = float(_normal(outline) @ -_AXES[2])
        if len(polygons) == 1:  # flat: it has no back
            facing = abs(facing)
        if facing > 0:
            depth = float((outline @ -_AXES[2]).mean())
            found.append((depth, len(found), _projected(outline), 0.55 + 0.4 * facing))
    found.sort(key=lambda shape: shape[:2])
    return [[outline] for _, _, outline, _ in found], [shade for _, _, _, shade in found]


def _normal(outline: Rows) -> npt.NDArray[np.float64]:
    """The unit normal of a polygon; zero for one without an area."""
    edges = outline - outline[0]
    sum_ = np.cross(edges[1:-1], edges[2:]).sum(axis=0)
    length = float(np.linalg.norm(sum_))
    return sum_ / length if 0 < length < np.inf else np.zeros(3)
