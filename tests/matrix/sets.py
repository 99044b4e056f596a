"""The point sets of the matrix: every kind that a hull, a triangulation or a reader may stumble on.

Coordinates are multiples of 1/8 wherever nothing else is the point of a set: such a number is the
same in doubles, floats, decimals and on the grids of the LAS files, so that every door can carry it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np


@dataclass(frozen=True, eq=False)
class PointSet:
    """A set of points, (n, d) doubles."""

    kind: str  #: what is awkward about it: a name of `KINDS`
    points: Any
    #: (whole numbers, scale, offset) of a LAS file whose grid no binary fraction holds.
    grid: Optional[tuple[Any, Any, Any]] = field(default=None)

    @property
    def name(self) -> str:
        return f"{self.kind}-{self.dimension}d"

    @property
    def count(self) -> int:
        return int(self.points.shape[0])

    @property
    def dimension(self) -> int:
        return int(self.points.shape[1])

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.points).all())

    @property
    def affine_dimension(self) -> int:
        """Of the flat that the points span: -1 without points."""
        if self.count == 0:
            return -1
        if self.kind in ("flat", "collinear"):
            return 1 if self.kind == "collinear" else self.dimension - 1
        return min(self.dimension, len(np.unique(self.points, axis=0)) - 1)

    @property
    def has_minus_zero(self) -> bool:
        return bool(((self.points == 0) & np.signbit(self.points)).any())

    @property
    def integral(self) -> bool:
        return self.finite and bool((self.points == np.rint(self.points)).all())

    def fits(self, dtype: Any) -> bool:
        """Whether every coordinate is exactly one of this type."""
        kind = np.dtype(dtype)
        if kind.kind == "f":
            with np.errstate(over="ignore"):
                return bool(np.array_equal(self.points.astype(kind), self.points, equal_nan=True))
        if not self.integral or self.has_minus_zero:
            return False
        limits = np.iinfo(kind)
        p = self.points
        return p.size == 0 or bool(p.min() >= float(limits.min) and p.max() <= float(limits.max))


#: What each kind is, for the listing.
KINDS = {
    "empty": "no points",
    "one": "a single point",
    "repeated": "three times the same point",
    "few": "d points: one too few for a simplex",
    "simplex": "d + 1 points",
    "generic": "24 points in general position",
    "doubles": "40 points that use all bits of a double",
    "flat": "points of a hyperplane",
    "collinear": "points of a line",
    "duplicates": "every point twice",
    "nan": "a NaN among the coordinates",
    "infinite": "an infinity among the coordinates",
    "minus-zero": "zeros of both signs",
    "huge": "coordinates near 1e300",
    "tiny": "coordinates near 1e-300",
    "wide": "coordinates near 1e300 beside others near 1e-300",
    "integers": "whole numbers from 0 to 100",
    "lattice": "all of {0, 1, 2}^d: cospherical, with points on edges and facets",
    "decimal": "a grid of hundredths and thousandths, as scans have",
}


def generic(d: int, n: int = 24, seed: int = 5) -> Any:
    """Points of which no d + 1 share a hyperplane and no d + 2 a sphere."""
    rng = np.random.default_rng(seed + d)
    return np.unique(rng.integers(-500, 500, (n, d)), axis=0)[rng.permutation(n)] / 8.0


def _flat(d: int) -> Any:
    base = generic(max(d - 1, 1), 16, 11)
    if d == 1:
        return np.full((5, 1), 2.5)
    last = base @ np.arange(1, d) - 3.0
    return np.column_stack([base, last])


def _decimal(d: int) -> PointSet:
    rng = np.random.default_rng(70 + d)
    scale = np.array([0.01, 0.01, 0.001])[:d]
    offset = np.array([484000.0, 5410000.0, -12.5])[:d]
    numbers = rng.integers(-40000, 40000, (24, d)).astype(np.int32)
    return PointSet("decimal", numbers * scale + offset, (numbers, scale, offset))


def _points_of(kind: str, d: int) -> Any:
    rng = np.random.default_rng(900 + d)
    spread = generic(d)
    if kind == "empty":
        return np.zeros((0, d))
    if kind == "one":
        return np.array([[3.0, -5.5, 7.25, 2.0][:d]])
    if kind == "repeated":
        return np.repeat(_points_of("one", d), 3, axis=0)
    if kind in ("few", "simplex"):
        corners = np.vstack([np.zeros(d), np.diag(np.arange(2.0, d + 2))]) + 1
        return corners[: d if kind == "few" else d + 1]
    if kind == "generic":
        return spread
    if kind == "doubles":
        return rng.normal(size=(40, d))
    if kind == "flat":
        return _flat(d)
    if kind == "collinear":
        return rng.permutation(np.arange(-4.0, 5.0))[:, None] * np.array([1.0, -2, 0.5, 3])[:d] + 1
    if kind == "duplicates":
        return np.vstack([spread[:12], spread[:12][::-1]])
    if kind in ("nan", "infinite"):
        broken = spread.copy()
        broken[7, d - 1] = np.nan if kind == "nan" else -np.inf
        return broken
    if kind == "minus-zero":
        signs = np.array(np.meshgrid(*[[-0.0, 1.0]] * d)).reshape(d, -1).T
        return np.vstack([signs, np.abs(signs), spread[:3] / 64])
    if kind == "huge":
        return rng.normal(size=(20, d)) * 1e300
    if kind == "tiny":
        return rng.normal(size=(20, d)) * 1e-300
    if kind == "wide":
        return rng.normal(size=(20, d)) * np.where(rng.random((20, d)) < 0.5, 1e300, 1e-300)
    if kind == "integers":
        return rng.integers(0, 101, (30, d)).astype(float)
    if kind == "lattice":
        return np.array(np.meshgrid(*[[0.0, 1, 2]] * d)).reshape(d, -1).T
    raise ValueError(kind)


def _made(kind: str, d: int) -> PointSet:
    return _decimal(d) if kind == "decimal" else PointSet(kind, np.ascontiguousarray(_points_of(kind, d)))


#: Kinds that a line and four dimensions get in a short run.
_SHORT = ("empty", "generic", "duplicates", "nan", "lattice")


def point_sets(large: bool) -> list[PointSet]:
    """Every kind in the plane and in space; on the line and in 4D all of them in a long run."""
    result = []
    for d in (2, 3, 1, 4):
        for kind in KINDS:
            if kind == "decimal" and d not in (2, 3):
                continue
            if kind in ("flat", "collinear") and d == 1:
                continue
            if d in (2, 3) or large or kind in _SHORT:
                result.append(_made(kind, d))
    return result
