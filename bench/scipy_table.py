#!/usr/bin/env python3
"""cullhull's drop-in classes beside SciPy's, call by call in one run: a table in Markdown.

    build/python/venv/bin/python bench/scipy_table.py [--what hull] [--sizes 10 1k 1M]
        [--dimensions 2 3] [--shapes gauss ball] [--threads N] [--seconds 1] [--limit 30] [--once]

A call is the whole of what programs do. hull: make the hull and read vertices, simplices,
equations, neighbors, area, volume and bounds. delaunay: the triangulation, its simplices and
neighbors.
voronoi: the diagram, its vertices, ridges and regions. find_simplex: as many questions as points to
a triangulation that is made. linear, nearest: interpolation at as many points, likewise; build_nearest
makes the interpolator too. find_one, linear_one, nearest_one: one point at a time.

Ours and SciPy's go by turns over several sets of a size; the figures are medians in microseconds,
with the 99th percentile of ours where there are 100 calls or more. A row ends where one call of
SciPy's takes longer than --limit seconds, or than memory allows. With --once SciPy has one call and
ours three, over one set: for rows of minutes.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.interpolate
import scipy.spatial

import cullhull

SIZES = ["10", "30", "100", "300", "1k", "3k", "10k", "30k", "100k", "300k", "1M"]
SHAPES = ["gauss", "ball", "sphere", "cube"]
#: More would take SciPy minutes and gigabytes: the simplices of points on a sphere.
LARGEST_SPHERE = {4: 100_000, 5: 10_000}


def number(text: str) -> int:
    return int(float(text.rstrip("kM")) * {"k": 1e3, "M": 1e6}.get(text[-1], 1))


def complete(hull: Any) -> Any:
    lists = (hull.vertices, hull.simplices, hull.equations, hull.neighbors)
    return (*lists, hull.min_bound, hull.max_bound, hull.area, hull.volume)


def timed(call: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


def hull(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    return lambda: complete(kind.ConvexHull(points, **choices))


def delaunay(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    def call() -> Any:
        found = kind.Delaunay(points, **choices)
        return found.simplices, found.neighbors

    return call


def voronoi(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    def call() -> Any:
        found = kind.Voronoi(points, **choices)
        return found.vertices, found.ridge_points, found.ridge_vertices, found.regions

    return call


def asked(points: Any) -> Any:
    """As many others, between the least and the largest coordinates."""
    low, high = points.min(axis=0), points.max(axis=0)
    return low + (high - low) * np.random.default_rng(0).random(points.shape)


def find_simplex(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    found, questions = kind.Delaunay(points, **choices), asked(points)
    return lambda: found.find_simplex(questions)


def interpolator(name: str, kind: Any, points: Any, **choices: Any) -> Any:
    module = scipy.interpolate if kind is scipy.spatial else kind
    return getattr(module, f"{name}NDInterpolator")(points, points[:, 0], **choices)


def linear(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    found, questions = interpolator("Linear", kind, points, **choices), asked(points)
    return lambda: found(questions)


def nearest(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    found, questions = interpolator("Nearest", kind, points, **choices), asked(points)
    return lambda: found(questions)


def build_nearest(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    questions = asked(points)
    return lambda: interpolator("Nearest", kind, points, **choices)(questions)


def one_by_one(function: Callable[[Any], Any], questions: Any) -> Callable[[], Any]:
    """Each call of the result asks about the next point; what the first question prepares is made."""
    function(questions[-1:])
    turn = itertools.cycle(questions[i : i + 1] for i in range(len(questions)))
    return lambda: function(next(turn))


def find_one(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    return one_by_one(kind.Delaunay(points, **choices).find_simplex, asked(points))


def linear_one(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    return one_by_one(interpolator("Linear", kind, points, **choices), asked(points))


def nearest_one(kind: Any, points: Any, **choices: Any) -> Callable[[], Any]:
    return one_by_one(interpolator("Nearest", kind, points, **choices), asked(points))


def agree(what: str, a: Any, b: Any) -> bool:
    """Whether the results are the same, but for what Qhull takes for flat or equal."""
    if what == "hull":
        return bool(np.isclose(a[-1], b[-1]) and np.isin(b[0], a[0]).all())
    if what in ("delaunay", "voronoi"):
        return bool(abs(len(a[0]) - len(b[0])) <= 0.001 * len(b[0]) + 2)
    if what in ("find_simplex", "find_one"):
        return bool(((a < 0) == (b < 0)).mean() > 0.999)
    return bool(np.isclose(a, b, rtol=1e-6, atol=1e-6, equal_nan=True).mean() > 0.999)


OF_SETS = (hull, delaunay, voronoi, find_simplex, linear, nearest, build_nearest)
CALLS = {call.__name__: call for call in (*OF_SETS, find_one, linear_one, nearest_one)}


def row(
    what: str, shape: str, n: int, d: int, threads: int | None, seconds: float, once: bool
) -> tuple[list[float], list[float]]:
    """Seconds of each call, ours and SciPy's, by turns."""
    prepare = CALLS[what]
    if once:
        points = cullhull.generate(shape, n, d, seed=1)
        call = prepare(cullhull, points, threads=threads)
        results = [timed(call) for _ in range(3)]
        other, b = timed(prepare(scipy.spatial, points))
        assert agree(what, results[0][1], b)
        return [mine for mine, _ in results], [other]
    count = max(1, min(32, 200_000 // n))
    sets = [cullhull.generate(shape, n, d, seed=seed) for seed in range(1, count + 1)]
    ours, theirs = [], []
    end = time.perf_counter() + seconds
    turn = 0
    if what.endswith("_one"):  # many calls of what is made once
        ask = prepare(cullhull, sets[0], threads=threads)
        other_ask = prepare(scipy.spatial, sets[0])
        while turn < 100 or time.perf_counter() < end:
            mine, a = timed(ask)
            other, b = timed(other_ask)
            assert agree(what, a, b)
            ours.append(mine)
            theirs.append(other)
            turn += 1
        return ours, theirs
    while turn < 4 or time.perf_counter() < end:
        points = sets[turn % count]
        mine, a = timed(prepare(cullhull, points, threads=threads))
        other, b = timed(prepare(scipy.spatial, points))
        if turn < count:
            assert agree(what, a, b)
        del a, b
        if turn > 0:  # the first call of a size has no warm pages
            ours.append(mine)
            theirs.append(other)
        turn += 1
    return ours, theirs


def percentile(times: list[float], share: float) -> float:
    return sorted(times)[min(len(times) - 1, int(share * len(times)))]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--what", choices=CALLS, default="hull")
    parser.add_argument("--sizes", nargs="+", default=SIZES)
    parser.add_argument("--dimensions", nargs="+", type=int, default=[2, 3, 4, 5])
    parser.add_argument("--shapes", nargs="+", default=SHAPES)
    parser.add_argument("--threads", type=int, help="of ours; all the machine offers if not given")
    parser.add_argument("--seconds", type=float, default=1.0, help="for each row")
    parser.add_argument("--limit", type=float, default=30.0, help="seconds of one call of SciPy's")
    parser.add_argument("--once", action="store_true", help="SciPy once, ours three times")
    arguments = parser.parse_args()

    print("| set | n | cullhull (us) | 99 % | SciPy (us) | ratio |\n|---|---:|---:|---:|---:|---:|")
    for d in arguments.dimensions:
        for shape in arguments.shapes:
            for n in map(number, arguments.sizes):
                if shape == "sphere" and n > LARGEST_SPHERE.get(d, n):
                    break
                how = (arguments.threads, arguments.seconds, arguments.once)
                ours, theirs = row(arguments.what, shape, n, d, *how)
                a, b = statistics.median(ours), statistics.median(theirs)
                worst = f"{percentile(ours, 0.99) * 1e6:,.1f}" if len(ours) >= 100 else ""
                print(
                    f"| {d}D {shape} | {n:,} | {a * 1e6:,.1f} | {worst} | {b * 1e6:,.1f} "
                    f"| {b / a:.1f}x |",
                    flush=True,
                )
                if b > arguments.limit:
                    break


if __name__ == "__main__":
    main()
