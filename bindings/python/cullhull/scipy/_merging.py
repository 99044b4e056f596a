"""Cells of a triangulation that are one but for rounding, and what is left of it without them.

All is computed in doubles, on points scaled by a power of two so that none is larger than one.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .._errors import InvalidArgument
from .._lists import Lists, first_places
from .._triangulation import Triangulation
from .._voronoi import VoronoiDiagram

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

#: Pairs of cells computed on at once: between two blocks Ctrl-C is heard.
_BLOCK = 2**16


def rounding_distance(points: Doubles) -> float:
    """As `Hull.rounding_distance`: what turning and shifting in doubles can do."""
    dimension = points.shape[1]
    return float(64 * dimension * np.sqrt(dimension) * 2.0**-53 * np.abs(points).max())


class Scaled(NamedTuple):
    """A triangulation's points with the largest coordinate between 1/2 and 1."""

    points: Doubles
    exponent: int

    @classmethod
    def of(cls, points: Doubles) -> Scaled:
        exponent = int(np.frexp(np.abs(points).max())[1])
        return cls(np.ldexp(points, -exponent), exponent)

    def down(self, lengths: Any) -> Any:
        return np.ldexp(lengths, -self.exponent)

    def up(self, length: float) -> float:
        return float(np.ldexp(length, self.exponent))


class Peeled(NamedTuple):
    """Which cells are left when flat ones at the boundary are dropped."""

    kept: npt.NDArray[np.bool_]
    distance: float  #: the largest height of a dropped cell above the facet it was dropped through


def peel(found: Triangulation, scaled: Scaled, tolerance: float) -> Peeled:
    """Drops cells one facet of which is at the boundary, and whose other corner is within
    ``tolerance`` of that facet's plane; again, until there is none."""
    cells, neighbours = found.cells, found.neighbours.astype(np.int64)
    kept, farthest = np.ones(len(cells), dtype=bool), 0.0
    cell, slot = np.nonzero(neighbours < 0)
    while tolerance > 0 and len(cell) > 0:
        heights = _heights(scaled.points, cells[cell], slot)
        flat = heights <= tolerance
        farthest = max(farthest, float(heights[flat].max(initial=0.0)))
        dropped = np.unique(cell[flat])
        kept[dropped] = False
        beside = np.unique(neighbours[dropped])
        beside = beside[beside >= 0]
        beside = beside[kept[beside]]
        row, slot = np.nonzero(np.isin(neighbours[beside], dropped))
        cell = beside[row]
    if not kept.any():
        raise InvalidArgument("no simplex is thicker than merge_distance")
    return Peeled(kept, scaled.up(farthest))


def _heights(points: Doubles, corners: npt.NDArray[Any], slot: Integers) -> Doubles:
    """How far one corner of each cell, in column ``slot``, is from the plane of the others."""
    rows = np.arange(len(corners))
    apex = points[corners[rows, slot]]
    others = corners[np.arange(corners.shape[1]) != slot[:, np.newaxis]]
    base = points[others.reshape(len(corners), -1)]
    return np.abs(_above(base, apex))


def _above(base: Doubles, x: Doubles) -> Doubles:
    """Signed distance of each x from the plane through d points."""
    edges = np.swapaxes(base[:, 1:] - base[:, :1], 1, 2)
    normal = np.linalg.qr(edges, mode="complete")[0][:, :, -1]
    nearest = np.abs(base - x[:, np.newaxis]).max(axis=2).argmin(axis=1)  # the least roundoff
    away = x - base[np.arange(len(base)), nearest]
    distances: Doubles = np.einsum("ij,ij->i", away, normal)
    return distances


def boundary(cells: npt.NDArray[Any], neighbours: npt.NDArray[Any]) -> npt.NDArray[np.int32]:
    """Facets without a neighbour, as `Triangulation.hull_facets`: oriented outward, rows sorted."""
    cell, slot = np.nonzero(neighbours < 0)
    corners = cells[cell]
    facets = corners[np.arange(corners.shape[1]) != slot[:, np.newaxis]].reshape(len(cell), -1)
    swapped = slot % 2 == 1
    last = facets[:, -2] > facets[:, -1]  # the cell's own row has its last two swapped
    facets = np.sort(facets, axis=1)
    turned = swapped ^ last
    facets[turned, -2:] = facets[turned, :-3:-1]
    order = np.lexsort(facets.T[::-1])
    return facets[order]


def components(count: int, one: Integers, other: Integers) -> Integers:
    """The least number that each of ``count`` nodes is linked with, itself included."""
    least = np.arange(count)
    while True:
        low = np.minimum(least[one], least[other])
        before = least.copy()
        np.minimum.at(least, one, low)
        np.minimum.at(least, other, low)
        least = least[least]
        if np.array_equal(least, before):
            return least


class Touching(NamedTuple):
    """Pairs of neighbouring cells: the far corner of cell ``one`` is on the sphere of ``other``."""

    one: Integers
    other: Integers
    mutual: npt.NDArray[np.bool_]  #: and the other way round; these pairs are in it once


def touching(
    found: Triangulation, centres: Doubles, scaled: Scaled, tolerance: float, kept: Any
) -> Touching:
    """Within ``tolerance``; ``centres`` of the cells' spheres, scaled."""
    cells, neighbours = found.cells, found.neighbours.astype(np.int64)
    one, slot = np.nonzero(neighbours > np.arange(len(cells))[:, np.newaxis])
    other = neighbours[one, slot]
    both = kept[one] & kept[other]
    one, slot, other = one[both], slot[both], other[both]
    ours, theirs = np.zeros((2, len(one)), dtype=bool)
    for begin in range(0, len(one) if tolerance > 0 else 0, _BLOCK):
        part = slice(begin, begin + _BLOCK)
        a, b = one[part], other[part]
        back = np.argmax(neighbours[b] == a[:, np.newaxis], axis=1)
        across = scaled.points[cells[a, slot[part]]], scaled.points[cells[b, back]]
        shared = scaled.points[cells[a, np.where(slot[part] == 0, 1, 0)]]
        ours[part] = _off_sphere(centres[b], shared, across[0]) <= tolerance
        theirs[part] = _off_sphere(centres[a], shared, across[1]) <= tolerance
    alone = theirs & ~ours
    return Touching(
        np.concatenate([one[ours], other[alone]]),
        np.concatenate([other[ours], one[alone]]),
        np.concatenate([(ours & theirs)[ours], np.zeros(alone.sum(), dtype=bool)]),
    )


def joined(groups: Integers, count: int, pairs: Touching) -> Integers:
    """The vertex that stands for each vertex, of which cell i has number ``groups[i]``.

    Those of mutual pairs are one. Of the others, such as a flat cell between two large ones whose
    spheres both hold its corners, ``one`` takes the vertex of ``other``: of several the lowest that
    is not such a cell's itself.
    """
    one, other = groups[pairs.one], groups[pairs.other]
    least = components(count, one[pairs.mutual], other[pairs.mutual])
    one, other = least[one], least[other]
    open_ = np.zeros(count, dtype=bool)
    apart = one != other
    one, other = one[apart], other[apart]
    open_[one] = True
    stands = np.arange(count)
    while open_.any():
        ready = open_[one] & ~open_[other]
        if not ready.any():  # a circle of them: its lowest stays
            open_[np.flatnonzero(open_)[0]] = False
            continue
        lowest = np.full(count, count)
        np.minimum.at(lowest, one[ready], stands[other[ready]])
        settled = lowest < count
        stands[settled] = lowest[settled]
        open_ &= ~settled
    return stands[least]


def _off_sphere(centre: Doubles, on: Doubles, x: Doubles) -> Doubles:
    """How far each x is from the sphere about ``centre`` through ``on``: ``|x - c| - |on - c|`` with
    an error of some units of roundoff times ``|x - on|``, however far the centre is."""
    with np.errstate(all="ignore"):  # NaN where a centre is infinite: nothing is near then
        from_x, from_on = x - centre, on - centre
        sums = np.linalg.norm(from_x, axis=1) + np.linalg.norm(from_on, axis=1)
        direction = (from_x + from_on) / sums[:, np.newaxis]
        distances: Doubles = np.abs(np.einsum("ij,ij->i", x - on, direction))
    return distances


class MergedDiagram(NamedTuple):
    """What of a `VoronoiDiagram` is left when vertices have been merged; as its members."""

    vertices: Doubles
    ridge_points: npt.NDArray[np.int32]
    ridges: Lists
    regions: Lists
    dropped: int
    distance: float


def merged_diagram(
    diagram: VoronoiDiagram, scaled: Scaled, peeled: Peeled, tolerance: float
) -> MergedDiagram:
    """See `TolerantVoronoi`."""
    found, count = diagram.triangulation, len(diagram.vertices)
    groups = found.cell_groups.astype(np.int64)
    centres = scaled.down(diagram.vertices)
    pairs = touching(found, centres[groups], scaled, tolerance, peeled.kept)
    least = joined(groups, count, pairs)
    outside = np.ones(count, dtype=bool)
    outside[groups[peeled.kept]] = False
    distance = _unequal(found, centres, least, scaled, peeled.kept)
    rest = np.flatnonzero((least == np.arange(count)) & ~outside)
    number = np.full(count + 1, -1, dtype=np.int64)  # the last for -1
    number[rest] = np.arange(len(rest))
    number[:count] = np.where(outside, -1, number[least])
    ridges, regions = (_relabelled(lists, number) for lists in (diagram.ridges, diagram.regions))
    sides = _faces_at_infinity(found, diagram.ridge_points, scaled, peeled.kept, tolerance)
    whole = np.add.reduceat(ridges.items >= 0, ridges.offsets[:-1]) if len(ridges) else 0
    lasting = whole + sides >= found.dimension
    return MergedDiagram(
        diagram.vertices[rest],
        diagram.ridge_points[lasting],
        _those(ridges, lasting),
        regions,
        count - len(rest),
        scaled.up(distance),
    )


def _unequal(
    found: Triangulation, centres: Doubles, least: Integers, scaled: Scaled, kept: Any
) -> float:
    """By how much the distances of a merged vertex from the corners of its cells differ at most."""
    groups = found.cell_groups.astype(np.int64)
    moved = np.flatnonzero(kept & (least[groups] != groups))
    if len(moved) == 0:
        return 0.0
    first = first_places(groups, len(centres))
    vertex = least[groups[moved]]
    on = scaled.points[found.cells[first[vertex], 0]]
    return max(
        float(_off_sphere(centres[vertex], on, scaled.points[column]).max())
        for column in found.cells[moved].T
    )


def _relabelled(lists: Lists, number: Integers) -> Lists:
    """With each number once, where it came first."""
    items = number[lists.items]
    owner = np.repeat(np.arange(len(lists)), lists.lengths())
    _, first = np.unique(owner * (len(number) + 1) + items + 1, return_index=True)
    first.sort()
    counts = np.bincount(owner[first], minlength=len(lists))
    return Lists(np.concatenate([[0], np.cumsum(counts)]), items[first])


def _those(lists: Lists, chosen: npt.NDArray[np.bool_]) -> Lists:
    lengths = lists.lengths()
    offsets = np.concatenate([[0], np.cumsum(lengths[chosen])])
    return Lists(offsets, lists.items[np.repeat(chosen, lengths)])


def _faces_at_infinity(
    found: Triangulation,
    pairs: npt.NDArray[np.int32],
    scaled: Scaled,
    kept: npt.NDArray[np.bool_],
    tolerance: float,
) -> Integers:
    """For each pair of points, how many flat parts of the boundary hold both: neighbouring facets
    each within ``tolerance`` of the other's plane are one part."""
    neighbours = np.where(kept[found.neighbours], found.neighbours, -1)[kept]
    facets = boundary(found.cells[kept], np.where(found.neighbours[kept] < 0, -1, neighbours))
    one, other = _hinges(facets)
    near = np.ones(len(one), dtype=bool)
    for a, b in ((one, other), (other, one)):
        apart = ~(facets[b][:, :, np.newaxis] == facets[a][:, np.newaxis]).any(axis=2)
        far = facets[b][np.arange(len(b)), apart.argmax(axis=1)]
        near &= np.abs(_above(scaled.points[facets[a]], scaled.points[far])) <= tolerance
    part = components(len(facets), one[near], other[near])
    width, size = facets.shape[1], np.int64(found.point_count)
    ends = np.sort(facets, axis=1).astype(np.int64)
    held = [
        np.column_stack([ends[:, i] * size + ends[:, j], part])
        for i in range(width)
        for j in range(i + 1, width)
    ]
    keys, counts = np.unique(np.unique(np.vstack(held), axis=0)[:, 0], return_counts=True)
    asked = pairs[:, 0].astype(np.int64) * size + pairs[:, 1]
    place = np.minimum(np.searchsorted(keys, asked), len(keys) - 1)
    return np.where(keys[place] == asked, counts[place], 0)


def _hinges(facets: npt.NDArray[np.int32]) -> tuple[Integers, Integers]:
    """Pairs of facets that have all corners but one in common."""
    width = facets.shape[1]
    ascending = np.sort(facets, axis=1)
    rows = np.vstack([np.delete(ascending, i, axis=1) for i in range(width)])
    owner = np.tile(np.arange(len(facets)), width)
    order = np.lexsort(rows.T[::-1])
    rows, owner = rows[order], owner[order]
    same = np.flatnonzero((rows[1:] == rows[:-1]).all(axis=1))
    return owner[same], owner[same + 1]
