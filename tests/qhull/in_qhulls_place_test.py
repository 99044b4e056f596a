#!/usr/bin/env python3
"""in_qhulls_place_test.py CLIENT CLIENT_OF_ONE FOLDER: programs that are linked to libqhull_r or to
libqhull run unchanged with the libraries in FOLDER, and find what they find with Qhull: clients of
our own line by line; Octave's own tests, matplotlib, Open3D, SAGA and MeshLab, where they are
installed. Exit status 77: not Qhull's library."""

import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

client, client_of_one, folder = sys.argv[1:]
OURS = dict(os.environ, LD_LIBRARY_PATH=folder)
QHULLS = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
wrong = []


def run(env, *words):
    done = subprocess.run(words, env=env, capture_output=True, text=True, timeout=300)
    if done.returncode and words[0] in (client, client_of_one):
        wrong.append(f"{words[1:]}: exit status {done.returncode}")
    return done.stdout, done.stderr


def lines():
    """Our client: the same lines, where no two answers are right."""
    hulls = [(2, 9), (2, 300), (3, 4), (3, 10), (3, 500), (4, 60), (5, 30), (6, 20)]
    cases = [(d, n, 0, command) for d, n in hulls for command in ("qhull", "qhull Qt", "qhull Qx")]
    cells = [(2, 10), (2, 400), (3, 10), (3, 300), (4, 50)]
    cases += [(d, n, 0, command) for d, n in cells for command in ("qhull d", "qhull d Qt Qbb Qc")]
    cases += [(3, 100, 0, "qhull+triangulate"), (2, 100, 0, "qhull d+triangulate")]
    cases += [(3, 300, 4, "qhull"), (3, 300, 20, "qhull"), (4, 300, 3, "qhull")]  # merged facets
    for d, n, grid, command in cases:
        for seed in (1, 2, 3):
            words = [client, str(d), str(n), str(seed), str(grid), *command.split("+")]
            theirs, ours = run(QHULLS, *words)[0], run(OURS, *words)[0]
            if grid:  # of equal points Qhull takes any
                theirs, ours = (re.findall(r"^vertices.*", text, re.M) for text in (theirs, ours))
            if theirs != ours or not theirs:
                wrong.append(f"{words[1:]}: other lines than Qhull's")
    for d, n, grid, command, code in ((3, 20, -1, "qhull", 1), (3, 20, -2, "qhull", 2),
                                      (3, 3, 0, "qhull", 1), (2, 20, -2, "qhull d", 2),
                                      (3, 20, 0, "qhull Fx", 1), (3, 20, 0, "qhull H0", 1),
                                      (3, 20, 0, "d Qt", 1), (3, 20, 0, "qhull Qu", 1)):
        out, err = run(OURS, client, str(d), str(n), "1", str(grid), command)
        if not out.startswith(f"code {code}\n") or len(err.strip().splitlines()) != 1:
            wrong.append(f"{d} {n} {grid} {command}: {out!r} {err!r}")
    ones = [(2, 9, "qhull"), (3, 500, "qhull Tcv"), (4, 60, "qhull Qt"), (3, 300, "qhull d Tcv"),
            (2, 400, "qhull d QJ"), (3, 3, "qhull"), (3, 20, "qhull H0")]
    for d, n, command in ones:
        words = [client_of_one, str(d), str(n), "1", command]
        theirs, ours = (sorted(run(env, *words)[0].splitlines()) for env in (QHULLS, OURS))
        if command == "qhull H0":  # halfspaces, which are not here
            theirs = ["code 1"] * 2
        if theirs != ours or not theirs:
            wrong.append(f"{words[1:]}: other lines than libqhull's")
    return f"{3 * len(cases) + len(ones)} sets"


# What Octave's tests ask of Qhull that is not so for every right answer, by the first words of the
# assertion: one of two diagonals of a square; where a polygon begins and an edge ends; one vertex
# for eight points of a circle that are rounded and lie on no circle.
ARGUED = {
    "convhulln": ["(h,[1, 2, 4; 1, 2, 6;", "(sortrows (sort (h, 2), [1:3]),[1, 2, 4; 1, 2, 5;"],
    "convhull": ["(convhull (x, y),[1; 7; 13;"],
    "delaunay": ["(sortrows (sort (delaunay (x, y), 2)),[1, 2, 4; 2, 3, 4])",
                 "(sortrows (sort (delaunay (mat), 2)),[1, 2, 4; 2, 3, 4])"],
    "voronoi": ["(vx (2, :),zeros (1, columns (vx)),eps)", "(vx,[-0.7; 1.7],eps)"],
}


def octave():
    if not shutil.which("octave-cli"):
        return "left out: no octave-cli"
    found = run(OURS, "octave-cli", "-q", "--eval", "disp(OCTAVE_HOME), disp(OCTAVE_VERSION)")[0].split()
    tests = f"{found[0]}/share/octave/{found[1]}/etc/tests/libinterp/dldfcn/"
    names = ["convhull", "delaunay", "delaunayn", "voronoi", "voronoin", "griddata", "griddatan",
             "griddata3", "tsearchn", "dsearchn",
             *(tests + name + ".cc-tst" for name in ("convhulln", "__voronoi__", "__delaunayn__"))]
    passed = total = 0
    with tempfile.TemporaryDirectory() as scratch:
        for name in names:
            short = os.path.basename(name).replace(".cc-tst", "")
            log = scratch + "/log"
            out, err = run(dict(OURS, HOME=scratch), "octave-cli", "-q", "--eval",
                           f"[n, m] = test ('{name}', 'normal', '{log}'); printf ('ran %d %d\\n', n, m)")
            ran = re.search(r"ran (\d+) (\d+)", out)
            if not ran:
                wrong.append(f"Octave's tests of {short}: {err.strip()}")
                continue
            passed, total = passed + int(ran[1]), total + int(ran[2])
            failed = re.findall(r"^ASSERT errors for:  assert (.*)$", open(log).read(), re.M)
            others = [f for f in failed if not any(f.startswith(a) for a in ARGUED.get(short, []))]
            if others or int(ran[2]) - int(ran[1]) != len(failed):
                wrong.append(f"Octave's tests of {short}: {others or 'an error'}")
    return f"{passed} of {total} tests of Octave, the others argued"


def matplotlib():
    code = """
import sys
import numpy as np
from matplotlib.tri import Triangulation
points = np.random.default_rng(1).random((500, 2))
t = Triangulation(*points.T)
a, b, c = (points[t.triangles[:, k]] for k in range(3))
u, v = b - a, c - a
assert (u[:, 0] * v[:, 1] > u[:, 1] * v[:, 0]).all()
for (k, n) in np.argwhere(t.neighbors >= 0):
    edge = {t.triangles[k, n], t.triangles[k, (n + 1) % 3]}
    assert edge < set(t.triangles[t.neighbors[k, n]])
print(len(t.triangles), (t.neighbors < 0).sum())
"""
    python = "/usr/bin/python3"
    if subprocess.run([python, "-c", "import matplotlib._qhull"], capture_output=True).returncode:
        return "left out: no python3-matplotlib"
    theirs, ours = run(QHULLS, python, "-c", code), run(OURS, python, "-c", code)
    if theirs[0] != ours[0] or not ours[0]:
        wrong.append(f"matplotlib: {ours} in place of {theirs}")
    return "matplotlib"


OPEN3D = """
import open3d, random
points = [[random.Random(k).random() for k in range(3 * i, 3 * i + 3)] for i in range(3000)]
cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
hull, ids = cloud.compute_convex_hull()
print(sorted(ids), len(hull.triangles), hull.is_watertight(), round(hull.get_volume(), 9))
flat = open3d.utility.Vector3dVector([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]])
try:
    open3d.geometry.PointCloud(flat).compute_convex_hull()
except RuntimeError as e:
    print("refused")
"""


def open3d():
    python = "/usr/bin/python3"
    if subprocess.run([python, "-c", "import open3d"], capture_output=True).returncode:
        return "left out: no python3-open3d"
    theirs, ours = run(QHULLS, python, "-c", OPEN3D), run(OURS, python, "-c", OPEN3D)
    if theirs[0] != ours[0] or not ours[0].endswith("refused\n"):
        wrong.append(f"Open3D: {ours} in place of {theirs}")
    return "Open3D"


def same_file(program, name, steps):
    """The lines of the file that the steps of a program write, with both libraries."""
    found = []
    for env in (QHULLS, OURS):
        with tempfile.TemporaryDirectory() as at:
            r = random.Random(1)
            text = "".join(f"{r.random():.4f} {r.random():.4f} {r.random():.4f}\n" for _ in range(1000))
            for points, head in (("points.csv", "X Y Z\n"), ("points.xyz", "")):
                with open(f"{at}/{points}", "w") as out:
                    out.write(head + text)
            for step in steps:
                subprocess.run(step, cwd=at, env=dict(env, HOME=at), capture_output=True, timeout=300)
            made = f"{at}/{name}"
            found.append(sorted(open(made, "rb").readlines()) if os.path.exists(made) else [])
    if found[0] != found[1] or not found[1]:
        wrong.append(f"{program}: another {name}")
    return program


def saga():
    """Natural neighbours of points on a grid."""
    if not shutil.which("saga_cmd"):
        return "left out: no saga_cmd"
    box = dict(SIZE=0.02, XMIN=0.1, XMAX=0.9, YMIN=0.1, YMAX=0.9)
    return same_file("SAGA", "grid.sdat", (
        ["saga_cmd", "io_shapes", "3", "-POINTS=p.shp", "-FILENAME=points.csv", "-HEADLINE=1"],
        ["saga_cmd", "grid_gridding", "3", "-POINTS=p.shp", "-FIELD=Z", "-TARGET_DEFINITION=0",
         *(f"-TARGET_USER_{k}={v}" for k, v in box.items()), "-TARGET_OUT_GRID=grid.sgrd"]))


def meshlab():
    if not shutil.which("meshlabserver") or not shutil.which("xvfb-run"):
        return "left out: no meshlabserver with xvfb-run"
    return same_file("MeshLab", "hull.off", (
        ["sh", "-c", "echo '<!DOCTYPE FilterScript><FilterScript><filter name=\"Convex Hull\"/>"
         "</FilterScript>' > hull.mlx"],
        ["xvfb-run", "-a", "meshlabserver", "-i", "points.xyz", "-o", "hull.off", "-s", "hull.mlx"]))


def main():
    if "libqhull_r.so" not in run(QHULLS, "ldd", client)[0]:
        sys.exit(77)
    for part in (lines, octave, matplotlib, open3d, saga, meshlab):
        print(part())
    for line in wrong:
        print("WRONG", line)
    sys.exit(len(wrong) > 0)


main()
