#!/usr/bin/env python3
"""What a hull costs by the number of ranks: bytes sent and work, and what follows for more of them.

    bench/reach.py MPI_BENCH [COUNT [RANKS,...]] [-- LAUNCHER...]

runs MPI_BENCH (bench/mpi_bench.cpp) by LAUNCHER (mpirun if not given) for a ball and a normal
distribution of COUNT points (1e7), and for a sphere of a fiftieth of them, on so many ranks
(1,2,4,8,16). The constants of the model (docs/reach.md) come from at most four ranks; beside what
more ranks took stands what the model said, over what was seen. Exit status 1 where a result differs
from one process's.
"""

import math
import re
import subprocess
import sys

# Exponent with which the number of extreme points grows with the number of points, in 3D.
GROWTH = {"ball": 0.5, "gauss": 0.0, "sphere": 1.0}
ROW, DOWN = 32, 24  # bytes per point with its id, and without
KEYS = {
    "bytes": r"bytes sent\s+(\d+)",
    "messages": r"in (\d+) messages",
    "common": r"map\s+(\d+) extreme",
    "contributed": r"(\d+) points left",
    "vertices": r"hull\s+(\d+) vertices",
    "work": r"work\s+([\d.]+) s",
    "alone": r"one process ([\d.]+) s",
}


def measure(launcher, program, count, shape, ranks):
    command = [*launcher, "-n", str(ranks), program, str(count), shape, "3", "3"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"reach: {' '.join(command)}: {done.stdout}{done.stderr}")
    row = {key: float(re.search(what, done.stdout)[1]) for key, what in KEYS.items()}
    return {"ranks": ranks, **row}


def line(points):
    """Least squares of y = a + b x."""
    n = len(points)
    mx, my = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    b = sum((x - mx) * (y - my) for x, y in points) / sum((x - mx) ** 2 for x, _ in points)
    return my - b * mx, b


class Model:
    """Of one shape: constants from `rows`, of `count` points."""

    def __init__(self, shape, count, rows):
        self.count, self.growth = count, GROWTH[shape]
        logs = [(math.log(r["ranks"]), math.log(r["contributed"])) for r in rows]
        left, self.power = line(logs)
        self.left = math.exp(left)
        self.common = sum(r["common"] for r in rows if r["ranks"] > 1) / (len(rows) - 1)
        self.vertices = rows[0]["vertices"]
        self.work = line([(r["ranks"], r["work"]) for r in rows])
        self.pass_work = rows[0]["work"]

    def contributed(self, count, ranks):
        most = self.left * (count / self.count) ** self.growth * ranks**self.power
        return min(count, most)

    def extreme(self, count):
        return min(count, self.vertices * (count / self.count) ** self.growth)

    def bytes(self, count, ranks):
        """Up the tree: twice what left the ranks, reduced to what is extreme from four parts on."""
        up, level, parts = 0.0, 0, ranks / 2
        while parts >= 0.5:
            share = count / parts / 2  # points behind each message of this level
            each = self.contributed(count, ranks) / parts / 2
            if level >= 2:
                each = min(each, self.extreme(share))
            up += parts * each * ROW
            level, parts = level + 1, parts / 2
            if parts < 1:
                break
        return up + (ROW + DOWN) * self.common * (ranks - 1)

    def work_seconds(self, ranks):
        return self.work[0] + self.work[1] * ranks


def table(shape, count, rows, model):
    for r in rows:
        told = ["", ""]
        if r["ranks"] > 4:
            told = [f"{model.bytes(count, r['ranks']) / r['bytes']:.2f}",
                    f"{model.work_seconds(r['ranks']) / r['work']:.2f}"]
        print(f"| {shape} {count:.0e} | {r['ranks']} | {r['common']:.0f} | {r['contributed']:.0f} |"
              f" {r['messages']:.0f} | {r['bytes'] / 1e6:.3f} | {100 * r['bytes'] / (24 * count):.2f}"
              f" % | {told[0]} | {r['work']:.3f} | {r['alone']:.3f} | {told[1]} |", flush=True)


def main():
    words, launcher = sys.argv[1:], ["mpirun"]
    if "--" in words:
        launcher = words[words.index("--") + 1 :]
        words = words[: words.index("--")]
    if not words:
        sys.exit(__doc__)
    whole = float(words[1]) if len(words) > 1 else 1e7
    ranks = [int(r) for r in words[2].split(",")] if len(words) > 2 else [1, 2, 4, 8, 16]
    if ranks[0] != 1 or len([r for r in ranks if r <= 4]) < 3:
        sys.exit("reach: the model needs 1 rank and two numbers of up to 4 besides")
    print("| points | ranks | points in the map | points sent | messages | MB sent | of the input | model |"
          " work, s | one process | model |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    models = {}
    for shape in GROWTH:
        count = whole / 50 if shape == "sphere" else whole
        rows = [measure(launcher, words[0], count, shape, r) for r in ranks]
        models[shape] = Model(shape, count, [r for r in rows if r["ranks"] <= 4])
        table(shape, count, rows, models[shape])
    print("\n| points | ranks | ball: MB sent | of the input | gauss: MB sent | sphere: TB sent |")
    print("|--:|--:|--:|--:|--:|--:|")
    for count, many in ((1e9, 64), (1e10, 256), (1e11, 1024), (1e12, 4096)):
        ball, gauss, sphere = (models[s].bytes(count, many) for s in GROWTH)
        print(f"| {count:.0e} | {many} | {ball / 1e6:.0f} | {100 * ball / 24 / count:.4f} % |"
              f" {gauss / 1e6:.1f} | {sphere / 1e12:.1f} |")


if __name__ == "__main__":
    main()
