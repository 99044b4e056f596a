"""The man pages and completions that are made of a program's own help: pages_test.py PROGRAM."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

root = Path(__file__).resolve().parents[2]
program = sys.argv.pop(1)
folder = Path(tempfile.mkdtemp())


def setUpModule() -> None:
    subprocess.run([program, "man", "--folder", folder], check=True)
    for shell, name in (("bash", "cullhull.bash"), ("fish", "cullhull.fish"), ("zsh", "_cullhull")):
        with open(folder / name, "wb") as script:
            subprocess.run([program, "completion", shell], check=True, stdout=script)


def tearDownModule() -> None:
    shutil.rmtree(folder)


def help_of(*words: str) -> str:
    return subprocess.run(
        [program, *words, "--help"], check=True, capture_output=True, text=True
    ).stdout


def complete(*words: str) -> "list[str]":
    """What bash offers for the last of the words."""
    script = f"""source {folder}/cullhull.bash
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_cullhull
printf '%s\\n' "${{COMPREPLY[@]}}" """
    ran = subprocess.run(
        ["bash", "-c", script, "bash", *words], check=True, capture_output=True, text=True
    )
    return ran.stdout.split()


class Pages(unittest.TestCase):
    def test_every_option_is_on_its_page(self) -> None:
        listed = help_of().split("Subcommands:")[1].split("\n\n")[0]
        commands = re.findall(r"^  ([a-z]+) ", listed, re.M)
        self.assertIn("hull", commands)
        for command in commands:
            page = (folder / "man1" / f"cullhull-{command}.1").read_text().replace("\\-", "-")
            for option in re.findall(r"^  (-[\w,-]+)", help_of(command), re.M):
                for name in option.split(","):
                    self.assertIn(f"\\fB{name}\\fR", page, command)

    def test_sections(self) -> None:
        page = (folder / "man1/cullhull-hull.1").read_text().replace("\\-", "-")
        headings = re.findall(r"^\.S[HS] (.*)$", page, re.M)
        self.assertEqual(headings[:3], ["NAME", "SYNOPSIS", "DESCRIPTION"])
        for heading in ("OPTIONS", "Input", "Filter", "EXAMPLES", "EXIT STATUS"):
            self.assertIn(heading, headings)
        examples = page.split(".SH EXAMPLES\n.nf\n")[1].split(".fi")[0]
        self.assertIn("cullhull hull scan.ply -o hull.ply", examples)
        self.assertNotIn("Examples:", page)
        self.assertIn("\\fBcullhull-formats\\fR(7)", page)

    def test_every_command_has_examples(self) -> None:
        for page in (folder / "man1").iterdir():
            self.assertIn("\n.SH EXAMPLES\n", page.read_text(), page.name)

    def test_a_page_alone(self) -> None:
        for name, page in ((), "man1/cullhull.1"), (("hull",), "man1/cullhull-hull.1"), (
            ("formats",),
            "man7/cullhull-formats.7",
        ):
            ran = subprocess.run([program, "man", *name], check=True, capture_output=True, text=True)
            self.assertEqual(ran.stdout, (folder / page).read_text(), page)
        ran = subprocess.run([program, "man", "hul"], capture_output=True, text=True)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("did you mean hull?", ran.stderr)

    def test_topics(self) -> None:
        page = (folder / "man7/cullhull-formats.7").read_text()
        self.assertIn(".pcd", page)
        self.assertIn("man7", (root / "cmake/Pages.cmake").read_text(), "pages that are installed")

    def test_roff_is_clean(self) -> None:
        groff = shutil.which("groff")
        if groff is None:
            self.skipTest("no groff to read the pages with")
        for page in [*(folder / "man1").iterdir(), *(folder / "man7").iterdir()]:
            ran = subprocess.run(
                [groff, "-man", "-Tascii", "-ww", "-z", page], capture_output=True, text=True
            )
            self.assertEqual(ran.stderr, "", page.name)

    def test_bash(self) -> None:
        self.assertEqual(complete("cullhull", "gen"), ["generate"])
        self.assertEqual(complete("cullhull", "hull", "--cull", "g"), ["gauge"])
        self.assertIn("--certify", complete("cullhull", "hull", "--c"))
        self.assertNotIn("--certify", complete("cullhull", "info", "--c"))

    def test_bash_values(self) -> None:
        gauge = ["gauge"]
        # As bash divides the line, and as it does with = taken out of COMP_WORDBREAKS.
        self.assertEqual(complete("cullhull", "hull", "--cull", "=", "g"), gauge)
        self.assertEqual(complete("cullhull", "hull", "--cull=g"), ["--cull=gauge"])
        self.assertEqual(complete("cullhull", "p.npy", "--cull", "g"), gauge, "hull is understood")
        every = ["auto", "gauge", "pseudo-hull", "none"]
        self.assertEqual(complete("cullhull", "hull", "--cull", "="), every)
        self.assertIn("sphere", complete("cullhull", "generate", "s"))
        self.assertEqual(complete("cullhull", "generate", "ball", "--motion", "tw"), ["twist"])
        self.assertEqual(complete("cullhull", "info", "--input-format", "np"), ["npy"])
        self.assertIn("FV", complete("cullhull", "hull", "--format", "F"))
        self.assertEqual(complete("cullhull", "delaunay", "--format", ""), ["i", "Fn", "Fx", "p"])
        self.assertEqual(complete("cullhull", "voronoi", "--format", ""), ["p", "o", "Fv"])
        self.assertEqual(complete("cullhull", "hull", "--threads", ""), [], "a number")
        self.assertEqual(complete("cullhull", "help", "form"), ["formats"])
        self.assertEqual(complete("cullhull", "help", "hu"), ["hull"])

    def test_bash_files(self) -> None:
        place = Path(tempfile.mkdtemp())
        for name in ("a.npy", "b.csv"):
            (place / name).touch()
        here = os.getcwd()
        os.chdir(place)
        try:
            both = ["a.npy", "b.csv"]
            self.assertEqual(sorted(complete("cullhull", "hull", "")), both)
            self.assertEqual(complete("cullhull", "hull", "-o", "a"), ["a.npy"])
            self.assertEqual(complete("cullhull", "hull", "--vertices", "=", "b"), ["b.csv"])
            first = complete("cullhull", "")
            self.assertEqual(sorted(first[-2:]), both, "commands come before files")
            (place / "hull.npy").touch()
            self.assertEqual(complete("cullhull", "hu"), ["hull", "hull.npy"])
            self.assertIn("hull", first)
            self.assertIn("help", first)
        finally:
            os.chdir(here)
            shutil.rmtree(place)

    def test_other_shells(self) -> None:
        for shell, file, option in (("zsh", "_cullhull", "-n"), ("fish", "cullhull.fish", "-n")):
            text = (folder / file).read_text()
            for word in ("pseudo-hull", "sphere", "twist", "formats"):
                self.assertIn(word, text)
            if shutil.which(shell):
                subprocess.run([shell, option, folder / file], check=True)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
