"""SciPy's own tests of ConvexHull and HalfspaceIntersection, with our classes in place."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("scipy.spatial.tests.test_qhull")


def test_scipys_tests_pass():
    path = [str(Path(__file__).parent), *filter(None, [os.environ.get("PYTHONPATH")])]
    run = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"),
            *("-p", "in_place_of_scipy", "--pyargs", "scipy.spatial.tests.test_qhull"),
            *("-k", "TestConvexHull or Test_HalfspaceIntersection"),
        ],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
    )
    print(run.stdout[-20_000:])
    assert run.returncode == 0
    passed = re.search(r"(\d+) passed", run.stdout)
    assert passed and int(passed[1]) >= 60 and "skipped" not in run.stdout
