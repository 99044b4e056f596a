"""A headless chromium that sees pages from file:// as a reader would."""
import io
import shutil
import sys
import time


def require():
    """Explains what is missing and ends: 77 where no package exists, 1 where one was not installed."""
    missing = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    for module in ("selenium", "PIL"):
        try:
            __import__(module)
        except ImportError:
            missing.append("python3-" + module)
    if not missing:
        return
    try:
        debian = "ID=debian\n" in open("/etc/os-release").read()
    except OSError:
        debian = False
    if debian:
        sys.exit(f"missing: {', '.join(missing)}; run scripts/install-deps.sh test")
    print(f"skipped: {', '.join(missing)}: this system has no packages of chromium and its driver")
    sys.exit(77)


class Browser:
    def __init__(self):
        from selenium import webdriver
        from selenium.webdriver.chrome.options import Options
        from selenium.webdriver.chrome.service import Service

        options = Options()
        options.binary_location = shutil.which("chromium")
        for flag in (
            "--headless=new",
            "--no-sandbox",  # chromium refuses to run as root otherwise
            "--disable-dev-shm-usage",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            "--disable-background-networking",
        ):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(
            service=Service(shutil.which("chromedriver")), options=options
        )
        self.driver.set_page_load_timeout(120)
        self.driver.set_script_timeout(120)
        self.screen(1000, 700)

    def close(self):
        self.driver.quit()

    def screen(self, width, height, dark=False, fine=1):
        self.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": fine, "mobile": width < 600},
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def open(self, path):
        """Returns what went wrong meanwhile: lines of the console, and requests beside the page's."""
        self.driver.get_log("browser"), self.driver.get_log("performance")
        self.driver.get("file://" + path)
        self.settle(0)
        return self.complaints(path)

    def complaints(self, path):
        import json

        found = [entry["message"] for entry in self.driver.get_log("browser")]
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] != "Network.requestWillBeSent":
                continue
            url = message["params"]["request"]["url"]
            if url != "file://" + path and not url.startswith("data:"):
                found.append("request of " + url)
        return found

    def drawn(self):
        return int(self.run("return document.documentElement.dataset.drawn || 0"))

    def settle(self, before):
        """Waits until something was drawn after `before` drawings, and nothing more follows."""
        end = time.monotonic() + 60
        while self.drawn() <= before:
            if time.monotonic() > end:
                raise AssertionError("nothing was drawn within a minute")
            time.sleep(0.02)
        while True:
            count = self.drawn()
            self.run("return new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
            if self.drawn() == count:
                return

    def doing(self, act):
        before = self.drawn()
        act()
        self.settle(before)

    def picture(self, element="stage"):
        """The pixels of an element, as they are on the screen."""
        from PIL import Image

        box = self.run(
            "const b = document.getElementById(arguments[0]).getBoundingClientRect();"
            "return [b.left, b.top, b.right, b.bottom].map(Math.round)", element)
        shot = Image.open(io.BytesIO(self.driver.get_screenshot_as_png())).convert("RGB")
        return shot.crop(box)


def pixels_changed(a, b):
    from PIL import ImageChops

    difference = ImageChops.difference(a, b).convert("L").point(lambda v: 255 if v > 2 else 0)
    return difference.histogram()[255]
