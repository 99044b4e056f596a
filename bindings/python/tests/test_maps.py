"""What offices do with maps: LAS tiles, GeoPackages and GeoParquet to hulls, outlines and cells that
GeoPandas and GDAL read with their coordinate reference system, fields and areas."""

import json
import re
import struct
import warnings
from pathlib import Path

import numpy as np
import pytest
from programs import run

import cullhull

pyogrio = pytest.importorskip("pyogrio")
geopandas = pytest.importorskip("geopandas")
shapely = pytest.importorskip("shapely")

CRS = "EPSG:25832"
SITES = np.round(
    np.random.default_rng(11).uniform([500000, 5500000], [510000, 5510000], (60, 2)), 2
)


def wells():
    return geopandas.GeoDataFrame(
        {
            "region": ["north, upper" if y > 5505000 else "south" for y in SITES[:, 1]],
            "depth": np.round(SITES[:, 0] % 97, 2),
            "owner": [None if i % 7 == 0 else f"owner {i}" for i in range(len(SITES))],
        },
        geometry=geopandas.points_from_xy(*SITES.T),
        crs=CRS,
    )


def country():
    """With a lake, and an island."""
    land = shapely.box(499000, 5499000, 508000, 5511000)
    lake = shapely.Point(504000, 5505000).buffer(1500)
    island = shapely.box(509000, 5500000, 511000, 5502000)
    shape = shapely.MultiPolygon([land.difference(lake), island])
    return geopandas.GeoDataFrame({"name": ["land"]}, geometry=[shape], crs=CRS)


def las_tile(path, corner, seed):
    """A tile of 2,000 points whose only mark of a system is ProjectedCSTypeGeoKey."""
    record = 20
    keys = struct.pack("<8H", 1, 1, 0, 1, 3072, 0, 1, 25832)
    vlr = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, len(keys), b"") + keys
    numbers = np.random.default_rng(seed).integers(0, 100000, (2000, 3), dtype="<i4")
    head = bytearray(227)
    head[:4] = b"LASF"
    head[24:26] = b"\x01\x02"
    struct.pack_into("<HIIBHI", head, 94, 227, 227 + len(vlr), 1, 0, record, len(numbers))
    struct.pack_into("<6d", head, 131, 0.01, 0.01, 0.01, *corner, 0)
    points = np.zeros((len(numbers), record), np.uint8)
    points[:, :12] = numbers.view(np.uint8).reshape(-1, 12)
    path.write_bytes(bytes(head) + vlr + points.tobytes())
    return np.asarray(corner) + numbers[:, :2] / 100


@pytest.fixture(scope="module")
def office(tmp_path_factory):
    """The files of an office, and the points of its tiles."""
    folder = tmp_path_factory.mktemp("office")
    wells().to_file(folder / "wells.gpkg")
    wells().to_file(folder / "wells.geojson")
    country().to_file(folder / "country.gpkg")
    (folder / "tiles").mkdir()
    tiles = [
        las_tile(folder / "tiles" / f"{i}.las", (500000 + 1000 * i, 5500000), i) for i in range(3)
    ]
    return folder, np.concatenate(tiles)


def ran(*words):
    done = run(*words)
    assert done.returncode == 0, done.stderr
    assert "/cullhull-" not in done.stdout + done.stderr, "names of our own files"
    return done.stdout


def read(path):
    """As GeoPandas reads it, and what has to hold of every result."""
    table = geopandas.read_file(path)
    assert table.crs == CRS, path
    shapes = table.geometry.dropna()  # a site in the lake has no cell
    assert shapes.is_valid.all(), path
    for shape in shapes:
        for part in getattr(shape, "geoms", [shape]):
            for ring in [part.exterior, *part.interiors]:
                assert ring.is_simple and ring.is_closed, path
    return table


ENDINGS = (".geojson", ".gpkg", ".fgb", ".shp")


@pytest.mark.parametrize("ending", ENDINGS)
def test_tiles_to_a_hull_and_an_outline(office, tmp_path, ending):
    folder, points = office
    out = tmp_path / f"out{ending}"
    said = ran("hull", folder / "tiles", "--columns", "x,y", "-o", out)
    assert "\ncrs        EPSG:25832\n" in said and f"wrote      {out}" in said
    hull = read(out)
    expected = shapely.MultiPoint(points).convex_hull
    assert len(hull) == 1
    assert hull.area.sum() == pytest.approx(expected.area, rel=1e-12)
    assert hull.geometry[0].equals(expected)
    ran("alpha", folder / "tiles", "--columns", "x,y", "--alpha", "60", "-o", out)
    outline = read(out)
    in_python = cullhull.alpha_shape(points, 60).to_shapely()
    assert outline.area.sum() == pytest.approx(in_python.area, rel=1e-9)
    ran("delaunay", folder / "wells.gpkg", "-o", out)
    assert read(out).area.sum() == pytest.approx(wells().union_all().convex_hull.area, rel=1e-12)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("source", ["wells.gpkg", "wells.geojson"])
def test_cells_of_a_country_with_a_lake(office, tmp_path, ending, source):
    folder, _ = office
    out = tmp_path / f"cells{ending}"
    keep = [] if source == "wells.geojson" else ["--keep", "region,depth,owner"]
    ran("voronoi", folder / source, "--clip", folder / "country.gpkg", *keep, "-o", out)
    cells = read(out).sort_values("point", ignore_index=True)
    shape, table = country().geometry[0], wells()
    assert cells.area.sum() == pytest.approx(shape.area, rel=1e-12)
    assert np.array_equal(cells["point"], np.arange(len(SITES)))
    # shapely's own diagram, cut by its own overlay
    whole = shapely.voronoi_polygons(table.union_all(), extend_to=shapely.box(4e5, 5e6, 6e5, 6e6))
    tree = shapely.STRtree(list(whole.geoms))
    for i, site in enumerate(table.geometry):
        theirs = whole.geoms[int(tree.nearest(site))].intersection(shape)
        assert cells.area.fillna(0)[i] == pytest.approx(theirs.area, rel=1e-6, abs=1e-3)
    if keep:
        assert cells["region"].tolist() == table["region"].tolist()
        assert np.array_equal(cells["depth"], table["depth"])
        assert cells["owner"].fillna("").tolist() == table["owner"].fillna("").tolist()


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_hull_for_each_value_of_a_field(office, tmp_path, ending):
    folder, _ = office
    out = tmp_path / f"hulls{ending}"
    ran("hull", folder / "wells.gpkg", "--by", "region", "-o", out)
    hulls = read(out).set_index("region")
    groups = wells().dissolve("region").convex_hull
    assert sorted(hulls.index) == sorted(groups.index)
    for name, shape in groups.items():
        assert hulls.geometry[name].area == pytest.approx(shape.area, rel=1e-12)
        assert hulls["points"][name] == (wells()["region"] == name).sum()
    unknown = run("hull", folder / "wells.gpkg", "--by", "town", "-o", out)
    assert unknown.returncode == 1
    assert unknown.stderr == (
        f"cullhull: {folder}/wells.gpkg: no field 'town'; there are 'region', 'depth', 'owner'\n"
    )


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("source", ["wells.gpkg", "wells.geojson"])
def test_hulls_and_vertices_keep_fields(office, tmp_path, ending, source):
    folder, _ = office
    table, out = wells(), tmp_path / f"hulls{ending}"
    ran("hull", folder / source, "--by", "region", "--keep", "region,owner", "-o", out)
    hulls = read(out).set_index("region")
    (kept,) = (name for name in hulls if name.startswith("kept_regi"))  # ten letters in a .shp
    assert hulls[kept].tolist() == hulls.index.tolist() and len(hulls) == 2
    assert hulls["owner"].isna().all(), "their wells have many owners"
    corners = tmp_path / f"corners{ending}"
    ran("hull", folder / source, "--vertices", corners, "--keep", "region,depth")
    kept = geopandas.read_file(corners)
    assert kept.crs == CRS
    assert sorted(kept["id"]) == sorted(cullhull.convex_hull(SITES).vertices)  # a .fgb orders them anew
    for row in kept.itertuples():
        assert row.region == table["region"][row.id] and row.depth == table["depth"][row.id]
        assert row.geometry.equals(table.geometry[row.id])


def test_survivors_keep_their_fields(office, tmp_path):
    folder, _ = office
    out = tmp_path / "s.gpkg"
    ran("cull", folder / "wells.gpkg", "--cull", "gauge", "--keep", "owner,depth", "-o", out)
    kept, table = geopandas.read_file(out), wells()
    assert kept.crs == CRS and 3 <= len(kept) <= len(table)
    for row in kept.itertuples():
        assert row.depth == table["depth"][row.id]
        assert row.geometry.equals(table.geometry[row.id])
    weighted = tmp_path / "w.json"
    ran("voronoi", folder / "wells.gpkg", "--weights", "depth", "-o", weighted)
    power = cullhull.voronoi(SITES, weights=table["depth"].to_numpy())
    assert json.loads(weighted.read_text())["vertices"] == power.vertices.tolist()


def test_heights_of_geometries_are_columns(tmp_path):
    solid = np.column_stack([SITES, SITES[:, 0] % 7])
    table = geopandas.GeoDataFrame({"n": np.arange(60)}, geometry=geopandas.points_from_xy(*solid.T))
    table.to_file(tmp_path / "a.gpkg")
    np.save(tmp_path / "a.npy", solid)
    ran("delaunay", tmp_path / "a.npy", "--columns", "0,1", "--height", "2", "-o", tmp_path / "a.ply")
    for height in (("--height", "z"), ("--height=Z",)):
        ran("delaunay", tmp_path / "a.gpkg", "--columns", "x,y", *height, "-o", tmp_path / "b.ply")
        assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    ran("voronoi", tmp_path / "a.gpkg", "--columns", "x,y", "--keep", "z,n", "-o", tmp_path / "c.gpkg")
    cells = geopandas.read_file(tmp_path / "c.gpkg")
    assert cells["z"].tolist() == solid[:, 2].tolist() and cells["n"].tolist() == list(range(60))
    table.assign(z=1).to_file(tmp_path / "b.gpkg")
    done = run("delaunay", tmp_path / "b.gpkg", "--columns", "x,y", "--height", "z")
    assert done.returncode == 1
    assert done.stderr.endswith("b.gpkg: field 'z' has the name of a coordinate; rename it\n")


def test_info_describes_the_users_file(office, tmp_path):
    folder, _ = office
    said = ran("info", folder / "wells.gpkg")
    assert said.startswith("format     GPKG\npoints     60\ndimension  2\n")
    assert "\nlayer      wells: 60 features, Point\n" in said
    assert "\nfields     region (text), depth (float64), owner (text)\n" in said
    assert "\ncrs        EPSG:25832\n" in said
    report = json.loads(ran("info", folder / "wells.gpkg", "--json"))
    assert report["format"] == "GPKG" and report["in_place"] is False
    assert report["crs"] == CRS
    assert report["layers"] == [{"name": "wells", "features": 60, "geometry": "Point"}]
    assert [field["name"] for field in report["fields"]] == ["region", "depth", "owner"]
    wells().to_parquet(tmp_path / "w.parquet")
    assert "\ncrs        EPSG:25832\n" in ran("info", tmp_path / "w.parquet")


def test_breaklines_of_any_vector_file(tmp_path):
    corners = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [1, 2]], float)
    points = geopandas.GeoDataFrame(geometry=geopandas.points_from_xy(*corners.T), crs=CRS)
    line = geopandas.GeoDataFrame(geometry=[shapely.LineString(corners[[0, 2, 3]])], crs=CRS)
    points.to_file(tmp_path / "p.gpkg")
    np.savetxt(tmp_path / "pairs.csv", [[0, 2], [2, 3]], fmt="%d", delimiter=",")
    ran("delaunay", tmp_path / "p.gpkg", "--edges", tmp_path / "pairs.csv", "-o", tmp_path / "a.json")
    for ending in ("gpkg", "shp", "fgb", "geojson", "parquet"):
        path = tmp_path / f"lines.{ending}"
        (line.to_parquet if ending == "parquet" else line.to_file)(path)
        ran("delaunay", tmp_path / "p.gpkg", f"--edges={path}", "-o", tmp_path / "b.json")
        assert (tmp_path / "a.json").read_text() == (tmp_path / "b.json").read_text(), ending


def test_messages_name_the_users_files(office, tmp_path):
    folder, _ = office
    (tmp_path / "far.geojson").write_text('{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}')
    country().to_crs(4326).to_file(tmp_path / "degrees.gpkg")
    wells().to_file(tmp_path / "points.gpkg")
    many = geopandas.GeoDataFrame(geometry=[shapely.Point(0, 0, 1), shapely.Point(1, 1, 2)], crs=CRS)
    many.to_file(tmp_path / "solid.gpkg")
    wells_file = folder / "wells.gpkg"
    for words, said in (
        (
            ("voronoi", wells_file, "--clip", tmp_path / "degrees.gpkg", "-o", tmp_path / "o.gpkg"),
            f"--clip {tmp_path}/degrees.gpkg: states EPSG:4326, but the points are in EPSG:25832",
        ),
        (
            ("voronoi", wells_file, "--clip", tmp_path / "points.gpkg", "-o", tmp_path / "o.gpkg"),
            f"{tmp_path}/points.gpkg: there is no polygon in it",
        ),
        (
            ("voronoi", wells_file, "--clip", tmp_path / "none.gpkg", "-o", tmp_path / "o.wkt"),
            f"{tmp_path}/none.gpkg: cannot open: No such file or directory",
        ),
        (
            ("delaunay", wells_file, "--edges", tmp_path / "points.gpkg"),
            f"{tmp_path}/points.gpkg: there is no line and no polygon in it",
        ),
        (
            ("voronoi", wells_file, "--weights", tmp_path / "points.gpkg"),
            f"--weights {tmp_path}/points.gpkg: takes a column of the points, or a file of one",
        ),
        (
            ("hull", wells_file, "-o", wells_file),
            f"-o {wells_file}: would overwrite the input {wells_file}",
        ),
        (
            ("hull", wells_file, "-o", tmp_path / "no" / "o.gpkg"),
            f"-o {tmp_path}/no/o.gpkg: there is no folder {tmp_path}/no",
        ),
        (
            ("hull", wells_file, tmp_path / "solid.gpkg", "-o", tmp_path / "o.gpkg"),
            f"{tmp_path}/solid.gpkg: ",
        ),
        (
            ("hull", tmp_path / "solid.gpkg", "-o", tmp_path / "o.gpkg"),
            f"{tmp_path}/o.gpkg: a geometry needs points of dimension 2, not 3",
        ),
        (("hull", wells_file, "--by", "region", "-o", tmp_path / "o.wkt"), f"{tmp_path}/o.wkt"),
    ):
        done = run(*words)
        assert done.returncode in (1, 2), words
        assert said in done.stderr, done.stderr
        assert "/cullhull-" not in done.stdout + done.stderr, done.stderr
        assert done.stderr.count("\n") == 1
        assert not (tmp_path / "o.gpkg").exists()


def test_laz_errors_and_systems_name_the_laz(tmp_path):
    laspy = pytest.importorskip("laspy")
    pytest.importorskip("lazrs")
    las_tile(tmp_path / "a.las", (500000, 5500000), 1)
    with laspy.open(tmp_path / "a.las") as scan:
        tile = scan.read()
    tile.write(tmp_path / "a.laz")
    ran("hull", tmp_path / "a.laz", "--columns", "x,y", "-o", tmp_path / "a.gpkg")
    assert read(tmp_path / "a.gpkg").crs == CRS
    tile.header.scales = [1, 1, 1]
    broken = bytearray((tmp_path / "a.laz").read_bytes())
    broken[131:139] = struct.pack("<d", float("nan"))
    (tmp_path / "broken.laz").write_bytes(broken)
    done = run("hull", tmp_path / "broken.laz")
    assert done.returncode == 1
    assert done.stderr.startswith(f"cullhull: {tmp_path}/broken.laz: ")
    assert "/cullhull-" not in done.stderr


def test_results_without_a_known_system(tmp_path):
    """GDAL takes GeoJSON without a name for WGS 84; other files then have none."""
    np.savetxt(tmp_path / "p.csv", SITES, delimiter=",", fmt="%.2f")
    for words, crs in (((), None), (("--crs", "EPSG:4326"), "EPSG:4326"), (("--crs", CRS), CRS)):
        for ending in (".gpkg", ".fgb", ".shp"):
            ran("hull", tmp_path / "p.csv", *words, "-o", tmp_path / f"h{ending}")
            found = geopandas.read_file(tmp_path / f"h{ending}")
            assert found.crs == crs, (ending, words)
    degrees = wells().to_crs(4326)
    degrees.to_file(tmp_path / "d.gpkg")
    ran("hull", tmp_path / "d.gpkg", "-o", tmp_path / "d.geojson")
    assert "crs" not in json.loads((tmp_path / "d.geojson").read_text())
    assert geopandas.read_file(tmp_path / "d.geojson").crs == "EPSG:4326"
    ran("hull", tmp_path / "d.gpkg", "-o", tmp_path / "e.gpkg")
    assert geopandas.read_file(tmp_path / "e.gpkg").crs == "EPSG:4326"


def test_saved_in_python(tmp_path):
    table, shape = wells(), country().geometry[0]
    hull = cullhull.convex_hull(SITES)
    diagram = cullhull.voronoi(SITES)
    cells = diagram.clip(shape)
    results = (
        hull,
        cullhull.ConvexHull(SITES),
        cullhull.delaunay(SITES),
        cullhull.Delaunay(SITES),
        cullhull.alpha_shape(SITES),
        cullhull.concave_hull(SITES, 0.3),
        cells,
        cullhull.hulls_by(SITES, table["region"]),
    )
    for i, result in enumerate(results):
        for ending in ENDINGS:
            path = tmp_path / f"{i}{ending}"
            for crs in (CRS, table.crs, 25832, table.crs.to_wkt()):
                result.save(path, crs=crs)
            assert len(read(path)) >= 1
            result.save(path)
            without = geopandas.read_file(path).crs
            assert without == ("EPSG:4326" if ending == ".geojson" else None)
        with pytest.raises(cullhull.InvalidArgument, match="crs: .json holds none; .geojson"):
            result.save(tmp_path / "a.json", crs=CRS)
    with pytest.raises(cullhull.InvalidArgument, match="an authority and a code"):
        hull.save(tmp_path / "a.geojson", crs="UTM 32")
    with pytest.raises(OSError, match="no/a.gpkg"):
        hull.save(tmp_path / "no" / "a.gpkg", crs=CRS)
    with pytest.raises(cullhull.InvalidArgument, match="geojson holds hulls of 2D"):
        cullhull.convex_hull(np.eye(4, 3)).save(tmp_path / "a.gpkg")


def test_cells_as_a_table_of_geopandas():
    table, shape = wells(), country().geometry[0]
    table.index = [f"w{i}" for i in range(len(table))]
    cells = cullhull.voronoi(table).clip(shape)
    frame = cells.to_geopandas(table)
    assert frame.crs == CRS and list(frame.index) == list(table.index)
    assert frame.columns.tolist() == ["point", "area", "region", "depth", "owner", "geometry"]
    assert frame["region"].tolist() == table["region"].tolist()
    assert frame.area.sum() == pytest.approx(shape.area, rel=1e-12)
    assert np.allclose(frame.area, frame["area"])
    assert cells.to_geopandas().crs is None
    assert cells.to_geopandas(crs=CRS).crs == CRS
    assert cells.to_geopandas(table, crs="EPSG:25833").crs == "EPSG:25833"
    with pytest.raises(cullhull.InvalidArgument, match="data has 59 rows, but there are 60 cells"):
        cells.to_geopandas(table[1:])
    solid = cullhull.voronoi(np.random.default_rng(1).normal(size=(9, 3))).clip([-1] * 3, [1] * 3)
    with pytest.raises(cullhull.InvalidArgument):
        solid.to_geopandas()


PAGE = Path(__file__).resolve().parents[3] / "docs" / "maps.md"


@pytest.mark.skipif(not PAGE.exists(), reason="only in the repository")
def test_the_pages_sample_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
    assert len(code) == 1
    exec(code[0], {})  # it asserts what it says


# ------------------------------------------------------------------------------ GeoParquet

SHAPES = {
    "point": [shapely.Point(1, 2), shapely.Point(3, 4)],
    "linestring": [shapely.LineString([[0, 0], [1, 1], [2, 0]]), shapely.LineString([[5, 5], [6, 7]])],
    "polygon": [
        shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2)),
        shapely.Polygon([[9, 9], [11, 9], [9, 12]]),
    ],
    "multipoint": [shapely.MultiPoint([[0, 0], [1, 5]]), shapely.MultiPoint([[7, 7]])],
    "multilinestring": [
        shapely.MultiLineString([[[0, 0], [1, 1]], [[2, 2], [3, 3], [4, 2]]]),
        shapely.MultiLineString([[[5, 5], [5, 6]]]),
    ],
    "multipolygon": [
        shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 2, 3, 3)]),
        shapely.MultiPolygon([shapely.box(7, 7, 8, 9)]),
    ],
}


def vertices(shapes, heights):
    """Without a ring's last position."""
    rows = []
    for shape in shapes:
        if shape is None or shape.is_empty:
            continue
        for part in getattr(shape, "geoms", [shape]):
            if part.geom_type == "Polygon":
                rings = [part.exterior, *part.interiors]
                rows += [p for ring in rings for p in list(ring.coords)[:-1]]
            else:
                rows += list(part.coords)
    return np.array(rows, float).reshape(-1, 3 if heights else 2)


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("encoding", ["WKB", "geoarrow"])
@pytest.mark.parametrize("heights", [False, True])
@pytest.mark.parametrize("missing", [False, True])
def test_geoparquet(tmp_path, kind, encoding, heights, missing):
    pytest.importorskip("pyarrow")
    shapes = SHAPES[kind]
    if heights:
        shapes = [shapely.force_3d(shape, 7.5) for shape in shapes]
    if missing:
        shapes = [None, shapes[0], None, shapes[1]]
    table = geopandas.GeoDataFrame(
        {"x": np.arange(len(shapes)), "y": 5.0, "n": 1}, geometry=shapes, crs=CRS
    )
    path = tmp_path / "a.parquet"
    table.to_parquet(path, geometry_encoding=encoding, row_group_size=2)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = cullhull.read(path)
    assert np.array_equal(found, vertices(shapes, heights))
    said = [str(w.message) for w in told]
    assert said == ([f"{path}: 2 of 4 rows have no geometry"] if missing else [])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        parts = list(cullhull.read(path, chunks=2))
    assert max(map(len, parts)) <= 2
    assert np.array_equal(np.concatenate(parts), found)
    assert np.array_equal(cullhull.read(path, columns=["x", "y"])[:, 0], table["x"])
    if kind == "polygon" and not missing:
        points = geopandas.GeoDataFrame(geometry=geopandas.points_from_xy([1, 3, 8], [1, 3, 8]), crs=CRS)
        points.to_parquet(tmp_path / "p.parquet", geometry_encoding=encoding)
        ran("voronoi", tmp_path / "p.parquet", "--clip", path, "-o", tmp_path / "c.gpkg")
        area = shapely.unary_union(SHAPES[kind]).area
        assert read(tmp_path / "c.gpkg").area.sum() == pytest.approx(area)


def test_geoparquet_that_names_another_primary_column(tmp_path):
    pytest.importorskip("pyarrow")
    table = geopandas.GeoDataFrame(
        {"second": geopandas.GeoSeries(SHAPES["point"], crs=CRS), "n": [1, 2]},
        geometry=SHAPES["linestring"],
        crs=CRS,
    ).set_geometry("second")
    table.to_parquet(tmp_path / "a.parquet")
    assert cullhull.read(tmp_path / "a.parquet").tolist() == [[1, 2], [3, 4]]
    assert len(cullhull.read(tmp_path / "a.parquet", columns=["geometry"])) == 5


def test_plain_wkb_and_geometries_of_several_types(tmp_path):
    pa = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    shapes = [SHAPES["point"][0], None, SHAPES["polygon"][0], SHAPES["multipoint"][0],
              shapely.GeometryCollection([shapely.Point(8, 8), SHAPES["linestring"][0]]),
              shapely.Point()]  # fmt: skip
    wkb = [None if shape is None else shapely.to_wkb(shape) for shape in shapes]
    want = vertices([shapes[0], shapes[2], shapes[3], *shapes[4].geoms], False)
    for name in ("geometry", "where"):
        path = tmp_path / "a.parquet"
        parquet.write_table(pa.table({"pop": np.arange(6), name: wkb, "size": np.ones(6)}), path)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            assert np.array_equal(cullhull.read(path), want)
        assert [str(w.message) for w in told] == [f"{path}: 1 of 6 rows has no geometry"]
    # Bytes that are no geometries are no reason to refuse columns of numbers.
    hashes = [b"\x17" * 32] * 6
    parquet.write_table(pa.table({"hash": hashes, "a": np.arange(6.0), "b": np.ones(6)}), path)
    with pytest.warns(cullhull.ShapeWarning, match="'a', 'b' are taken"):
        assert cullhull.read(path).shape == (6, 2)
    mixed = [shapely.to_wkb(shapely.Point(1, 2)), shapely.to_wkb(shapely.Point(1, 2, 3))]
    parquet.write_table(pa.table({"geometry": mixed}), path)
    with pytest.raises(cullhull.BadFile, match="row 1: 3 coordinates where those before have 2"):
        cullhull.read(path)


def test_attributes_are_never_taken_for_geometries(tmp_path):
    """Of an encoding that is not read: the file is refused, whatever numbers it has beside."""
    pa = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    geo = {"version": "1.1.0", "primary_column": "g", "columns": {"g": {"encoding": "WKT"}}}
    table = pa.table({"x": [1.0, 2.0], "y": [3.0, 4.0], "g": ["POINT (1 2)", "POINT (3 4)"]})
    path = tmp_path / "a.parquet"
    parquet.write_table(table.replace_schema_metadata({"geo": json.dumps(geo)}), path)
    with pytest.raises(cullhull.InvalidArgument, match="column 'g', are neither WKB nor lists"):
        cullhull.read(path)
    assert cullhull.read(path, columns=["x", "y"]).tolist() == [[1, 3], [2, 4]]


def test_fields_of_geoparquet(tmp_path):
    pytest.importorskip("pyarrow")
    for encoding in ("WKB", "geoarrow"):
        wells().to_parquet(tmp_path / "w.parquet", geometry_encoding=encoding)
        country().to_parquet(tmp_path / "c.parquet", geometry_encoding=encoding)
        out = tmp_path / "o.gpkg"
        ran("voronoi", tmp_path / "w.parquet", "--clip", tmp_path / "c.parquet", "--keep",
            "region", "-o", out)  # fmt: skip
        cells = read(out)
        assert cells["region"].tolist() == wells()["region"].tolist()
        assert cells.area.sum() == pytest.approx(country().area.sum(), rel=1e-12)
