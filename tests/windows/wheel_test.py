"""What the wheel writes in a Python of Windows, under wine: wheel_test.py FOLDER
What Linux's program writes of the same, and whether the bytes are the same: FOLDER CULLHULL"""
import subprocess
import sys
from pathlib import Path

folder, programs = Path(sys.argv[1]), sys.argv[2:]
#: Each file, and what it is to the program.
words = {"3.npy": "generate ball -n 20000 -d 3", "2.npy": "generate disk -n 5000 -d 2",
         "4.npy": "generate ball -n 300 -d 4", "h3.json": "hull 3.npy", "h3.ply": "hull 3.npy",
         "h2.geojson": "hull 2.npy", "h4.json": "hull 4.npy", "d3.json": "delaunay 3.npy",
         "d2.ply": "delaunay 2.npy", "v2.json": "voronoi 2.npy", "s.hullstate": "hull 3.npy",
         "b.json": "hull 3.npy"}


def write():
    import cullhull
    import numpy as np
    import scipy.spatial

    points = {d: cullhull.generate(kind, n, d)
              for kind, n, d in (("ball", 20000, 3), ("disk", 5000, 2), ("ball", 300, 4))}
    for d, rows in points.items():
        np.save(folder / f"{d}.npy", rows)
    hulls = {d: cullhull.convex_hull(rows) for d, rows in points.items()}
    for name in ("h3.json", "h3.ply", "h2.geojson", "h4.json"):
        hulls[int(name[1])].save(folder / name, points[int(name[1])])
    for name in ("d3.json", "d2.ply"):
        cullhull.delaunay(points[int(name[1])]).save(folder / name)
    cullhull.voronoi(points[2]).save(folder / "v2.json")
    cullhull.HullState(points[3]).save(folder / "s.hullstate")
    stream = cullhull.HullStream()
    stream.extend(np.array_split(points[3], 7))
    stream.hull().save(folder / "b.json", points[3])
    with cullhull.patch("scipy"):
        assert isinstance(scipy.spatial.ConvexHull(points[3]), cullhull.ConvexHull)
    assert cullhull.certify(points[3], hulls[3])


if not programs:
    write()
    sys.exit()
faults = []
for name, command in words.items():
    theirs = folder / f"linux-{name}"
    option = "--partial" if name.endswith("state") else "-o"
    subprocess.run([*programs, *command.split(), "-q", option, theirs.name], cwd=folder, check=True)
    begin = 128 if name.endswith("npy") else 0  # NumPy writes another header, as long
    if theirs.read_bytes()[begin:] != (folder / name).read_bytes()[begin:]:
        faults.append(name)
print(f"wheel_test: {len(words)} files, other bytes than Linux's in {faults or 'none'}")
sys.exit(bool(faults))
