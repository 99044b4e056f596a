#!/usr/bin/env python3
"""try_test.py MODULE CULLHULL: the program as a module of WebAssembly (scripts/wasm.sh, whose
build/wasm/program is MODULE) beside this system's: under node the same bytes, and in Chromium, on the page where
files are dropped, the same figures. Exit status 77: no module was built here, or no node or browser."""

import functools
import http.server
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent / "viewer"))
import browser as browser_module  # noqa: E402

MODULE, NATIVE = [pathlib.Path(word).resolve() for word in sys.argv[1:3]]
WASM = ["node", str(HERE / "program.cjs"), str(MODULE / "cullhull.js")]


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="cullhull try Größe ")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name, shape, count, dimension in (
                ("ball.ply", "ball", 20000, 3), ("disk.csv", "disk", 5000, 2), ("4.npy", "ball", 300, 4)):
            self.native("generate", shape, "-n", str(count), "-d", str(dimension), "-q", "-o", name)
        shutil.copy(ROOT / "data" / "autzen-east.las", self.folder / "east.las")
        (self.folder / "broken.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
                                                "property double y\nend_header\n0 0\n1 0\n")

    def run_in(self, program, *words):
        return subprocess.run([*program, *words], capture_output=True, cwd=self.folder)

    def native(self, *words):
        ended = self.run_in([str(NATIVE)], *words)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended.stdout


class Module(Folder):
    def same(self, words, output=None, status=0):
        ends = []
        for program in ([str(NATIVE)], WASM):
            ended = self.run_in(program, *words)
            file = self.folder / (output or "none")
            ends.append((ended.returncode, ended.stdout, ended.stderr, file.exists() and file.read_bytes()))
            file.unlink(missing_ok=True)
        self.assertEqual(ends[0][0], status, ends[0][2])
        self.assertEqual(bool(ends[0][3]), output is not None)
        self.assertTrue(ends[0] == ends[1], f"{words}: {[end[:3] for end in ends]}")

    def test_the_same_bytes(self):
        for name, endings in (("ball.ply", "json ply obj stl"), ("disk.csv", "json geojson wkt"),
                              ("4.npy", "json"), ("east.las", "json ply")):
            for ending in endings.split():
                self.same(["hull", name, "-q", "--certify", "-o", f"out.{ending}"], f"out.{ending}")
        for words in (["delaunay", "disk.csv"], ["alpha", "disk.csv", "--ratio", "0.1"],
                      ["delaunay", "east.las", "--columns", "x,y"], ["voronoi", "disk.csv"]):
            self.same([*words, "-q", "-o", "out.geojson"], "out.geojson")
        self.same(["generate", "cube", "-n", "1000", "-d", "3", "-q", "-o", "out.csv"], "out.csv")
        self.same(["--help"])

    def test_errors_are_one_line(self):
        for words, status in ((["hull", "broken.ply"], 1), (["hull", "absent.csv"], 1), (["hulk", "4.npy"], 2),
                              (["delaunay", "ball.ply", "--memory", "1000"], 4)):
            self.same(words, status=status)
        # Sizes that 32 bits would cut off to what the file has.
        head = b"{'descr':'<f8','fortran_order':False,'shape':(%d,2)}\n"
        for count in (2**28 + 1, 2**32 + 1, 2**60 + 1):
            text = head % count
            (self.folder / "long.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text +
                                                   bytes(16))
            self.same(["hull", "long.npy"], status=1)


class Page(Folder):
    @classmethod
    def setUpClass(cls):
        site = tempfile.TemporaryDirectory(prefix="cullhull-site-")
        cls.addClassCleanup(site.cleanup)
        for file in (ROOT / "docs/site/try.html", ROOT / "docs/site/try.js", MODULE / "cullhull.js",
                     MODULE / "cullhull.wasm"):
            shutil.copy(file, site.name)
        cls.asked = []

        class Handler(http.server.SimpleHTTPRequestHandler):
            def log_message(self, _, *arguments):
                cls.asked.append(arguments[0].split()[1])

        server = http.server.ThreadingHTTPServer(
            ("127.0.0.1", 0), functools.partial(Handler, directory=site.name))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)
        cls.address = f"http://127.0.0.1:{server.server_port}/try.html"
        cls.browser = browser_module.Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        super().setUp()
        self.driver = self.browser.driver

    def line(self):
        return self.browser.run("return document.getElementById('line').textContent")

    def choose(self, name):
        self.driver.get(self.address)
        self.driver.find_element("id", "files").send_keys(str(self.folder / name))

    def ended(self):
        end = time.monotonic() + 120
        while self.line() in ("", "Working ..."):
            self.assertLess(time.monotonic(), end, "no end within two minutes")
            time.sleep(0.05)
        return self.line()

    def figures(self):
        """Of the viewer in the frame."""
        self.driver.switch_to.frame("page")
        try:
            end = time.monotonic() + 60
            while True:
                found = dict(self.browser.run("return [...document.querySelectorAll('#result [data-key]')]"
                                              ".map(e => [e.dataset.key, JSON.parse(e.dataset.value)])"))
                if found or time.monotonic() > end:
                    return found
                time.sleep(0.05)
        finally:
            self.driver.switch_to.default_content()

    def test_figures_are_the_programs(self):
        for name in ("ball.ply", "disk.csv", "east.las"):
            self.choose(name)
            self.assertRegex(self.ended(), f"^{name}: [0-9.]+ s$")
            report = json.loads(self.native("view", name, "-q", "-o", "native.html", "--json"))
            shown = self.figures()
            self.assertIn("vertex_count", shown)
            for key, value in shown.items():
                whole = functools.reduce(lambda part, word: part[word], key.split("."), report)
                self.assertEqual(value, whole, f"{name}: {key}")
        self.assertEqual(set(self.asked), {"/try.html", "/try.js", "/cullhull.js", "/cullhull.wasm"})

    def test_an_outline(self):
        self.native("hull", "disk.csv", "-q", "-o", "corners.geojson")
        self.choose("corners.geojson")
        self.ended()
        self.browser.run("document.getElementById('cells').value = '--outline'; document.getElementById('again').click()")
        self.assertRegex(self.ended(), "^corners.geojson: [0-9.]+ s$")
        self.assertIn("vertex_count", self.figures())
        self.driver.switch_to.frame("page")
        self.addCleanup(self.driver.switch_to.default_content)
        cells, edges, lines = self.browser.run("""return [viewer.frame.cells.length, viewer.frame.edges.length / 2,
            viewer.stage.parts.cellEdges.geometry.attributes.position.count / 2]""")
        self.assertTrue(cells > 0 and edges <= lines < cells, (cells, edges, lines))

    def test_a_drop(self):
        self.driver.get(self.address)
        self.browser.run("""const files = new DataTransfer();
            files.items.add(new File(["x,y\\n0,0\\n2,0\\n0,2\\n0.5,0.5\\n"], "four.csv"));
            document.body.dispatchEvent(new DragEvent("drop", {dataTransfer: files, bubbles: true}));""")
        self.assertRegex(self.ended(), "^four.csv: ")
        self.assertEqual(self.figures()["vertex_count"], 3)

    def test_errors_and_cancel(self):
        line = self.run_in([str(NATIVE)], "view", "./broken.ply", "-o", "o.html").stderr.decode().strip()
        self.choose("broken.ply")
        self.assertEqual(self.ended(), line)
        self.native("generate", "sphere", "-n", "300k", "-d", "3", "-q", "-o", "many.npy")
        self.choose("many.npy")
        self.driver.find_element("id", "cancel").click()
        self.assertEqual(self.line(), "cancelled")

    def test_nothing_is_sent(self):
        self.driver.get(self.address)
        for call in ("fetch('try.js')", "fetch('http://127.0.0.1:9/')"):
            answer = self.driver.execute_async_script(
                f"const done = arguments[0]; {call}.then(() => done('sent'), e => done(e.name))")
            self.assertEqual(answer, "TypeError", call)


if __name__ == "__main__":
    if not (MODULE / "cullhull.wasm").exists() or shutil.which("node") is None:
        print("try_test: no module (scripts/wasm.sh), or no node")
        sys.exit(77)
    browser_module.require()
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
