"""What the package consists of: types, documentation, examples, lazy imports."""

import ast
import doctest
import importlib.util
import inspect
import os
import pickle
import re
from pathlib import Path

import pytest

import cullhull
from programs import python

ROOT = Path(__file__).parents[3]
PACKAGE = Path(cullhull.__file__).parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def run(*words, **options):
    done = python(*words, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("example", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples(example, tmp_path):
    assert run(example, cwd=tmp_path, env={**os.environ, "MPLBACKEND": "Agg"})


def test_there_are_examples():
    assert EXAMPLES


def members(thing):
    """Public methods, properties and the like, its own and those of our base classes."""
    for kind in thing.__mro__:
        if kind.__module__.startswith("cullhull"):
            for name, value in vars(kind).items():
                if not name.startswith("_") and name not in getattr(kind, "__slots__", ()):
                    yield name, value


@pytest.mark.parametrize("name", [n for n in cullhull.__all__ if n != "__version__"])
def test_every_public_name_is_documented(name):
    """What it is, takes and gives, what it raises, and an example that runs."""
    thing = getattr(cullhull, name)
    text = inspect.getdoc(thing)
    assert text and ">>>" in text
    if inspect.isclass(thing) and issubclass(thing, (Exception, Warning)):
        return
    if not inspect.isclass(thing):
        assert "Returns\n---" in text
        sections = inspect.signature(thing).parameters
        assert all(argument in text for argument in sections), text
        assert not sections or ("Parameters\n---" in text and "Raises\n---" in text)
        return
    for member, value in members(thing):
        text = inspect.getdoc(value)
        assert text, member
        if inspect.isfunction(value):
            assert ">>>" in text, member
            arguments = [a for a in inspect.signature(value).parameters if a not in ("self", "style")]
            assert all(a in text for a in arguments), member
            assert not arguments or "Parameters\n---" in text, member


@pytest.mark.parametrize("needed", ["", "dask"])
def test_the_documentation_is_true(needed):
    """The modules that need no package of others, and the one that does."""
    import importlib
    import pkgutil

    if needed:
        pytest.importorskip(needed)
        for name in (f"cullhull.{needed}", f"cullhull.cluster._{needed}"):
            failed, tests = doctest.testmod(importlib.import_module(name))
            assert tests > 0 and failed == 0
        return
    names = [m.name for m in pkgutil.walk_packages(cullhull.__path__, "cullhull.")]
    names = [n for n in names if not n.endswith(("__main__", "dask"))]
    modules = [cullhull, *map(importlib.import_module, names)]
    results = [doctest.testmod(module) for module in modules]
    assert sum(tests for _, tests in results) > 100 and not any(failed for failed, _ in results)
    for kind in (cullhull.Certificate, cullhull.QhullError):
        examples = doctest.DocTestFinder().find(kind, kind.__name__, globs={})
        runner = doctest.DocTestRunner()
        assert [runner.run(example).failed for example in examples if example.examples] == [0]


PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("page", [p for p in PAGES if ">>> " in p.read_text()], ids=lambda p: p.stem)
def test_samples_of_the_documentation(page):
    failures, tests = doctest.testfile(str(page), module_relative=False, optionflags=doctest.ELLIPSIS)
    assert tests > 3 and failures == 0


def test_fragments_of_the_documentation():
    """Blocks without a prompt: they run, too, each alone, where what they import is installed."""
    given = (
        "import numpy as np\n"
        "points = other = np.random.default_rng(0).random((50, 3))\n"
        "list_of_arrays = [points, points[:20]]\n"
    )
    ran = 0
    for page in PAGES:
        if page.name == "frameworks.md":
            continue  # test_recipes.py
        for block in re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.M | re.S):
            if ">>> " in block:
                continue
            if any(
                importlib.util.find_spec(name) is None
                for name in ("pandas", "shapely", "trimesh", "pyvista")
                if name in block
            ):
                continue
            run("-c", given + block)
            ran += 1
    assert ran >= 2


def test_no_module_imports_one_that_imports_it():
    import ast

    needs = {}
    modules = {
        ".".join(path.relative_to(PACKAGE).with_suffix("").parts): path
        for path in PACKAGE.rglob("*.py")
    }
    for module, path in modules.items():
        needs[module] = {
            ".".join((*module.split(".")[: -node.level], *filter(None, (node.module, last))))
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.ImportFrom) and node.level
            for last in (None, *(alias.name for alias in node.names))
        } & modules.keys()
    assert "_core" not in modules and "_hull" in needs["scipy._convex_hull"]
    while needs:
        free = [name for name, others in needs.items() if not others & needs.keys() - {name}]
        assert free, needs
        for name in free:
            del needs[name]


def test_import_is_light():
    loaded = run(
        "-c",
        "import sys, cullhull; print([m for m in ('scipy', 'matplotlib', 'tqdm') if m in sys.modules])",
    )
    assert loaded.strip() == "[]"


def test_modules_come_with_their_names():
    """The native module alone at first; then whatever is asked for, as if it had been there."""
    code = (
        "import sys, numpy, cullhull\n"
        "print(sorted(m for m in sys.modules if m.startswith('cullhull.')))\n"
        "print(cullhull.geo.__name__, cullhull.show.__name__, cullhull.scipy.__name__)\n"
        "print(set(cullhull.__all__) - set(dir(cullhull)), hasattr(cullhull, 'nothing'))\n"
        "from cullhull import *\n"
        "print(convex_hull is cullhull.convex_hull)"
    )
    assert run("-c", code).splitlines() == [
        "['cullhull._core']",
        "cullhull.geo cullhull.show cullhull.scipy",
        "set() False",
        "True",
    ]


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(cullhull.__file__).with_suffix(".pyi").read_text("utf-8"))
    names = [a.asname for n in tree.body if isinstance(n, ast.ImportFrom) for a in n.names]
    names += [n.name for n in tree.body if isinstance(n, ast.ClassDef)]
    assert sorted(filter(None, names)) == cullhull.__all__


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
    pytest.importorskip("dask")  # whose types cullhull.dask names
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "_core.pyi").exists()
    # With the same options in all runs the second and third read NumPy's types from the cache.
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
    shown = run("-m", "mypy", *checks, user, cwd=tmp_path)
    assert "int64" in shown or "signedinteger" in shown
    user.write_text(
        user.read_text()
        + "hull.volume = 'large'\ncullhull.convex_hull(points=1, x=2)\n"
        + "cullhull.convex_hull(np.eye(3), backend='gpu')\n"
        + "cullhull.ConvexHull(np.eye(3), cull='all')\n"
        + "cullhull.cull(np.eye(3), method='some')\n"
        + "cullhull.HullTracker(backend='gpu')\n"
    )
    wrong = python("-m", "mypy", *checks, user, cwd=tmp_path)
    assert wrong.returncode == 1
    assert all(f"user.py:{line}: error" in wrong.stdout for line in range(7, 13)), wrong.stdout


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


def test_errors_are_shown_by_the_names_of_the_package():
    import traceback

    for name in cullhull.__all__:
        kind = getattr(cullhull, name)
        if inspect.isclass(kind) and issubclass(kind, (Exception, Warning)):
            assert kind.__module__ == "cullhull" and kind.__qualname__ == name
            again = pickle.loads(pickle.dumps(kind("said")))
            assert type(again) is kind and again.args == ("said",)
    try:
        cullhull.convex_hull([[float("nan"), 0.0]])
    except ValueError as error:
        assert traceback.format_exception_only(type(error), error)[0].startswith("cullhull.NotFinite: ")


def test_every_extra_that_an_error_names_exists():
    text = (ROOT / "pyproject.toml").read_text()
    extras = set(re.findall(r"^(\w+) = \[", text.split("[project.optional-dependencies]")[1], re.M))
    named = set()
    for path in PACKAGE.rglob("*.py"):
        named |= set(re.findall(r"needed\([^)]*, \"(\w+)\"\)", path.read_text()))
        named |= set(re.findall(r"cullhull\[(\w+)\]", path.read_text()))
    assert len(named) > 8 and named <= extras
