#!/usr/bin/env python3
"""figures.py: figures of the documentation are those of stored lines of bench/results.

    scripts/figures.py            compares the pages that docs/figures.txt names
    scripts/figures.py --write    writes the stored figures into the pages

docs/figures.txt says how a passage is written down. A time, rate or ratio that no passage covers is
an error, so that a page cannot have one without a stored line.
"""

import argparse
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
UNITS = {"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9, "G": 1e-9, "M": 1e-6, "T": 1e-12, "%": 100,
         "x": 1}
NUMBER = r"(?:\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d*\.\d+|\d+)"
# What must have a source: a number before a unit of time, a rate, or a ratio.
FIGURE = re.compile(
    rf"(?<![\w.,]){NUMBER} ?(?:ms|µs|ns|s|[GT]B/s|[GM] (?:points|sets)/s|×|%)(?![\w/])")
# A column of such numbers has the unit in its head.
UNIT_IN_HEAD = re.compile(r",? (?:ms|µs|ns|s)(?![\w])|×")
# Columns of what others report, what was predicted, and limits that a script sets.
NOT_MEASURED = re.compile(r"reported|predicted|estimate|limit|the paper|counted work")


class Lines:
    """A file of JSON lines: lines("part", "workload", key=value) is the only one with these."""

    def __init__(self, path):
        self.path = path
        text = (ROOT / path).read_text()
        if path.endswith(".json"):  # a report of cullhull-bench
            self.lines = [dict(row, part=figure["id"], workload=row["name"])
                          for figure in json.loads(text)["figures"] for row in figure["rows"]]
        else:
            self.lines = [json.loads(line) for line in text.splitlines() if line]

    def all(self, part, workload=None, **keys):
        wanted = dict(keys, **({"workload": workload} if workload else {}))
        return [Line(line) for line in self.lines
                if line.get("part") == part and all(line.get(k) == v for k, v in wanted.items())]

    def starting(self, name):
        """The lines of bench/device_hulls.py whose set's name, whatever its folder, starts so."""
        return [Line(line) for line in self.lines
                if line.get("workload", line.get("name", "")).rpartition("/")[2].startswith(name)]

    def named(self, name):
        return self.only([line for line in self.starting(name)
                          if line.get("workload", line.get("name")).rpartition("/")[2] == name],
                         name)

    def __call__(self, part, workload=None, **keys):
        wanted = f"{part!r} {workload or ''} {keys or ''}"
        return self.only(self.all(part, workload, **keys), wanted)

    # Of reports of cullhull-bench, which list lost workloads in a figure "lost" as well.

    def time(self, workload, series, part=None):
        """The seconds of a series, such as "Qhull"; `part`: the figure, needed where several have it."""
        found = [line for line in self.lines if line["workload"] == workload
                 and (line["part"] == part if part else line["part"] != "lost")]
        return self.only(found, f"{workload} {part or ''}")["values"][series]

    def ratios(self, best):
        """For each workload, least time of the other programs over that of `best`."""
        for line in self.lines:
            values = line["values"]
            if line["part"] != "lost":
                yield min(v for k, v in values.items() if v and "cullhull" not in k) / values[best]

    def mean(self, series, sequence):
        """Over the frames of a sequence but the first."""
        found = [line["values"][series] for line in self.lines
                 if re.fullmatch(rf"{sequence}, frame [1-9]\d*", line["workload"])]
        return sum(found) / len(found)

    def only(self, found, wanted):
        if len(found) != 1:
            raise LookupError(f"{self.path}: {len(found)} lines of {wanted}")
        return found[0]


class Line(dict):
    def __getattr__(self, name):
        value = self[name]
        return Line(value) if isinstance(value, dict) else value


class Passage:
    """A text with placeholders: {expression unit}."""

    def __init__(self, number, text, names):
        self.number, self.text = number, text
        pieces = re.split(r"\{([^{}]+)\}", text)
        self.values = []
        pattern = ""
        for index, piece in enumerate(pieces):
            if index % 2 == 0:
                pattern += r"\s+".join(re.escape(word) for word in re.split(r"\s+", piece))
                continue
            expression, unit = piece.rsplit(" ", 1)
            self.values.append(eval(expression, {"min": min, "max": max, **names}) * UNITS[unit])
            pattern += f"({NUMBER})"
        self.pattern = re.compile(pattern)


def decimals(shown):
    return len(shown.partition(".")[2])


def agrees(shown, value):
    return abs(float(shown.replace(",", "")) - value) <= 0.5 * 10 ** -decimals(shown) * (1 + 1e-9)


def spelled(shown, value):
    return f"{value:,.{decimals(shown)}f}"


def blank(text):
    return re.sub(r"[^\n]", " ", text)


def seen(cell, head):
    if NOT_MEASURED.search(head):
        return blank(cell)
    return re.sub(rf"{NUMBER}(?=[ ,]|$)", r"\g<0>×", cell) if UNIT_IN_HEAD.search(head) else cell


def to_check(page):
    """The page with everything blank that shows no measurement of ours."""
    page = re.sub(r"<!-- ([\w.]+): begin -->.*?<!-- \1: end -->", lambda m: blank(m[0]), page,
                  flags=re.S)
    page = re.sub(r"^```.*?^```", lambda m: blank(m[0]), page, flags=re.S | re.M)
    lines, header = [], None
    for line in page.split("\n"):
        if line.startswith("    "):
            line = blank(line)
        if line.startswith("|"):
            cells = line.split("|")
            if header:
                line = "|".join(seen(cell, head) for cell, head in zip(cells, header))
            header = header or cells
        else:
            header = None
        lines.append(line)
    return "\n".join(lines)


def read_passages():
    """A list of (page, passages, whether every figure of the page needs one)."""
    names, pages = {}, []
    entry, first = [], 0

    def finish():
        if entry:
            pages[-1][1].append(Passage(first, " ".join(entry), names))
            entry.clear()

    for number, line in enumerate((ROOT / "docs" / "figures.txt").read_text().splitlines(), 1):
        if line.startswith("#") or not line.strip():
            finish()
        elif match := re.fullmatch(r"page (\S+)( partly)?", line):
            pages.append((match[1], [], not match[2]))
        elif match := re.fullmatch(r"(\w+) = (bench/results/\S+)", line):
            names[match[1]] = Lines(match[2])
        else:
            first = number if not entry else first
            entry.append(line.strip())
    finish()
    return pages


def check(name, passages, whole, write):
    path = ROOT / name
    page = path.read_text()
    faults = []
    for passage in passages:
        found = list(passage.pattern.finditer(page))
        if len(found) != 1:
            faults.append(f"docs/figures.txt:{passage.number}: found {len(found)} times in {name}: "
                          + passage.text[:70])
            continue
        new = page[found[0].start():found[0].end()]
        for group in range(len(passage.values), 0, -1):
            shown, value = found[0][group], passage.values[group - 1]
            if agrees(shown, value):
                continue
            at = found[0].start(group) - found[0].start()
            new = new[:at] + spelled(shown, value) + new[at + len(shown):]
            line = page.count("\n", 0, found[0].start(group)) + 1
            faults.append(f"{name}:{line}: {shown} is {spelled(shown, value)} in the stored line")
        page = page[:found[0].start()] + new + page[found[0].end():]
    if write:
        path.write_text(page)
    for passage in passages:
        page = passage.pattern.sub(lambda match: re.sub(r"\d", " ", match[0]), page)
    rest = to_check(page) if whole else ""
    for match in FIGURE.finditer(rest):
        line = rest.count("\n", 0, match.start()) + 1
        shown = match[0].removesuffix("×")
        faults.append(f"{name}:{line}: '{shown}' has no stored line in docs/figures.txt")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the stored figures")
    arguments = parser.parse_args()
    faults = [fault for name, passages, whole in read_passages()
              for fault in check(name, passages, whole, arguments.write)]
    print("\n".join(faults) if faults else "figures.py: every figure is that of its stored line")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
