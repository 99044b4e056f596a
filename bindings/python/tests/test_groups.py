"""hulls_by: the hull of each group is convex_hull of its points, whatever the keys come as."""

from __future__ import annotations

import json
import pickle

import cullhull
import numpy as np
import pytest
from programs import run


def table(groups: int = 200, dimension: int = 2, seed: int = 5):
    random = np.random.default_rng(seed)
    keys = np.repeat(np.arange(groups) * 3, random.integers(1, 41, groups))
    random.shuffle(keys)
    return random.integers(0, 6, (len(keys), dimension)).astype(float), keys


@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
def test_each_group_is_the_hull_of_its_points(dimension):
    points, keys = table(dimension=dimension)
    hulls = cullhull.hulls_by(points, keys)
    assert list(hulls) == sorted(set(keys.tolist()))
    assert len(hulls) == len(hulls.batch) == 200
    for key, hull in hulls.items():
        members = np.flatnonzero(keys == key)
        assert np.array_equal(hulls.members(key), members)
        alone = cullhull.convex_hull(points[members])
        assert np.array_equal(hull.vertices, alone.vertices)
        assert hull.volume == alone.volume and hull.area == alone.area
        assert np.array_equal(hull.facet_planes, alone.facet_planes)
    again = pickle.loads(pickle.dumps(hulls))
    assert list(again) == list(hulls) and np.array_equal(again.batch.volumes, hulls.batch.volumes)


def test_keys_of_every_kind():
    points, numbers = table()
    words = np.array([f"town {k}" for k in numbers])
    expected = cullhull.hulls_by(points, words)
    same = [words.tolist(), words.astype(object)]
    pandas = pytest.importorskip("pandas")
    same += [pandas.Series(words), pandas.Series(words, dtype="category"), pandas.Index(words)]
    pyarrow = pytest.importorskip("pyarrow")
    same += [
        pyarrow.array(words.tolist()),
        pyarrow.chunked_array([words[:99].tolist(), words[99:].tolist()]),
        pyarrow.array(words.tolist()).dictionary_encode(),
    ]
    for keys in same:
        hulls = cullhull.hulls_by(points, keys)
        assert list(hulls) == list(expected), type(keys)
        assert np.array_equal(hulls.batch.volumes, expected.batch.volumes), type(keys)
    for keys in (numbers.astype("u1"), numbers.astype("f4"), pyarrow.array(numbers)):
        assert len(cullhull.hulls_by(points, keys)) == 200
    days = np.datetime64("2020-01-01") + numbers
    assert len(cullhull.hulls_by(points, days)) == 200
    assert cullhull.hulls_by(points, numbers)[np.int64(3)].point_count == (numbers == 3).sum()


def test_what_is_refused():
    points = np.zeros((3, 2))
    for keys, said in [
        ([1, 2], "3 points, but 2 keys"),
        ([1.0, float("nan"), 2.0], "missing"),
        (np.array(["a", None, "b"], dtype=object), "missing"),
        (np.array([1, "a", 2], dtype=object), "one kind"),
        ([[1], [2], [3]], "one value a point"),
    ]:
        with pytest.raises(cullhull.InvalidArgument, match=said):
            cullhull.hulls_by(points, keys)
    with pytest.raises(cullhull.NotFinite):
        cullhull.hulls_by([[0.0, np.inf]], [1])
    hulls = cullhull.hulls_by(points, [1, 2, 1])
    for key in (7, "a", []):
        with pytest.raises(KeyError):
            hulls[key]
        assert key == [] or key not in hulls
    with pytest.raises(TypeError):
        cullhull.GroupHulls()


def test_no_points():
    hulls = cullhull.hulls_by(np.zeros((0, 2)), [])
    assert len(hulls) == 0 and list(hulls) == []


def test_shapely_has_the_same_corners():
    shapely = pytest.importorskip("shapely")
    points, keys = table(300, seed=9)
    for key, hull in cullhull.hulls_by(points, keys).items():
        theirs = shapely.MultiPoint(points[keys == key]).convex_hull
        ours = {tuple(p) for p in points[keys == key][hull.vertices].tolist()}
        assert ours == {tuple(p) for p in shapely.get_coordinates(theirs).tolist()}


UNLIKE = [
    ["a", "a\0", "b"],
    [2**53, 2**53 + 1, 0.5],
    [2**63, 2**63 + 1, -1],
]


@pytest.mark.parametrize("keys", UNLIKE, ids=repr)
def test_unlike_keys_are_groups_of_their_own(keys):
    points = np.arange(18.0).reshape(9, 2)
    hulls = cullhull.hulls_by(points, [key for key in keys for _ in range(3)])
    assert len(hulls) == 3 and set(hulls) == set(keys)
    for i, key in enumerate(keys):
        assert hulls.members(key).tolist() == [3 * i, 3 * i + 1, 3 * i + 2]


def test_keys_of_two_kinds_are_refused():
    with pytest.raises(cullhull.InvalidArgument, match="of one kind"):
        cullhull.hulls_by([[0, 0], [1, 1]], [1, "1"])


@pytest.mark.parametrize("unit", ["D", "ns"])
def test_no_time_is_no_group(unit):
    days = np.array(["2026-01-01", "NaT", "2026-01-02"], dtype=f"datetime64[{unit}]")
    with pytest.raises(cullhull.InvalidArgument, match="1 missing value"):
        cullhull.hulls_by(np.zeros((3, 2)), days)
    assert len(cullhull.hulls_by(np.zeros((2, 2)), days[[0, 2]])) == 2


def test_pandas_missing_values_are_no_group():
    pandas = pytest.importorskip("pandas")
    for missing in (pandas.NA, pandas.NaT, None):
        with pytest.raises(cullhull.InvalidArgument, match="missing"):
            cullhull.hulls_by(np.zeros((2, 2)), pandas.Series(["a", missing], dtype=object))


def test_polars_keys():
    polars = pytest.importorskip("polars")
    points = np.array([[0.0, 0], [1, 0], [0, 1], [5, 5]])
    for keys, dtype in [
        (["a", "a", "a", "b"], polars.String),
        (["a", "a", "a", "b"], polars.Categorical),
        ([1, 1, 1, 2], polars.Int64),
        ([0.5, 0.5, 0.5, 2.5], polars.Float64),
        ([True, True, True, False], polars.Boolean),
    ]:
        hulls = cullhull.hulls_by(points, polars.Series(keys, dtype=dtype))
        assert set(hulls) == set(keys) and hulls[keys[0]].volume == 0.5
    with pytest.raises(cullhull.InvalidArgument, match="1 missing value"):
        cullhull.hulls_by(points, polars.Series(["a", None, "a", "b"]))


def test_groups_are_equal_where_keys_members_and_hulls_are():
    points, keys = table(groups=20)
    hulls = cullhull.hulls_by(points, keys)
    days = np.datetime64("2020-01-01") + keys
    assert hulls == hulls and not hulls != hulls
    assert hulls == cullhull.hulls_by(points, keys) == pickle.loads(pickle.dumps(hulls))
    moved, other_keys = points.copy(), keys.copy()
    moved[hulls.members(keys[0])[hulls[keys[0]].vertices[0]]] += 9.5
    other_keys[0] += 1
    for other in (
        cullhull.hulls_by(moved, keys),
        cullhull.hulls_by(points, other_keys),
        cullhull.hulls_by(points, [str(key) for key in keys]),
        cullhull.hulls_by(points, days),
        cullhull.hulls_by(points[:-1], keys[:-1]),
        cullhull.hulls_by(points[:0], keys[:0]),
        dict(hulls),
        3,
    ):
        assert hulls != other and not hulls == other
    assert cullhull.hulls_by(points[:0], keys[:0]) == cullhull.hulls_by(points[:0], keys[:0])
    with pytest.raises(TypeError, match="unhashable"):
        hash(hulls)


def written_by_the_program(tmp_path, points, keys, ending):
    """What ``cullhull hull --by`` writes of the same points and keys."""
    names = "xyzw"[: points.shape[1]]
    rows = [f"{key}," + ",".join(map(repr, p)) for key, p in zip(keys, points.tolist())]
    (tmp_path / "a.csv").write_text("\n".join([f"town,{','.join(names)}", *rows, ""]))
    out = tmp_path / f"theirs{ending}"
    command = ["hull", tmp_path / "a.csv", "--by", "town", "--columns", ",".join(names), "-q"]
    done = run(*command, "-o", out)
    assert done.returncode == 0, done.stderr
    return out.read_bytes()


@pytest.mark.parametrize("ending", [".csv", ".json", ".geojson"])
@pytest.mark.parametrize("kind", ["numbers", "words", "halves"])
def test_saved_as_the_program_writes_groups(tmp_path, ending, kind):
    for dimension in (2,) if ending == ".geojson" else (1, 2, 3, 4):
        points, numbers = table(dimension=dimension)
        keys = {"numbers": numbers, "words": [f"town {k}" for k in numbers], "halves": numbers / 2}
        hulls = cullhull.hulls_by(points, keys[kind])
        hulls.save(tmp_path / f"ours{ending}", by="town")
        texts = [f"{k:g}" for k in numbers / 2] if kind == "halves" else keys[kind]
        theirs = written_by_the_program(tmp_path, points, texts, ending)
        assert (tmp_path / f"ours{ending}").read_bytes() == theirs
        pickle.loads(pickle.dumps(hulls)).save(tmp_path / "again", format=ending[1:], by="town")
        assert (tmp_path / "again").read_bytes() == theirs


def test_keys_as_they_are_written(tmp_path):
    def keys(values):
        points = np.zeros((len(values), 2))
        cullhull.hulls_by(points, values).save(tmp_path / "a.json")
        saved = json.loads((tmp_path / "a.json").read_bytes())
        assert saved["by"] == "key"
        return [group["key"] for group in saved["groups"]]

    assert keys([10, 9, -1]) == [-1, 9, 10]
    assert keys([1e300, 2.0, 2.5]) == [2, 2.5, 1e300]
    assert keys(["10", "9"]) == [9, 10], "all are numbers"
    assert keys(["10", "9", "b"]) == ["10", "9", "b"]
    assert keys([True, False]) == ["False", "True"]
    assert keys([b"a", b"b"]) == ["a", "b"]
    assert keys(["\u00fc\"", ""]) == ["", "\u00fc\""]
    days = np.array(["2026-01-02", "2026-01-01"], dtype="datetime64[ns]")
    assert keys(days) == ["2026-01-01T00:00:00.000000000", "2026-01-02T00:00:00.000000000"]


def test_batches_are_saved_by_the_number_of_the_set(tmp_path):
    points, _ = table()
    batch = cullhull.convex_hulls(points, [0, 5, 5, 300])
    batch.save(tmp_path / "a.csv")
    head, *rows = (tmp_path / "a.csv").read_text().splitlines()
    assert head == "set,points,vertices,perimeter,area,wkt"
    assert [row.split(",")[:2] for row in rows] == [["0", "5"], ["1", "0"], ["2", "295"]]
    batch.save(tmp_path / "a.json")
    saved = json.loads((tmp_path / "a.json").read_text())
    assert [group["area"] for group in saved["groups"] if "area" in group] == [
        volume for volume, k in zip(batch.volumes, batch.affine_dimensions) if k == 2
    ]
    assert saved["points"] == {"count": 300, "dimension": 2, "scalar": "f64"}
    single = cullhull.convex_hulls(points.astype(np.float32), [0, 300])
    single.save(tmp_path / "b.json")
    assert json.loads((tmp_path / "b.json").read_text())["points"]["scalar"] == "f32"
    with pytest.raises(cullhull.InvalidArgument, match="expected .geojson .csv .json"):
        batch.save(tmp_path / "a.ply")
    with pytest.raises(cullhull.InvalidArgument, match="not 3D"):
        cullhull.convex_hulls(np.zeros((2, 4, 3))).save(tmp_path / "c.geojson")
    assert not (tmp_path / "a.ply").exists() and not (tmp_path / "c.geojson").exists()
    cullhull.convex_hulls(np.empty((0, 4, 3))).save(tmp_path / "none.csv")
    assert (tmp_path / "none.csv").read_text().count("\n") == 1


def test_a_column_of_a_table_by_its_name():
    points, numbers = table(20)
    words = np.array([f"town {k}" for k in numbers])
    expected = cullhull.hulls_by(points, words)
    pandas = pytest.importorskip("pandas")
    pyarrow = pytest.importorskip("pyarrow")
    columns = {"x": points[:, 0], "g": words, "y": points[:, 1]}
    frame = pandas.DataFrame(columns)
    tables = [frame, frame.astype({"g": "category"}), pyarrow.table(columns)]
    try:
        import polars

        tables.append(polars.DataFrame(columns))
    except ImportError:
        pass
    for one in tables:
        hulls = cullhull.hulls_by(one, "g")
        assert list(hulls) == list(expected), type(one)
        assert np.array_equal(hulls.batch.volumes, expected.batch.volumes), type(one)
        with pytest.raises(cullhull.InvalidArgument, match="no column 'h'; the table has 'x', 'g', 'y'"):
            cullhull.hulls_by(one, "h")
    assert list(frame) == ["x", "g", "y"]  # the caller's table is as it was
    twice = pandas.concat([frame, frame[["g"]]], axis=1)
    with pytest.raises(cullhull.InvalidArgument, match="several columns 'g'"):
        cullhull.hulls_by(twice, "g")
    with pytest.raises(ValueError):
        cullhull.hulls_by(points, "g")


def test_a_column_of_a_table_of_geometries():
    geopandas = pytest.importorskip("geopandas")
    points, numbers = table(20)
    words = np.array([f"town {k}" for k in numbers])
    places = geopandas.GeoDataFrame(
        {"g": words, "n": numbers}, geometry=geopandas.points_from_xy(*points.T)
    )
    hulls = cullhull.hulls_by(places, "g")
    assert np.array_equal(hulls.batch.volumes, cullhull.hulls_by(points, words).batch.volumes)
