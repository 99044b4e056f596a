#!/usr/bin/python3
"""report_picture.py REPORT.html FIGURE OUT.png: one figure of a `cullhull bench --report` page."""
import os
import sys

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "tests", "viewer"))
import browser as browser_module  # noqa: E402

browser_module.require()
if len(sys.argv) != 4:
    sys.exit("usage: scripts/report_picture.py REPORT.html FIGURE OUT.png")
page, figure, out = sys.argv[1:]
browser = browser_module.Browser()
try:
    browser.screen(900, 900)
    browser.open(os.path.abspath(page))
    browser.run("document.getElementById(arguments[0]).scrollIntoView()", figure)
    browser.run("document.querySelectorAll('details').forEach(d => d.hidden = true)")
    picture = browser.picture(figure)
finally:
    browser.close()
picture.quantize(64).save(out, optimize=True)
