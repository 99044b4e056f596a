#!/usr/bin/env python3
"""Man pages and shell completions of a program, made of what it says of itself.

scripts/program-pages.py PROGRAM FOLDER writes FOLDER/man1/cullhull.1 and one page per command,
FOLDER/cullhull.bash, FOLDER/cullhull.fish and FOLDER/_cullhull (zsh).
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

    def words(self) -> list[str]:
        """The values it takes, where they are listed."""
        value = self.value.replace(" REQUIRED", "").replace(" ...", "").strip()
        plain = re.fullmatch(r"[a-z0-9-]+(\|[a-z0-9-]+)*", value)
        return value.split("|") if plain else []


@dataclass
class Command:
    words: list[str]  # "cullhull", "hull"
    summary: str
    usage: str = ""
    positionals: list[Option] = field(default_factory=list)
    options: list[Option] = field(default_factory=list)
    commands: list[tuple[str, str]] = field(default_factory=list)
    footer: str = ""

    def name(self) -> str:
        return "-".join(self.words)


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
    sections = {"Positionals:", "Options:", "Subcommands:"}
    while at < len(lines):
        if lines[at] in sections:
            title, end = lines[at], at + 1
            while end < len(lines) and lines[end].startswith("  "):
                end += 1
            found = entries(lines[at + 1 : end])
            if title == "Subcommands:":
                command.commands = found
            else:
                into = command.options if title == "Options:" else command.positionals
                into.extend(option(*entry) for entry in found)
            at = end
        elif lines[at]:
            command.footer = "\n".join(lines[at:]).strip("\n")
            break
        else:
            at += 1
    return command


# ------------------------------------------------------------------------------- man pages


def roff(text: str) -> str:
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\n".join("\\&" + line if line[:1] == "." else line for line in text.split("\n"))


def man_page(command: Command, version: str) -> str:
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
    for title, options in (("ARGUMENTS", command.positionals), ("OPTIONS", command.options)):
        if options:
            out.append(f".SH {title}")
        for one in options:
            names = ", ".join(f"\\fB{roff(name)}\\fR" for name in one.names)
            out += [".TP", f"{names} {roff(one.value)}".rstrip(), roff(one.text)]
    if command.commands:
        out.append(".SH COMMANDS")
        for name, text in command.commands:
            page = f"{command.name()}-{name}"
            out += [".TP", f"\\fB{roff(name)}\\fR", f"{roff(text)} (\\fB{roff(page)}\\fR(1))"]
    if command.footer:
        out += [".SH NOTES", ".nf", roff(command.footer), ".fi"]
    if len(command.words) > 1:
        parent = "-".join(command.words[:-1])
        out += [".SH SEE ALSO", f"\\fB{roff(parent)}\\fR(1)"]
    return "\n".join(out) + "\n"


# ------------------------------------------------------------------------------- completions


def bash(tree: list[Command]) -> str:
    """Commands first, then options, the words of an option, else files."""
    cases, values = [], []
    for command in tree:
        path = " ".join(command.words[1:])
        names = [n for o in command.options for n in o.names] + [c for c, _ in command.commands]
        cases.append(f'    "{path}") known="{" ".join(names)}" ;;')
        for one in command.options:
            if one.words():
                pattern = "|".join(f'"{path} {name}"' for name in one.names)
                values.append(f'    {pattern}) words="{" ".join(one.words())}" ;;')
    commands = "|".join(f'"{" ".join(c.words[1:])}"' for c in tree if len(c.words) > 1)
    return f"""# bash completion of cullhull
_cullhull() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local path="" known="" words="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${{path:+$path }}${{COMP_WORDS[i]}}" in
    {commands}) path="${{path:+$path }}${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$path $before" in
{chr(10).join(values)}
  esac
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    return
  fi
  case "$path" in
{chr(10).join(cases)}
  esac
  mapfile -t COMPREPLY < <(compgen -W "$known" -- "$word"
    [[ $word == -* ]] || compgen -f -- "$word")
}}
complete -o filenames -F _cullhull cullhull
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
        for one in command.options:
            names = "".join(
                f" -l {n[2:]}" if n.startswith("--") else f" -s {n[1:]}" for n in one.names
            )
            words = f" -x -a {fish_quoted(' '.join(one.words()))}" if one.words() else ""
            if not words and one.value and not one.value.startswith("[="):
                words = " -r"
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
            elif one.value and not one.value.startswith("[="):
                action = ":" + text_of(one.value.split()[0]) + ":_files"
            for name in one.names:
                equals = "=" if name.startswith("--") and action else ""
                specs.append(quoted(f"*{name}{equals}{shown}{action}"))
        specs.append("'*:file:_files'")
        body = " \\\n    ".join(specs)
        function = "_" + command.name().replace("-", "_")
        functions.append(f"{function}() {{\n  _arguments -s \\\n    {body}\n}}\n")
    out += functions
    listed = "\n".join(f"    {quoted(name + ':' + text_of(text))}" for name, text in top.commands)
    cases = "\n".join(
        f"    {c.words[1]}) _{c.name().replace('-', '_')} ;;" for c in tree[1:] if len(c.words) == 2
    )
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
    for command in tree:
        (folder / "man1" / f"{command.name()}.1").write_text(man_page(command, version))
    (folder / "cullhull.bash").write_text(bash(tree))
    (folder / "cullhull.fish").write_text(fish(tree))
    (folder / "_cullhull").write_text(zsh(tree))


if __name__ == "__main__":
    main()
