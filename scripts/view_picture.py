#!/usr/bin/python3
"""view_picture.py CULLHULL: remakes docs/view.png, the LiDAR scan in `cullhull view`."""
import os
import subprocess
import sys
import tempfile

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "tests", "viewer"))
import browser as browser_module  # noqa: E402

browser_module.require()
if len(sys.argv) != 2:
    sys.exit("usage: scripts/view_picture.py CULLHULL")
with tempfile.TemporaryDirectory() as folder:
    page = os.path.join(folder, "page.html")
    scan = os.path.join(root, "data", "autzen-150k.ply")
    subprocess.run([sys.argv[1], "view", scan, "-o", page], check=True)
    browser = browser_module.Browser()
    try:
        browser.screen(1100, 620)
        browser.open(page)
        browser.doing(lambda: browser.driver.find_element("id", "show-stretch").click())
        browser.run("document.activeElement.blur()")
        whole = browser_module.io.BytesIO(browser.driver.get_screenshot_as_png())
    finally:
        browser.close()
from PIL import Image  # noqa: E402

Image.open(whole).convert("RGB").quantize(96).save(os.path.join(root, "docs", "view.png"), optimize=True)
