"""GeoPackage, Shapefile, FlatGeobuf, GML and KML through cullhull.read and the package's program."""

import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from programs import run
from test_command_line import expected, hull, wkb, write

import cullhull

pyogrio = pytest.importorskip("pyogrio")

POINTS = np.random.default_rng(7).integers(-1000, 1000, (60, 2)) / 8.0
RING = np.array([[0, 0], [4, 0], [4, 3], [0, 0]], float)
FIXTURES = Path(pyogrio.__file__).parent / "tests" / "fixtures"


@pytest.mark.parametrize("ending", [".gpkg", ".shp", ".fgb", ".gml", ".kml"])
@pytest.mark.parametrize("heights", [False, True])
def test_read_points(tmp_path, ending, heights):
    points = POINTS / 32  # longitudes and latitudes, which KML holds
    if heights:
        points = np.column_stack([points, points[:, 0] * 0.5 + 1])
    path = tmp_path / f"a{ending}"
    kind = "Point Z" if heights else "Point"
    crs = "EPSG:4326" if ending == ".kml" else "EPSG:25832"
    write(path, [wkb(1, [p]) for p in points], kind, crs=crs)
    assert np.array_equal(cullhull.read(path), points)
    assert np.array_equal(cullhull.read(path, columns=["y", "X"]), points[:, [1, 0]])
    parts = list(cullhull.read(path, chunks=25))
    assert [len(part) for part in parts] == [25, 25, 10]
    assert np.array_equal(np.concatenate(parts), points)
    with pytest.raises(cullhull.InvalidArgument, match="no column 'q'; there are x, y"):
        cullhull.read(path, columns=["q"])


def test_layers(tmp_path):
    path = tmp_path / "a.gpkg"
    write(path, [wkb(3, RING)], "Polygon", "fields")
    table = {"layer": "owners", "geometry_type": None}
    pyogrio.raw.write(path, None, [np.arange(3)], ["name"], **table)
    assert np.array_equal(cullhull.read(path), RING[:-1]), "the only layer with geometries"
    with pytest.raises(cullhull.BadFile, match="layer 'owners' has no geometries"):
        cullhull.read(f"{path}:owners")
    with pytest.raises(cullhull.BadFile, match="has no layer 'roads'; there are fields, owners"):
        cullhull.read(f"{path}:roads")
    write(path, [wkb(2, RING * 2)], "LineString", "roads")
    with pytest.raises(cullhull.BadFile, match="has several layers: .*a.gpkg:fields, .*:roads"):
        cullhull.read(path)
    assert np.array_equal(cullhull.read(f"{path}:roads"), RING * 2)
    alone = tmp_path / "b.gpkg"
    pyogrio.raw.write(alone, None, [np.arange(3)], ["name"], **table)
    with pytest.raises(cullhull.BadFile, match="no layer has geometries"):
        cullhull.read(alone)
    assert run("hull", alone).stderr == f"cullhull: {alone}: no layer has geometries\n"


@pytest.mark.parametrize("ending", [".gpkg", ".shp", ".fgb"])
def test_layers_without_a_feature(tmp_path, ending):
    path = tmp_path / f"a{ending}"
    write(path, [], "Point")
    assert cullhull.read(path).shape == (0, 2)
    assert hull(path) == (expected(tmp_path, np.empty((0, 2))), "")


def test_geometries_of_several_types(tmp_path):
    many = b"\x01" + np.array([4, 2], "<u4").tobytes() + wkb(1, [[1, 2]]) + wkb(1, [[3, 4]])
    empty = b"\x01" + np.array([6, 0], "<u4").tobytes()
    shapes = [wkb(1, [[8, 9]]), wkb(2, RING), None, many, wkb(3, RING), empty]
    write(tmp_path / "a.gpkg", shapes, "Unknown")
    want = np.concatenate([[[8, 9]], RING, [[1, 2], [3, 4]], RING[:-1]])
    assert np.array_equal(cullhull.read(tmp_path / "a.gpkg"), want)
    assert hull(tmp_path / "a.gpkg")[0] == expected(tmp_path, want)
    write(tmp_path / "b.gpkg", [wkb(1, [[8, 9]]), wkb(1, [[8, 9, 1]])], "Unknown")
    with pytest.raises(cullhull.BadFile, match="b.gpkg: some geometries have heights and others"):
        cullhull.read(tmp_path / "b.gpkg")
    write(tmp_path / "c.gpkg", [None, None], "Point")
    assert cullhull.read(tmp_path / "c.gpkg").shape == (0, 2)


def test_points_come_a_few_thousand_at_a_time(tmp_path):
    """So memory stays small, and Ctrl-C is heard between two blocks."""
    points = np.random.default_rng(1).random((50_000, 2))
    write(tmp_path / "a.fgb", [wkb(1, [p]) for p in points], "Point")
    parts = list(cullhull.read(tmp_path / "a.fgb", chunks=1 << 20))
    assert max(map(len, parts)) <= 1 << 14
    assert np.array_equal(np.concatenate(parts), points)


def test_blocks_of_mixed_byte_orders_and_empty_points(tmp_path):
    shapes = [wkb(1, [[1, 2]]), wkb(1, [[np.nan, np.nan]]), wkb(1, [[3, 4]], order=">")]
    for ending in (".fgb", ".gpkg", ".shp"):
        write(tmp_path / f"a{ending}", [*shapes, None, wkb(1, [[5, 6]])], "Point")
        assert cullhull.read(tmp_path / f"a{ending}").tolist() == [[1, 2], [3, 4], [5, 6]]
    option = "OGR_FLATGEOBUF_STREAM_BASE_IMPL"
    assert pyogrio.get_gdal_config_option(option) is None, "as it was"


def test_files_of_others():
    """Those that pyogrio's own tests read."""
    if not FIXTURES.exists():
        pytest.skip("this pyogrio comes without its tests")
    countries = cullhull.read(FIXTURES / "naturalearth_lowres" / "naturalearth_lowres.shp")
    assert countries.shape[1] == 2 and len(countries) > 10_000
    outline = cullhull.convex_hull(countries)
    assert bool(outline.contains(countries).all()) and outline.certify(countries)
    assert (np.abs(countries) < [180.001, 90.001]).all()
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of measures, which are not taken
        assert cullhull.read(FIXTURES / "line_zm.gpkg").shape[1] == 3
    assert cullhull.read(FIXTURES / "test_gpkg_nulls.gpkg").shape == (4, 2)
    for name in ("curve.gpkg", "curvepolygon.gpkg", "multisurface.gpkg"):
        with pytest.raises(cullhull.BadFile, match=f"{name}: curves .* have no vertices to take"):
            cullhull.read(FIXTURES / name)


def test_remote_names_are_refused():
    with pytest.raises(cullhull.BadFile, match="by fsspec read reads .npy"):
        cullhull.read("s3://bucket/a.gpkg")


@pytest.mark.parametrize("ending", [".gpkg", ".parquet"])
def test_the_memory_limit_holds(tmp_path, ending):
    """A limit that the points do not fit into is refused by the program, as for its own formats."""
    points = cullhull.generate("sphere", 30_000, 3)
    if ending == ".gpkg":
        write(tmp_path / "a.gpkg", [wkb(1, [p]) for p in points], "Point Z")
    else:
        parquet = pytest.importorskip("pyarrow.parquet")
        import pyarrow

        parquet.write_table(pyarrow.table(dict(zip("xyz", points.T))), tmp_path / "a.parquet")
    ran = run("delaunay", tmp_path / f"a{ending}", "--memory", "1M", "-o", tmp_path / "t.json")
    assert ran.returncode == 4 and ran.stderr.count("\n") == 1, ran.stderr
    assert not (tmp_path / "t.json").exists()


#: Reads one block of a file and then waits, as for a large file.
SLOW = """
import sys, time
from cullhull import __main__
from cullhull.geo import _vectors
blocks = _vectors.blocks
def slow(*words):
    for block in blocks(*words):
        yield block
    open(sys.argv.pop(), "w").close()
    time.sleep(60)
_vectors.blocks = slow
__main__.main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_ctrl_c_while_reading(tmp_path):
    write(tmp_path / "a.gpkg", [wkb(1, [p]) for p in POINTS], "Point")
    scratch, started = tmp_path / "scratch", tmp_path / "started"
    scratch.mkdir()
    command = ["hull", tmp_path / "a.gpkg", "-o", tmp_path / "hull.json", started]
    with subprocess.Popen(
        [sys.executable, "-c", SLOW, *map(str, command)],
        env={**os.environ, "TMPDIR": str(scratch)},
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        while not started.exists() and process.poll() is None:
            time.sleep(0.02)
        assert len(list(scratch.iterdir())) == 1
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=30)[1]
    assert (process.returncode, said) == (130, "cullhull: cancelled\n")
    assert not list(scratch.iterdir()) and not (tmp_path / "hull.json").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_ctrl_c_while_the_program_computes(tmp_path):
    """The terminal sends the signal to both: the program ends as it does by itself, and the
    temporary folder is removed."""
    write(tmp_path / "a.gpkg", [wkb(1, [p]) for p in POINTS], "Point")
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    words = ["hull", tmp_path / "a.gpkg", "--repeat", "1000000", "-q"]
    with subprocess.Popen(
        [sys.executable, "-m", "cullhull", *map(str, words)],
        env={**os.environ, "TMPDIR": str(scratch)},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        if not children.exists():
            process.kill()
            pytest.skip("this system does not list the children of a process")
        while not children.read_text().strip() and process.poll() is None:
            time.sleep(0.02)
        time.sleep(1)
        os.killpg(process.pid, signal.SIGINT)
        said = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert said in ("cullhull: cancelled\n", ""), "silent if it had not yet begun"
    assert not list(scratch.iterdir())
