#!/usr/bin/env python3
"""browser_test.py CULLHULL: the pages cullhull writes, opened in a browser from file://."""
import json
import math
import os
import random
import subprocess
import time
import unittest

import pages
from browser import pixels_changed
from pages import APP, app, path

MOST_BYTES = 12_000_000


def setUpModule():
    global browser
    browser = pages.begin()


def tearDownModule():
    pages.end()


def generated(name, *arguments):
    app("generate", *arguments, "-o", path(name))
    return path(name)


def written(name, rows):
    with open(path(name), "w") as file:
        file.writelines(" ".join(repr(float(x)) for x in row) + "\n" for row in rows)
    return path(name)


def flattened(report, prefix=""):
    for key, value in report.items():
        if isinstance(value, dict):
            yield from flattened(value, prefix + key + ".")
        elif value != []:
            yield prefix + key, value


class Page(unittest.TestCase):
    def view(self, source, *options):
        """Makes and opens a page; the report that was written beside it."""
        page, report = source + ".html", source + ".report.json"
        app("view", source, "-o", page, f"--json={report}", *options)
        self.assertLess(os.path.getsize(page), MOST_BYTES)
        browser.screen(1000, 700)
        self.assertEqual(browser.open(page), [])
        self.page = page
        with open(report) as file:
            written = json.load(file)
        return written["frames"] if written["kind"] == "view_report" else written

    def key(self, *keys):
        from selenium.webdriver.common.action_chains import ActionChains

        def press():
            canvas = browser.driver.find_element("id", "canvas")
            browser.run("arguments[0].focus()", canvas)
            ActionChains(browser.driver).send_keys(*keys).perform()

        browser.doing(press)

    def click(self, element_id):
        browser.doing(lambda: browser.driver.find_element("id", element_id).click())

    def text(self, element_id):
        return browser.run("return document.getElementById(arguments[0]).innerText", element_id)

    def expect_not_blank(self, least):
        """So many pixels below the buttons are not the paper's, with the axes switched off."""
        from PIL import ImageColor

        self.click("show-axes")
        picture = browser.picture("canvas")
        picture = picture.crop((0, 60, picture.width, picture.height))
        paper = ImageColor.getrgb(browser.run(
            "return getComputedStyle(document.documentElement).getPropertyValue('--paper').trim()"))
        colours = picture.getcolors(maxcolors=1 << 24)
        self.assertGreater(sum(count for count, colour in colours if colour != paper), least)
        self.click("show-axes")

    def expect_figures(self, report):
        cells = browser.run(
            "return [...document.querySelectorAll('td[data-key]')]"
            ".map(c => [c.dataset.key, c.dataset.value, c.innerText, c.title])")
        expected = dict(flattened(report))
        for key in ("schema", "kind"):  # of the report, not of the hull
            expected.pop(key)
        unknown = [k for k, v in expected.items() if v is None and k.startswith("placement.")]
        for key in unknown:  # what a file does not say is no figure
            expected.pop(key)
        if expected.get("cull.method") == "none":  # nothing was filtered
            expected.pop("cull.survivors", None)
        self.assertEqual({k: json.loads(v) for k, v, *_ in cells}, expected)
        for key, value, text, whole in cells:
            value = json.loads(value)
            if key == "placement.numbers":
                self.assertNotIn(text, ("", value))
            elif isinstance(value, str):
                self.assertIn(text, (value, "beyond the doubles"))
            elif isinstance(value, (int, float)) and not isinstance(value, bool):
                read = text.replace(",", "").replace("−", "-")
                number = float(read.split()[0])
                unit = {"ms": 1e-3, "MB": 1e6}.get(read.split()[-1], 1)
                whole_part, _, rest = read.split()[0].split("e")[0].lstrip("-").partition(".")
                digits = (whole_part + rest).lstrip("0")
                # Large numbers have all digits before the point, and one behind it.
                self.assertTrue(len(digits) <= 6 or (len(whole_part) > 5 and len(rest) <= 1), key)
                timed = "seconds" in key or "bytes" in key
                allowed = max(0.0051 * abs(value), 0.051 * unit) if timed else 5e-6 * abs(value)
                self.assertLessEqual(abs(number * unit - value), allowed, key)
                if number * unit != value:  # then a hover shows all digits
                    self.assertEqual(float(whole), value, key)

    def expect_figures_whole(self):
        """Every number stands on one line, and the panel is wide enough for it."""
        lines = browser.run("""
            const range = document.createRange();
            return [...document.querySelectorAll('td.number')].flatMap((cell) => {
              const texts = [...cell.childNodes].map((n) => n.firstChild || n);
              return texts.map((t) => (range.selectNode(t), [t.data, range.getClientRects().length]));
            });""")
        self.assertGreater(len(lines), 5)
        self.assertEqual([text for text, count in lines if count != 1], [])
        spare = browser.run(
            "const p = document.querySelector('.panel'); return p.clientWidth - p.scrollWidth")
        self.assertGreaterEqual(spare, 0)

    def expect_toggles_work(self, wanted):
        enabled = browser.run(
            "return [...document.querySelectorAll('#toggles input:not(:disabled)')].map(b => b.id)")
        self.assertEqual(sorted(enabled), sorted("show-" + name for name in wanted))
        whole = browser.picture()
        for toggle in enabled:
            self.click(toggle)
            self.assertGreater(pixels_changed(whole, browser.picture()), 15, toggle)
            self.click(toggle)
            self.assertEqual(pixels_changed(whole, browser.picture()), 0, toggle)


class Static(Page):
    def test_solid(self):
        source = generated("ball.npy", "ball", "-n", "200k", "-d", "3")
        report = self.view(source)
        self.expect_figures(report)
        alone = json.loads(app("hull", source, "--json", "-q"))
        for name in ("points", "vertex_count", "facet_count", "area", "volume", "centroid"):
            self.assertEqual(report[name], alone[name])
        self.assertEqual(report["cull"]["survivors"], alone["cull"]["survivors"])
        self.expect_not_blank(10_000)
        everything = ("points", "survivors", "vertices", "faces", "edges", "axes")
        self.expect_toggles_work(everything)

    def test_turning_zooming_and_back(self):
        from selenium.webdriver.common.action_chains import ActionChains

        self.view(generated("cube.npy", "cube", "-n", "5k", "-d", "3"))
        whole = browser.picture()
        canvas = browser.driver.find_element("id", "canvas")

        def drag():
            ActionChains(browser.driver).drag_and_drop_by_offset(canvas, 120, 40).perform()

        def wheel():
            browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
                "type": "mouseWheel", "x": 300, "y": 300, "deltaX": 0, "deltaY": -240})

        for act in (drag, wheel, lambda: canvas.send_keys("+"), lambda: canvas.send_keys("\ue012"),
                    lambda: browser.driver.find_element("id", "nearer").click()):
            before = browser.picture()
            browser.doing(act)
            self.assertGreater(pixels_changed(before, browser.picture()), 100)
        self.click("reset")
        # Below the buttons: the one under the mouse looks different.
        below = (0, 60, whole.width, whole.height)
        self.assertEqual(pixels_changed(whole.crop(below), browser.picture().crop(below)), 0)
        self.assertEqual(browser.complaints(self.page), [])

    def test_picking(self):
        source = generated("few.npy", "ball", "-n", "300", "-d", "3")
        self.view(source)
        app("hull", source, "-o", path("few.json"), "-q")
        with open(path("few.json")) as file:
            hull = json.load(file)
        for vertex in range(3):
            self.key("n")
            shown = self.text("picked").replace("−", "-").split()
            self.assertEqual(shown[:2], ["Vertex", str(hull["vertices"][vertex])])
            self.assertEqual([float(x) for x in shown[3::2]], hull["vertex_coordinates"][vertex])
        self.key("\ue00c")  # Escape
        self.assertIn("Click", self.text("picked"))

    def click_at(self, x, y):
        from selenium.webdriver.common.action_chains import ActionChains

        canvas = browser.driver.find_element("id", "canvas")
        box = canvas.rect
        offset = (round(x - box["width"] / 2), round(y - box["height"] / 2))
        browser.doing(lambda: ActionChains(browser.driver)
                      .move_to_element_with_offset(canvas, *offset).click().perform())

    def rows_of_box(self, element_id):
        return dict(browser.run(
            "return [...document.querySelectorAll(`#${arguments[0]} tr`)]"
            ".map(r => [r.cells[0].textContent, r.cells[1].title || r.cells[1].textContent])", element_id))

    def choose(self, element_id, value):
        browser.doing(lambda: browser.run(
            "const s = document.getElementById(arguments[0]); s.value = arguments[1];"
            "s.dispatchEvent(new Event('input', {bubbles: true}));"
            "s.dispatchEvent(new Event('change', {bubbles: true}))", element_id, value))

    def test_facets_are_picked(self):
        """A box: each facet is four corners, and its plane is that of the hull's own file."""
        corners = [(x, y, z) for x in (0, 2) for y in (0, 3) for z in (0, 5)]
        source = written("box.txt", corners)
        self.view(source)
        app("hull", source, "-o", path("box.json"), "-q")
        with open(path("box.json")) as file:
            hull = json.load(file)
        bare = browser.picture()
        for facet in range(6):
            self.key("]")
            self.assertIn(f"Facet {facet}", self.text("picked"))
            shown = self.rows_of_box("picked")
            self.assertEqual(sorted(int(c) for c in shown["Corners"].split(",")), sorted(hull["facets"][facet]))
            plane = [float(shown[k].replace("−", "-")) for k in ("Normal x", "Normal y", "Normal z", "Offset")]
            self.assertEqual(plane, [x + 0.0 for x in hull["facet_planes"][facet]])
            self.assertIn(float(shown["Area"]), (6, 10, 15))
        self.key("\ue00c")  # Escape
        browser.run("document.activeElement.blur()")
        self.assertEqual(pixels_changed(bare, browser.picture()), 0)
        stage = browser.driver.find_element("id", "canvas").rect
        self.click_at(stage["width"] / 2 + 15, stage["height"] / 2 + 25)
        self.assertIn("Facet", self.text("picked"))
        self.assertGreater(pixels_changed(bare, browser.picture()), 2000)

    def test_measuring(self):
        self.view(written("pair.txt", [(0, 0), (3, 4)]))
        from_to = browser.run(
            "const s = document.getElementById('canvas').getBoundingClientRect(); return [s.width, s.height]")
        self.key("m")
        self.assertIn("Click", self.text("measured"))
        places = browser.run(
            "return [0, 1].map(row => viewer.rig.project(viewer.placed(row)).slice(0, 2))")
        for x, y in places:
            self.assertTrue(0 < x < from_to[0] and 0 < y < from_to[1])
            self.click_at(x, y)
        self.assertEqual(float(self.rows_of_box("measured")["Distance"]), 5)
        self.key("\ue00c")
        self.assertFalse(browser.driver.find_element("id", "measured").is_displayed())

    def test_clipping(self):
        self.view(generated("clip.npy", "ball", "-n", "20k", "-d", "3"))
        whole = browser.picture()
        self.choose("clip-axis", "0")
        half = browser.picture()
        self.assertGreater(pixels_changed(whole, half), 5000)
        self.click("clip-flip")
        self.assertGreater(pixels_changed(half, browser.picture()), 5000)
        self.choose("clip-axis", "")
        browser.run("document.activeElement.blur()")
        self.assertEqual(pixels_changed(whole, browser.picture()), 0)

    def cells(self, source):
        """Those that `cullhull delaunay` writes, as sets of ids."""
        app("delaunay", source, "-o", source + ".cells.json", "-q")
        with open(source + ".cells.json") as file:
            return {frozenset(cell) for cell in json.load(file)["cells"]}

    def shown_cells(self):
        """Those of the page."""
        return {frozenset(cell) for cell in browser.run("""
            const f = viewer.frame, k = f.cell_corners, out = [];
            for (let i = 0; i < f.cells.length; i += k) out.push([...f.cells.slice(i, i + k)].map(r => f.ids[r]));
            return out;""")}

    def drawn_polygons(self):
        """The triangles of the cells' part, in the picture's units, and how many lines are around."""
        return browser.run("""
            const p = viewer.stage.parts, at = p.cells.geometry.attributes.position.array;
            return [[...at], p.cellEdges.geometry.attributes.position.array.length / 6];""")

    def test_cells_of_the_plane(self):
        # A grid's ties are cut by ids, and equal points are one.
        rows = [(x, y) for x in range(12) for y in range(9)] + [(3, 3), (0.5, 0.25), (7.3, 2.1)]
        source = written("cells.txt", rows)
        self.view(source, "--delaunay")
        wanted = self.cells(source)
        self.assertEqual(self.shown_cells(), wanted)
        self.assertIn(f"{len(wanted)} Delaunay cells of all points", self.text("notes"))
        places, lines = self.drawn_polygons()
        self.assertEqual(lines, 3 * len(wanted))
        area = 0
        for i in range(0, len(places), 9):
            (ax, ay), (bx, by), (cx, cy) = (places[i + 3 * k:i + 3 * k + 2] for k in range(3))
            area += ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
        self.assertAlmostEqual(area, 4 * 8 / 11, places=4)  # 11 by 8, the longer side 2
        self.expect_not_blank(10_000)
        self.expect_toggles_work(("survivors", "vertices", "faces", "cells", "edges", "axes"))

    def test_the_outline_is_its_boundary(self):
        # Two squares that share a corner's neighbourhood, with a bay between them.
        source = written("bay.txt", [(x, y) for x in range(12) for y in range(12) if not (4 <= x < 8 and y > 3)])
        self.view(source, "--outline")
        app("alpha", source, "-o", path("bay.json"), "-q")
        with open(path("bay.json")) as file:
            shape = json.load(file)
        self.assertEqual(self.shown_cells(), {frozenset(cell) for cell in shape["cells"]})
        places, lines = self.drawn_polygons()
        self.assertEqual((len(places), lines), (9 * len(shape["cells"]), len(shape["facets"])))
        self.assertLess(len(shape["cells"]), len(self.cells(source)))
        self.assertIn("in the outline (alpha shape)", self.text("notes"))

    def test_cells_of_space_are_cut(self):
        source = generated("cut.npy", "ball", "-n", "700", "-d", "3")
        self.view(source, "--delaunay")
        self.assertEqual(self.shown_cells(), self.cells(source))
        middle, _ = self.drawn_polygons()
        # The plane y = const through the middle: all of it lies there, and its area is that of the
        # hull's section, found from where the plane cuts the hull's edges (these are few).
        ys = {round(y, 5) for y in middle[1::3]}
        self.assertEqual(len(ys), 1)
        area = 0
        for i in range(0, len(middle), 9):
            (ax, _, az), (bx, _, bz), (cx, _, cz) = (middle[i + 3 * k:i + 3 * k + 3] for k in range(3))
            area += abs((bx - ax) * (cz - az) - (bz - az) * (cx - ax)) / 2
        section = sorted(browser.run("""
            const f = viewer.frame, at = viewer.stage.hull, w = arguments[0], out = [];
            for (let i = 0; i < f.edges.length; i += 2) {
              const [a, b] = [3 * f.edges[i], 3 * f.edges[i + 1]];
              const s = at[a + 1] - w, t = at[b + 1] - w;
              if ((s > 0) === (t > 0)) continue;
              const u = s / (s - t);
              out.push([at[a] + u * (at[b] - at[a]), at[a + 2] + u * (at[b + 2] - at[a + 2])]);
            }
            return out;""", min(ys)), key=lambda p: math.atan2(p[1], p[0]))
        ring = zip(section, section[1:] + section[:1])
        self.assertAlmostEqual(area, sum(a[0] * b[1] - a[1] * b[0] for a, b in ring) / 2, places=3)
        half = browser.picture()
        self.click("show-cells")
        self.assertGreater(pixels_changed(half, browser.picture()), 2000)
        self.click("show-cells")
        self.click("clip-flip")
        self.assertGreater(pixels_changed(half, browser.picture()), 5000)
        self.choose("clip-axis", "2")
        self.assertNotEqual(self.drawn_polygons()[0], middle)
        self.choose("clip-axis", "")
        self.assertEqual(self.drawn_polygons(), [[], 0])

    def test_cells_of_flats_and_few_points(self):
        for name, rows, cells in (("one", [(1, 2)], 0), ("two", [(1, 2), (3, 4)], 0),
                                  ("line", [(0, 0), (1, 1), (3, 3)], 0),
                                  ("three", [(0, 0), (1, 0), (0, 1)], 1),
                                  ("plane", [(0, 0, 0), (1, 0, 1), (0, 1, 2), (1, 1, 3)], 2)):
            self.view(written(f"flat-{name}.txt", rows), "--delaunay")
            self.assertEqual(len(self.drawn_polygons()[0]), 9 * cells, name)
            self.assertEqual(browser.complaints(self.page), [])

    def test_many_cells_are_those_of_a_sample(self):
        self.view(generated("many.npy", "cube", "-n", "60k", "-d", "3"), "--delaunay")
        shown = browser.run("return [viewer.frame.cells.length / 4, viewer.frame.cell_points]")
        self.assertTrue(20_000 < shown[1] < 60_000 and shown[0] > 5 * shown[1], shown)
        self.assertIn("a fair sample, seen where", self.text("notes"))
        self.assertGreater(len(self.drawn_polygons()[0]), 1000)

    def test_saving(self):
        """The PNG is the picture; the mesh has the hull that the program finds, bit for bit."""
        from PIL import Image

        source = generated("save.npy", "cube", "-n", "2k", "-d", "3")
        report = self.view(source)
        browser.driver.execute_cdp_cmd(
            "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": os.path.dirname(path(""))})
        for button, name in (("save-picture", "save.png"), ("save-mesh", "save-hull.ply")):
            browser.driver.find_element("id", button).click()
            end = time.monotonic() + 30
            while not os.path.exists(path(name)) and time.monotonic() < end:
                time.sleep(0.05)
        self.assertEqual(browser.complaints(self.page), [])
        picture = Image.open(path("save.png")).convert("RGB")
        self.assertEqual(picture.size, browser.picture("canvas").size)
        self.assertGreater(len(picture.getcolors(maxcolors=1 << 24)), 100)
        again = json.loads(app("hull", path("save-hull.ply"), "--json", "-q"))
        for name in ("vertex_count", "facet_count", "simplex_count"):
            self.assertEqual(again[name], report[name])
        self.assertEqual(float(again["volume"]).hex(), float(report["volume"]).hex())

    def test_landscape_opens_in_colours_of_height(self):
        draw = random.Random(7)
        rows = [(1000 * draw.random(), 1000 * draw.random(), 40 * draw.random()) for _ in range(3000)]
        self.view(written("land.txt", rows))
        self.assertEqual(browser.run("return document.getElementById('proportions').value"), "4")
        self.assertEqual(browser.run("return document.getElementById('colour-by').value"), "2")
        coloured = browser.picture()
        self.assertGreater(len(coloured.getcolors(maxcolors=1 << 24)), 500)
        self.assertTrue(browser.driver.find_element("id", "legend").is_displayed())
        self.choose("colour-by", "role")
        self.assertGreater(pixels_changed(coloured, browser.picture()), 2000)
        self.assertFalse(browser.driver.find_element("id", "legend").is_displayed())

    def test_colours_of_the_file(self):
        head = ("ply\nformat ascii 1.0\nelement vertex 600\nproperty float x\nproperty float y\n"
                "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                "end_header\n")
        draw = random.Random(8)
        with open(path("red.ply"), "w") as file:
            file.write(head)
            for _ in range(600):
                file.write(" ".join(str(draw.uniform(-1, 1)) for _ in range(3)) + " 250 10 20\n")
        self.view(path("red.ply"))
        self.assertEqual(browser.run("return document.getElementById('colour-by').value"), "file")
        red = lambda: sum(n for n, (r, g, b) in browser.picture().getcolors(maxcolors=1 << 24)
                          if r > 150 and r > 1.6 * g and r > 1.6 * b)
        coloured = red()
        self.assertGreater(coloured, 300)
        self.choose("colour-by", "role")
        self.assertLess(red(), coloured / 4)  # the orange of survivors comes near

    def test_one_point_is_picked_by_a_click(self):
        self.view(written("one.txt", [(3, 4, 5)] * 3))
        self.expect_not_blank(20)
        self.click("canvas")  # its middle
        self.assertEqual(self.text("picked").split(), ["Vertex", "0", "x", "3", "y", "4", "z", "5"])

    def test_three_points(self):
        self.expect_figures(self.view(written("three.txt", [(0, 0, 0), (1, 0, 0.2), (0, 1, 0.5)])))
        self.expect_not_blank(2000)
        self.assertIn("They lie in a plane", self.text("summary"))
        self.expect_toggles_work(("vertices", "faces", "edges", "axes"))

    def test_flat_set(self):
        draw = random.Random(4)
        points = [(draw.randrange(500), draw.randrange(500)) for _ in range(2000)]
        self.expect_figures(self.view(written("flat.txt", [(x, y, x + 2 * y) for x, y in points])))
        self.expect_not_blank(2000)
        self.assertIn("They lie in a plane", self.text("summary"))

    def test_line(self):
        self.expect_figures(self.view(written("line.txt", [(k, 2 * k, 3 * k) for k in range(30)])))
        self.expect_not_blank(100)

    def test_no_points(self):
        import struct

        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (0, 3), }".ljust(117) + b"\n"
        with open(path("none.npy"), "wb") as file:
            file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
        self.view(path("none.npy"))
        self.assertIn("no points", self.text("message"))

    def test_huge_coordinates(self):
        draw = random.Random(5)
        rows = [[1.7e308 * draw.uniform(-1, 1) for _ in range(3)] for _ in range(500)]
        self.expect_figures(self.view(written("huge.txt", rows)))
        self.expect_not_blank(5000)

    def test_no_figure_is_broken(self):
        draw = random.Random(6)
        for name, size, d in (("long.txt", 1e5, 3), ("tiny.txt", 1e-60, 4), ("large.txt", 1e60, 4)):
            rows = [[size * draw.uniform(-1, 1) for _ in range(d)] for _ in range(200)]
            self.view(written(name, rows))
            self.key("n")  # a vertex and its coordinates
            self.expect_figures_whole()
            browser.doing(lambda: browser.screen(320, 700))
            self.expect_figures_whole()

    def test_plot(self):
        source = generated("disk.npy", "ball", "-n", "1200k", "-d", "2")
        self.expect_figures(self.view(source))
        self.expect_not_blank(5000)
        self.expect_toggles_work(("points", "survivors", "vertices", "faces", "edges", "axes"))
        before = browser.picture()
        self.key("+")
        self.assertGreater(pixels_changed(before, browser.picture()), 1000)

    def test_five_dimensions(self):
        from selenium.webdriver.support.ui import Select

        self.expect_figures(self.view(generated("d5.npy", "gauss", "-n", "3k", "-d", "5")))
        self.expect_not_blank(5000)
        before = browser.picture()
        choice = Select(browser.driver.find_element("id", "axis-0"))
        browser.doing(lambda: choice.select_by_visible_text("x5"))
        self.assertGreater(pixels_changed(before, browser.picture()), 1000)
        after = browser.picture()
        choice = Select(browser.driver.find_element("id", "axis-2"))
        browser.doing(lambda: choice.select_by_visible_text("x5"))  # changes places with the first
        self.assertEqual(browser.run("return document.getElementById('axis-0').value"), "2")
        self.assertGreater(pixels_changed(after, browser.picture()), 1000)
        # A plot of each pair of axes; its outline is the hull of the projections.
        self.assertEqual(browser.run("return document.querySelectorAll('#pairs button').length"), 10)
        self.click("pair-1-3")
        self.assertEqual([browser.run("return document.getElementById(arguments[0]).value", f"axis-{i}")
                          for i in range(3)], ["1", "3", "-1"])
        corners = browser.run(
            "return [...new Set(viewer.shape.edges)].map(row => viewer.frame.ids[row]).sort((a, b) => a - b)")
        app("hull", path("d5.npy"), "--columns", "1,3", "--json=" + path("plane.json"), "--vertices",
            path("plane.csv"), "-q")
        with open(path("plane.csv")) as file:
            self.assertEqual(corners, [int(line) for line in file.readlines()[1:]])
        self.assertGreater(pixels_changed(after, browser.picture()), 1000)

    def test_hull_file(self):
        source = generated("h.npy", "cube", "-n", "20k", "-d", "3")
        app("hull", source, "-o", path("h.json"), "-q")
        report = self.view(path("h.json"))
        self.expect_figures(report)
        self.assertNotIn("threads", report)
        self.expect_not_blank(5000)
        self.assertIn("without its points", self.text("notes"))

    def test_eight_million_points(self):
        report = self.view(generated("big.npy", "ball", "-n", "8M", "-d", "3", "--type", "f32"))
        os.remove(path("big.npy"))
        self.expect_figures(report)
        self.expect_not_blank(10_000)
        self.assertIn("a fair sample", self.text("notes"))

    def test_hull_too_large_for_a_page(self):
        report = self.view(generated("sphere.npy", "sphere", "-n", "150k", "-d", "3"))
        self.assertGreater(report["vertex_count"], 140_000)
        self.expect_figures(report)
        self.expect_not_blank(10_000)
        self.assertIn("too large for this page", self.text("notes"))

    def test_dark_and_phone(self):
        self.view(generated("p.npy", "octahedron", "-n", "20k", "-d", "3"))
        light = browser.picture().getpixel((5, 300))
        browser.doing(lambda: browser.screen(1000, 700, dark=True))
        dark = browser.picture().getpixel((5, 300))
        self.assertLess(sum(dark), 150)
        self.assertGreater(sum(light), 600)
        browser.doing(lambda: browser.screen(390, 844))
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), 390)
        self.assertGreater(len(browser.picture().getcolors(maxcolors=1 << 24)), 100)


class Moving(Page):
    def test_slider_and_play(self):
        reports = self.view(
            generated("moving.npy", "cube", "-n", "2k", "-d", "3", "--frames", "12", "--motion", "twist"))
        self.assertEqual(len(reports), 12)
        self.expect_figures(reports[0])
        self.expect_not_blank(5000)
        first = browser.picture("canvas")
        for frame in (5, 11):
            browser.doing(lambda: browser.run(
                "const t = document.getElementById('time'); t.value = arguments[0];"
                "t.dispatchEvent(new Event('input'))", frame))
            self.expect_figures(reports[frame])
            self.assertGreater(pixels_changed(first, browser.picture("canvas")), 500)
        self.key(".")  # around to the first
        self.assertEqual(self.text("when"), "Frame 1 of 12")
        browser.run("document.activeElement.blur()")  # a ring shows where the keyboard is
        self.assertEqual(pixels_changed(first, browser.picture("canvas")), 0)
        before = browser.drawn()
        browser.driver.find_element("id", "play").click()
        while browser.drawn() < before + 3:
            pass
        browser.driver.find_element("id", "play").click()
        self.assertNotEqual(self.text("when"), "Frame 1 of 12")

    def test_moving_points_are_tracked(self):
        source = generated(
            "led.npy", "gauss", "-n", "100k", "-d", "3", "--frames", "4", "--motion", "twist")
        reports = self.view(source)
        self.assertEqual([r["track"]["method"] for r in reports],
                         ["static", "gauge", "gauge", "gauge"])
        app("track", source, f"--json={path('led.json')}", "-q")
        with open(path("led.json")) as file:
            frames = json.load(file)["frames"]
        for report, frame in zip(reports, frames):
            self.assertEqual(report["cull"]["survivors"], frame["survivors"])
            self.assertEqual(report["vertex_count"], frame["vertex_count"])
            self.assertEqual(report["track"]["vertices_came"], frame["vertices_came"])
        self.key(".")  # the first has no frame before
        browser.run("document.activeElement.blur()")
        self.expect_toggles_work(
            ("points", "survivors", "vertices", "faces", "edges", "axes"))

    def test_hulls_that_track_wrote(self):
        source = generated(
            "t.npy", "cube", "-n", "2k", "-d", "3", "--frames", "3", "--motion", "twist")
        for pattern, shown in (("hulls/h-%d.json", "hulls/h-*.json"), ("meshes/%02d.ply", "meshes")):
            os.makedirs(path(os.path.dirname(pattern)))
            app("track", source, "-o", path(pattern), "-q")
            page, report = path("tracked.html"), path("tracked.json")
            frames = ["--frames"] if shown == "meshes" else []
            app("view", path(shown), *frames, "-o", page, f"--json={report}")
            self.assertEqual(browser.open(page), [])
            with open(report) as file:
                reports = json.load(file)["frames"]
            self.assertEqual(len(reports), 3)
            self.expect_figures(reports[0])
            self.expect_not_blank(5000)
            before = browser.picture("canvas")
            self.key(".")
            self.assertGreater(pixels_changed(before, browser.picture("canvas")), 500)
            self.expect_figures(reports[1])

    def test_long_sequences_are_thinned(self):
        reports = self.view(
            generated("long.npy", "cube", "-n", "50", "-d", "2", "--frames", "300", "--motion", "spin"))
        self.assertEqual(len(reports), 120)
        self.assertIn("120 of 300 frames", self.text("notes"))


class Errors(unittest.TestCase):
    def refused(self, status, part, *arguments):
        ran = subprocess.run([APP, "view", *arguments], capture_output=True, text=True)
        self.assertEqual(ran.returncode, status, ran.stderr)
        self.assertIn(part, ran.stderr)
        self.assertEqual(ran.stderr.count("\n"), 1)

    def test_one_line_and_a_status(self):
        good = written("good.txt", [(0, 0), (1, 0), (0, 1)])
        self.refused(2, "-o PAGE.html is needed", "-")
        self.refused(1, "cannot open", path("absent.npy"), "-o", path("x.html"))
        self.refused(1, "cannot write", good, "-o", path("nowhere/x.html"))
        self.refused(2, "standard output", good, "-o", "-", "--json")
        app("hull", good, f"--json={path('report.json')}", "-q")
        self.refused(2, "dimension 2 and 3", generated("four.npy", "ball", "-n", "20", "-d", "4"),
                     "--delaunay", "-o", path("x.html"))
        app("hull", good, "-o", path("good.json"), "-q")
        self.refused(2, "without its points", path("good.json"), "--delaunay", "-o", path("x.html"))
        self.refused(2, "exclude one another", good, "--delaunay", "--outline", "-o", path("x.html"))
        self.refused(1, "not a hull with its lists", path("report.json"), "-o", path("x.html"))
        self.assertFalse(os.path.exists(path("x.html")))

    def test_names_are_text(self):
        source = written("<b>&\"x\".txt", [(0, 0), (1, 0), (0, 1)])
        app("view", source, "-o", path("named.html"))
        self.assertEqual(browser.open(path("named.html")), [])
        self.assertEqual(browser.driver.title, "<b>&\"x\".txt")


if __name__ == "__main__":
    pages.require()
    unittest.main(verbosity=2)
