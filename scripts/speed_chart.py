#!/usr/bin/env python3
"""speed_chart.py: draws docs/speed.svg, the README's chart, from the first table of docs/performance.md.
No figure is written here: a row is found by its name, its numbers are the table's."""

import html
import math
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROWS = {  # of the table, and what the chart calls them
    "3D ball 8M": "8M points in a ball",
    "3D octahedron 15M": "15M in an octahedron",
    "3D gauss 10M": "10M normally distributed",
    "3D sphere surface 1M": "1M on a sphere, all extreme",
    "2D disk 10M": "2D: 10M in a disk",
    "2D circle 2M": "2D: 2M on a circle, all extreme",
    "4D ball 8M": "4D: 8M in a ball",
    "3D turned lattice surface 998.79k": "1M lattice points on a turned cube",
}
BARS = [  # column of the table, name, class of the bar
    ("Qhull, ms", "Qhull 2020.2, 1 thread", "qhull"),
    ("CGAL, ms", "CGAL 5.5, 1 thread", "cgal"),
    ("cullhull, 2 threads, ms", "cullhull, 2 threads", "ours"),
]
WIDTH, LEFT, RIGHT, TOP = 860, 260, 70, 84
BAR, GAP = 13, 16
FEWEST, MOST = 5, 40_000  # ms at the two ends of the axis
STYLE = """
text { font: 14px system-ui, "Segoe UI", "Liberation Sans", sans-serif; fill: #24292f }
.title { font-weight: 600; font-size: 17px } .small { font-size: 12px; fill: #57606a }
.back { fill: #fcfcfb } .line { stroke: #d8dee4 }
.qhull { fill: #b6bcc4 } .cgal { fill: #d9a066 } .ours { fill: #1d56b8 }
@media (prefers-color-scheme: dark) {
  text { fill: #e6edf3 } .small { fill: #9da7b3 } .back { fill: #161b22 } .line { stroke: #30363d }
  .qhull { fill: #6e7681 } .cgal { fill: #b98046 } .ours { fill: #6ea2ff }
}
"""


def table():
    """The rows of the first table: its name, and a dictionary of columns."""
    text = (ROOT / "docs" / "performance.md").read_text()
    lines = re.search(r"^\|.*\|\n\|[-:| ]+\|\n(?:\|.*\|\n)+", text, re.M)[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {re.sub(r" [¹²³]$", "", row[0]): dict(zip(cells[0], row)) for row in cells[2:]}


def place(ms):
    share = math.log(ms / FEWEST) / math.log(MOST / FEWEST)
    return LEFT + share * (WIDTH - LEFT - RIGHT)


def spelled(ms):
    return f"{ms / 1000:.1f} s" if ms >= 1000 else f"{ms:.3g} ms"


def chart():
    rows = table()
    groups, y = [], TOP
    for name, label in ROWS.items():
        drawn = [(rows[name][column], kind) for column, _, kind in BARS if rows[name][column]]
        groups.append((label, y, drawn))
        y += len(drawn) * (BAR + 2) + GAP
    height = y + 34
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img">',
        "<title>Time to the complete hull: Qhull, CGAL and cullhull</title>",
        f"<style>{STYLE}</style>",
        f'<rect class="back" width="{WIDTH}" height="{height}" rx="8"/>',
        '<text class="title" x="20" y="32">Time to the complete hull (logarithmic scale, shorter is better)</text>',
    ]
    x = 20
    for _, name, kind in BARS:
        out.append(f'<rect class="{kind}" x="{x}" y="46" width="14" height="14" rx="2"/>')
        out.append(f'<text x="{x + 20}" y="58">{name}</text>')
        x += 48 + 8 * len(name)
    for ms in (10, 100, 1000, 10_000):
        out.append(f'<line class="line" x1="{place(ms):.1f}" y1="{TOP - 8}" x2="{place(ms):.1f}" y2="{y - 4}"/>')
        out.append(f'<text class="small" x="{place(ms):.1f}" y="{y + 12}" text-anchor="middle">{spelled(ms)}</text>')
    for label, top, drawn in groups:
        middle = top + len(drawn) * (BAR + 2) / 2 + 4
        out.append(f'<text x="{LEFT - 12}" y="{middle:.1f}" text-anchor="end">{html.escape(label)}</text>')
        for i, (cell, kind) in enumerate(drawn):
            ms, at = float(cell.replace(",", "")), top + i * (BAR + 2)
            out.append(f'<rect class="{kind}" x="{LEFT}" y="{at}" width="{place(ms) - LEFT:.1f}" height="{BAR}" rx="2"/>')
            out.append(f'<text class="small" x="{place(ms) + 6:.1f}" y="{at + 11}">{spelled(ms)}</text>')
    return "\n".join([*out, "</svg>", ""])


if __name__ == "__main__":
    (ROOT / "docs" / "speed.svg").write_text(chart())
