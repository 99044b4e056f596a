"""The recipes of docs/how-to/frameworks.md: each runs as a program, and what it defines is checked."""

import importlib.util
import pathlib
import re

import pytest

import cullhull
from programs import python, with_path

HERE = pathlib.Path(__file__).resolve().parent
PAGES = [HERE.parents[2] / "docs" / "how-to" / "frameworks.md", HERE / "frameworks.md"]  # a bundle's
TEXT = next(page for page in PAGES if page.exists()).read_text()
RECIPES = re.findall(r"^```python\n(.*?)^```$", TEXT, re.M | re.S)
PACKAGES = {"torch": "PyTorch", "jax": "JAX", "cupy": "CuPy", "warp": "Warp"}

BEFORE = {
    # The default compiles C++, which takes a minute and a compiler. All that comes before is the same.
    "torch.compile": """
import functools, os, torch
if not os.environ.get("CULLHULL_RECIPES_COMPILE"):
    torch.compile = functools.partial(torch.compile, backend="aot_eager")
""",
}
AFTER = {
    "def triangles(": """
torch.library.opcheck(triangles, (points,))
torch.library.opcheck(triangles, (points.detach()[:, :1].expand(-1, 3),))
hull = cullhull.convex_hull(points.detach())
assert abs(volume(points) - hull.volume) < 1e-9 and abs(area(points) - hull.area) < 1e-9
moving = torch.autograd.grad(area(points), points)[0].any(dim=1).nonzero().flatten()
assert moving.tolist() == sorted(hull.vertices.tolist())
more = torch.randn(25, 3, dtype=torch.float64, device=device)
assert torch.allclose(compiled(more), volume(more))
compiled(points).backward()
assert torch.allclose(points.grad, 2 * torch.autograd.grad(volume(points), points)[0])
assert volume(torch.zeros(9, 3, device=device)) == 0
try:
    cullhull.convex_hull(points)
    raise AssertionError("a tensor that requires a gradient was taken")
except cullhull.InvalidArgument as error:
    assert "detach()" in str(error) or "requires grad" in str(error), error
""",
    "def simplices_of_sets(": """
torch.library.opcheck(simplices_of_sets, (sets,))
for d in (2, 4):
    some = torch.randn(2, 8, d, dtype=torch.float64, device=device, requires_grad=True)
    assert torch.autograd.gradcheck(volumes, some)
mixed = sets.detach().clone()
mixed[1, :, 2] = 0.5  # in a plane
mixed[2] = 0
found = volumes(mixed)
expected = torch.tensor(cullhull.convex_hulls(mixed.cpu()).volumes, device=device)
assert torch.allclose(found[0], expected[0]) and found[1] == found[2] == 0
compiled = torch.compile(simplices_of_sets, fullgraph=True)
assert all(map(torch.equal, compiled(sets.detach()), simplices_of_sets(sets.detach())))
""",
    "def padded_simplices(": """
from jax.test_util import check_grads
jax.config.update("jax_enable_x64", True)
rows = jnp.asarray(np.random.default_rng(0).normal(size=(30, 3)))
for function in (volume, area):
    check_grads(function, (rows,), order=1, modes=("fwd", "rev"))
check_grads(volume, (rows[:, :2],), order=1, modes=("fwd", "rev"))
hull = cullhull.convex_hull(rows)
assert np.isclose(volume(rows), hull.volume) and np.isclose(area(rows), hull.area)
moving = np.flatnonzero(np.asarray(jax.grad(area)(rows)).any(axis=1))
assert np.array_equal(moving, np.sort(hull.vertices))
flat = rows.at[:, 2].set(0.5)
assert volume(flat) == 0 and not np.isnan(jax.grad(area)(flat)).any()
sphere = rows / jnp.linalg.norm(rows, axis=1, keepdims=True)  # as many triangles as there may be
assert (np.asarray(simplices(sphere)) >= 0).all() and np.isclose(volume(sphere), cullhull.convex_hull(sphere).volume)
assert jax.vmap(jax.grad(volume))(jnp.stack([rows, sphere, flat])).shape == (3, 30, 3)
assert np.asarray(hull.contains(rows)).all() and cullhull.convex_hulls(jnp.stack([rows, rows])).volumes[1] == hull.volume
""",
    "def add_volumes(": """
for kind in (wp.vec3, wp.vec3d):
    array = wp.array(rows, dtype=kind, device=device)
    plain = cullhull.convex_hull(rows.astype(np.float32 if kind is wp.vec3 else np.float64))
    assert cullhull.convex_hull(array).volume == plain.volume
plane = wp.array(rows[:, :2], dtype=wp.vec2d, device=device)
assert cullhull.convex_hull(plane).volume == cullhull.convex_hull(rows[:, :2]).volume
sets = wp.array(rows.reshape(20, 50, 3), dtype=wp.vec3d, device=device)
assert np.array_equal(cullhull.convex_hulls(sets).volumes, cullhull.convex_hulls(rows.reshape(20, 50, 3)).volumes)
if use_device:
    inside = wp.from_dlpack(hull.sides(points, on_device=True))
    assert np.array_equal(inside.numpy(), hull.sides(rows))
""",
}


def package(recipe):
    return next(name for name in PACKAGES if re.search(rf"^import {name}\b", recipe, re.M))


def named(recipe):
    return f"{package(recipe)}-{RECIPES.index(recipe)}"


def test_the_page_has_recipes_for_every_package():
    assert {package(recipe) for recipe in RECIPES} == set(PACKAGES)
    for marks in (BEFORE, AFTER):
        assert all(any(mark in recipe for recipe in RECIPES) for mark in marks)


@pytest.mark.parametrize("recipe", RECIPES, ids=named)
def test_recipe(recipe, tmp_path):
    name = package(recipe)
    if importlib.util.find_spec(name) is None:
        pytest.skip(f"{PACKAGES[name]} is not installed")
    if name == "cupy" and not cullhull.cuda_status()["available"]:
        pytest.skip("CuPy needs a CUDA device")
    parts = [text for mark, text in BEFORE.items() if mark in recipe]
    parts += [recipe, *(text for mark, text in AFTER.items() if mark in recipe)]
    program = tmp_path / "recipe.py"  # a file: Warp reads the source of its kernels
    program.write_text("".join(parts))
    # The package that was imported here, wherever the program starts.
    path = with_path(pathlib.Path(cullhull.__file__).parents[1])
    done = python(program, timeout=500, cwd=tmp_path, env=path)
    assert done.returncode == 0, done.stdout + done.stderr
