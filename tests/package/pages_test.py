"""The man pages and completions that are made of a program's own help: pages_test.py PROGRAM."""

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
    script = root / "scripts/program-pages.py"
    subprocess.run([sys.executable, script, program, folder], check=True)


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

    def test_roff_is_clean(self) -> None:
        groff = shutil.which("groff")
        if groff is None:
            self.skipTest("no groff to read the pages with")
        for page in (folder / "man1").iterdir():
            ran = subprocess.run(
                [groff, "-man", "-Tascii", "-ww", "-z", page], capture_output=True, text=True
            )
            self.assertEqual(ran.stderr, "", page.name)

    def test_bash(self) -> None:
        self.assertEqual(complete("cullhull", "gen"), ["generate"])
        self.assertEqual(complete("cullhull", "hull", "--cull", "g"), ["gauge"])
        self.assertIn("--certify", complete("cullhull", "hull", "--c"))
        self.assertNotIn("--certify", complete("cullhull", "info", "--c"))

    def test_other_shells(self) -> None:
        for shell, file, option in (("zsh", "_cullhull", "-n"), ("fish", "cullhull.fish", "-n")):
            text = (folder / file).read_text()
            self.assertIn("pseudo-hull", text)
            if shutil.which(shell):
                subprocess.run([shell, option, folder / file], check=True)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
