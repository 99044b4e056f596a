"""SciPy's own tests of the classes and functions that ours stand in for, with ours in place."""

import pytest
from programs import passed_in_place

pytest.importorskip("scipy.spatial.tests.test_qhull")

#: Module, what of it ("" is all), and how many tests of it pass at least.
SUITES = (
    ("scipy.spatial.tests.test_qhull", "", 180),
    ("scipy.spatial.tests.test_spherical_voronoi", "", 60),
    ("scipy.spatial.tests.test__plotutils", "", 5),
    ("scipy.interpolate.tests.test_interpnd", "TestLinearNDInterpolation", 10),
    ("scipy.interpolate.tests.test_ndgriddata", "not Clough", 30),
)

#: Left out; docs/python.md says why, test_delaunay.py has what else they assert.
LEFT_OUT = (
    *("test_joggle", "test_degenerate_barycentric_transforms", "test_threading"),
    "(TestVoronoi and pathological-2)",
)


@pytest.mark.parametrize("module, which, least", SUITES, ids=[s[0].split(".")[-1] for s in SUITES])
def test_scipys_tests_pass(module, which, least):
    words = [*filter(None, [which]), *(f"not {name}" for name in LEFT_OUT)]
    words = ("--pyargs", module, "-k", " and ".join(words))
    passed, said = passed_in_place("in_place_of_scipy", *words)
    assert passed >= least and "skipped" not in said
