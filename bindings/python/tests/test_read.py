"""cullhull.read of what other people's programs write: which columns, rows and bytes are taken."""

import struct
import warnings

import numpy as np
import pytest

import cullhull
from made_files import scan, write_hdf5, write_parquet

POINTS = np.random.default_rng(3).normal(size=(300, 3))


def said_while_reading(path, **options):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        points = cullhull.read(path, **options)
    assert all(w.category is cullhull.ShapeWarning for w in told)
    assert len(told) <= 1
    return points, str(told[0].message) if told else ""


def test_every_format_of_the_program_is_in_the_docstring(tmp_path):
    names = cullhull._core.input_formats()
    assert {"npy", "asc", "raw"} <= set(names)
    for name in set(names) - {"raw"}:
        assert f".{name}" in cullhull.read.__doc__
    (tmp_path / "cloud.asc").write_text("//X Y Z R G B\n2\n1 2 3 255 0 0\n4 5 6 0 255 0\n")
    points, said = said_while_reading(tmp_path / "cloud.asc")
    assert points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert "X, Y and Z of 6 columns" in said


# ------------------------------------------------------------------------------------ Parquet


def written(tmp_path, columns, metadata=None):
    return write_parquet(tmp_path / "a.parquet", columns, metadata)


def axes(points=POINTS, names="xyz"):
    return {name: points[:, j] for j, name in enumerate(names)}


def test_parquet_columns_by_name_in_any_case(tmp_path):
    path = written(tmp_path, {"ID": np.arange(300), **axes(names="ZXY")})
    points, said = said_while_reading(path)
    assert np.array_equal(points, POINTS[:, [1, 2, 0]])
    assert said == ""
    assert np.array_equal(cullhull.read(path, columns=["z", "X"]), POINTS[:, [0, 1]])


@pytest.mark.parametrize("names", [("lat", "Lon"), ("latitude", "longitude"), ("Northing", "EASTING")])
def test_parquet_coordinates_of_maps(tmp_path, names):
    path = written(tmp_path, {"class": np.ones(300), **axes(names=names)})
    assert np.array_equal(cullhull.read(path), POINTS[:, [1, 0]])


@pytest.mark.parametrize("kind", ["fixed", "list", "large"])
def test_parquet_points_as_lists(tmp_path, kind):
    pa = pytest.importorskip("pyarrow")
    rows = POINTS.astype(np.float32)
    flat = pa.array(rows.ravel())
    if kind == "fixed":
        lists = pa.FixedSizeListArray.from_arrays(flat, 3)
    elif kind == "list":
        lists = pa.ListArray.from_arrays(pa.array(np.arange(301, dtype="i4") * 3), flat)
    else:
        lists = pa.LargeListArray.from_arrays(pa.array(np.arange(301) * 3), flat)
    path = written(tmp_path, {"name": ["a"] * 300, "xyz": lists, "id": np.arange(300)})
    for columns in (None, ["xyz"], [1]):
        points = cullhull.read(path, columns=columns)
        assert points.dtype == np.float32
        assert np.array_equal(points, rows)
    blocks = list(cullhull.read(path, chunks=77))
    assert [len(b) for b in blocks[:2]] == [77, 77] or len(blocks) > 1
    assert np.array_equal(np.concatenate(blocks), rows)
    with pytest.raises(ValueError, match="'xyz' .* alone"):
        cullhull.read(path, columns=["xyz", "id"])


def test_parquet_lists_of_unequal_length_or_with_holes(tmp_path):
    path = written(tmp_path, {"xyz": [[1.0, 2.0], [1.0, 2.0, 3.0]]})
    with pytest.raises(cullhull.BadFile, match="'xyz': lists of 2 and of 3 numbers"):
        cullhull.read(path)
    path = written(tmp_path, {"xyz": [[1.0, 2.0], None]})
    with pytest.raises(cullhull.BadFile, match="'xyz' has missing values"):
        cullhull.read(path)
    path = written(tmp_path, {"xyz": [[1.0, 2.0], [None, 2.0]]})
    with pytest.raises(cullhull.BadFile, match="'xyz' has missing values"):
        cullhull.read(path)


def test_parquet_two_lists_are_a_question(tmp_path):
    path = written(tmp_path, {"a": [[1.0, 2.0]], "b": [[3.0, 4.0]]})
    with pytest.raises(ValueError, match="columns= says which .* 'a', 'b'"):
        cullhull.read(path)
    assert cullhull.read(path, columns=["b"]).tolist() == [[3, 4]]


def test_parquet_never_takes_all_columns_silently(tmp_path):
    path = written(tmp_path, {"name": ["p"] * 300, "id": np.arange(300), **axes(names="abc")})
    points, said = said_while_reading(path)
    assert np.array_equal(points, POINTS)
    assert said == f"{path}: 'a', 'b', 'c' are taken as coordinates, not 'name', 'id'"
    points, said = said_while_reading(written(tmp_path, axes(names="abc")))
    assert said == f"{path}: 'a', 'b', 'c' are taken as coordinates"


def test_parquet_columns_are_those_of_a_text_of_these_names(tmp_path):
    """Known names in any language and order; unknown ones are refused, as in a text."""
    for names, want in {
        ("lat", "lng"): "10",
        ("POINT_Y", "POINT_X", "OBJECTID"): "10",
        ("Rechtswert", "Hochwert"): "01",
        ("id", "X [m]", "Y [m]"): "12",
        ("north", "east", "height"): "102",
        ("pop", "rate"): None,
        ("OBJECTID", "area"): None,
        ("value",): "0",
    }.items():
        columns = {name: np.arange(4.0) ** (j + 1) for j, name in enumerate(names)}
        path = written(tmp_path, columns)
        text = tmp_path / "a.csv"
        np.savetxt(text, np.column_stack(list(columns.values())), delimiter=",",
                   header=",".join(names), comments="")  # fmt: skip
        for file in (path, str(text)):
            if want is None:
                with pytest.raises(ValueError, match=r"not known as coordinates: '"):
                    cullhull.read(file)
                continue
            points, _ = said_while_reading(file)
            assert points.tolist() == np.column_stack(
                [columns[names[int(j)]] for j in want]
            ).tolist(), (file, names)


def test_parquet_never_gives_objects(tmp_path):
    import decimal

    text = {"name": ["p", "q"], "when": [decimal.Decimal("1.5"), decimal.Decimal("2.5")]}
    path = written(tmp_path, text)
    with pytest.raises(ValueError, match="no column of numbers; there are 'name' .*, 'when'"):
        cullhull.read(path)
    for column in text:
        with pytest.raises(ValueError, match=f"column '{column}' holds .* not numbers"):
            cullhull.read(path, columns=[column])
    with pytest.raises(ValueError, match="no column 'w'"):
        cullhull.read(path, columns=["w"])
    (tmp_path / "a.parquet").write_bytes(b"PAR1 is no Parquet")
    with pytest.raises(cullhull.BadFile, match="a.parquet: "):
        cullhull.read(tmp_path / "a.parquet")


def wkb(points, order="<", kind=1, flags=0):
    head = struct.pack(order + "BI", order == "<", kind | flags)
    if flags & 0x20000000:
        head += struct.pack(order + "I", 4326)
    return [head + struct.pack(order + f"{len(p)}d", *p) for p in points]


LARGE = 2**53 + 1  #: lies between two doubles


@pytest.mark.parametrize("kind", ["int64", "uint64"])
def test_parquet_whole_numbers_beside_doubles_are_not_rounded(tmp_path, kind):
    whole = np.arange(300).astype(kind)
    whole[290] = 2**60
    columns = {"x": POINTS[:, 0], "y": whole}
    points = cullhull.read(written(tmp_path, columns))
    assert points.dtype == np.float64 and points[290, 1] == 2.0**60
    whole[291] = LARGE
    path = written(tmp_path, columns)
    for options in ({}, {"columns": ["y", "x"]}):
        with pytest.raises(cullhull.BadFile, match=f"'y', row 291: {LARGE} is a 64-bit integer"):
            cullhull.read(path, **options)
    with pytest.raises(cullhull.BadFile, match="column 'y', row 291"):
        list(cullhull.read(path, chunks=100))
    alone = cullhull.read(path, columns=["y"])
    assert alone.dtype == kind and int(alone[291, 0]) == LARGE
    assert cullhull.read(path, columns=["x"]).shape == (300, 1)


def test_parquet_whole_numbers_of_two_types(tmp_path):
    signed, unsigned = np.full(3, -1), np.array([0, 1, 2**64 - 1], dtype=np.uint64)
    small = np.array([1, 2, 3], dtype=np.int32)
    with pytest.raises(cullhull.BadFile, match=f"'y', row 2: {2**64 - 1} is"):
        cullhull.read(written(tmp_path, {"x": signed, "y": unsigned}))
    signed[1] = -LARGE
    points = cullhull.read(written(tmp_path, {"x": signed, "y": small}))
    assert points.dtype == np.int64 and int(points[1, 0]) == -LARGE
    extremes = np.array([2**63 - 1, -(2**63), 2**62])
    with pytest.raises(cullhull.BadFile, match=f"'x', row 0: {2**63 - 1} is"):
        cullhull.read(written(tmp_path, {"x": extremes, "y": unsigned}))
    extremes[0] = 0
    points = cullhull.read(written(tmp_path, {"x": extremes, "y": small.astype("f4")}))
    assert points[:, 0].tolist() == [0, -(2.0**63), 2.0**62]
    with pytest.raises(cullhull.BadFile, match=f"'x', row 1: -{LARGE} is"):
        cullhull.read(written(tmp_path, {"x": signed, "y": small.astype("f4")}))


def test_parquet_rows_at_fault_are_numbered_from_the_first_of_the_file(tmp_path):
    structs = [{"x": i, "y": 0.5} for i in range(200)] + [{"x": LARGE, "y": 0.5}]
    path = written(tmp_path, {"at": structs})
    with pytest.raises(cullhull.BadFile, match="column 'at': column 'x', row 200: "):
        list(cullhull.read(path, columns=["at"], chunks=150))
    geometries = wkb(POINTS[:200]) + wkb(POINTS[:1], kind=2)
    path = written(tmp_path, {"geometry": geometries})
    with pytest.raises(cullhull.BadFile, match="'geometry', row 200: no geometry in WKB"):
        list(cullhull.read(path, columns=["geometry"], chunks=150))


def test_hdf5_whole_numbers_beside_doubles_are_not_rounded(tmp_path):
    write_hdf5(tmp_path / "a.h5", {"x": [0.5, 1.5], "y": [1, LARGE]})
    with pytest.raises(cullhull.BadFile, match=f"'y', row 1: {LARGE} is"):
        cullhull.read(f"{tmp_path}/a.h5:x,y")


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize(
    "width, kind, flags",
    [(2, 1, 0), (3, 1001, 0), (3, 1, 0x80000000), (2, 1, 0x20000000), (3, 1, 0xA0000000)],
)
def test_geoparquet_points(tmp_path, order, width, kind, flags):
    geo = {"primary_column": "where", "columns": {"where": {"encoding": "WKB"}}}
    rows = POINTS[:, :width]
    path = written(
        tmp_path, {"pop": np.arange(300), "where": wkb(rows, order, kind, flags)}, geo
    )
    for columns in (None, ["where"]):
        assert np.array_equal(cullhull.read(path, columns=columns), rows)
    assert np.array_equal(np.concatenate(list(cullhull.read(path, chunks=77))), rows)


def test_geoparquet_of_measured_and_mixed_points(tmp_path):
    geo = {"primary_column": "g", "columns": {"g": {"encoding": "WKB"}}}
    measured = wkb(POINTS, "<", 2001)
    assert np.array_equal(cullhull.read(written(tmp_path, {"g": measured}, geo)), POINTS[:, :2])
    mixed = wkb(POINTS[:150, :2], "<") + wkb(POINTS[150:, :2], ">")
    assert np.array_equal(cullhull.read(written(tmp_path, {"g": mixed}, geo)), POINTS[:, :2])


def test_geoparquet_of_what_is_no_point(tmp_path):
    geo = {"primary_column": "g", "columns": {"g": {"encoding": "WKB"}}}
    curve = struct.pack("<BII4d", 1, 8, 2, 0, 0, 1, 1)
    point = wkb(POINTS[:1, :2])[0]
    for rows, why in (
        ([point, curve], r"'g', row 1: curves \(WKB type 8\) have no vertices to take"),
        ([point, None, b""], "'g', row 2: no geometry in WKB"),
        ([point, b"\1\1\0"], "'g', row 1: no geometry in WKB"),
        ([point, point[:-1]], "'g', row 1: no geometry in WKB"),
        ([point, wkb(POINTS[:1], "<", 1001)[0]], "'g', row 1: 3 coordinates where those before have 2"),
    ):
        with pytest.raises(cullhull.BadFile, match=why):
            cullhull.read(written(tmp_path, {"g": rows}, geo))
    empty = wkb([[np.nan, np.nan]])[0]
    path = written(tmp_path, {"g": [empty, point, None, empty, point]}, geo)
    points, said = said_while_reading(path)
    assert np.array_equal(points, POINTS[[0, 0], :2])
    assert said == f"{path}: 1 of 5 rows has no geometry"


def test_geoparquet_points_as_structs(tmp_path):
    geo = {"primary_column": "g", "columns": {"g": {"encoding": "point"}}}
    rows = [{"x": p[0], "y": p[1]} for p in POINTS]
    path = written(tmp_path, {"n": np.arange(300), "g": rows}, geo)
    assert np.array_equal(cullhull.read(path), POINTS[:, :2])


# --------------------------------------------------------------------------------------- HDF5


@pytest.mark.parametrize("ending", ["h5", "nc"])
def test_hdf5_columns_of_their_own(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    columns = {f"g/{name}": column for name, column in axes().items()}
    write_hdf5(path, {**columns, "short": POINTS[:7, 0], "rows": POINTS})
    assert np.array_equal(cullhull.read(f"{path}:g/x,g/y,g/z"), POINTS)
    blocks = list(cullhull.read(f"{path}:g/x,/g/z", chunks=99))
    assert [len(b) for b in blocks] == [99, 99, 99, 3]
    assert np.array_equal(np.concatenate(blocks), POINTS[:, [0, 2]])
    assert cullhull.read(f"{path}:g/x,g/y,g/z", columns=[2]).tolist() == POINTS[:, 2:].tolist()
    with pytest.raises(cullhull.BadFile, match="'g/x' and 'short' have 300 and 7 numbers"):
        cullhull.read(f"{path}:g/x,short")
    with pytest.raises(cullhull.BadFile, match="'rows' .* no column"):
        cullhull.read(f"{path}:g/x,rows")
    with pytest.raises(ValueError, match="there are .*/g/x"):
        cullhull.read(f"{path}:g/x,none")


def never_filled(tmp_path, chunk=None):
    """A dataset p of which nothing is written."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
        if chunk:
            made.set_chunk(chunk)
        space = h5py.h5s.create_simple((300, 3))
        h5py.h5d.create(file.id, b"p", h5py.h5t.NATIVE_DOUBLE, space, made)
    return path


def test_hdf5_whose_fill_time_is_unknown(tmp_path):
    """libhdf5 passes a damaged value on and fills nothing, as if it were told never to."""
    path = never_filled(tmp_path)
    message = bytes([2, 2, 1])  # version, late allocation, never filled
    content = path.read_bytes()
    assert content.count(message) == 1
    path.write_bytes(content.replace(message, bytes([2, 2, 66])))
    with pytest.raises(cullhull.BadFile, match="never written"):
        cullhull.read(path)


@pytest.mark.parametrize("chunk", [None, (100, 2)])
def test_hdf5_that_was_never_written(tmp_path, chunk):
    h5py = pytest.importorskip("h5py")
    path = never_filled(tmp_path, chunk)
    with pytest.raises(cullhull.BadFile, match="never written"):
        cullhull.read(path)
    with h5py.File(path, "a") as file:
        file["p"][:200 if chunk else 300] = POINTS[: 200 if chunk else 300]
    if chunk:
        with pytest.raises(cullhull.BadFile, match="never written"):
            cullhull.read(path)
        with h5py.File(path, "a") as file:
            file["p"][200:] = POINTS[200:]
    assert np.array_equal(cullhull.read(path), POINTS)


# --------------------------------------------------------------------------------------- LAZ


@pytest.fixture
def laz(tmp_path):
    numbers = np.random.default_rng(1).integers(-(10**6), 10**6, (3, 200)).T
    scan(numbers, "laz", 3, "1.2", [1, 1, 1], [0, 0, 0]).write(str(tmp_path / "a.laz"))
    return tmp_path / "a.laz"


def test_laz_columns_by_name(laz):
    points = cullhull.read(laz)
    assert np.array_equal(cullhull.read(laz, columns=["x", "y"]), points[:, :2])
    assert np.array_equal(cullhull.read(laz, columns=["Z", "x"]), points[:, [2, 0]])
    with pytest.raises(ValueError, match="no column 'w'; there are 'x', 'y', 'z'"):
        cullhull.read(laz, columns=["w"])


def test_laz_that_is_damaged_is_a_bad_file(laz):
    whole = laz.read_bytes()
    item = 315  # of the record that lists how fields are packed: its type
    for damaged in (
        whole[:item] + b"\x3f" + whole[item + 1 :],
        whole[: len(whole) // 2],
        whole[:239] + b"L" + whole[240:],
        whole[:239] + b"\x97" + whole[240:],
        whole[:100],
    ):
        laz.write_bytes(damaged)
        with pytest.raises(cullhull.BadFile, match="a.laz: "):
            cullhull.read(laz)


@pytest.mark.parametrize("count", [0, 1, 10, 49_999, 50_000, 50_001, 200_000])
@pytest.mark.parametrize("point_format", [0, 1, 2, 3, 6, 7, 8])
def test_laz_fields_are_laspys(tmp_path, point_format, count):
    laspy = pytest.importorskip("laspy")
    pytest.importorskip("lazrs")
    random = np.random.default_rng(count)
    las = laspy.create(point_format=point_format, file_version="1.4" if point_format > 5 else "1.2")
    las.header.scales, las.header.offsets = [1, 1, 1], [0, 0, 0]
    las.add_extra_dim(laspy.ExtraBytesParams("extra", "u2"))
    size = las.point_format.size
    numbers = np.cumsum(random.integers(-3, 4, (count, size)), axis=0).astype(np.uint8)
    if count % 2:  # nothing that could be predicted
        numbers = random.integers(0, 256, (count, size), dtype=np.uint8)
    records = np.ascontiguousarray(numbers).view(las.points.array.dtype).reshape(count)
    las.points = laspy.ScaleAwarePointRecord(records, las.point_format, [1, 1, 1], [0, 0, 0])
    if "gps_time" in las.point_format.dimension_names:
        las.gps_time = np.cumsum(random.integers(0, 3, count)) + 1e6 * random.integers(0, 3, count)
    las.write(tmp_path / "a.laz")
    fields = [n for n in las.point_format.standard_dimension_names if n not in ("X", "Y", "Z")]
    for columns in (["x", "y", "z"], fields, *([f, "y"] for f in fields)):
        expected = np.column_stack([np.asarray(las[c.upper() if c in "xyz" else c]) for c in columns])
        got = cullhull.read(tmp_path / "a.laz", columns=columns, raw=True)
        assert got.shape == (count, len(columns))
        assert np.array_equal(got, expected), columns


# ----------------------------------------------------------------------------- CSV and meshes


def test_csv_columns_that_number_the_points(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(",a,b\n0,1,2\n1,3,4\n")
    points, said = said_while_reading(path)
    assert points.tolist() == [[1, 2], [3, 4]]
    assert said == f"{path}: 'a', 'b' are taken as coordinates, not ''"
    path.write_text("fid,lat,lon\n0,1,2\n1,3,4\n")
    points, said = said_while_reading(path)
    assert points.tolist() == [[2, 1], [4, 3]]
    assert said == f"{path}: lon and lat of 3 columns are taken as coordinates"


def test_csv_with_decimal_commas(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("x\ty\n1,5\t2,5\n3,5\t4,5\n")
    points, said = said_while_reading(path)
    assert points.tolist() == [[1.5, 2.5], [3.5, 4.5]]
    assert said == f"{path}: commas are read as decimal marks; --decimal . refuses them"
    path.write_text("1,5 2,5\n3,5 4,5\n")
    with pytest.raises(cullhull.BadFile, match="in Python decimal=\",\""):
        cullhull.read(path)
    assert cullhull.read(path, decimal=",").tolist() == [[1.5, 2.5], [3.5, 4.5]]
    assert next(cullhull.read(path, decimal=",", chunks=1)).tolist() == [[1.5, 2.5]]
    with pytest.raises(cullhull.BadFile):
        cullhull.read(path, decimal=".")
    with pytest.raises(cullhull.InvalidArgument, match="`decimal` should be"):
        cullhull.read(path, decimal=";")
    np.save(tmp_path / "a.npy", np.zeros((2, 2)))
    with pytest.raises(cullhull.InvalidArgument, match="decimal commas"):
        cullhull.read(tmp_path / "a.npy", decimal=",")


def test_csv_whose_names_say_nothing(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("mass,L\u00e4nge,name\n1,2,a\n3,4,b\n", encoding="utf-8")
    way = "'mass', 'L\u00e4nge', 'name'; .* 0,1 .in Python columns="
    with pytest.raises(cullhull.BadFile, match=way):
        cullhull.read(path)
    for columns in ("mass,L\u00e4nge", "0,1", "0:2", [0, 1], ["mass", "L\u00e4nge"]):
        assert cullhull.read(path, columns=columns).tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize(
    "name, text, rows",
    [
        ("a.pts", "2\n1 2 3\n4 5 6\n", [[1, 2, 3], [4, 5, 6]]),
        ("a.node", "2 2 0 1\n1 1 2 0\n2 3 4 0\n", [[1, 2], [3, 4]]),
        ("a.json", "[[1, 2], [3, 4]]", [[1, 2], [3, 4]]),
        (
            "a.ptx",
            "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 1\n1 2 3 0.5\n",
            [[2, 3, 4]],
        ),
    ],
)
def test_texts_of_other_programs(tmp_path, name, text, rows):
    path = tmp_path / name
    path.write_text(text)
    assert cullhull.read(path).tolist() == rows


@pytest.mark.parametrize(
    "name, text, said",
    [
        ("a.off", "OFF2 1 0\n0 1 2\n3 4 5\n", "ends within its faces: 0 of 1 are there"),
        ("a.obj", "v 0 1 2\n$ what\nv 3 4 5\n", "no keyword of .obj"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
            "property float z\nproperty list uchar int l\nend_header\n0 1 2\n3 4 5\n",
            "vertices without the list",
        ),
    ],
)
def test_meshes_with_a_remark(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    points, line = said_while_reading(tmp_path / name)
    assert points.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert said in line


def test_columns_as_the_program_takes_them(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("id,x,y,z\n7,1,2,3\n8,4,5,6\n")
    assert cullhull.read(path, columns="z, x").tolist() == [[3, 1], [6, 4]]


def test_npy_that_is_damaged_is_a_bad_file(tmp_path):
    """Each byte of the head changed, the file cut, other things under its name: an array that NumPy
    can still read, or one line of ours."""
    path = tmp_path / "a.npy"
    np.save(path, np.arange(12.0).reshape(6, 2))
    whole = path.read_bytes()
    rng = np.random.default_rng(3)
    damaged = [whole[:n] for n in (0, 3, 8, 60, 127, 140)]
    damaged += [b"PK\x03\x04" + whole, b"\x80\x04N.", b"points", whole.replace(b"<f8", b"|O8")]
    damaged += [whole.replace(b"(6, 2)", b"(6, 2" + b"0" * 20 + b")")]
    for at in range(128):
        for byte in rng.integers(0, 256, 4):
            damaged.append(whole[:at] + bytes([byte]) + whole[at + 1 :])
    refused = 0
    for content in damaged:
        path.write_bytes(content)
        for chunks in (None, 4):
            try:
                found = cullhull.read(path, chunks=chunks)
                assert len(found if chunks is None else list(found)) > 0
            except cullhull.Error as error:
                refused += 1
                assert str(error).startswith(f"{path}: ") and "\n" not in str(error)
                assert "pickle" not in str(error)
    assert refused > 200
    with pytest.raises(FileNotFoundError):
        cullhull.read(tmp_path / "none.npy")


# ------------------------------------------------------------------------- columns as one word


def test_columns_as_one_word(tmp_path):
    wide = np.column_stack([POINTS, POINTS[:, ::-1], np.arange(300)])
    np.save(tmp_path / "a.npy", wide)
    np.savetxt(tmp_path / "a.txt", wide)
    write_parquet(tmp_path / "a.parquet", {f"c{j}": wide[:, j] for j in range(7)})
    write_hdf5(tmp_path / "a.h5", {"points": wide})
    for name in ("a.npy", "a.txt", "a.parquet", "a.h5"):
        for text, taken in (
            ("0:3", [0, 1, 2]),
            ("0,2,5", [0, 2, 5]),
            (" 6 , 1:3", [6, 1, 2]),
            ("3:4", [3]),
        ):
            found = said_while_reading(tmp_path / name, columns=text)[0]
            assert np.allclose(found, wide[:, taken], rtol=0, atol=1e-15), (name, text)
        for text in ("0:9", "9", "7:8"):
            with pytest.raises(ValueError):
                cullhull.read(tmp_path / name, columns=text)
        for text in ("", " , ", "3:1"):
            with pytest.raises(cullhull.InvalidArgument, match="names no column"):
                cullhull.read(tmp_path / name, columns=text)
    (tmp_path / "named.csv").write_text('0,"a, b",y\n1,2,3\n4,5,6\n')
    assert cullhull.read(tmp_path / "named.csv", columns='"0",y').tolist() == [[1, 3], [4, 6]]
    assert cullhull.read(tmp_path / "named.csv", columns='"a, b",0').tolist() == [[2, 1], [5, 4]]
    with pytest.raises(ValueError, match="a range such as 0:3 or a list such as 0,2,5"):
        cullhull.read(tmp_path / "a.txt", columns="0-3")
    for text, width in (("0:3", 3), ("0,2,5", 3), ("5:", 2), (":4", 4)):
        assert cullhull.read(tmp_path / "a.txt", columns=text).shape == (300, width)


@pytest.mark.parametrize("name", ["a.npy", "a.laz", "a.las", "a.csv", "a.h5:/p"])
def test_no_column_twice(tmp_path, name):
    path = tmp_path / name
    if name == "a.npy":
        np.save(path, POINTS)
    elif name == "a.csv":
        path.write_text("x,y,z\n1,2,3\n")
    elif name == "a.h5:/p":
        write_hdf5(tmp_path / "a.h5", {"p": POINTS})
    else:
        scan(np.arange(9)[:, None] + [0, 0, 0], name[2:], 3).write(str(path))
    for columns in [[0, 0], *([["x", "X"]] if name[:5] in ("a.laz", "a.las", "a.csv") else [])]:
        with pytest.raises(cullhull.InvalidArgument, match="named twice"):
            cullhull.read(path, columns=columns)


@pytest.mark.parametrize("ending", ["las", "laz"])
def test_scans_without_points(tmp_path, ending):
    laspy = pytest.importorskip("laspy")
    if ending == "laz":
        pytest.importorskip("lazrs")
    path = str(tmp_path / f"a.{ending}")
    with laspy.open(path, "w", header=laspy.LasHeader(point_format=0, version="1.2")):
        pass
    assert cullhull.read(path).shape == (0, 3)
    assert [block.shape for block in cullhull.read(path, chunks=5)] == [(0, 3)]
    assert cullhull.read(path, raw=True).dtype == np.int32


# ------------------------------------------------------------------------ points without a return


def test_skip_nan(tmp_path):
    rows = np.array([[np.nan, 0], [0, 0], [1, 0], [np.nan, np.nan], [0, 1]])
    np.save(tmp_path / "a.npy", rows)
    (tmp_path / "a.xyz").write_text("\n".join(" ".join(map(str, row)) for row in rows))
    for name in ("a.npy", "a.xyz"):
        points, said = said_while_reading(tmp_path / name, skip_nan=True)
        assert points.tolist() == [[0, 0], [1, 0], [0, 1]]
        assert "2 of 5 points have a NaN coordinate and are skipped" in said
        (points, ids), _ = said_while_reading(tmp_path / name, skip_nan=True, return_rows=True)
        assert ids.tolist() == [1, 2, 4]
        assert ids[cullhull.convex_hull(points).vertices].tolist() == [1, 2, 4]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            pieces = list(
                cullhull.read(tmp_path / name, chunks=2, skip_nan=True, return_rows=True)
            )
        assert np.concatenate([p for p, _ in pieces]).tolist() == points.tolist()
        assert np.concatenate([r for _, r in pieces]).tolist() == [1, 2, 4]
    points, ids = cullhull.read(tmp_path / "a.npy", return_rows=True)
    assert len(points) == 5 and ids.tolist() == [0, 1, 2, 3, 4]
    whole, said = said_while_reading(tmp_path / "a.npy", columns=[1], skip_nan=True)
    assert len(whole) == 4 and "1 of 5" in said


# ----------------------------------------------------------------------------------------- NumPy


@pytest.mark.parametrize("case", [str.upper, str.lower])
def test_structured_arrays(tmp_path, case):
    fields = [(case(n), "<f4" if n == "x" else "<f8") for n in "xyz"]
    made = np.zeros(300, dtype=[("label", "u1"), *fields, ("rgb", "u1", (3,))])
    for j, n in enumerate("xyz"):
        made[case(n)] = POINTS[:, j]
    made["label"] = np.arange(300) % 7
    np.save(tmp_path / "a.npy", made)
    points = cullhull.read(tmp_path / "a.npy")
    assert points.dtype == np.float64
    assert np.array_equal(points[:, 1:], POINTS[:, 1:])
    assert np.array_equal(cullhull.read(tmp_path / "a.npy", columns="z,Label")[:, 1], made["label"])
    assert np.array_equal(cullhull.read(tmp_path / "a.npy", columns=[2, 1]), POINTS[:, [2, 1]])
    assert sum(len(block) for block in cullhull.read(tmp_path / "a.npy", chunks=128)) == 300
    for columns, said in (("x,X", "named twice"), ("q", "no column 'q'"), ("rgb", "no column 'rgb'")):
        with pytest.raises(cullhull.InvalidArgument, match=said):
            cullhull.read(tmp_path / "a.npy", columns=columns)
    np.save(tmp_path / "b.npy", np.zeros(3, dtype=[("pop", "f8"), ("rate", "f8")]))
    with pytest.raises(cullhull.BadFile, match="name no x and y: 'pop', 'rate'; columns="):
        cullhull.read(tmp_path / "b.npy")
    assert cullhull.read(tmp_path / "b.npy", columns="rate,pop").shape == (3, 2)


def test_an_array_of_one_axis_is_points_of_a_line(tmp_path):
    np.save(tmp_path / "a.npy", np.arange(4.0))
    assert cullhull.read(tmp_path / "a.npy").tolist() == [[0], [1], [2], [3]]
    assert [b.shape for b in cullhull.read(tmp_path / "a.npy", chunks=3)] == [(3, 1), (1, 1)]


# ------------------------------------------------------------------------------ HDF5 and NetCDF


def test_hdf5_of_columns_alone(tmp_path):
    write_hdf5(tmp_path / "a.h5", axes())
    with pytest.raises(cullhull.InvalidArgument, match=r"FILE.h5:/x,/y,/z; there are /x, /y, /z"):
        cullhull.read(tmp_path / "a.h5")
    assert np.array_equal(cullhull.read(f"{tmp_path}/a.h5:x,y,z"), POINTS)
    assert np.array_equal(cullhull.read(f"{tmp_path}/a.h5:/y"), POINTS[:, 1:2])
    write_hdf5(tmp_path / "b.h5", {"only": POINTS[:, 0]})
    assert np.array_equal(cullhull.read(tmp_path / "b.h5"), POINTS[:, :1])


def test_netcdf_of_the_classic_format(tmp_path):
    netcdf = pytest.importorskip("scipy.io").netcdf_file
    with netcdf(tmp_path / "a.nc", "w") as file:
        file.createDimension("n", 300)
        for j, name in enumerate("xyz"):
            file.createVariable(name, "f8", ("n",))[:] = POINTS[:, j]
    points = cullhull.read(f"{tmp_path}/a.nc:x,y,z")
    assert np.array_equal(points, POINTS) and points.dtype.isnative
    assert np.array_equal(cullhull.read(f"{tmp_path}/a.nc:z"), POINTS[:, 2:])
    with pytest.raises(cullhull.InvalidArgument, match="there are x, y, z"):
        cullhull.read(tmp_path / "a.nc")
    (tmp_path / "b.nc").write_bytes(b"CDF\x05" + bytes(40))
    with pytest.raises(cullhull.BadFile, match="CDF-5; nccopy -k nc4"):
        cullhull.read(tmp_path / "b.nc")
    (tmp_path / "c.nc").write_bytes((tmp_path / "a.nc").read_bytes()[:40])
    with pytest.raises(cullhull.BadFile):
        cullhull.read(tmp_path / "c.nc")
