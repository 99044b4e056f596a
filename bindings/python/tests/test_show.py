"""Pictures and the command line."""

import json
from pathlib import Path

import numpy as np
import pytest

import cullhull
from programs import run


def parsed(html):
    import xml.dom.minidom

    return xml.dom.minidom.parseString(html)


@pytest.mark.parametrize("dimension", [1, 2, 3, 5])
@pytest.mark.parametrize("flat", [False, True])
def test_notebook(dimension, flat):
    points = cullhull.generate("cube", 60, dimension)
    if flat:
        points[:, -1] = 0.5
    hull = cullhull.convex_hull(points, certify=True)
    page = parsed(hull._repr_html_())
    assert f"{len(hull.vertices)}" in page.toxml() and repr(hull).startswith("<Hull of 60 points")
    drawn = len(page.getElementsByTagName("polygon"))
    if dimension == 3 and not flat:
        towards = hull.facet_planes[:, :3] @ [-0.433, -0.75, -0.5]
        assert drawn == (towards > 0).sum() and 0 < drawn < hull.facet_count
    elif hull.affine_dimension == 2 and dimension in (2, 3):
        assert drawn == 1 or dimension == 2
    else:
        assert drawn == 0


def test_notebook_of_nothing():
    parsed(cullhull.convex_hull(np.empty((0, 3)))._repr_html_())


@pytest.mark.parametrize("dimension, k", [(2, 2), (2, 1), (2, 0), (3, 3), (3, 2), (3, 1), (3, -1)])
def test_plot(dimension, k):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rng = np.random.default_rng(0)
    points = rng.integers(0, 9, (20, max(k, 0))) @ rng.integers(0, 9, (max(k, 0), dimension)) + 1
    if k < 0:
        points = points[:0]
    elif k == dimension:
        points = rng.random((20, dimension))
    hull = cullhull.convex_hull(points)
    axes = hull.plot(facecolor="red") if k >= 2 else hull.plot()
    assert len(axes.collections) == (k >= 1)
    axes.figure.canvas.draw()
    low, high = axes.get_xlim()
    assert k < 0 or (low <= points[:, 0].min() and points[:, 0].max() <= high)
    assert hull.plot(axes) is axes
    plt.close("all")


def test_plot_of_other_dimensions():
    with pytest.raises(ValueError, match="4D"):
        cullhull.convex_hull(np.eye(4)).plot()


def test_save(tmp_path):
    points = cullhull.generate("ball", 1000, 3)
    hull = cullhull.convex_hull(points)
    hull.save(tmp_path / "all.json", points)
    written = json.loads((tmp_path / "all.json").read_text())
    assert written["vertices"] == hull.vertices.tolist()
    assert written["points"]["count"] == 1000
    hull.save(str(tmp_path / "alone.json"))
    written = json.loads((tmp_path / "alone.json").read_text())
    assert written["points"]["count"] == len(hull.vertices)
    hull.save(tmp_path / "mesh.ply")
    assert cullhull.convex_hull(np.eye(3)).save(tmp_path / "mesh.off") is None
    with pytest.raises(OSError):
        hull.save(tmp_path / "no" / "such" / "folder.ply")
    with pytest.raises(ValueError):
        hull.save(tmp_path / "file.docx")
    with pytest.raises(ValueError):
        cullhull.convex_hull(np.eye(5)).save(tmp_path / "mesh.ply")


def test_command_line(tmp_path):
    points = cullhull.generate("ball", 5000, 3)
    np.save(tmp_path / "points.npy", points)
    done = run("hull", "points.npy", "--vertices", "ids.npy", "--json", cwd=tmp_path)
    hull = cullhull.convex_hull(points)
    assert done.returncode == 0 and json.loads(done.stdout)["volume"] == hull.volume
    assert np.array_equal(np.load(tmp_path / "ids.npy"), np.sort(hull.vertices))
    hull.save(tmp_path / "hull.json", points)
    assert run("certify", "points.npy", "hull.json", cwd=tmp_path).returncode == 0
    assert run("--version").stdout.strip() == cullhull.__version__
    missing = run("hull", "absent.npy", cwd=tmp_path)
    assert missing.returncode == 1 and "absent.npy" in missing.stderr
    assert run("nonsense").returncode == 2


def test_view(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    points = cullhull.generate("ball", 500, 3)
    hull = cullhull.convex_hull(points)
    try:
        page = hull.view(path=tmp_path / "hull.html", show=False)
    except cullhull.BackendUnavailable as error:
        pytest.skip(str(error))  # built without three.js
    assert not opened and page == str(tmp_path / "hull.html")
    assert "<html" in (tmp_path / "hull.html").read_text()
    temporary = hull.view(points)
    assert opened == [Path(temporary).as_uri()]
    with pytest.raises(cullhull.Error):
        hull.view(path=tmp_path / "no" / "folder.html")


def test_convex_hull_plot_2d_draws_what_scipys_does():
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    spatial = pytest.importorskip("scipy.spatial", reason="scipy is not installed")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    points = np.random.default_rng(3).random((30, 2))
    ours = cullhull.convex_hull_plot_2d(cullhull.ConvexHull(points)).axes[0]
    theirs = spatial.convex_hull_plot_2d(spatial.ConvexHull(points)).axes[0]
    native = cullhull.convex_hull_plot_2d(cullhull.convex_hull(points)).axes[0]
    assert np.array_equal(ours.lines[0].get_xydata(), theirs.lines[0].get_xydata())
    assert ours.get_xlim() == theirs.get_xlim() and ours.get_ylim() == theirs.get_ylim()

    def edges(axes):
        return sorted(sorted(map(tuple, e)) for e in axes.collections[0].get_segments())

    assert edges(ours) == edges(theirs) == edges(native)
    assert cullhull.convex_hull_plot_2d(cullhull.ConvexHull(points), ours) is ours.figure
    with pytest.raises(ValueError, match="Convex hull is not 2-D"):
        cullhull.convex_hull_plot_2d(cullhull.ConvexHull(np.eye(3)))
    plt.close("all")


def test_notebooks_name_the_measures_of_the_dimension():
    def rows(points):
        page = parsed(cullhull.convex_hull(points)._repr_html_())
        heads = page.getElementsByTagName("th")
        return {h.firstChild.data: h.nextSibling.firstChild.data for h in heads}

    square = rows([[0, 0], [2, 0], [2, 3], [0, 3]])
    assert square["area"] == "6" and square["perimeter"] == "10" and "volume" not in square
    flat = rows([[0, 0, 1], [2, 0, 1], [2, 3, 1], [0, 3, 1]])
    assert flat["area"] == "6" and flat["perimeter"] == "10" and "volume" not in flat
    cube = rows(np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]))
    assert cube["volume"] == "1" and cube["area"] == "6" and "perimeter" not in cube
    line = rows([[0, 0], [3, 4]])
    assert line["length"] == "5" and not {"area", "perimeter", "volume"} & set(line)
    point = rows([[3, 4]])
    assert not {"area", "perimeter", "volume", "length"} & set(point)


def test_a_surface_of_many_facets_is_opaque_and_lit():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    hull = cullhull.convex_hull(cullhull.generate("sphere", 400, 3))
    faces = hull.plot().collections[0]
    faces.axes.figure.canvas.draw()
    colours = faces.get_facecolor()
    assert (colours[:, 3] == 1).all() and len(np.unique(colours, axis=0)) > 100
    assert faces.get_linewidth()[0] < 0.3
    assert np.allclose(hull.plot(facecolor="red").collections[0].get_facecolor()[0, :3], [1, 0, 0])
    few = cullhull.convex_hull(cullhull.generate("sphere", 20, 3)).plot().collections[0]
    assert few.get_alpha() == 0.4


def scene_of(path):
    text = path.read_text()
    begin = text.index(">", text.index('id="scene"')) + 1
    return json.loads(text[begin : text.index("</script>", begin)])


@pytest.mark.parametrize("dimension", [2, 3])
def test_pages_of_diagrams_have_their_sites(tmp_path, dimension):
    points = np.random.default_rng(5).random((30, dimension))
    cells = cullhull.voronoi(points).clip(points.min(axis=0), points.max(axis=0))
    try:
        cells.view(tmp_path / "cells.html", show=False)
    except cullhull.BackendUnavailable:
        pytest.skip("built without three.js")
    (frame,) = scene_of(tmp_path / "cells.html")["frames"]
    assert frame["survivors"] == 30 and frame["point_name"] == "Site"
    assert frame["measures"][1] == 30
    assert frame["ids"][1] == frame["vertices"] + 30
    assert frame["report"]["points"]["count"] == 30
