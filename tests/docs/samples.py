"""The code blocks of the documentation's pages."""

import pathlib
import re
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Block(NamedTuple):
    page: str  # as in the tree
    line: int  # of its first line of text
    language: str
    text: str
    given: str  # what an invisible comment "<!-- given: ... -->" before the block declares
    output: str | None  # the text block that follows at once, what the sample prints


def pages():
    """README and every page of docs/, in order."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(path):
    """The fenced blocks of a page."""
    found = []
    text = path.read_text()
    pattern = r"(?:<!-- given: (?P<given>.*?) -->\n+)?^```(?P<language>[\w-]*)\n(?P<text>.*?)^```$"
    for match in re.finditer(pattern, text, re.M | re.S):
        between = text[found[-1][1] : match.start()] if found else "none"
        if match["language"] == "text" and found and not between.strip():
            block, end = found[-1]
            found[-1] = (block._replace(output=match["text"]), match.end())
            continue
        line = text.count("\n", 0, match.start("text")) + 1
        page = str(path.relative_to(ROOT))
        block = Block(page, line, match["language"], match["text"], match["given"] or "", None)
        found.append((block, match.end()))
    return [block for block, _ in found]


def every(language):
    return [block for path in pages() for block in blocks(path) if block.language == language]


def matches(pattern, text):
    """Line by line; "..." stands for the rest of a line, and a line of it for any number of lines."""
    parts = []
    for line in pattern.splitlines():
        if line.strip() == "...":
            parts.append(r"(?:.*\n)*?")
        else:
            parts.append(re.escape(line).replace(re.escape("..."), ".*") + r"\n")
    return re.fullmatch("".join(parts), text if text.endswith("\n") or not text else text + "\n") is not None
