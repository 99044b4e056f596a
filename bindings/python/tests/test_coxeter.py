"""coxeter with our class in place of SciPy's."""

import os

import pytest
from foreign_suites import passed_and_failed

pytest.importorskip("coxeter")


def test_coxeters_own_tests():
    """Those that make hulls of polyhedra and merge their faces, from coxeter's source archive, over
    stand-ins for the conftest.py and utils.py that it leaves out. test_io.py compares with files
    that it leaves out too. CULLHULL_COXETER_ALL=1 runs all others, for minutes."""
    tests = os.environ.get("CULLHULL_COXETER_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_COXETER_TESTS does not name coxeter's tests folder")
    arguments = ["-pconftest", "tests", "--ignore", "tests/test_io.py"]
    few = os.environ.get("CULLHULL_COXETER_ALL") != "1"
    if few:
        arguments += ["-k", "insphere_catalan or trapezohedra or merge_faces or convex_hulls"]
    passed, failed = passed_and_failed(os.path.dirname(tests), "coxeter_tests", arguments)
    assert not failed and passed >= (15 if few else 2000)
