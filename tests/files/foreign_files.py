"""Point sets as h5py, netCDF4, pypcd4 and laspy write them, held against the same points as .npy.

foreign_files.py PROGRAM [MPI_PROGRAM LAUNCHER...]: the program gives the same hull, whole and in
blocks, and on the ranks of a job, or one line that says what is wrong. A program without libhdf5
must say so.
"""

import gzip
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import laspy
import netCDF4
import numpy as np
from pypcd4 import Encoding, PointCloud

PROGRAM = ""
ON_RANKS = []  # launcher and program, but for the number of ranks


def run(*words):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, timeout=120)


def error_of(*words):
    done = run(*words)
    text = done.stderr.decode()
    assert done.returncode in (1, 2, 4), (done.returncode, text)
    assert text.count("\n") == 1, text
    return text


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.random = np.random.default_rng(5)
        self.points = self.random.normal(size=(5000, 3)).astype(np.float32)

    def hull_of(self, *inputs, options=()):
        done = run("hull", *inputs, "-o", "-", "-q", *options)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return done.stdout

    def same(self, points, *inputs, options=()):
        """The inputs, read both ways, have the hull of `points`."""
        npy = self.folder / "same.npy"
        np.save(npy, points)
        expected = self.hull_of(npy)
        for stream in ("off", "on"):
            if stream == "off" and len(inputs) > 1:
                continue
            with self.subTest(stream=stream):
                got = self.hull_of(*inputs, options=("--stream", stream, *options))
                self.assertEqual(got, expected)


class Pcd(Files):
    def test_every_encoding(self):
        cloud = PointCloud.from_xyz_points(self.points)
        for encoding in Encoding:
            with self.subTest(encoding=encoding):
                path = self.folder / f"{encoding.value}.pcd"
                cloud.save(path, encoding=encoding)
                points = self.points
                if encoding is Encoding.ASCII:  # whose decimals are what the file holds
                    rows = path.read_text().split("\n")
                    start = next(i for i, row in enumerate(rows) if row.startswith("DATA")) + 1
                    points = np.array([[float(w) for w in r.split()] for r in rows[start:] if r])
                self.same(points, path)

    def test_fields_of_many_types(self):
        fields = ("intensity", "z", "label", "x", "stamp", "y")
        types = (np.float32, np.float64, np.uint16, np.float32, np.uint8, np.int32)
        columns = [
            (self.random.normal(size=1000) * 100).astype(t)
            if t != np.uint8
            else self.random.integers(0, 9, 1000).astype(t)
            for t in types
        ]
        cloud = PointCloud.from_points(columns, fields, types)
        xyz = np.column_stack([columns[fields.index(c)].astype(np.float64) for c in "xyz"])
        for encoding in (Encoding.BINARY, Encoding.BINARY_COMPRESSED):
            path = self.folder / f"{encoding.value}.pcd"
            cloud.save(path, encoding=encoding)
            self.same(xyz, path)

    def test_what_is_cut_short(self):
        path = self.folder / "a.pcd"
        for encoding in (Encoding.BINARY, Encoding.BINARY_COMPRESSED):
            PointCloud.from_xyz_points(self.points).save(path, encoding=encoding)
            path.write_bytes(path.read_bytes()[:-100])
            for stream in ("on", "off"):
                text = error_of("hull", path, "--stream", stream)
                self.assertIn("a.pcd: byte", text)


class Las(Files):
    def las(self, point_format, version, count=2000):
        las = laspy.create(point_format=point_format, file_version=version)
        las.header.scales, las.header.offsets = [0.01, 0.02, 0.5], [100, -200, 300]
        for axis in "XYZ":
            las[axis] = self.random.integers(-(10**6), 10**6, count).astype(np.int32)
        las.intensity = self.random.integers(0, 65535, count).astype(np.uint16)
        las.return_number = self.random.integers(1, 6, count).astype(np.uint8)
        return las

    def test_survivors_keep_every_field(self):
        path, fewer = self.folder / "a.las", self.folder / "b.las"
        for point_format in range(11):
            version = "1.4" if point_format > 5 else "1.3" if point_format > 3 else "1.2"
            las = self.las(point_format, version)
            if version == "1.4":
                las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("us", 7, "behind", b"x" * 99)])
            las.write(str(path))
            las = laspy.read(str(path))
            for stream in ("off", "on"):
                with self.subTest(point_format=point_format, stream=stream):
                    done = run("cull", path, "-o", fewer, "--stream", stream)
                    self.assertEqual(done.returncode, 0, done.stderr.decode())
                    ids_path = self.folder / "ids.npy"
                    run("cull", path, "-o", ids_path, "--stream", stream)
                    ids = np.load(ids_path)
                    self.assertLess(len(ids), 1000)
                    got = laspy.read(str(fewer))
                    self.assertEqual(got.header.version, las.header.version)
                    self.assertEqual(got.header.point_format, las.header.point_format)
                    self.assertTrue((got.header.scales == las.header.scales).all())
                    self.assertTrue((got.header.offsets == las.header.offsets).all())
                    self.assertTrue((got.points.array == las.points.array[ids]).all())
                    self.assertEqual(len(got), len(ids))
                    returns = np.bincount(got.return_number, minlength=6)[1:6]
                    self.assertEqual(list(got.header.number_of_points_by_return[:5]), list(returns))
                    xyz = np.column_stack([got.x, got.y, got.z])
                    self.assertTrue(np.allclose(got.header.mins, xyz.min(0), atol=1e-9))
                    self.assertTrue(np.allclose(got.header.maxs, xyz.max(0), atol=1e-9))
                    if version == "1.4":
                        self.assertEqual(got.evlrs[0].record_data, b"x" * 99)
                    self.assertEqual(self.hull_vertices(fewer), self.hull_vertices(path))

    def test_laz_is_the_las(self):
        """Every command's output, and the records of survivors; the same hull from a pipe."""
        las, laz = self.folder / "a.las", self.folder / "a.laz"
        for point_format in (0, 1, 2, 3, 6, 7, 8):
            for count in (1, 10, 49_999, 50_000, 50_001):
                scan = self.las(point_format, "1.4" if point_format > 5 else "1.2", count)
                scan.write(str(las))
                scan.write(str(laz))
                with self.subTest(point_format=point_format, count=count):
                    for words in (("--columns", "x,y"), ("--by", "return_number")):
                        self.assertEqual(self.hull_of(laz, options=words),
                                         self.hull_of(las, options=words))
                    for stream in ("off", "on"):
                        got = []
                        for path in (las, laz):
                            out = self.folder / (path.stem + "-fewer.las")
                            done = run("cull", path, "-o", out, "--stream", stream)
                            self.assertEqual(done.returncode, 0, done.stderr.decode())
                            got.append(laspy.read(str(out)).points.array)
                        self.assertTrue((got[0] == got[1]).all())
                    with open(laz, "rb") as pipe:
                        done = subprocess.run([PROGRAM, "hull", "-", "-q", "-o", "-"],
                                              stdin=pipe, capture_output=True, timeout=120)
                    self.assertEqual(done.stdout, self.hull_of(las), done.stderr)

    def hull_vertices(self, path):
        done = run("hull", path, "--format", "p")
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return sorted(done.stdout.decode().splitlines())

    def test_las_is_written_of_one_las_alone(self):
        self.las(0, "1.2").write(str(self.folder / "a.las"))
        np.save(self.folder / "a.npy", self.points)
        out = self.folder / "out.las"
        self.assertIn("of one .las", error_of("cull", self.folder / "a.npy", "-o", out))
        twice = [self.folder / "a.las"] * 2
        self.assertIn("of one .las", error_of("cull", *twice, "--points", out))
        self.assertFalse(out.exists())


class Hdf5(Files):
    def setUp(self):
        super().setUp()
        with h5py.File(self.folder / "probe.h5", "w") as file:
            file["p"] = self.points
        done = run("hull", self.folder / "probe.h5")
        if b"built without libhdf5" in done.stderr:
            self.assertEqual(done.returncode, 2)
            self.skipTest("the program was built without libhdf5")

    def test_every_type_and_layout(self):
        path = self.folder / "a.h5"
        types = ("f2", "<f4", ">f4", "f8", ">f8", "i1", "u1", "i2", ">u2", "i4", "u4", "i8", "u8")
        layouts = ({}, {"chunks": (700, 2)}, {"chunks": (999, 3), "compression": "gzip", "shuffle": True})
        for kind in types:
            scale = 30 if np.dtype(kind).kind in "iu" else 1
            points = np.abs(self.points * scale) if kind[-2] == "u" else self.points * scale
            points = points.astype(kind)
            for layout in layouts:
                with self.subTest(kind=kind, layout=layout):
                    with h5py.File(path, "w") as file:
                        file.create_dataset("scan/one/points", data=points, **layout)
                        file["other"] = np.zeros(7)
                    wide = points.astype("f4" if kind == "f2" else "f8" if kind[-1] == "8" else
                                         np.dtype(kind).newbyteorder("="))
                    self.same(wide, f"{path}:/scan/one/points")
                    self.same(wide[:, [2, 0]], f"{path}:scan/one/points", options=("--columns", "2,0"))

    def test_columns_of_their_own(self):
        path = self.folder / "a.hdf5"
        columns = [self.points[:, 0], self.points[:, 1].astype("f8"), (self.points[:, 2] * 99).astype("i2")]
        with h5py.File(path, "w") as file:
            for name, column in zip("xyz", columns):
                file[f"g/{name}"] = column
            file["g/short"] = columns[0][:10]
        self.same(np.column_stack(columns), f"{path}:g/x,g/y,g/z")
        self.same(np.column_stack(columns[:1] * 2), f"{path}:g/x,g/x")
        self.assertIn("5000 and 10 numbers", error_of("hull", f"{path}:g/x,g/short"))

    def test_netcdf4(self):
        path = self.folder / "a.nc"
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            file.createDimension("n", None)
            for j, name in enumerate("xyz"):
                file.createVariable(name, "f4", ("n",))[:] = self.points[:, j]
        self.same(self.points, f"{path}:x,y,z")
        old = self.folder / "old.nc"
        with netCDF4.Dataset(old, "w", format="NETCDF3_CLASSIC") as file:
            file.createDimension("n", 3)
        self.assertIn("nccopy", error_of("hull", f"{old}:x"))

    def test_many_files_are_one_set(self):
        for i, part in enumerate(np.array_split(self.points, 3)):
            with h5py.File(self.folder / f"part{i}.h5", "w") as file:
                file["p"] = part
                file["q"] = part
        inputs = [f"{self.folder}/part{i}.h5:/p" for i in range(3)]
        self.same(self.points, *inputs)
        self.same(self.points, f"{self.folder}/part*.h5:/p", *())

    def test_checkpoint_and_limits(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("p", shape=(10**9, 3), dtype="f8", chunks=(10**6, 3))
        self.assertIn("need more than", error_of("hull", f"{path}:p", "--memory", "1GiB", "--stream", "off"))

    def sparse(self, file, name, **layout):
        """A dataset (5000, 3) that libhdf5 never fills, so that reading leaves gaps."""
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
        if "chunk" in layout:
            made.set_chunk(layout["chunk"])
        if layout.get("packed"):
            made.set_deflate(4)
        space = h5py.h5s.create_simple((5000, 3))
        return h5py.Dataset(h5py.h5d.create(file.id, name.encode(), h5py.h5t.NATIVE_DOUBLE, space, made))

    def test_storage_that_was_never_written(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w") as file:
            self.sparse(file, "contiguous")
            self.sparse(file, "chunked", chunk=(700, 2))
            self.sparse(file, "part", chunk=(700, 2))[:2000] = self.points[:2000]
            self.sparse(file, "packed", chunk=(700, 3), packed=True)[1400:2800] = self.points[1400:2800]
        for stream in ("off", "on"):
            for name, first in (("contiguous", 0), ("chunked", 0), ("part", 2100), ("packed", 0)):
                with self.subTest(name=name, stream=stream):
                    text = error_of("hull", f"{path}:{name}", "--stream", stream)
                    self.assertIn(f"point {first} was never written", text)

    def test_gaps_that_have_a_value(self):
        path = self.folder / "a.h5"
        whole = self.points.astype("f8")
        with h5py.File(path, "w") as file:
            for name, packed in (("plain", False), ("packed", True)):
                self.sparse(file, name, chunk=(700, 2), packed=packed)[...] = whole
            self.sparse(file, "contiguous")[...] = whole
            filled = file.create_dataset("filled", (5000, 3), "f8", chunks=(700, 3), fillvalue=2.5)
            filled[:1400] = whole[:1400]
            file.create_dataset("zeros", (5000, 3), "f8")
        for name in ("plain", "packed", "contiguous"):
            self.same(whole, f"{path}:{name}")
        whole[1400:] = 2.5
        self.same(whole, f"{path}:filled")
        self.same(np.zeros((5000, 3)), f"{path}:zeros")

    def test_what_is_not_there(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w") as file:
            file["points"] = self.points
            file["group/times"] = np.zeros(3)
            file["words"] = ["a", "b"]
            file["cube"] = np.zeros((2, 2, 2))
            file["wide"] = np.array([[2**53 + 1, 0], [1, 1]])
            file["pairs"] = np.zeros(3, dtype=[("a", "f4"), ("b", "f4")])
        for stream in ("on", "off"):
            options = ("--stream", stream)
            listed = error_of("hull", path, *options)
            self.assertIn("'/group/times' (3), '/points' (5000, 3), '/wide' (2, 2)", listed)
            self.assertNotIn("words", listed)
            self.assertIn("no dataset 'nope'", error_of("hull", f"{path}:nope", *options))
            for name in ("words", "cube", "pairs", "group"):
                text = error_of("hull", f"{path}:{name}", *options)
                self.assertRegex(text, "is no array|no dataset")
            self.assertIn("index (0, 0)", error_of("hull", f"{path}:wide", *options))
            self.assertIn("no column among", error_of("hull", f"{path}:points,points", *options))
        done = subprocess.run([PROGRAM, "hull", "-"], input=path.read_bytes(), capture_output=True)
        self.assertIn(b"from a file", done.stderr)

    def test_names_in_errors_are_printable(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w", libver="earliest") as file:
            for name in ("aaaa", "bbbb"):
                file[name] = np.eye(2)
        path.write_bytes(path.read_bytes().replace(b"aaaa\0", b"\xf7\xff\x01\x1b\0", 1))
        for stream in ("on", "off"):  # libhdf5 finds the name, and nothing by it
            self.assertIn("object '????'", error_of("hull", path, "--stream", stream))

    def test_what_crashes_libhdf5(self):
        path = pathlib.Path(__file__).parent / "damaged.h5"  # of 1.10, by a length of a heap's names
        for stream in ("on", "off"):
            self.assertIn(str(path), error_of("hull", f"{path}:x,y", "--stream", stream))

    def test_what_is_corrupt(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("p", data=self.points, chunks=(100, 3), compression="gzip")
        whole = path.read_bytes()
        for size in (9, 100, 900, len(whole) // 2, len(whole) - 7):
            path.write_bytes(whole[:size])
            for stream in ("on", "off"):
                error_of("hull", f"{path}:p", "--stream", stream)
        for _ in range(200):  # nothing but a hull or a line may come of it
            bad = bytearray(whole)
            for at in self.random.integers(0, len(bad), 8):
                bad[at] = self.random.integers(0, 256)
            path.write_bytes(bad)
            done = run("hull", f"{path}:p", "--memory", "2GiB")
            self.assertIn(done.returncode, (0, 1, 2, 4), done.stderr.decode())


def write_tile(path, points):
    """By its ending: what somebody's program writes for these points."""
    kind = path.name.split(".", 1)[1]
    if kind == "npy":
        np.save(path, points)
    elif kind == "npz":
        np.savez_compressed(path, points=points)
    elif kind in ("csv", "csv.gz"):
        with (gzip.open if kind.endswith("gz") else open)(path, "wt") as file:
            file.write("x,y,z\n")
            np.savetxt(file, points, fmt="%.17g", delimiter=",")
    elif kind == "xyz":
        np.savetxt(path, points, fmt="%.17g")
    elif kind == "h5":
        with h5py.File(path, "w") as file:
            file["points"] = points
    elif kind == "nc":
        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("n", len(points))
            file.createDimension("d", 3)
            file.createVariable("points", points.dtype, ("n", "d"))[:] = points
    elif kind == "las":
        las = laspy.create(point_format=3, file_version="1.2")
        las.points = laspy.ScaleAwarePointRecord.zeros(len(points), header=las.header)
        las.points.array["X"], las.points.array["Y"], las.points.array["Z"] = points.T
        las.write(str(path))
    else:
        encodings = {"a.pcd": Encoding.ASCII, "b.pcd": Encoding.BINARY}
        encoding = encodings.get(kind, Encoding.BINARY_COMPRESSED)
        PointCloud.from_xyz_points(points).save(path, encoding=encoding)


class Tiles(Files):
    def test_a_hundred_tiles_are_one_file(self):
        whole = (self.random.normal(size=(20000, 3)) * 1000).round().astype(np.float32)
        for kind in ("npy", "npz", "csv", "csv.gz", "xyz", "h5", "nc", "las", "a.pcd", "b.pcd", "c.pcd"):
            with self.subTest(kind=kind):
                folder = self.folder / kind
                folder.mkdir()
                points = whole.astype("i4") if kind == "las" else whole
                raw = ("--raw",) if kind == "las" else ()
                text = kind[:3] in ("csv", "xyz", "a.p")
                for i, tile in enumerate(np.array_split(points, 100)):
                    write_tile(folder / f"tile{i}.{kind}", tile)
                if kind in ("h5", "nc") and b"built without" in run("hull", folder / f"tile0.{kind}").stderr:
                    self.skipTest("the program was built without libhdf5")
                np.save(self.folder / "whole.npy", points.astype("f8") if text else points)
                expected = self.hull_of(self.folder / "whole.npy", options=("--stream", "off"))
                self.assertEqual(self.hull_of(folder, options=raw), expected)
                state = self.folder / "half.hullstate"
                halves = [f"{folder}/tile[0-4]?.{kind}", f"{folder}/tile[5-9]?.{kind}"]
                first = [f"{folder}/tile?.{kind}", halves[0]]
                done = run("hull", *first, "--partial", state, "-q", *raw)
                self.assertEqual(done.returncode, 0, done.stderr.decode())
                self.assertEqual(self.hull_of(state, halves[1], options=raw), expected)


class Ranks(Files):
    def setUp(self):
        super().setUp()
        if not ON_RANKS:
            self.skipTest("the program for MPI jobs was not built")

    def hull_on(self, ranks, *words):
        launcher, program = ON_RANKS[:-1], ON_RANKS[-1]
        command = [*launcher, "-n", str(ranks), program, "hull", *map(str, words), "-q"]
        return subprocess.run(command, capture_output=True, timeout=120)

    def check(self, *inputs):
        """Four ranks write what one process does."""
        out = self.folder / "ranks.json"
        done = self.hull_on(4, *inputs, "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        one = self.folder / "one.json"
        self.hull_of(*inputs, options=("--stream", "on", "-o", str(one)))
        self.assertEqual(out.read_bytes(), one.read_bytes())

    def test_hyperslabs_of_one_dataset(self):
        path = self.folder / "a.h5"
        for layout in ({}, {"chunks": (700, 2)}, {"chunks": (999, 3), "compression": "gzip"}):
            for count in (5000, 3, 1):
                with h5py.File(path, "w") as file:
                    points = self.points[:count]
                    chunks = {"chunks": (1, 3)} if count < 999 and layout else layout
                    file.create_dataset("p", data=points, **chunks)
                    file["x"], file["y"] = points[:, 0], points[:, 1].astype("f8")
                if b"built without libhdf5" in run("hull", f"{path}:p").stderr:
                    self.skipTest("the program was built without libhdf5")
                with self.subTest(layout=layout, count=count):
                    self.check(f"{path}:p")
                    self.check(f"{path}:x,y")

    def test_no_rank_reads_the_others_hyperslabs(self):
        path, out = self.folder / "a.h5", self.folder / "out.json"
        with h5py.File(path, "w") as file:  # 120 MB
            file["p"] = self.random.standard_normal((10**7, 3), dtype=np.float32)
        if b"built without libhdf5" in run("hull", f"{path}:p").stderr:
            self.skipTest("the program was built without libhdf5")
        options = ("--memory", "100MB", "-o", out)
        self.assertIn(b"need more than", self.hull_on(1, f"{path}:p", *options).stderr)
        done = self.hull_on(4, f"{path}:p", *options)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        self.check(f"{path}:p")

    def test_slices_and_tiles_of_scans(self):
        points = (self.points * 1000).astype("i4")
        for kind in ("las", "b.pcd", "npy"):
            with self.subTest(kind=kind):
                slices = self.folder / f"all.{kind}"
                write_tile(slices, points)
                self.check(slices)
                tiles = [self.folder / f"tile{i}.{kind}" for i in range(17)]
                for tile, part in zip(tiles, np.array_split(points, 17)):
                    write_tile(tile, part)
                self.check(*tiles)


class Others(Files):
    def test_zarr_names_what_reads_it(self):
        folder = self.folder / "a.zarr"
        folder.mkdir()
        (folder / ".zarray").write_text("{}")
        for stream in ("on", "off"):
            self.assertIn("cullhull.read(path)", error_of("hull", folder, "--stream", stream))


if __name__ == "__main__":
    PROGRAM, *rest = sys.argv[1:]
    ON_RANKS = [*rest[1:], rest[0]] if rest else []
    unittest.main(argv=sys.argv[:1])
