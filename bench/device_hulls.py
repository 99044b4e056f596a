"""Hulls of points on a device beside the CPU's, from Python: the same bits, and how long they take.

usage: device_hulls.py [--out FILE] [--seconds T] [SCAN.ply ...]

Writes a line of JSON for each set, medians of some calls in seconds: `auto` and `cuda` for points
on the device, `cpu` and `host_cuda` for the same points in the host's memory. What the device alone
found has as many survivors as vertices. Needs a device, CuPy and NumPy. Exit status: 0 if all hulls
are equal; 1 if one is not.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator

import cullhull
import cupy as cp
import numpy as np

MOST_ON_HOST = 20_000_000  # points: the CPU's calls beyond take more than their figures are worth


def median_seconds(call: Callable[[], object], repeat: int) -> float:
    call()
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return sorted(seconds)[repeat // 2]


def ball(n: int, d: int = 3, seed: int = 0, inner: float = 0.0) -> cp.ndarray:
    """Points between `inner` and 1 from the origin, evenly distributed, float32."""
    cp.random.seed(seed)
    rows = cp.random.standard_normal((n, d), dtype=cp.float32)
    rows /= cp.linalg.norm(rows, axis=1, keepdims=True)
    share = cp.random.random((n, 1), dtype=cp.float32)
    return (rows * (inner**d + (1 - inner**d) * share) ** (1 / d)).astype(cp.float32)


def sets(scans: list[str]) -> Iterator[tuple[str, Callable[[], cp.ndarray], int]]:
    """(name, points, calls) of each set."""
    for path in scans:
        rows = np.asarray(cullhull.read(path))
        yield f"{path}, f64", lambda rows=rows: cp.asarray(rows), 5
        yield f"{path}, f32", lambda rows=rows: cp.asarray(rows.astype(np.float32)), 5
    for seed in range(4):
        yield f"ball 8M, seed {seed}", lambda seed=seed: ball(8_000_000, seed=seed), 5
        yield (
            f"shell 600k, 0.985 to 1, seed {seed}",
            lambda seed=seed: ball(600_000, seed=100 + seed, inner=0.985),
            3,
        )
    for n in (100_000, 1_000_000):
        yield f"sphere {n}", lambda n=n: ball(n, inner=1.0), 5
    for bits in (14, 16, 17, 18, 20, 22, 24):
        yield f"ball 2^{bits}", lambda bits=bits: ball(1 << bits), 5
    for bits in (16, 18, 20, 23):
        yield f"disk 2^{bits}", lambda bits=bits: ball(1 << bits, 2), 5
    for bits in (18, 21):
        yield f"4D ball 2^{bits}", lambda bits=bits: ball(1 << bits, 4), 3
        normal = lambda bits=bits: cp.random.standard_normal((1 << bits, 3))  # noqa: E731
        yield f"normal 2^{bits}, f64", normal, 3
    yield "bytes 4M", lambda: cp.random.randint(0, 256, (4_000_000, 3)).astype(cp.float32), 3
    yield "cube 4M, f64", lambda: cp.random.random((4_000_000, 3)), 3
    for n in (10_000_000, 30_000_000, 50_000_000):
        yield f"ball {n}", lambda n=n: ball(n, seed=3), 5


def compared(points: cp.ndarray, repeat: int) -> dict[str, object]:
    hull = cullhull.convex_hull(points)
    found = hull.statistics
    row: dict[str, object] = {
        "count": points.shape[0],
        "dimension": points.shape[1],
        "vertices": len(hull.vertices),
        "survivors": found["survivors"],
        "filter": found["cull_method"],
        "backend": found["backend"],
        "reason": found["cull_reason"],
    }
    for backend, name in (("auto", "auto"), ("cuda", "cuda")):
        call = lambda b=backend: cullhull.convex_hull(points, backend=b)  # noqa: E731
        row[name] = median_seconds(call, repeat)
    if len(points) > MOST_ON_HOST:
        return row
    rows = cp.asnumpy(points)
    own = cullhull.convex_hull(rows, backend="cpu")
    row["equal"] = hull.volume == own.volume and all(
        np.array_equal(getattr(hull, part), getattr(own, part))
        for part in ("vertices", "simplices", "equations")
    )
    for backend, name in (("cpu", "cpu"), ("cuda", "host_cuda")):
        row[name] = median_seconds(lambda b=backend: cullhull.convex_hull(rows, backend=b), repeat)
    return row


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=argparse.FileType("a"), default=sys.stdout)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("scans", nargs="*")
    arguments = parser.parse_args()
    start = time.monotonic()
    all_equal = True
    for name, points, repeat in sets(arguments.scans):
        if time.monotonic() - start > arguments.seconds:
            print(f"no time left for {name}", file=sys.stderr)
            return 1
        row = compared(points(), repeat)
        all_equal &= bool(row.get("equal", True))
        line = json.dumps({"part": "hull from Python", "workload": name, **row})
        print(line, file=arguments.out, flush=True)
    return 0 if all_equal else 1


if __name__ == "__main__":
    sys.exit(main())
