#!/usr/bin/env python3
"""Man pages and shell completions of a program, generated from its help.

scripts/program-pages.py PROGRAM FOLDER writes FOLDER/man1/cullhull.1 and one page per command,
FOLDER/man7 with one page per help topic, FOLDER/cullhull.bash, FOLDER/cullhull.fish and
FOLDER/_cullhull (zsh).
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Option:
    names: list[str]
    value: str  # what the help calls its value, empty for a flag
    text: str
    listed: list[str] = field(default_factory=list)  # values that the help lists elsewhere

    def words(self) -> list[str]:
        """The values it takes, where they are known."""
        value = self.value.replace(" REQUIRED", "").replace(" ...", "").strip()
        plain = re.fullmatch(r"[a-z0-9-]+(\|[a-z0-9-]+)*", value)
        return value.split("|") if plain else self.listed

    def needs_value(self) -> bool:
        return bool(self.value) and not self.value.startswith("[=")

    def takes_file(self) -> bool:
        return bool(re.search(r"FILE|FOLDER|PAGE|IDS|OUT", self.value))


@dataclass
class Command:
    words: list[str]  # "cullhull", "hull"
    summary: str
    usage: str = ""
    positionals: list[Option] = field(default_factory=list)
    sections: list[tuple[str, list[Option]]] = field(default_factory=list)
    commands: list[tuple[str, str]] = field(default_factory=list)
    topics: list[tuple[str, str]] = field(default_factory=list)
    footer: str = ""

    def name(self) -> str:
        return "-".join(self.words)

    @property
    def options(self) -> list[Option]:
        return [one for _, options in self.sections for one in options]

    def footer_parts(self) -> tuple[str, str, str]:
        """Notes, examples and exit status."""
        notes, examples, status = [], [], []
        for block in self.footer.split("\n\n"):
            if block.startswith("Examples:\n"):
                examples.append(block.removeprefix("Examples:\n"))
            elif block.startswith("Exit status: "):
                status.append(block.removeprefix("Exit status: "))
            else:
                notes.append(block)
        return tuple("\n\n".join(part).strip("\n") for part in (notes, examples, status))


def entries(lines: list[str]) -> list[tuple[str, str]]:
    """Pairs of a term and its text, as CLI11 lays them out: the text begins at column 30."""
    found: list[tuple[str, str]] = []
    for line in lines:
        if line.startswith("  ") and line[2] != " ":
            fits = len(line) > 30 and line[29] == " " and line[30] != " "
            found.append((line[2:30].strip(), line[30:].strip()) if fits else (line.strip(), ""))
        elif found:
            term, text = found[-1]
            found[-1] = (term, (text + " " + line.strip()).strip())
    return found


def option(term: str, text: str) -> Option:
    names, _, value = term.partition(" ")
    return Option(names.split(","), value.strip(), text)


def describe(program: str, words: list[str]) -> Command:
    help_text = subprocess.run(
        [program, *words[1:], "--help"], check=True, capture_output=True, text=True
    ).stdout
    head, _, rest = help_text.partition("\nUsage: ")
    command = Command(words, head.replace("cullhull: ", "", 1) if len(words) == 1 else head)
    lines = rest.split("\n")
    command.usage = lines[0]
    at = 1
    while at < len(lines):
        end = at + 1
        while end < len(lines) and lines[end].startswith("  "):
            end += 1
        title, body = lines[at], lines[at + 1 : end]
        if title in ("Positionals:", "Subcommands:", "Topics:"):
            found = entries(body)
            if title == "Subcommands:":
                command.commands = found
            elif title == "Topics:":
                command.topics = found
            else:
                command.positionals = [option(*entry) for entry in found]
        elif re.fullmatch(r"[A-Z][a-z ]*:", title) and body and body[0].startswith("  -"):
            command.sections.append((title[:-1], [option(*entry) for entry in entries(body)]))
        elif title:
            command.footer = "\n".join(lines[at:]).strip("\n")
            break
        at = end
    list_values(command)
    return command


def list_values(command: Command) -> None:
    """Values that the help lists in its footer: shapes, motions, words of --format."""
    listed = {}
    words = re.search(r"--format takes[^:]*: ((?:.|\n  )*?)[.(]", command.footer)
    if words:
        items = words[1].split(",")
        listed["--format"] = (
            items[0].split() if len(items) == 1 else [item.split()[0] for item in items]
        )
    for title, names in (("Shapes", "SHAPE"), ("Motions", "--motion")):
        found = re.search(rf"^{title}.*:\n((?:  .*\n)+)", command.footer + "\n", re.M)
        if found:
            listed[names] = [line.split()[0] for line in found[1].splitlines()]
    for one in [*command.positionals, *command.options]:
        for name in one.names:
            one.listed = listed.get(name, one.listed)


# ------------------------------------------------------------------------------- man pages


def roff(text: str) -> str:
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\n".join("\\&" + line if line[:1] == "." else line for line in text.split("\n"))


def man_page(command: Command, version: str, topics: list[tuple[str, str]]) -> str:
    first = command.summary.split("\n")[0].rstrip(".")
    out = [
        f'.TH "{command.name().upper()}" 1 "" "cullhull {version}" "User Commands"',
        ".SH NAME",
        f"{roff(command.name())} \\- {roff(first[:1].lower() + first[1:])}",
        ".SH SYNOPSIS",
        roff(command.usage),
        ".SH DESCRIPTION",
        roff(command.summary),
    ]
    sections = [(f".SS {title}", options) for title, options in command.sections]
    if sections:
        sections[0] = (".SH OPTIONS\n" + sections[0][0], sections[0][1])
    for title, options in ((".SH ARGUMENTS", command.positionals), *sections):
        if options:
            out.append(title)
        for one in options:
            names = ", ".join(f"\\fB{roff(name)}\\fR" for name in one.names)
            out += [".TP", f"{names} {roff(one.value)}".rstrip(), roff(one.text)]
    if command.commands:
        out.append(".SH COMMANDS")
        for name, text in command.commands:
            page = f"{command.name()}-{name}"
            out += [".TP", f"\\fB{roff(name)}\\fR", f"{roff(text)} (\\fB{roff(page)}\\fR(1))"]
    if command.topics:
        out.append(".SH TOPICS")
        for name, text in command.topics:
            page = f"{command.name()}-{name}"
            out += [".TP", f"\\fB{roff(name)}\\fR", f"{roff(text)} (\\fB{roff(page)}\\fR(7))"]
    notes, examples, status = command.footer_parts()
    if notes:
        out += [".SH NOTES", ".nf", roff(notes), ".fi"]
    if examples:
        out += [".SH EXAMPLES", ".nf", roff(examples), ".fi"]
    if status:
        out += [".SH EXIT STATUS", roff(status)]
    if len(command.words) > 1:
        parent = "-".join(command.words[:-1])
        pages = [f"{parent}(1)", *(f"{parent}-{name}(7)" for name, _ in topics)]
        out += [".SH SEE ALSO", ",\n".join(f"\\fB{roff(p[:-3])}\\fR{p[-3:]}" for p in pages)]
    return "\n".join(out) + "\n"


def topic_page(program: str, name: str, about: str, version: str) -> str:
    text = subprocess.run(
        [program, "help", name], check=True, capture_output=True, text=True
    ).stdout.strip("\n")
    page = f"cullhull-{name}"
    return "\n".join(
        [
            f'.TH "{page.upper()}" 7 "" "cullhull {version}" "Miscellaneous"',
            ".SH NAME",
            f"{roff(page)} \\- {roff(about[:1].lower() + about[1:])}",
            ".SH DESCRIPTION",
            ".nf",
            roff(text),
            ".fi",
            ".SH SEE ALSO",
            "\\fBcullhull\\fR(1)",
            "",
        ]
    )


# ------------------------------------------------------------------------------- completions


def bash(tree: list[Command]) -> str:
    """The values of an option, or files where it takes one; options after a dash; else files, the
    values of an argument and, as the first word, commands."""
    options, values, arguments, files, others = [], [], [], [], []
    for command in tree:
        path = " ".join(command.words[1:])
        names = [n for o in command.options for n in o.names]
        options.append(f'      "{path}") known="{" ".join(names)}" ;;')
        for one in command.options:
            pattern = "|".join(f'"{path} {name}"' for name in one.names)
            if one.words():
                values.append(f'    {pattern}) words="{" ".join(one.words())}" ;;')
            elif one.needs_value():
                (files if one.takes_file() else others).append(pattern)
        for one in command.positionals:
            if one.words():
                arguments.append(f'    "{path}") words="{" ".join(one.words())}" ;;')
        if command.commands:
            words = " ".join(name for name, _ in command.commands)
            arguments.append(f'    "{path}") words="{words} help" ;;')
    topics = " ".join(name for name, _ in [*tree[0].commands, *tree[0].topics])
    arguments.append(f'    "help") words="{topics}" ;;')
    commands = "|".join(f'"{" ".join(c.words[1:])}"' for c in tree if len(c.words) > 1)
    return f"""# bash completion of cullhull
_cullhull() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local path="" known="" words="" prefix="" i
  # --cull=g is one word, or the three words --cull, = and g.
  if [[ $word == "=" ]]; then
    word=""
  elif [[ $before == "=" ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  elif [[ $word == --*=* ]]; then
    before=${{word%%=*}} prefix=${{word%%=*}}= word=${{word#*=}}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${{path:+$path }}${{COMP_WORDS[i]}}" in
    {commands}|"help") path="${{path:+$path }}${{COMP_WORDS[i]}}" ;;
    esac
  done
  # A file in the place of a command means the hull of this file.
  if [[ -z $path && $COMP_CWORD -gt 1 && ${{COMP_WORDS[1]}} != -* ]]; then path=hull; fi
  case "$path $before" in
{chr(10).join(values)}
    {"|".join(files)})
      mapfile -t COMPREPLY < <(compgen -P "$prefix" -f -- "$word")
      return
      ;;
    {"|".join(others)})
      COMPREPLY=()
      return
      ;;
  esac
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -P "$prefix" -W "$words" -- "$word")
    return
  fi
  if [[ $word == -* ]]; then
    case "$path" in
{chr(10).join(options)}
    esac
    mapfile -t COMPREPLY < <(compgen -W "$known" -- "$word")
    return
  fi
  case "$path" in
{chr(10).join(arguments)}
  esac
  mapfile -t COMPREPLY < <(
    [[ $path == help ]] || compgen -f -- "$word"
    [[ -z $words ]] || compgen -W "$words" -- "$word"
  )
}}
complete -o filenames -o nosort -F _cullhull cullhull
"""


def quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"


def fish_quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish(tree: list[Command]) -> str:
    out = ["# fish completion of cullhull"]
    for command in tree:
        if len(command.words) > 2:
            continue
        name = command.words[1] if len(command.words) == 2 else ""
        when = f"__fish_seen_subcommand_from {name}" if name else "__fish_use_subcommand"
        for sub, text in command.commands:
            known = f"-a {sub} -d {fish_quoted(text)}"
            out.append(f"complete -c cullhull -n {fish_quoted(when)} {known}")
        if command.commands:
            known = f"-a help -d {fish_quoted('Help of a command or a topic')}"
            out.append(f"complete -c cullhull -n {fish_quoted(when)} {known}")
        if command.topics:
            words = " ".join(name for name, _ in [*command.commands, *command.topics])
            known = f"-x -a {fish_quoted(words)}"
            out.append(f"complete -c cullhull -n '__fish_seen_subcommand_from help' {known}")
        for one in command.positionals:
            if one.words():
                known = f"-a {fish_quoted(' '.join(one.words()))} -d {fish_quoted(one.text)}"
                out.append(f"complete -c cullhull -n {fish_quoted(when)} {known}")
        for one in command.options:
            names = "".join(
                f" -l {n[2:]}" if n.startswith("--") else f" -s {n[1:]}" for n in one.names
            )
            words = f" -x -a {fish_quoted(' '.join(one.words()))}" if one.words() else ""
            if not words and one.needs_value():
                words = " -r -F" if one.takes_file() else " -x"
            says = f"-d {fish_quoted(one.text)}"
            out.append(f"complete -c cullhull -n {fish_quoted(when)}{names}{words} {says}")
    return "\n".join(out) + "\n"


def zsh(tree: list[Command]) -> str:
    def text_of(text: str) -> str:
        return re.sub(r"([\[\]:])", r"\\\1", text)

    out = ["#compdef cullhull", "# zsh completion of cullhull", ""]
    top = tree[0]
    functions = []
    for command in tree[1:]:
        specs = []
        for one in command.options:
            shown = "[" + text_of(one.text) + "]"
            action = ""
            if one.words():
                action = ":" + "value:(" + " ".join(one.words()) + ")"
            elif one.needs_value():
                action = ":" + text_of(one.value.split()[0]) + ":"
                action += "_files" if one.takes_file() else ""
            for name in one.names:
                equals = "=" if name.startswith("--") and action else ""
                specs.append(quoted(f"*{name}{equals}{shown}{action}"))
        for one in command.positionals:
            if one.words():
                specs.append(quoted(f"1:{one.names[0].lower()}:({' '.join(one.words())})"))
        specs.append("'*:file:_files'")
        body = " \\\n    ".join(specs)
        function = "_" + command.name().replace("-", "_")
        functions.append(f"{function}() {{\n  _arguments -s \\\n    {body}\n}}\n")
    out += functions
    listed = "\n".join(f"    {quoted(name + ':' + text_of(text))}" for name, text in top.commands)
    cases = "\n".join(
        f"    {c.words[1]}) _{c.name().replace('-', '_')} ;;" for c in tree[1:] if len(c.words) == 2
    )
    topics = " ".join(name for name, _ in [*top.commands, *top.topics])
    out.append(f"""_cullhull() {{
  local -a commands=(
{listed}
  )
  if ((CURRENT == 2)); then
    _describe command commands
    _files
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{cases}
    help) _arguments '1:topic:({topics})' ;;
    *) _files ;;
  esac
}}

_cullhull "$@"
""")
    return "\n".join(out)


def main() -> None:
    program, folder = sys.argv[1], Path(sys.argv[2])
    version = subprocess.run(
        [program, "--version"], check=True, capture_output=True, text=True
    ).stdout.strip()
    tree: list[Command] = []

    def visit(words: list[str]) -> None:
        command = describe(program, words)
        tree.append(command)
        for name, _ in command.commands:
            visit([*words, name])

    visit(["cullhull"])
    (folder / "man1").mkdir(parents=True, exist_ok=True)
    (folder / "man7").mkdir(parents=True, exist_ok=True)
    for command in tree:
        page = man_page(command, version, tree[0].topics)
        (folder / "man1" / f"{command.name()}.1").write_text(page)
    for name, about in tree[0].topics:
        page = topic_page(program, name, about, version)
        (folder / "man7" / f"cullhull-{name}.7").write_text(page)
    (folder / "cullhull.bash").write_text(bash(tree))
    (folder / "cullhull.fish").write_text(fish(tree))
    (folder / "_cullhull").write_text(zsh(tree))


if __name__ == "__main__":
    main()
