"""Points in pieces give the bits of all of them at once."""

import concurrent.futures
import copy
import functools
import gzip
import importlib.util
import pickle
import random
import struct
import threading
import time

import numpy as np
import pytest

import cullhull
import programs
from made_files import scan, write_hdf5, write_parquet

#: Points of scans.
WHOLE = (cullhull.generate("ball", 500) * 1e6).astype(np.int32)
ARRAYS = (
    *("vertices", "vertex_points", "facet_planes", "simplices", "simplex_neighbours"),
    *("simplex_facets", "centroid"),
)


def same(a, b):
    """Every list and number, bit for bit; statistics aside."""
    for name in ARRAYS:
        x, y = getattr(a, name), getattr(b, name)
        if x.dtype != y.dtype or x.shape != y.shape or x.tobytes() != y.tobytes():
            return False
    return (
        a.facets.tolist() == b.facets.tolist()
        and a.facet_neighbours.tolist() == b.facet_neighbours.tolist()
        and (a.volume, a.area, a.point_count) == (b.volume, b.area, b.point_count)
    )


@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int16])
def test_blocks_in_any_order_give_the_whole(dimension, dtype):
    points = (cullhull.generate("ball", 4000, dimension) * 500).astype(dtype)
    whole = cullhull.convex_hull(points)
    starts = list(range(0, 4000, 700))
    random.Random(1).shuffle(starts)
    stream = cullhull.HullStream()
    for start in starts:
        stream.push(points[start : start + 700], start)
    assert stream.point_count == 4000
    assert same(stream.hull(), whole)
    state = stream.state()
    assert state.points.dtype == dtype
    assert np.array_equal(state.points, points[state.ids.astype(int)])
    assert np.array_equal(state.ids, np.sort(whole.vertices))


def test_iterators_lists_and_strides():
    points = cullhull.generate("ball", 5000)
    stream = cullhull.HullStream()
    stream.extend(points[i : i + 100].tolist() for i in range(0, 5000, 100))
    assert same(stream.hull(), cullhull.convex_hull(points))
    other = cullhull.HullStream()
    other.push(np.asfortranarray(points)[::-1])
    assert other.hull().volume == cullhull.convex_hull(points[::-1]).volume


def test_many_threads_push_at_once_without_the_gil():
    points = cullhull.generate("gauss", 400_000)
    stream = cullhull.HullStream(threads=1)
    starts = range(0, 400_000, 5000)
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda i: stream.push(points[i : i + 5000], i), starts))
    assert same(stream.hull(), cullhull.convex_hull(points))


def test_other_threads_run_while_one_pushes():
    points = cullhull.generate("sphere", 300_000)
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    clock = threading.Thread(target=tick)
    clock.start()
    stream = cullhull.HullStream()
    stream.push(points)
    stream.state()
    done.set()
    clock.join()
    assert len(ticks) > 3


def test_states_merge_in_any_tree():
    points = np.concatenate([cullhull.generate("cube", 3000), cullhull.generate("cube", 1000)])
    whole = cullhull.HullState(points)
    parts = [cullhull.HullState(points[i : i + 500], i) for i in range(0, 4000, 500)]
    for seed in range(5):
        states = list(parts)
        rng = random.Random(seed)
        while len(states) > 1:
            rng.shuffle(states)
            states.append(states.pop() | pickle.loads(pickle.dumps(states.pop())))
        assert states[0] == whole
    assert cullhull.HullState() | whole == whole
    assert whole != parts[0]
    assert same(whole.hull(), cullhull.convex_hull(points))


def test_saved_and_loaded(tmp_path):
    points = cullhull.generate("ball", 2000).astype(np.float32)
    state = cullhull.HullState(points, 5)
    state.save(tmp_path / "a.hullstate")
    assert cullhull.HullState.load(tmp_path / "a.hullstate") == state
    state.save(tmp_path / "a.npz")
    arrays = np.load(tmp_path / "a.npz")
    for name, array in state.to_arrays().items():
        assert np.array_equal(arrays[name], array)
        assert arrays[name].dtype == array.dtype
    data = bytearray((tmp_path / "a.hullstate").read_bytes())
    data[100] ^= 1
    (tmp_path / "b.hullstate").write_bytes(data)
    with pytest.raises(cullhull.BadFile, match="b.hullstate"):
        cullhull.HullState.load(tmp_path / "b.hullstate")
    with pytest.raises(ValueError):
        state.save(tmp_path / "a.txt")


def test_copies_go_on_by_themselves():
    points = cullhull.generate("ball", 3000)
    stream = cullhull.HullStream(threads=1)
    stream.push(points[:1000])
    copies = [copy.copy(stream), copy.deepcopy(stream), pickle.loads(pickle.dumps(stream))]
    for each in copies:
        each.push(points[1000:], 1000)
        assert same(each.hull(), cullhull.convex_hull(points))
    assert stream.point_count == 1000


def test_a_push_that_fails_leaves_everything_as_it_was():
    points = cullhull.generate("ball", 1000)
    stream = cullhull.HullStream()
    stream.push(points)
    bad = points.copy()
    bad[17, 1] = np.nan
    with pytest.raises(cullhull.NotFinite, match="point 1017, coordinate 1"):
        stream.push(bad)
    with pytest.raises(ValueError, match="dimension"):
        stream.push(points[:, :2])
    with pytest.raises(TypeError):
        stream.push(np.array([["a", "b", "c"]]))
    with pytest.raises(ValueError):
        stream.push(points, -1)
    assert stream.point_count == 1000
    stream.push(points)
    assert stream.point_count == 2000
    assert same(stream.hull(), cullhull.convex_hull(np.concatenate([points, points])))


def test_nothing_has_no_hull():
    with pytest.raises(ValueError, match="dimension"):
        cullhull.HullStream().hull()
    assert len(cullhull.HullState()) == 0
    assert cullhull.HullState(np.empty((0, 3))).hull().affine_dimension == -1
    with pytest.raises(TypeError):
        cullhull.HullState().merge([[1, 2]])


def test_budget():
    stream = cullhull.HullStream(memory_budget=4 << 20)
    points = cullhull.generate("sphere", 100_000)
    with pytest.raises(MemoryError, match="the stream holds"):
        for i in range(0, 100_000, 5000):
            stream.push(points[i : i + 5000])
    assert 5000 <= stream.point_count < 100_000


def test_shown():
    assert repr(cullhull.HullStream()) == "<HullStream: 0 points, 0 of them held>"
    assert "3 extreme of 4 points in 2D" in repr(
        cullhull.HullState([[0, 0], [3, 0], [0, 3], [1, 1]])
    )


def test_read_npy_in_chunks(tmp_path):
    points = cullhull.generate("ball", 1000, 4).astype(np.float32)
    np.save(tmp_path / "a.npy", points)
    assert np.array_equal(cullhull.read(tmp_path / "a.npy"), points)
    blocks = list(cullhull.read(tmp_path / "a.npy", columns=[0, 2, 3], chunks=300))
    assert [len(b) for b in blocks] == [300, 300, 300, 100]
    assert np.array_equal(np.concatenate(blocks), points[:, [0, 2, 3]])
    with pytest.raises(ValueError, match="columns must be numbers from 0 to 3"):
        list(cullhull.read(tmp_path / "a.npy", columns=[4], chunks=10))


WRITTEN = {
    "a.xyz": b"0 1 2\n3 4 5\n",
    "a.csv": b"name,z,y,x,intensity\np,2,1,0,7\nq,5,4,3,8\n",
    "a.obj": b"v 0 1 2\nv 3 4 5\n",
    "a.off": b"OFF\n2 0 0\n0 1 2\n3 4 5\n",
    "a.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty uchar a\n"
    b"property float x\nproperty float y\nproperty float z\nend_header\n"
    + b"".join(struct.pack("<Bfff", 9, k, k + 1, k + 2) for k in (0, 3)),
    "a.pcd": b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    b"POINTS 2\nDATA ascii\n0 1 2\n3 4 5\n",
    "a.xyz.gz": gzip.compress(b"0 1 2\n3 4 5\n"),
}


@pytest.mark.parametrize("name", WRITTEN)
@pytest.mark.filterwarnings("ignore::cullhull.ShapeWarning")
def test_read_by_the_programs_readers(tmp_path, name):
    (tmp_path / name).write_bytes(WRITTEN[name])
    points = cullhull.read(tmp_path / name)
    assert points.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert [b.tolist() for b in cullhull.read(tmp_path / name, chunks=1)] == [
        [[0, 1, 2]],
        [[3, 4, 5]],
    ]
    assert cullhull.convex_hull(points).volume == cullhull.convex_hull([[0, 1, 2], [3, 4, 5]]).volume


def test_read_columns_of_text(tmp_path):
    (tmp_path / "a.csv").write_bytes(WRITTEN["a.csv"])
    with pytest.warns(cullhull.ShapeWarning, match="x, y and z of 5 columns"):
        cullhull.read(tmp_path / "a.csv")
    assert cullhull.read(tmp_path / "a.csv", columns=["intensity", "x"]).tolist() == [[7, 0], [8, 3]]
    assert cullhull.read(tmp_path / "a.csv", columns=[1, 2]).tolist() == [[2, 1], [5, 4]]
    with pytest.raises(ValueError, match="no column"):
        cullhull.read(tmp_path / "a.csv", columns=["w"])


def test_read_refuses(tmp_path):
    with pytest.raises(OSError, match="none.ply"):
        cullhull.read(tmp_path / "none.ply")
    (tmp_path / "bad.ply").write_bytes(b"ply\nformat ascii 1.0\n")
    with pytest.raises(cullhull.BadFile, match="bad.ply"):
        cullhull.read(tmp_path / "bad.ply")
    (tmp_path / "a.xyz").write_bytes(b"0 1 2\n")
    kept = cullhull.read(tmp_path / "a.xyz")
    with pytest.raises(ValueError, match="read-only"):
        kept[0, 0] = 1


def test_read_hdf5_by_dataset(tmp_path):
    points = cullhull.generate("ball", 1000)
    path = tmp_path / "a.h5"
    write_hdf5(path, {"scan/points": points})
    assert np.array_equal(cullhull.read(path), points)
    write_hdf5(path, {"other": points[:7]})
    assert np.array_equal(cullhull.read(f"{path}:/scan/points"), points)
    blocks = list(cullhull.read(f"{path}:other", columns=[2, 0], chunks=3))
    assert [len(b) for b in blocks] == [3, 3, 1]
    assert np.array_equal(np.concatenate(blocks), points[:7, [2, 0]])
    for name in (path, f"{path}:nothing", f"{path}:scan"):
        with pytest.raises(ValueError, match="/other, /scan/points"):
            cullhull.read(name)


def test_read_parquet_by_column(tmp_path):
    points = cullhull.generate("ball", 1000)
    write_parquet(tmp_path / "a.parquet", {"name": ["a"] * 1000, **dict(zip("xyz", points.T))})
    assert np.array_equal(cullhull.read(tmp_path / "a.parquet"), points)
    blocks = list(cullhull.read(tmp_path / "a.parquet", columns=["z", "x"], chunks=100))
    assert np.array_equal(np.concatenate(blocks), points[:, [2, 0]])
    with pytest.raises(ValueError, match="no column 'w'"):
        cullhull.read(tmp_path / "a.parquet", columns=["w"])
    write_parquet(tmp_path / "b.parquet", {"x": [1.0, None], "y": [1.0, 2.0]})
    with pytest.raises(cullhull.BadFile, match="missing"):
        cullhull.read(tmp_path / "b.parquet")


@pytest.mark.parametrize("point_format", range(11))
@pytest.mark.parametrize("ending", ["las", "laz"])
def test_las_of_every_point_format(tmp_path, point_format, ending):
    if ending == "laz" and point_format in (4, 5, 9, 10):
        pytest.skip("lazrs does not compress waveforms")
    version = "1.4" if point_format > 5 else "1.3" if point_format > 3 else "1.2"
    las = scan(WHOLE, ending, point_format, version, [0.01, 0.1, 0.001], [484000, -200.5, 300])
    points, path = WHOLE, tmp_path / f"a.{ending}"
    las.classification = np.arange(500) % 5
    las.write(str(path))
    raw = cullhull.read(path, raw=True)
    assert raw.dtype == np.int32 and np.array_equal(raw, points)
    assert np.array_equal(np.concatenate(list(cullhull.read(path, chunks=77, raw=True))), points)
    exact = (points.astype(np.int64) * [10, 100, 1] + [484000000, -200500, 300000]) / 1000
    assert np.array_equal(cullhull.read(path), exact)
    assert np.array_equal(np.concatenate(list(cullhull.read(path, chunks=77))), exact)
    assert np.array_equal(cullhull.read(path, columns=["y", "X"]), exact[:, [1, 0]])
    got = cullhull.read(path, columns=["x", "classification"])
    assert np.array_equal(got, np.column_stack([exact[:, 0], np.arange(500) % 5]))
    laspys = pytest.importorskip("laspy").read(str(path)).xyz  # with the roundings of its product and its sum
    assert np.allclose(exact, laspys, rtol=2**-51, atol=484000 * 2**-52)


def test_scans_beside_no_grid_are_what_laspy_computes(tmp_path):
    las = scan(WHOLE, "las", 3, "1.2", [0.01, 1 / 3, 0.001], [484000.123456789012, 0, np.pi])
    for name in ("a.las", "a.laz") if importlib.util.find_spec("lazrs") else ("a.las",):
        las.write(str(tmp_path / name))
        assert np.array_equal(cullhull.read(tmp_path / name), las.xyz)
        assert np.array_equal(np.concatenate(list(cullhull.read(tmp_path / name, chunks=9))), las.xyz)


@pytest.mark.parametrize("ending", ["las", "laz"])
@pytest.mark.parametrize("bad", [0.0, -0.01, np.nan, np.inf])
def test_scans_without_a_scale_are_raw_alone(tmp_path, ending, bad):
    points, path = WHOLE, tmp_path / f"a.{ending}"
    scan(points, ending).write(str(path))
    with open(path, "r+b") as file:
        file.seek(139)
        file.write(np.float64(bad).tobytes())
    with pytest.raises(cullhull.BadFile, match=f"scale of y is {bad:g}, which gives no coordinates"):
        cullhull.read(path)
    with pytest.raises(cullhull.BadFile, match="scale of y"):
        list(cullhull.read(path, chunks=77))
    assert np.array_equal(cullhull.read(path, raw=True), points)
    assert np.array_equal(np.concatenate(list(cullhull.read(path, chunks=77, raw=True))), points)


@pytest.mark.parametrize("ending", ["las", "laz"])
def test_coordinates_beside_gps_time_are_in_the_world(tmp_path, ending):
    las = scan(WHOLE[:300], ending, 1, "1.2", [0.01] * 3, [100, 200, 300])
    las.x, las.y, las.z = cullhull.generate("ball", 300).T * 50 + [[100], [200], [300]]
    las.gps_time = np.arange(300) ** 1.5
    path = tmp_path / f"a.{ending}"
    las.write(str(path))
    for raw in (False, True):
        x, y = (las.X, las.Y) if raw else (np.asarray(las.x), np.asarray(las.y))
        expected = np.column_stack([x, y, las.gps_time])
        whole = cullhull.read(path, columns="x,y,gps_time", raw=raw)
        parts = cullhull.read(path, columns="x,y,gps_time", raw=raw, chunks=77)
        np.testing.assert_array_equal(whole, expected)
        np.testing.assert_array_equal(np.concatenate(list(parts)), expected)


@pytest.mark.parametrize("at", [139, 163])
def test_the_command_line_reads_stored_integers_of_laz(tmp_path, at):
    points, path = WHOLE, tmp_path / "a.laz"
    scan(points, "laz").write(str(path))
    with open(path, "r+b") as file:
        file.seek(at)
        file.write(np.float64(np.nan).tobytes())
    done = programs.run("cull", path, "--raw", "-q", "--points", tmp_path / "a.npy")
    assert done.returncode == 0, done.stderr
    found = np.load(tmp_path / "a.npy")
    expected = points[cullhull.convex_hull(points).vertices]
    assert {tuple(row) for row in expected} <= {tuple(row) for row in found.astype(int)}


@pytest.mark.parametrize("chunks", [None, 2])
def test_two_dimensional_files_have_no_column_z(tmp_path, chunks):
    path = tmp_path / "a.geojson"
    path.write_text('{"type":"MultiPoint","coordinates":[[0,0],[1,0],[0,1],[7,8]]}')
    for columns in (["x", "y", "z"], "z", ["z", "x"]):
        with pytest.raises(cullhull.InvalidArgument, match="no column 'z'; there are 'x', 'y'"):
            list(cullhull.read(path, columns=columns, chunks=chunks))


def test_read_zarr_by_name(tmp_path):
    zarr = pytest.importorskip("zarr")
    points = cullhull.generate("ball", 1000)
    zarr.save_array(str(tmp_path / "a.zarr"), points)
    assert np.array_equal(cullhull.read(tmp_path / "a.zarr"), points)
    blocks = list(cullhull.read(tmp_path / "a.zarr", columns=[2, 0], chunks=300))
    assert np.array_equal(np.concatenate(blocks), points[:, [2, 0]])
    zarr.save_group(str(tmp_path / "b.zarr"), scan=points, other=points[:7])
    assert np.array_equal(cullhull.read(f"{tmp_path}/b.zarr/scan"), points)
    with pytest.raises(ValueError, match="as FOLDER.zarr/NAME; there are other, scan"):
        cullhull.read(tmp_path / "b.zarr")


def test_read_e57_of_several_scans(tmp_path):
    pye57 = pytest.importorskip("pye57")
    points = cullhull.generate("ball", 1000).astype(np.float32)  # as it writes them
    path = tmp_path / "a.e57"
    with pye57.E57(str(path), mode="w") as file:
        for part in (points[:400], points[400:]):
            axes = {f"cartesian{c}": part[:, j].copy() for j, c in enumerate("XYZ")}
            file.write_scan_raw(axes)
    assert np.array_equal(cullhull.read(path), points)
    blocks = list(cullhull.read(path, columns=[2, 0], chunks=300))
    assert [len(b) for b in blocks] == [300, 100, 300, 300]
    assert np.array_equal(np.concatenate(blocks), points[:, [2, 0]])
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(cullhull.BadFile, match="a.e57: "):
        cullhull.read(path)


@pytest.mark.parametrize("ending", ["npy", "h5", "parquet", "las", "zarr"])
def test_read_by_fsspec(ending):
    fsspec = pytest.importorskip("fsspec")
    package = {"h5": "h5py", "parquet": "pyarrow", "zarr": "zarr"}.get(ending)
    if package is not None:
        pytest.importorskip(package)
    points = WHOLE
    name = f"memory://cullhull/a.{ending}"
    _write_by_fsspec(fsspec, name, ending, points)
    raw = ending == "las"  # whose numbers were written without their scale
    assert np.array_equal(cullhull.read(name, raw=raw), points)
    assert np.array_equal(np.concatenate(list(cullhull.read(name, chunks=77, raw=raw))), points)


def _write_by_fsspec(fsspec, name, ending, points):
    if ending == "zarr":
        import zarr

        zarr.save_array(name, points)
        return
    with fsspec.open(name, "wb") as file:
        if ending == "npy":
            np.save(file, points)
        elif ending == "h5":
            import h5py

            with h5py.File(file, "w") as archive:
                archive["points"] = points
        elif ending == "parquet":
            import pyarrow.parquet

            pyarrow.parquet.write_table(
                pyarrow.table({c: points[:, j] for j, c in enumerate("xyz")}), file
            )
        else:
            scan(points).write(file)


def test_the_program_reads_laz(tmp_path):
    numbers = (cullhull.generate("ball", 900) * 1e6).astype(np.int32)
    las = scan(numbers, "laz", 6, "1.4", [0.01, 0.1, 0.001], [484000, -200.5, 300])
    las.classification = np.arange(900) % 3
    for name in ("a.las", "a.laz"):
        las.write(str(tmp_path / name))

    run = functools.partial(programs.run, cwd=tmp_path)
    for words in (("hull", "a.las", "-o", "-"), ("hull", "a.las", "--by", "classification", "-o", "-")):
        expected, got = run(*words), run(words[0], "a.laz", *words[2:])
        assert (got.returncode, got.stdout, got.stderr) == (0, expected.stdout, "")
    assert run("hull", "a.laz", "-o", "b.obj").returncode == 0
    assert run("hull", "*.laz", "--json").returncode == 0
    # Folders, patterns and lists of which some are packed: in the order in which the program has them.
    (tmp_path / "tiles").mkdir()
    (tmp_path / "same").mkdir()
    for i, ending in enumerate(("laz", "las", "laz")):
        las.X = las.X + 100 * i
        las.write(str(tmp_path / f"tiles/{i + 9}.{ending}"))
        las.write(str(tmp_path / f"same/{i + 9}.las"))
    (tmp_path / "tiles.lst").write_text("# some\ntiles/9.laz\ntiles/1*.la?\n")
    expected = run("hull", "same", "-o", "-")
    assert expected.returncode == 0
    for word in ("tiles", "tiles/*", "tiles/*.la[sz]", "@tiles.lst"):
        got = run("hull", word, "-o", "-")
        assert (got.returncode, got.stdout, got.stderr) == (0, expected.stdout, ""), word
    frames = run("track", "tiles", "-o", "f%d.json")
    assert frames.returncode == 0
    assert run("hull", "same/10.las", "-o", "g.json").returncode == 0
    assert (tmp_path / "f1.json").read_text() == (tmp_path / "g.json").read_text()
    missing = run("hull", "@nothing.lst")
    assert missing.returncode == 1 and "nothing.lst" in missing.stderr
    (tmp_path / "bad.laz").write_bytes(b"LASF nothing")
    bad = run("hull", "bad.laz")
    assert bad.returncode == 1 and bad.stderr.startswith("cullhull: bad.laz: ")
    assert bad.stderr.count("\n") == 1
