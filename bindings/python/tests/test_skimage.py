"""scikit-image with our class in place of SciPy's."""

import os
import re
from pathlib import Path

import numpy as np
import pytest

import cullhull
from programs import passed_in_place

pytest.importorskip("skimage", reason="scikit-image is not installed")


def test_scikit_images_own_tests():
    """All of its tests of convex hulls, unchanged: from the package, or its source archive."""
    tests = os.environ.get("CULLHULL_SKIMAGE_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_SKIMAGE_TESTS does not name scikit-image's test of convex hulls")
    words = ("-s", "-W", "default", "--noconftest", "-c", os.devnull, tests)
    passed, said = passed_in_place("in_place_for_skimage", *words, cwd=Path(tests).parent)
    assert passed >= 10
    hulls = re.search(r"(\d+) hulls by cullhull", said)
    assert hulls and int(hulls[1]) >= 10


@pytest.fixture
def in_place(monkeypatch):
    import skimage.morphology.convex_hull as module

    monkeypatch.setattr(
        module, "ConvexHull", lambda points: cullhull.ConvexHull(points, strict=True)
    )


def images():
    rng = np.random.default_rng(2)
    yield rng.random((40, 50)) > 0.9
    yield rng.random((12, 14, 10)) > 0.95
    for shape in ((9, 9), (7, 7, 7)):
        for k in range(3):
            flat = np.zeros(shape, dtype=bool)
            flat[(slice(1, 6),) * k + (3,) * (len(shape) - k)] = True
            yield flat


@pytest.mark.parametrize("offset", [False, True])
@pytest.mark.parametrize("number", range(8))
def test_images_and_warnings_are_scipys(number, offset, in_place, monkeypatch):
    import warnings

    import scipy.spatial
    import skimage.morphology.convex_hull as module

    def made():
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            image = module.convex_hull_image(list(images())[number], offset_coordinates=offset)
        return image, [re.sub(r"run-id \d+", "run-id", str(w.message)) for w in told]

    ours, our_words = made()
    monkeypatch.setattr(module, "ConvexHull", scipy.spatial.ConvexHull)
    theirs, their_words = made()
    assert np.array_equal(ours, theirs) and our_words == their_words
