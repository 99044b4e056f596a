"""How far results may lie apart whose points are decimals by one door and doubles by another.

A scan on a decimal grid is computed as the decimals that it holds; the reference file holds the
doubles next to them. Each coordinate differs by at most half a unit in its last place, e, and ids
are the same; where corners of a diagram lie follows from the points they belong to.
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: Errors of second order, and the roundings of the bounds and of the results themselves.
_ROOM = 2


def _unit(points: Any) -> float:
    return float(np.spacing(np.abs(points).max()))


def corners(diagram: dict[str, Any], points: Any) -> Any:
    """A bound for each vertex. With edges E from the first of its points, of lengths |e_i|, the
    corner c seen from there solves E c = b, b_i = (|e_i|^2 - w_i + w_0) / 2. Where coordinates move
    by e, entries of E move by 2 e and b_i by 2 e |e_i|_1, so that c moves by at most
    |E^-1| 2 e (max |e_i|_1 + |c|_1), and the point itself by e."""
    owners: list[list[int]] = [[] for _ in diagram["vertices"]]
    for point, region in enumerate(diagram["regions"]):
        for v in region:
            if v >= 0:
                owners[v].append(point)
    unit = _unit(points)
    bounds = []
    for vertex, own in zip(diagram["vertices"], owners):
        edges = points[own[1:]] - points[own[0]]
        seen = np.abs(np.array(vertex) - points[own[0]]).sum()
        inverse = np.abs(np.linalg.pinv(edges)).sum(axis=1).max()
        bounds.append(inverse * unit * (np.abs(edges).sum(axis=1).max() + seen) + unit)
    return _ROOM * np.array(bounds)


def rays(points: Any) -> float:
    """A bound for unit vectors along rays, which are at right angles to facets of the hull: one
    of edges F turns by at most |F^+| times what the edges move by, 2 e sqrt(d) each."""
    from scipy.spatial import ConvexHull

    d = points.shape[1]
    flattest = max(
        np.linalg.norm(np.linalg.pinv(points[f[1:]] - points[f[0]]), 2)
        for f in ConvexHull(points, qhull_options="Qt").simplices
    )
    return float(_ROOM * flattest * _unit(points) * d)


def same_diagram(got: dict[str, Any], want: dict[str, Any], points: Any) -> bool:
    """The same cells, corners where the decimals have them, rays along the same lines: a ray's
    length means nothing."""
    for key in want:
        if key not in ("vertices", "ray_directions", "points") and got[key] != want[key]:
            return False
    apart = np.abs(np.array(got["vertices"]) - np.array(want["vertices"]))
    if (apart > corners(want, points)[:, None]).any():
        return False
    a, b = (np.array(x["ray_directions"]) for x in (got, want))
    a, b = (x / np.linalg.norm(x, axis=1)[:, None] for x in (a, b))
    return bool((np.abs(a - b) <= rays(points)).all())
