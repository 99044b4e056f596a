"""Circumspheres of simplices, the planes of lifted simplices, and maps to barycentric coordinates.

All are computed in doubles: they decide nothing about a triangulation.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Doubles = npt.NDArray[np.float64]

#: The reciprocal condition number below which `transforms` gives NaN, as SciPy documents it.
_LEAST_RECIPROCAL_CONDITION = 1000 * np.finfo(np.float64).eps
#: Simplices computed on at once: between two blocks Ctrl-C is heard.
_BLOCK = 2**14


class Spheres(NamedTuple):
    """For each simplex, the centre c of the sphere through its corners, of radius r, and the power
    ``|c|**2 - r**2`` of the origin; not finite where the simplex is flat in doubles."""

    centres: Doubles  # (s, d)
    powers: Doubles  # (s,)


def _blocks(count: int) -> Iterator[slice]:
    return (slice(begin, begin + _BLOCK) for begin in range(0, count, _BLOCK))


def spheres(points: Doubles, cells: npt.NDArray[Any], weights: Doubles | None = None) -> Spheres:
    """The spheres of simplices; with weights, spheres that have equal power from all corners."""
    centres, powers = np.empty((len(cells), points.shape[1])), np.empty(len(cells))
    for block in _blocks(len(cells)):
        corners = points[cells[block]]
        first = corners[:, 0]
        edges = corners[:, 1:] - first[:, np.newaxis]
        right = 0.5 * (edges**2).sum(axis=2)
        if weights is not None:
            raised = weights[cells[block]]
            right -= 0.5 * (raised[:, 1:] - raised[:, :1])
        away = _solutions(edges, right)
        # |first + away|^2 - |away|^2, in which |away|^2, large for a flat simplex, cancels
        with np.errstate(invalid="ignore"):
            centres[block] = first + away
            powers[block] = (first * (first + 2 * away)).sum(axis=1)
            if weights is not None:
                powers[block] += raised[:, 0]
    return Spheres(centres, powers)


def planes(found: Spheres, scale: float, shift: float, *, upper: bool = False) -> Doubles:
    """(s, d + 2): outward unit normal and offset of each simplex lifted to
    ``scale * |x|**2 + shift``; of the lower hull, or the upper one."""
    count, dimension = found.centres.shape
    out = np.empty((count, dimension + 2))
    for block in _blocks(count):
        rows = out[block]
        rows[:, :-2] = 2 * scale * found.centres[block]
        rows[:, -2] = -1
        rows[:, -1] = shift - scale * found.powers[block]
        rows /= np.sqrt((rows[:, :-1] ** 2).sum(axis=1))[:, np.newaxis]
        if upper:
            np.negative(rows, out=rows)
    return out


def transforms(points: Doubles, cells: npt.NDArray[Any]) -> Doubles:
    """(s, d + 1, d): ``[i, :d] @ (x - [i, d])`` are the first d barycentric coordinates of x in
    simplex i; NaN where it is nearly flat."""
    dimension = points.shape[1]
    out = np.empty((len(cells), dimension + 1, dimension))
    for block in _blocks(len(cells)):
        _write_transforms(points[cells[block]], out[block])
    return out


def _solutions(matrices: Doubles, right: Doubles) -> Doubles:
    """The solution of each system, of least length for fewer equations than unknowns; not finite
    where the matrix is singular in doubles."""
    if matrices.shape[1] != matrices.shape[2]:
        inverses = np.linalg.pinv(matrices)
        return (inverses @ right[:, :, np.newaxis])[:, :, 0]
    out = np.full(right.shape, np.nan)
    good = _regular(matrices)
    out[good] = np.linalg.solve(matrices[good], right[good][:, :, np.newaxis])[:, :, 0]
    return out


def _write_transforms(corners: Doubles, out: Doubles) -> None:
    last = corners[:, -1]
    edges = np.swapaxes(corners[:, :-1] - last[:, np.newaxis], 1, 2)
    out[:, :-1] = _inverses(edges)
    out[:, -1] = last
    norms = np.abs(edges).sum(axis=1).max(axis=1), np.abs(out[:, :-1]).sum(axis=1).max(axis=1)
    with np.errstate(all="ignore"):
        flat = ~(1 / (norms[0] * norms[1]) >= _LEAST_RECIPROCAL_CONDITION)
    out[flat] = np.nan


def _inverses(matrices: Doubles) -> Doubles:
    out = np.full(matrices.shape, np.nan)
    good = _regular(matrices)
    out[good] = np.linalg.inv(matrices[good])
    return out


def _regular(matrices: Doubles) -> npt.NDArray[np.bool_]:
    """Those that LAPACK can factor: one singular matrix would make it refuse all of them."""
    sign, _ = np.linalg.slogdet(matrices)
    regular: npt.NDArray[np.bool_] = sign != 0
    return regular
