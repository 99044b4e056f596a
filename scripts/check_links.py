#!/usr/bin/env python3
"""check_links.py FOLDER: every link, picture, style and script of the HTML pages in FOLDER must be a
file in it, every anchor must be on its page, and nothing may be loaded from elsewhere (links to
follow may lead there)."""

import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__(convert_charrefs=True)
        self.ids, self.links, self.loads = set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        for name in ("id", "name"):
            if values.get(name):
                self.ids.add(values[name])
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        if tag in ("img", "script", "iframe", "source") and values.get("src"):
            self.loads.append(values["src"])
        if tag == "link" and values.get("href") and values.get("rel") not in ("canonical",):
            self.loads.append(values["href"])


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1]).resolve()
    pages = {path: Page(path) for path in sorted(folder.rglob("*.html"))}
    broken, checked = [], 0
    for path, page in pages.items():
        for target, loaded in [(t, False) for t in page.links] + [(t, True) for t in page.loads]:
            parts = urllib.parse.urlsplit(target)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if loaded:
                    broken.append(f"{path.relative_to(folder)}: loads {target}")
                continue
            checked += 1
            file = path
            if parts.path:
                file = (path.parent / urllib.parse.unquote(parts.path)).resolve()
                if file.is_dir():
                    file /= "index.html"
            if not file.is_file() or not file.is_relative_to(folder):
                broken.append(f"{path.relative_to(folder)}: there is no {target}")
            elif parts.fragment and file in pages:
                if urllib.parse.unquote(parts.fragment) not in pages[file].ids:
                    broken.append(f"{path.relative_to(folder)}: no place {target}")
    for line in broken:
        print(line, file=sys.stderr)
    if broken or not pages:
        sys.exit(f"check_links: {len(broken)} broken of {checked} links in {len(pages)} pages")
    print(f"{checked} links in {len(pages)} pages, none broken")


main()
