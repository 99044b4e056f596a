"""What the package consists of: types, documentation, examples, lazy imports."""

import doctest
import inspect
import os
import subprocess
import sys
from pathlib import Path

import pytest

import cullhull

ROOT = Path(__file__).parents[3]
PACKAGE = Path(cullhull.__file__).parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(*words, **options):
    done = subprocess.run(
        [sys.executable, *map(str, words)], capture_output=True, text=True, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("example", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples(example, tmp_path):
    assert run(example, cwd=tmp_path, env={**os.environ, "MPLBACKEND": "Agg"})


def test_there_are_examples():
    assert EXAMPLES


def test_every_public_name_is_documented():
    for name in cullhull.__all__:
        thing = getattr(cullhull, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and callable(value):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_the_documentation_is_true():
    failures, tests = doctest.testmod(cullhull)
    assert tests > 0 and failures == 0
    page = ROOT / "docs" / "python.md"
    failures, tests = doctest.testfile(str(page), module_relative=False)
    assert tests > 10 and failures == 0


def test_import_is_light():
    loaded = run(
        "-c",
        "import sys, cullhull; print([m for m in ('scipy', 'matplotlib', 'tqdm') if m in sys.modules])",
    )
    assert loaded.strip() == "[]"


def test_without_scipy_the_error_is_still_there():
    run(
        "-c",
        "import sys; sys.modules['scipy'] = sys.modules['scipy.spatial'] = None\n"
        "import cullhull\n"
        "try: cullhull.ConvexHull([[0, 0], [1, 1]], strict=True)\n"
        "except RuntimeError as error: assert type(error) is cullhull.QhullError\n"
        "else: raise SystemExit('no error')",
    )


def test_types(tmp_path):
    pytest.importorskip("mypy")
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "_core.pyi").exists()
    checks = ("--strict", "--disable-error-code", "import-untyped", "--cache-dir", tmp_path)
    run("-m", "mypy", *checks, "-p", "cullhull", cwd=tmp_path)
    user = tmp_path / "user.py"
    user.write_text(
        "import numpy as np\n"
        "import cullhull\n"
        "hull = cullhull.convex_hull(np.eye(3), threads=2)\n"
        "volume: float = hull.volume\n"
        "first: cullhull.Hull = cullhull.convex_hulls([np.eye(3)])[0]\n"
        "reveal_type(hull.vertices)\n"
    )
    shown = run("-m", "mypy", "--strict", "--cache-dir", tmp_path, user, cwd=tmp_path)
    assert "int64" in shown or "signedinteger" in shown
    user.write_text(user.read_text() + "hull.volume = 'large'\ncullhull.convex_hull(points=1, x=2)\n")
    wrong = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", tmp_path, user],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert wrong.returncode == 1 and "user.py:7" in wrong.stdout and "user.py:8" in wrong.stdout


def test_source_archive_is_complete(tmp_path):
    pytest.importorskip("scikit_build_core")
    import tarfile

    run("-c", f"from scikit_build_core.build import build_sdist; build_sdist({str(tmp_path)!r})", cwd=ROOT)
    (archive,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(archive) as tar:
        names = {name.split("/", 1)[1] for name in tar.getnames() if "/" in name}
    for folder in ("src", "include", "apps", "cmake", "viewer", "bindings/python/src", "bindings/python/cullhull"):
        for path in (ROOT / folder).rglob("*"):
            if path.is_file() and not path.is_symlink() and path.suffix != ".pyc":
                assert str(path.relative_to(ROOT)) in names
    assert {"CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml"} <= names
    assert not any(name.startswith(("build/", "data/")) for name in names)
