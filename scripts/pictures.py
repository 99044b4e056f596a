#!/usr/bin/python3
"""pictures.py [REPORT.html]: remakes the pictures of README.md and docs/ from the built program.

docs/picture.svg         the LiDAR scan, drawn by examples/draw_svg.cpp, if that was built
docs/view.png            the same scan in `cullhull view`
docs/paper.png           figure 12 of `cullhull bench paper`
docs/moving-points.png   its figure 16

REPORT.html is what `cullhull bench paper --report REPORT.html` wrote; without it the two figures
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
    browser.screen(1100, 620, fine=FINE)
    browser.open(page)
    browser.doing(lambda: browser.driver.find_element("id", "show-stretch").click())
    browser.run("document.activeElement.blur()")
    save(shot(browser), "view.png", 256)


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
    if os.path.exists(os.path.join(programs, "example_draw_svg")):
        program("example_draw_svg", scan, os.path.join(root, "docs", "picture.svg"), "4")
    browser = browser_module.Browser()
    try:
        with tempfile.TemporaryDirectory() as folder:
            draw_view(browser, folder)
            report = os.path.abspath(sys.argv[1]) if len(sys.argv) == 2 else ""
            if not report:
                report = os.path.join(folder, "paper.html")
                program("cullhull", "bench", "paper", "--figure", "figure-12", "--figure",
                        "figure-16", "--report", report, "-q")
            draw_figure(browser, report, "figure-12", "paper.png")
            draw_figure(browser, report, "figure-16", "moving-points.png")
    finally:
        browser.close()


main()
