#!/usr/bin/python3
"""pictures.py [REPORT.html]: remakes the pictures of README.md and docs/ from the built program.

docs/speed.svg           the README's chart (scripts/speed_chart.py)
docs/picture.svg         the LiDAR scan, drawn by examples/draw_svg.cpp, if that was built
docs/view.png            the same scan in `cullhull view`
docs/showpiece.png       the same page in the dark, the picture alone
docs/gallery/*.png       what pages of other sets look like
docs/paper.png           figure 12 of `cullhull-bench paper`
docs/moving-points.png   its figure 16

`pictures.py gallery` makes those of pages alone. REPORT.html is what `cullhull-bench paper --report REPORT.html` wrote; without it the two figures
are measured now, at full size (two minutes). BUILD names another folder than build/release.
"""
import io
import os
import subprocess
import sys
import tempfile

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "tests", "viewer"))
import browser as browser_module  # noqa: E402

programs = os.path.join(os.environ.get("BUILD", os.path.join(root, "build", "release")), "bin")
scan = os.path.join(root, "data", "autzen-150k.ply")
FINE = 2  # pixels are drawn so many times finer and averaged: smooth lines whoever draws them


def program(name, *arguments):
    subprocess.run([os.path.join(programs, name), *arguments], check=True)


def save(picture, name, colours):
    """As small a PNG as looks the same."""
    small = picture.resize((picture.width // FINE, picture.height // FINE), 1)  # 1: Lanczos
    path = os.path.join(root, "docs", name)
    small.quantize(colours, kmeans=2).save(path, optimize=True)
    print(f"docs/{name}: {os.path.getsize(path) // 1000} kB")


def shot(browser):
    from PIL import Image

    return Image.open(io.BytesIO(browser.driver.get_screenshot_as_png())).convert("RGB")


def draw_view(browser, folder):
    page = os.path.join(folder, "scan.html")
    program("cullhull", "view", scan, "-o", page, "-q")
    draw_page(browser, page, "view.png", (1100, 620))
    draw_page(browser, page, "showpiece.png", (1200, 600), dark=True, picture_alone=True,
              look=(-0.62, 0.52, 0.92), script="set('show-axes', false); set('show-vertices', false); set('glass', 9);")


HELPERS = """
const set = (id, value) => {
  const input = document.getElementById(id);
  if (input.type === 'checkbox') { if (input.checked !== value) input.click(); return; }
  input.value = value;
  for (const kind of ['input', 'change']) input.dispatchEvent(new Event(kind, {bubbles: true}));
};
"""


def draw_page(browser, page, name, size, dark=False, picture_alone=False, script="", after="", look=None, colours=256):
    """A page of `cullhull view` after a script: the whole of it, or the picture without panel and
    buttons; `look`: yaw, pitch, and the share of the distance from which all is seen."""
    browser.screen(*size, dark=dark, fine=FINE)
    browser.open(page)
    hide = """for (const s of ['.panel', '.corner', '.legend', '.timeline']) document.querySelector(s).style.display = 'none';
        delete document.documentElement.dataset.moving;"""
    turn = "" if look is None else (
        f"viewer.rig.yaw = {look[0]}; viewer.rig.pitch = {look[1]}; viewer.rig.fill(viewer.space.extent, viewer.on.axes);"
        f"viewer.rig.reach *= {look[2]}; viewer.rig.update();")
    browser.doing(lambda: browser.run(
        HELPERS + (hide if picture_alone else "") + script + "viewer.resize(); viewer.reframe();" + turn + after +
        "document.activeElement.blur(); viewer.invalidate();"))
    save(shot(browser), name, colours)


TWIST = ("cube", "-n", "30k", "-d", "3", "--frames", "20", "--motion", "twist")
# Sets, how they are made, and what is done in their pages.
GALLERY = {
    "filter": (scan, dict(script="set('colour-by', 'role'); set('glass', 16);", picture_alone=True)),
    "ball": (("ball", "-n", "1M", "-d", "3"), dict(
        dark=True, picture_alone=True, look=(-0.35, 0.3, 1),
        script="set('glass', 100); set('clip-axis', '0'); set('clip-place', 560); set('show-axes', false);")),
    "relief": (("bumpy", "-n", "300k", "-d", "3"), dict(
        picture_alone=True, script="set('glass', 60); set('show-vertices', false); set('show-axes', false);")),
    "polyhedron": (("grid:9", "-n", "400", "-d", "3"), dict(
        after="viewer.pickFacet(7);", script="set('glass', 80);")),
    "twist-1": (TWIST, dict(picture_alone=True, script="set('show-axes', false); set('glass', 70);")),
    "twist-20": (TWIST, dict(picture_alone=True, script="set('show-axes', false); set('glass', 70); viewer.go(19);")),
    "five": (("gauss", "-n", "20k", "-d", "5"), dict(dark=True)),
    "five-plot": (("gauss", "-n", "20k", "-d", "5"), dict(script="viewer.project([0, 3, -1]);")),
    "disk": (("disk", "-n", "200k", "-d", "2"), dict(picture_alone=True)),
    "cone": (("cone", "-n", "3k", "-d", "3"), dict(
        dark=True, picture_alone=True, script="set('glass', 90); set('show-axes', false);")),
}


def draw_gallery(browser, folder):
    for name, (source, how) in GALLERY.items():
        points, page = os.path.join(folder, name + ".npy"), os.path.join(folder, name + ".html")
        if source == scan:
            points = scan
        else:
            program("cullhull", "generate", *source, "-o", points, "-q")
        program("cullhull", "view", points, "-o", page, "-q")
        size = (900, 600) if how.get("picture_alone") else (1100, 620)
        draw_page(browser, page, f"gallery/{name}.png", size, colours=128, **how)


def draw_figure(browser, report, figure, name):
    browser.screen(800, 1600, fine=FINE)
    browser.open(report)
    browser.run(
        "document.querySelectorAll('section').forEach(s => s.hidden = s.id !== arguments[0]);"
        "document.querySelectorAll('details').forEach(d => d.hidden = true);"
        "document.getElementById(arguments[0]).scrollIntoView()", figure)
    left, top, right, bottom = browser.run(
        "const b = document.getElementById(arguments[0]).getBoundingClientRect();"
        "return [b.left - 12, b.top - 8, b.right + 12, b.bottom + 8]", figure)
    save(shot(browser).crop([round(FINE * x) for x in (left, top, right, bottom)]), name, 64)


def main():
    browser_module.require()
    if len(sys.argv) > 2 or sys.argv[1:] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    subprocess.run([sys.executable, os.path.join(root, "scripts", "speed_chart.py")], check=True)
    if os.path.exists(os.path.join(programs, "example_draw_svg")):
        program("example_draw_svg", scan, os.path.join(root, "docs", "picture.svg"), "4")
    browser = browser_module.Browser()
    try:
        with tempfile.TemporaryDirectory() as folder:
            draw_view(browser, folder)
            draw_gallery(browser, folder)
            if sys.argv[1:] == ["gallery"]:
                return
            report = os.path.abspath(sys.argv[1]) if len(sys.argv) == 2 else ""
            if not report:
                report = os.path.join(folder, "paper.html")
                program("cullhull-bench", "paper", "--figure", "figure-12", "--figure",
                        "figure-16", "--report", report, "-q")
            draw_figure(browser, report, "figure-12", "paper.png")
            draw_figure(browser, report, "figure-16", "moving-points.png")
    finally:
        browser.close()


main()
