"""What the package's program reads beyond the formats of the program itself."""

import numpy as np
import pytest
from programs import run, with_path

POINTS = np.random.default_rng(3).integers(-1000, 1000, (60, 2)) / 8.0


def hull(*words):
    """The hull as the program writes it, and what it says on standard error."""
    ran = run("hull", *words, "-o", "-", "-q")
    assert ran.returncode == 0, ran.stderr
    return ran.stdout, ran.stderr


def expected(tmp_path, points):
    np.save(tmp_path / "expected.npy", points)
    return hull(tmp_path / "expected.npy")[0]


def wkb(kind, points, *, rings=None, order="<"):
    """A geometry of 2D or 3D points in WKB."""
    width = np.shape(points)[1]
    code = kind + (1000 if width == 3 else 0)
    head = (b"\x01" if order == "<" else b"\x00") + np.array(code, order + "u4").tobytes()
    count = np.array(len(points), order + "u4").tobytes()
    body = np.asarray(points, order + "f8").tobytes()
    if kind == 1:
        return head + body
    one = np.array(1, order + "u4").tobytes()
    return head + (one + count + body if kind == 3 else count + body)


def write(path, shapes, kind, layer=None, crs="EPSG:25832"):
    pyogrio = pytest.importorskip("pyogrio")
    shapes = np.array([*shapes, None], dtype=object)[:-1]
    names = np.arange(len(shapes))
    in_order = {"SPATIAL_INDEX": "NO"} if str(path).endswith(".fgb") else {}
    driver = "KML" if str(path).endswith(".kml") else None  # there are two of them
    pyogrio.raw.write(
        path,
        shapes,
        [names],
        ["name"],
        geometry_type=kind,
        crs=crs,
        layer=layer,
        driver=driver,
        layer_options=in_order,
    )


@pytest.mark.parametrize("ending", [".gpkg", ".shp", ".fgb"])
def test_points_of_vector_files(tmp_path, ending):
    write(tmp_path / f"a{ending}", [wkb(1, [p]) for p in POINTS], "Point")
    assert hull(tmp_path / f"a{ending}") == (expected(tmp_path, POINTS), "")
    ran = run("delaunay", tmp_path / f"a{ending}", "-o", tmp_path / "mesh.ply", "-q")
    assert ran.returncode == 0, ran.stderr


def test_vertices_of_polygons_in_layers(tmp_path):
    ring = np.array([[0, 0], [4, 0], [4, 3], [0, 0]], float)
    write(tmp_path / "a.gpkg", [wkb(3, ring), wkb(3, ring + 8)], "Polygon", "fields")
    both = np.concatenate([ring[:-1], ring[:-1] + 8])
    assert hull(tmp_path / "a.gpkg")[0] == expected(tmp_path, both)
    write(tmp_path / "a.gpkg", [wkb(2, ring[:2] * 2)], "LineString", "roads")
    ran = run("hull", tmp_path / "a.gpkg")
    assert ran.returncode == 1
    assert ran.stderr.startswith(f"cullhull: {tmp_path}/a.gpkg: has several layers: ")
    assert f"{tmp_path}/a.gpkg:roads" in ran.stderr
    assert hull(f"{tmp_path}/a.gpkg:roads")[0] == expected(tmp_path, ring[:2] * 2)
    assert hull(f"{tmp_path}/a.gpkg:fields")[0] == expected(tmp_path, both)


def test_heights_and_columns(tmp_path):
    points = np.column_stack([POINTS, POINTS[:, 0] * 0.5 + 1])
    write(tmp_path / "a.gpkg", [wkb(1, [p]) for p in points], "Point Z")
    assert hull(tmp_path / "a.gpkg")[0] == expected(tmp_path, points)
    assert hull(tmp_path / "a.gpkg", "--columns", "x,z")[0] == expected(tmp_path, points[:, [0, 2]])


def test_folders_read_vector_files_among_others(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    write(folder / "a.shp", [wkb(1, [p]) for p in POINTS[:30]], "Point")
    np.save(folder / "b.npy", POINTS[30:])
    assert hull(folder)[0] == expected(tmp_path, POINTS)


def test_parquet_by_names(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    import pyarrow

    columns = {"Lat": POINTS[:, 1], "Lon": POINTS[:, 0], "depth": POINTS[:, 0] * 2}
    parquet.write_table(pyarrow.table(columns), tmp_path / "a.parquet")
    assert hull(tmp_path / "a.parquet")[0] == expected(tmp_path, POINTS)
    numbered = {"id": np.arange(60), "a": POINTS[:, 0], "b": POINTS[:, 1]}
    parquet.write_table(pyarrow.table(numbered), tmp_path / "n.parquet")
    out, said = hull(tmp_path / "n.parquet")
    assert out == expected(tmp_path, POINTS)
    assert said.startswith(f"cullhull: {tmp_path}/n.parquet: ")
    assert said.endswith("; --columns takes others\n")
    assert said.count("\n") == 1
    chosen = expected(tmp_path, np.column_stack([POINTS[:, 0] * 2, POINTS[:, 1]]))
    assert hull(tmp_path / "a.parquet", "--columns", "depth,Lat") == (chosen, "")
    assert hull(tmp_path / "a.parquet", "--columns=depth,Lat") == (chosen, "")
    write(tmp_path / "b.gpkg", [wkb(1, [p]) for p in POINTS], "Point")
    ran = run("hull", tmp_path / "a.parquet", tmp_path / "b.gpkg", "--columns", "0,1")
    assert ran.returncode == 1
    assert ran.stderr == "cullhull: --columns of .parquet files and others: give them apart\n"


def test_what_is_missing_or_damaged_is_said_in_one_line(tmp_path):
    pytest.importorskip("pyogrio")
    (tmp_path / "a.gpkg").write_bytes(b"no database")
    ran = run("hull", tmp_path / "a.gpkg")
    assert ran.returncode == 1
    assert ran.stderr.startswith(f"cullhull: {tmp_path}/a.gpkg: ")
    assert ran.stderr.count("\n") == 1
    blocked = tmp_path / "blocked" / "pyogrio"
    blocked.mkdir(parents=True)
    (blocked / "__init__.py").write_text("raise ImportError('none')")
    ran = run("hull", tmp_path / "a.gpkg", env=with_path(blocked.parent))
    assert ran.returncode == 1
    assert ran.stderr == (
        f"cullhull: {tmp_path}/a.gpkg: reading .gpkg files needs pyogrio, which is not installed: "
        "pip install 'cullhull[vector]'\n"
    )


def test_geometries_in_wkb():
    from cullhull.geo import _vectors

    def vertices(*shapes):
        parts = []
        for shape in shapes:
            assert _vectors.add(parts, shape, 0) == len(shape)
        return _vectors._together(parts, "f").tolist()

    ring = [[0, 0], [4, 0], [4, 3], [0, 0]]
    for order in "<>":
        assert vertices(wkb(1, [[1, 2]], order=order)) == [[1, 2]]
        assert vertices(wkb(3, ring, order=order)) == ring[:-1]
        many = (b"\x01" if order == "<" else b"\x00") + np.array([4, 2], order + "u4").tobytes()
        two = many + wkb(1, [[1, 2]], order=order) + wkb(1, [[3, 4]], order=">")
        assert vertices(two) == [[1, 2], [3, 4]]
    assert vertices(wkb(2, ring)) == ring, "a line that closes is no ring"
    assert vertices(wkb(1, [[1, 2, 3]])) == [[1, 2, 3]]
    assert vertices(wkb(1, [[np.nan, np.nan]])) == [], "POINT EMPTY"
    measured = b"\x01" + np.array(2001, "<u4").tobytes() + np.array([1, 2, 9.0]).tobytes()
    assert vertices(measured) == [[1, 2]]
    extended = b"\x01" + np.array([0xA0000001, 4326], "<u4").tobytes()
    assert vertices(extended + np.array([1, 2, 9.0]).tobytes()) == [[1, 2, 9]]
    with pytest.raises(ValueError, match="some geometries have heights"):
        vertices(wkb(1, [[1, 2]]), wkb(1, [[1, 2, 3]]))
    with pytest.raises(ValueError, match="curves"):
        vertices(b"\x01" + np.array([8, 0], "<u4").tobytes())
