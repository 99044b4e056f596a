#!/usr/bin/env python3
"""Holds two folders of *.hulls against each other (tests/record_hulls.cpp): equal points must have
equal hulls. Points that only one machine has are counted, a list of the tests follows: they come of
the C library's sines and logarithms, which differ in their last bit.

Usage: scripts/compare_hulls.py FOLDER FOLDER. Exit status 1: a hull differs, or there is none.
"""
import collections
import pathlib
import sys


def read(folder):
    hulls = collections.defaultdict(set)
    for path in sorted(pathlib.Path(folder).glob("*.hulls")):
        for line in path.read_text().splitlines():
            test, points, hull = line.rsplit(" ", 2)
            hulls[points].add((hull, path.stem + ": " + test))
    return hulls


def main():
    a, b = (read(folder) for folder in sys.argv[1:3])
    common = a.keys() & b.keys()
    wrong = [p for p in common if len({hull for hull, _ in a[p] | b[p]}) != 1]
    tests = {test for p in common for _, test in a[p]}
    print(f"hulls: {len(common)} point sets of {len(tests)} tests on both machines, "
          f"{len(wrong)} with another hull")
    for p in wrong[:20]:
        print("  differs:", ", ".join(sorted(test for _, test in a[p] | b[p])))
    alone = collections.Counter(test for only in (a.keys() - common, b.keys() - common)
                                for p in only for _, test in (a if p in a else b)[p])
    if alone:
        print(f"hulls: {len(a) - len(common)} and {len(b) - len(common)} point sets on one machine "
              "alone, of: " + ", ".join(f"{test} ({n})" for test, n in alone.most_common(30)))
    return 1 if wrong or not common else 0


sys.exit(main())
