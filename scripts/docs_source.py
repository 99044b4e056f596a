#!/usr/bin/env python3
"""docs_source.py PROGRAM XML FOLDER: arranges what Sphinx reads.

FOLDER gets the Markdown of docs/ and of the root side by side, each page as it is but for its links:
they are relative to where the page lies in the tree, and so that they hold on a code host. A link to
a page of the site (or to a public header, or to a topic of the help in apps/cullhull/topics.cpp#TOPIC,
which have one) is turned towards it, one to any other file of the tree leads to the file on the code
host. Between <!-- tabs --> and <!-- end tabs --> each paragraph that is bold as a whole begins a tab of
that name. Added are a page for every command and every topic, from PROGRAM's help, one for every public
header, for which Doxygen has left XML (whose private parts are taken out), and one for every name in the
tables of docs/reference/python.md.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import textwrap

root = pathlib.Path(__file__).resolve().parent.parent
HOST = "https://github.com/cullhull/cullhull"
TOP = ["README", "HACKING", "CHANGELOG", "CONTRIBUTING", "SECURITY"]
ALONE = ("Simplified", "Lists", "NearestFacets", "Rays")  # what they inherit is a tuple's or a sequence's
TOPICS = root / "apps" / "cullhull" / "topics.cpp"
COMMANDS = ["hull", "cull", "track", "delaunay", "voronoi", "alpha", "certify", "generate", "info", "view", "qconvex",
            "completion", "man"]


def pages():
    """Every page: where it lies in the tree, and where in the site."""
    found = {root / f"{name}.md": pathlib.PurePosixPath(f"{name.lower()}.md") for name in TOP}
    for path in sorted((root / "docs").rglob("*.md")):
        found[path] = pathlib.PurePosixPath(path.relative_to(root / "docs").as_posix())
    found[root / "data" / "README.md"] = pathlib.PurePosixPath("reference/data.md")
    return found


def headers():
    """Every public header and its page; the umbrella and the version need none."""
    return {
        header: pathlib.PurePosixPath(f"reference/cpp/{header.stem}.md")
        for header in sorted((root / "include" / "cullhull").glob("*.hpp"))
        if header.stem not in ("cullhull", "version")
    }


def turned(text, path, found, kept):
    """The text with its links as they must be in the site; `kept` takes the files they need."""
    here = found[path]

    def replace(match):
        bang, label, target = match[1], match[2], match[3]
        name, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target) or name == "":
            return match[0]
        file = (path.parent / name).resolve()
        if file in found:
            goal = found[file]
        elif file == TOPICS and anchor:
            goal, anchor = pathlib.PurePosixPath(topic_page(anchor)), ""
        elif file.is_file() and (bang or file.is_relative_to(root / "docs")):
            goal = pathlib.PurePosixPath(file.relative_to(root).as_posix().removeprefix("docs/"))
            kept[goal] = file
        elif file.exists():  # of the tree, not of the site
            kind = "tree" if file.is_dir() else "blob"
            return f"[{label}]({HOST}/{kind}/main/{file.relative_to(root).as_posix()})"
        else:
            sys.exit(f"{path.relative_to(root)}: there is no {target}")
        turned_name = os.path.relpath(str(goal), str(here.parent))
        return f"{bang}[{label}]({turned_name}{'#' + anchor if anchor else ''})"

    code = re.compile(r"(^```.*?^```$)", re.M | re.S)
    parts = code.split(text)
    for i in range(0, len(parts), 2):
        parts[i] = re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", replace, parts[i])
    for i in range(1, len(parts), 2):  # doctest wants a blank line at the end, readers do not
        parts[i] = re.sub(r"\n+```$", "\n```", parts[i])
    return with_tabs("".join(parts))


def with_tabs(text):
    """The tabs of a page, of which a code host shows the names in bold instead."""

    def tabs(match):
        items = re.split(r"^\*\*(.+)\*\*$", match[1], flags=re.M)[1:]
        body = "".join(
            f"\n:::{{tab-item}} {name}\n:sync: {name.lower()}\n{content}:::\n"
            for name, content in zip(items[::2], items[1::2])
        )
        return f"::::{{tab-set}}\n{body}\n::::"

    return re.sub(r"^<!-- tabs -->\n(.*?)^<!-- end tabs -->$", tabs, text, flags=re.M | re.S)


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout


def write(folder, name, text):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    # An unchanged page keeps its time, so that Sphinx need not read it again.
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    return path


def topic_page(name):
    return f"reference/commands/help-{name}.md"


def topic_pages(program, folder):
    """A page for each topic of the help: its sections, word for word, under headings."""
    written = set()
    listed = help_of(program).split("\nTopics:\n")[1].split("\n\n")[0]
    for name, about in re.findall(r"^  (\w+) +(.+)$", listed, re.M):
        page = f"# cullhull help {name}\n\n{about}, as `cullhull help {name}` prints them.\n"
        text = subprocess.run([program, "help", name], check=True, capture_output=True, text=True).stdout
        for block in text.strip("\n").split("\n\n"):
            title, _, body = block.partition(":\n")
            if body.startswith("  "):
                page += f"\n## {title}\n"
                block = textwrap.dedent(body)
            page += f"\n```text\n{block}\n```\n"
        written.add(write(folder, topic_page(name), page))
    return written


def command_pages(program, folder):
    """A page for each command, and one for the program that measures."""
    written = set()
    for name in COMMANDS:
        about, rest = help_of(program, name).split("\n", 1)
        page = f"# cullhull {name}\n\n{about}.\n\n```text\n{rest.strip()}\n```\n"
        written.add(write(folder, f"reference/commands/{name}.md", page))
    bench = f"{program}-bench"
    text = help_of(bench)
    page = f"# cullhull-bench\n\nMeasurements; `make bench` builds it.\n\n```text\n{text.strip()}\n```\n"
    for suite in re.findall(r"^  (\w+) {3,}", text.split("Subcommands:")[1].split("\n\n")[0], re.M):
        about, rest = help_of(bench, suite).split("\n", 1)
        page += f"\n## cullhull-bench {suite}\n\n{about}.\n\n```text\n{rest.strip()}\n```\n"
    written.add(write(folder, "reference/commands/cullhull-bench.md", page))
    return written


def first_comment(header):
    """What the header says it holds."""
    lines = []
    for line in header.read_text().splitlines():
        if not line.startswith("//"):
            break
        lines.append(line[2:].strip())
    return " ".join(lines)


def header_pages(folder):
    """A page for each public header, by Doxygen and Breathe."""
    written = set()
    for header, page in headers().items():
        source = f"{HOST}/blob/main/include/cullhull/{header.name}"
        body = f"# {header.name}\n\n`#include <cullhull/{header.name}>` ([source]({source}))\n\n"
        body += f"{first_comment(header)}\n\n"
        body += f"```{{eval-rst}}\n.. doxygenfile:: {header.name}\n```\n"
        written.add(write(folder, str(page), body))
    return written


def python_pages(folder):
    """A page for each class and function that the tables of the Python reference name."""
    written = set()
    text = (root / "docs" / "reference" / "python.md").read_text()
    for table in re.findall(r"^\.\. autosummary::\n((?:   :.*\n)*)\n((?:   \S+\n)+)", text, re.M):
        for name in table[1].split():
            short = name.removeprefix("cullhull.")
            kind = "class" if re.match(r"[A-Z]", short.split(".")[-1]) else "function"
            title = f"cullhull.{short}" if kind == "class" else f"cullhull.{short}()"
            whole = "\n   :no-inherited-members:" if short in ALONE else ""
            body = f"# {title}\n\n```{{eval-rst}}\n.. currentmodule:: cullhull\n\n.. auto{kind}:: {name}{whole}\n```\n"
            written.add(write(folder, f"reference/python/{short}.md", body))
    return written


def without_private(xml):
    for path in pathlib.Path(xml).glob("*.xml"):
        text = path.read_text()
        public = re.sub(r'<sectiondef kind="private-[\w-]+">.*?</sectiondef>', "", text, flags=re.S)
        if public != text:
            path.write_text(public)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, xml, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    without_private(xml)
    folder.mkdir(parents=True, exist_ok=True)
    found, kept = pages(), {}
    found = {path: site for path, site in found.items() if path.exists()}
    written = set()
    goals = found | headers()
    for path, site in found.items():
        written.add(write(folder, str(site), turned(path.read_text(), path, goals, kept)))
    for goal, file in kept.items():
        target = folder / goal
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_bytes() != file.read_bytes():
            shutil.copyfile(file, target)
        written.add(target)
    written |= command_pages(program, folder) | topic_pages(program, folder)
    written |= header_pages(folder) | python_pages(folder)
    for path in folder.rglob("*"):  # pages that were
        if path.is_file() and path not in written:
            path.unlink()


main()
