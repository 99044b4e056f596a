#!/usr/bin/env python3
"""search_test.py HTML: asks the site's own search, Sphinx's script in a browser, what people ask
(questions.txt), and wants the right page among the first three results for at least nine in ten. No
table of "Which function" is cut on a laptop's screen. Exit status 77: no site was built here, or there
is no package of a browser."""

import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "viewer"))
import browser as browser_module  # noqa: E402

FIRST, SHARE = 3, 0.9
ASK = """
return JSON.parse(arguments[0]).map(question =>
  Search._performSearch(...Search._parseQuery(question)).reverse().slice(0, 8).map(r => r[0]));
"""

# Wrappers of tables scroll what is wider than they are.
CUT = """
return [...document.querySelectorAll("article .table-wrapper")]
  .filter(w => w.scrollWidth > w.clientWidth).map(w => w.innerText.slice(0, 60));
"""


def cut_tables(browser, page, width):
    browser.driver.set_window_size(width, 900)
    browser.driver.get(f"file://{page}")
    return browser.run(CUT)


def questions():
    for line in (HERE / "questions.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            question, pages = line.split("|")
            yield question.strip(), pages.split()


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    site = pathlib.Path(sys.argv[1]).resolve()
    if not (site / "search.html").exists():
        print(f"search_test: there is no site in {site}: make docs")
        return 77
    browser_module.require()
    asked = list(questions())
    for question, pages in asked:
        for page in pages:
            assert (site / f"{page}.html").exists(), f"{question}: the site has no page {page}"
    browser = browser_module.Browser()
    try:
        browser.driver.get(f"file://{site}/search.html")
        browser.driver.execute_async_script(
            "const done = arguments[0]; const wait = () => Search.hasIndex() ? done() : setTimeout(wait, 50); wait();")
        found = browser.run(ASK, json.dumps([question for question, _ in asked]))
        for width in (1366, 1440, 1920):
            cut = cut_tables(browser, site / "which-function.html", width)
            assert not cut, f"which-function.html at {width} pixels: cut are {cut}"
    finally:
        browser.close()
    failed = []
    for (question, pages), results in zip(asked, found):
        if not set(pages) & set(results[:FIRST]):
            failed.append(question)
            print(f"not found: {question}: wanted {' or '.join(pages)}, first are {', '.join(results) or 'none'}")
    right = len(asked) - len(failed)
    print(f"{right} of {len(asked)} questions lead to the right page")
    assert len(asked) >= 50
    return 0 if right >= SHARE * len(asked) else 1


if __name__ == "__main__":
    sys.exit(main())
