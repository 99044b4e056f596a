#!/usr/bin/env python3
"""wrap_prose.py FILE.md ...: wraps paragraphs and list items of Markdown at 100 columns and changes
nothing else: no code, no table, no heading, and no word."""

import re
import sys

WIDTH = 100
FENCE = re.compile(r"\s*(```+|~~~+)")
ITEM = re.compile(r"\s*([-*]|\d+\.) ")
KEPT = re.compile(r"\s*$|#|\s*\||<|!\[|[-=]{3,}$")  # blank, heading, table, HTML, picture, rule


def pieces(text):
    """Words; code in backticks is one of them, whatever blanks it has."""
    held = ""
    for word in text.split():
        held = f"{held} {word}" if held else word
        if held.count("`") % 2 == 0:
            yield held
            held = ""
    yield from held.split()


def wrapped(text, first, rest):
    lines, held = [], []
    lead = first
    for piece in pieces(text):
        if held and len(lead) + len(" ".join([*held, piece])) > WIDTH:
            # A line must not begin with what would make it a list, a heading or a table.
            down = [piece]
            while len(held) > 1 and re.match(r"([-*+]|\d+[.)])$|[#>|]", down[0]):
                down.insert(0, held.pop())
            lines.append(lead + " ".join(held))
            lead, held = rest, down
        else:
            held.append(piece)
    return [*lines, lead + " ".join(held)]


def wrap(text):
    lines, out, i = text.split("\n"), [], 0
    while i < len(lines):
        line, fence = lines[i], FENCE.match(lines[i])
        i += 1
        if fence:
            out.append(line)
            while i < len(lines) and not lines[i].strip().startswith(fence[1]):
                out.append(lines[i])
                i += 1
            out += lines[i : i + 1]  # the fence that closes
            i += 1
        elif KEPT.match(line) or (re.match(" {4}", line) and (not out or not out[-1] or re.match(" {4}", out[-1]))):
            out.append(line)  # four blanks behind a blank line: code
        else:
            indent, mark, body = re.match(r"(\s*)((?:(?:[-*]|\d+\.) +)?)(.*)", line).groups()
            rest, first = indent + " " * len(mark), indent + mark
            paragraph = [body]
            while i < len(lines) and not paragraph[-1].endswith(("\\", "  ")) and not (
                KEPT.match(lines[i]) or FENCE.match(lines[i]) or ITEM.match(lines[i])
            ):
                paragraph.append(lines[i].strip() + ("  " if lines[i].endswith("  ") else ""))
                i += 1
            hard = "  " if paragraph[-1].endswith("  ") else ""
            out += wrapped(" ".join(paragraph), first, rest)
            out[-1] += hard
    return "\n".join(out)


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    for path in sys.argv[1:]:
        with open(path) as file:
            text = file.read()
        new = wrap(text)
        assert text.split() == new.split(), f"{path}: a word would change"
        if new != text:
            with open(path, "w") as file:
                file.write(new)


main()
