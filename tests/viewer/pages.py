"""What the tests of pages share: the program, a folder for its files, and a browser."""
import os
import subprocess
import sys
import tempfile

from browser import Browser, require

__all__ = ["APP", "app", "begin", "end", "path", "require"]

APP = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "cullhull"


def begin():
    global folder, browser
    folder = tempfile.TemporaryDirectory(prefix="cullhull-view-")
    browser = Browser()
    return browser


def end():
    browser.close()
    folder.cleanup()


def path(name):
    return os.path.join(folder.name, name)


def app(*arguments):
    return subprocess.run([APP, *arguments], check=True, capture_output=True, text=True).stdout


def bench(*arguments):
    subprocess.run([f"{APP}-bench", *arguments], check=True, capture_output=True)
