"""OpenPNM with our classes in place of SciPy's."""

import os

import pytest
from foreign_suites import passed_and_failed

openpnm = pytest.importorskip("openpnm")


def test_openpnms_own_tests():
    """Those of networks, and all others that make a diagram or a triangulation, from OpenPNM's
    source archive."""
    tests = os.environ.get("CULLHULL_OPENPNM_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_OPENPNM_TESTS does not name OpenPNM's tests folder")
    files = ["network", "models/network", "models/physics/CapillaryPressureTest.py"]
    kinds = ["-opython_files=*Test*.py", "-opython_classes=*Test"]
    arguments = ["-pstand_in", *kinds, *(f"tests/unit/{name}" for name in files)]
    passed, failed = passed_and_failed(os.path.dirname(tests), "openpnm_tests", arguments)
    assert not failed and passed >= 110
