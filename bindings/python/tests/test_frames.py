"""Data frames and labelled arrays: nullable, Arrow-backed, mixed, missing."""

import numpy as np
import pytest

import cullhull

POINTS = cullhull.generate("ball", 200, 3)
EXPECTED = cullhull.convex_hull(POINTS)
GRID = np.indices((3, 3, 3)).reshape(3, -1).T


def assert_read(points, expected=EXPECTED):
    assert cullhull.convex_hull(points).volume == expected.volume
    assert np.array_equal(cullhull.ConvexHull(points).simplices, expected.simplices)
    assert cullhull.convex_hull([[9, 9, 9], [-9, 9, 9], [9, -9, 9], [9, 9, -9]]).sides(
        points
    ).shape == (len(points),)


def pandas():
    return pytest.importorskip("pandas", reason="pandas is not installed")


def frame(points=POINTS):
    return pandas().DataFrame(points, columns=list("xyz"))


def test_pandas():
    assert_read(frame())
    assert_read(frame(POINTS.astype(np.float32)), cullhull.convex_hull(POINTS.astype(np.float32)))


def test_pandas_nullable():
    nullable = frame().convert_dtypes()
    assert str(nullable.dtypes["x"]) == "Float64"
    assert_read(nullable)
    assert_read(frame(GRID).convert_dtypes(), cullhull.convex_hull(GRID))
    mixed = frame(GRID).astype({"x": "Int8", "y": "float32", "z": "UInt64"})
    assert_read(mixed, cullhull.convex_hull(GRID))


def test_pandas_on_arrow():
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    for kind in ("float64[pyarrow]", "float32[pyarrow]"):
        assert_read(
            frame().astype(kind),
            cullhull.convex_hull(POINTS.astype(kind.removesuffix("[pyarrow]"))),
        )
    assert_read(frame(GRID).astype("int64[pyarrow]"), cullhull.convex_hull(GRID))


def test_what_is_missing_is_named():
    nullable = frame().convert_dtypes()
    nullable.loc[7, "y"] = pandas().NA
    with pytest.raises(cullhull.NotFinite, match="row 7 of column 'y' is missing"):
        cullhull.convex_hull(nullable)
    plain = frame().copy()  # before pandas 3 a frame shares its array's memory
    plain.loc[7, "y"] = np.nan
    with pytest.raises(cullhull.NotFinite, match="7"):
        cullhull.convex_hull(plain)


def test_no_column_is_rounded():
    big = frame(GRID).astype({"x": "float64", "y": "int64", "z": "int64"})
    big.loc[3, "y"] = 2**60 + 1
    for one in (big, big.convert_dtypes()):
        with pytest.raises(ValueError, match="no double holds"):
            cullhull.convex_hull(one)
    text = frame().astype({"x": "string"})
    for one in (text, frame(GRID).astype({"z": "datetime64[ns]"})):
        with pytest.raises(TypeError, match="real numbers"):
            cullhull.convex_hull(one)
    with pytest.raises(ValueError):
        cullhull.convex_hull(frame()["x"])
    with pytest.raises(ValueError):
        cullhull.convex_hull(pandas().DataFrame(index=range(3)))


def test_polars():
    polars = pytest.importorskip("polars", reason="polars is not installed")
    assert_read(polars.DataFrame(POINTS, schema=list("xyz")))
    columns = {"x": GRID[:, 0].astype(np.int8), "y": GRID[:, 1], "z": GRID[:, 2] * 1.0}
    assert_read(polars.DataFrame(columns), cullhull.convex_hull(GRID))
    missing = polars.DataFrame({"x": [1.0, None], "y": [1, 2]})
    with pytest.raises(cullhull.NotFinite, match="row 1 of column 'x' is missing"):
        cullhull.convex_hull(missing)
    with pytest.raises(TypeError, match="real numbers"):
        cullhull.convex_hull(polars.DataFrame({"x": ["a", "b"], "y": [1, 2]}))


def test_arrow():
    arrow = pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    table = arrow.table({name: POINTS[:, i] for i, name in enumerate("xyz")})
    assert_read(table)
    missing = arrow.table({"x": [1.0, 2.0], "y": [1, None]})
    with pytest.raises(cullhull.NotFinite, match="row 1 of column 'y' is missing"):
        cullhull.convex_hull(missing)


def test_xarray():
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    assert_read(xarray.DataArray(POINTS, dims=("point", "axis")))
    with pytest.raises(TypeError):
        cullhull.convex_hull(xarray.Dataset({"x": ("point", POINTS[:, 0])}))


def test_an_array_on_its_side_warns():
    for make in (cullhull.convex_hull, cullhull.ConvexHull, cullhull.cull):
        with pytest.warns(cullhull.ShapeWarning, match=r"3 points in 200D: .* points\.T\?") as told:
            make(POINTS.T)
        assert len(told) == 1 and told[0].filename == __file__


@pytest.mark.filterwarnings("error")
def test_what_does_not_warn():
    cullhull.convex_hull(POINTS)
    for shape in ((1, 50), (0, 50), (3, 8), (9, 9), (2, 3)):
        cullhull.convex_hull(np.ones(shape))
    cullhull.convex_hull(POINTS[:50]).contains(POINTS[:2])


def test_once_a_line():
    import warnings

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("default")
        for _ in range(5):
            cullhull.convex_hull(POINTS[:20].T)
    assert len(told) == 1
