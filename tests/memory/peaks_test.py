#!/usr/bin/env python3
"""Every command keeps its memory limit, from files and from pipes.

    tests/memory/peaks_test.py PROGRAM [--list] [NAME ...]

A cell is a command, a set of points and a limit. The program either succeeds, and its peak is at most
the limit + 10 % + 16 MiB, or it refuses with status 4 and one line on standard error that names the
memory, and its peak is no more than that either. The peak is the largest resident set of the process
(wait4), less the size of the input files that it maps: the system may take back their pages, and
docs/streams.md says that --memory does not count them. Nothing is subtracted for a pipe.

A command without --memory has half of the machine's memory: of those it is tested that a pipe or
their pieces take no more than a fixed amount.

Which cells must succeed is part of the table, so that refusing everything is no way to pass. Prints a
line for each cell that failed.
"""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

MIB = 1 << 20
#: Of the program itself and its libraries, before it does anything.
OVERHEAD = 16 * MIB

# name: arguments of generate
SETS = {
    "plane-10k": "disk -n 10k -d 2",
    "plane-100k": "disk -n 100k -d 2",
    "plane-1M": "disk -n 1M -d 2",
    "space-10k": "ball -n 10k -d 3",
    "space-100k": "ball -n 100k -d 3",
    "space-300k": "ball -n 300k -d 3",
    "space-1M": "ball -n 1M -d 3",
    "sphere-100k": "sphere -n 100k -d 3",
    "four-3k": "ball -n 3k -d 4",
    "four-100k": "ball -n 100k -d 4",
}

FITS, REFUSED, EITHER = "fits", "refused", "either"
NPY, CSV = ".npy", ".csv"

# (command, set, extension, limit in MB, from, expected). INPUT is the file, or - for a pipe; OUT is a
# path without an extension. A limit of 0: the command has no --memory, and its peak is checked
# against a fixed one, the number behind it.
CELLS = [
    # A pipe of any size is read in blocks.
    ("hull INPUT", "space-1M", NPY, 8, "pipe", FITS),
    ("hull INPUT", "space-1M", NPY, 8, "file", FITS),
    ("hull INPUT", "space-1M", CSV, 16, "pipe", FITS),
    ("hull INPUT", "space-1M", CSV, 16, "file", FITS),
    ("hull INPUT", "plane-10k", CSV, 4, "pipe", FITS),
    ("hull INPUT", "four-100k", NPY, 40, "pipe", EITHER),
    ("hull INPUT", "sphere-100k", NPY, 100, "pipe", FITS),
    ("hull INPUT", "sphere-100k", NPY, 16, "pipe", REFUSED),
    ("hull INPUT", "sphere-100k", NPY, 16, "file", REFUSED),
    ("hull INPUT --json=OUT.json -o OUT.ply", "space-1M", NPY, 20, "pipe", FITS),
    ("hull INPUT --only vertices", "space-1M", NPY, 8, "pipe", FITS),
    ("cull INPUT -o OUT.npy", "space-1M", NPY, 8, "pipe", FITS),
    ("cull INPUT -o OUT.npy", "plane-100k", NPY, 4, "file", FITS),
    # What needs all points keeps the limit, too: it holds them, or refuses.
    ("hull INPUT --certify", "space-1M", NPY, 12, "pipe", REFUSED),
    ("hull INPUT --certify", "space-1M", NPY, 60, "pipe", FITS),
    ("hull INPUT --certify", "space-1M", NPY, 12, "file", FITS),
    ("hull INPUT --cull gauge", "space-1M", NPY, 12, "pipe", REFUSED),
    ("hull INPUT --stream off", "space-1M", CSV, 40, "pipe", REFUSED),
    ("hull INPUT --stream off", "space-1M", CSV, 40, "file", FITS),
    ("hull INPUT --stream off", "space-1M", CSV, 20, "file", REFUSED),
    ("hull INPUT --repeat 2", "plane-1M", NPY, 40, "pipe", FITS),
    ("cull INPUT --repeat 2 -o OUT.npy", "plane-1M", NPY, 12, "pipe", REFUSED),
    ("view INPUT -o OUT.html", "space-100k", NPY, 60, "file", FITS),
    ("view INPUT -o OUT.html", "space-1M", NPY, 12, "pipe", REFUSED),
    ("qconvex TI INPUT s", "space-1M", NPY, 20, "file", FITS),
    ("qconvex s", "space-1M", NPY, 12, "pipe", REFUSED),
    ("qconvex s", "space-1M", NPY, 60, "pipe", FITS),
    ("qconvex s", "plane-100k", CSV, 20, "pipe", FITS),
    # Triangulations and what is made of them.
    ("delaunay INPUT", "plane-10k", NPY, 4, "file", FITS),
    ("delaunay INPUT", "plane-100k", NPY, 10, "file", REFUSED),
    ("delaunay INPUT", "plane-100k", NPY, 25, "pipe", FITS),
    ("delaunay INPUT -o OUT.ply", "plane-1M", NPY, 250, "file", FITS),
    ("delaunay INPUT", "plane-1M", NPY, 100, "pipe", REFUSED),
    ("delaunay INPUT", "space-10k", NPY, 12, "file", FITS),
    ("delaunay INPUT", "space-100k", NPY, 30, "file", REFUSED),
    ("delaunay INPUT", "space-100k", CSV, 100, "pipe", FITS),
    ("delaunay INPUT", "space-300k", NPY, 80, "file", REFUSED),
    ("delaunay INPUT", "space-1M", NPY, 80, "pipe", REFUSED),
    ("delaunay INPUT", "sphere-100k", NPY, 70, "file", FITS),
    ("delaunay INPUT", "four-3k", NPY, 20, "file", FITS),
    ("delaunay INPUT", "four-100k", NPY, 100, "file", REFUSED),
    ("delaunay INPUT --threads 1", "space-300k", NPY, 80, "file", REFUSED),
    ("voronoi INPUT", "plane-10k", NPY, 6, "file", FITS),
    ("voronoi INPUT", "plane-100k", NPY, 20, "file", REFUSED),
    ("voronoi INPUT -o OUT.json", "plane-100k", NPY, 50, "pipe", FITS),
    ("voronoi INPUT", "space-10k", NPY, 30, "file", FITS),
    ("voronoi INPUT", "space-100k", NPY, 90, "file", REFUSED),
    ("voronoi INPUT --box=-1,-1,1,1", "plane-100k", NPY, 40, "file", REFUSED),
    ("voronoi INPUT --box=-1,-1,1,1 -o OUT.geojson", "plane-100k", NPY, 120, "file", FITS),
    ("voronoi INPUT --measures OUT.npy", "plane-1M", NPY, 100, "pipe", REFUSED),
    ("alpha INPUT", "plane-100k", NPY, 30, "file", FITS),
    ("alpha INPUT", "plane-100k", NPY, 10, "pipe", REFUSED),
    ("alpha INPUT --ratio 0.5", "plane-100k", NPY, 30, "file", FITS),
    ("alpha INPUT", "space-100k", NPY, 30, "file", REFUSED),
    ("alpha INPUT --json=OUT.json", "space-10k", NPY, 14, "pipe", FITS),
    ("alpha INPUT", "space-300k", NPY, 80, "file", REFUSED),
    # Moving points: an array of frames.
    ("track INPUT", "frames", NPY, 20, "file", FITS),
    ("track INPUT", "frames", NPY, 8, "pipe", REFUSED),
    ("track INPUT", "frames", NPY, 60, "pipe", FITS),
    # Without --memory: the number is the most that they may take beside their input.
    ("info INPUT", "space-1M", NPY, -16, "pipe", FITS),
    ("info INPUT", "space-1M", CSV, -16, "pipe", FITS),
    ("info INPUT", "space-1M", NPY, -4, "file", FITS),
    ("certify INPUT HULL", "space-1M", NPY, -24, "pipe", FITS),
    ("certify INPUT HULL", "space-1M", CSV, -24, "pipe", FITS),
    ("generate ball -n 1M -d 3 -o OUT.npy", "", "", -40, "file", FITS),
]


def run(program, words, source):
    """Status, first lines of standard error, and peak in bytes."""
    errors = tempfile.TemporaryFile()
    child = subprocess.Popen([program, *words], stdin=subprocess.PIPE if source else subprocess.DEVNULL,
                             stdout=subprocess.DEVNULL, stderr=errors)
    if source:
        try:
            with open(source, "rb") as file:
                while block := file.read(1 << 18):
                    child.stdin.write(block)
        except BrokenPipeError:
            pass  # it has refused
        try:
            child.stdin.close()
        except BrokenPipeError:
            pass
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    errors.seek(0)
    unit = 1 if sys.platform == "darwin" else 1024
    return child.returncode, errors.read().decode(errors="replace"), usage.ru_maxrss * unit


class Cells:
    def __init__(self, program, folder):
        self.program, self.folder = program, Path(folder)
        self.made = {}

    def generate(self, words, name):
        if name not in self.made:
            path = self.folder / name
            subprocess.run([self.program, "generate", *words.split(), "-q", "-o", path], check=True)
            self.made[name] = path
        return self.made[name]

    def points(self, name, ending):
        if name == "frames":
            return self.generate("ball -n 100k -d 3 --frames 12 --motion twist", "frames.npy")
        return self.generate(SETS[name], name + ending)

    def hull(self, points):
        path = self.folder / "hull.json"
        if not path.exists():
            subprocess.run([self.program, "hull", points, "-q", "-o", path], check=True)
        return path

    def check(self, cell):
        """What is wrong, or None."""
        command, name, ending, limit, way, expected = cell
        points = self.points(name, ending) if name else None
        given = "-" if way == "pipe" else str(points)
        words = [word.replace("INPUT", given).replace("OUT", str(self.folder / "out"))
                 for word in command.split()]
        if "HULL" in words:
            words[words.index("HULL")] = str(self.hull(points))
        if limit > 0:
            words += ["--memory", f"{limit}M"]
        mapped = points.stat().st_size if points and way == "file" else 0
        status, errors, peak = run(self.program, words, points if way == "pipe" else None)
        for left in self.folder.glob("out*"):
            left.unlink()
        most = abs(limit) * 1_100_000 + OVERHEAD
        if peak - mapped > most:
            return f"peak {(peak - mapped) / 1e6:.0f} MB, at most {most / 1e6:.0f} (status {status})"
        if status == 4:
            if expected == FITS:
                return f"refused: {errors.strip()}"
            if errors.count("\n") != 1 or "memory" not in errors:
                return f"refused without its reason: {errors!r}"
            in_blocks = "--stream on" in errors
            if in_blocks and command.split()[0] not in ("hull", "cull", "certify", "info"):
                return f"names an option that it lacks: {errors.strip()}"
            return None
        if status != 0:
            return f"status {status}: {errors.strip()}"
        return "accepted" if expected == REFUSED else None


def title(cell):
    return f"{cell[0]} of {cell[1]}{cell[2]}, {abs(cell[3])} MB, {cell[4]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("names", nargs="*", help="run only cells whose title contains one of these")
    parser.add_argument("--list", action="store_true", help="print every cell with its outcome")
    arguments = parser.parse_args()
    if not hasattr(os, "wait4"):
        return 77  # no peak of a child process
    chosen = [c for c in CELLS
              if not arguments.names or any(n in title(c) for n in arguments.names)]
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        cells = Cells(os.path.abspath(arguments.program), folder)
        for cell in chosen:
            wrong = cells.check(cell)
            failed += wrong is not None
            if wrong or arguments.list:
                print(f"{'FAILED ' if wrong else 'ok     '} {title(cell)}{': ' + wrong if wrong else ''}",
                      flush=True)
    print(f"{len(chosen)} cells, {failed} failed")
    return 1 if failed or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())
