"""A slow, obvious hull to compare with: every facet by trying all subsets, in exact fractions."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any


def determinant(rows: list[list[Fraction]]) -> Fraction:
    if not rows:
        return Fraction(1)
    return sum(
        (
            (-1) ** j * rows[0][j] * determinant([row[:j] + row[j + 1 :] for row in rows[1:]])
            for j in range(len(rows))
            if rows[0][j]
        ),
        Fraction(0),
    )


def facets(points: Any) -> set[frozenset[int]]:
    """Sets of indices of all points on each facet's plane, for full-dimensional points."""
    exact = [[Fraction(float(x)) for x in point] for point in points]
    d = len(exact[0])
    found = set()
    for corner in itertools.combinations(range(len(exact)), d):
        sides = []
        for point in exact:
            rows = [[a - b for a, b in zip(exact[i], point)] for i in corner]
            value = determinant(rows)
            sides.append((value > 0) - (value < 0))
        if any(sides) and (min(sides) >= 0 or max(sides) <= 0):
            found.add(frozenset(i for i, side in enumerate(sides) if side == 0))
    return found


def vertices(points: Any) -> list[int]:
    """Extreme points: those that are a facets' only common point, of equal ones the lowest."""
    planes = facets(points)
    extreme = []
    for i in range(len(points)):
        mine = [plane for plane in planes if i in plane]
        common = frozenset.intersection(*mine) if mine else frozenset()
        if common and i == min(common) and all(tuple(points[j]) == tuple(points[i]) for j in common):
            extreme.append(i)
    return extreme
