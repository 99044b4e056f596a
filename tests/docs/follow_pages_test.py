#!/usr/bin/env python3
"""What scripts/follow-docs.sh runs in an empty root: the script that follow_pages.py makes of pages."""

import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

import follow_pages
import samples


def script(*pages):
    sys.argv[1:] = map(str, pages)
    made = io.StringIO()
    with contextlib.redirect_stdout(made):
        follow_pages.main()
    return made.getvalue()


class FollowPages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="cullhull-follow-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.addCleanup(setattr, follow_pages, "HOME", follow_pages.HOME)
        follow_pages.HOME = folder.name

    def followed(self, text):
        """Exit status and output of a page's commands."""
        page = self.folder / "page.md"
        page.write_text(text)
        ran = subprocess.run(["bash", "-c", script(page)], capture_output=True, text=True, check=False)
        return ran.returncode, ran.stdout

    def test_every_page_gives_a_script(self):
        pages = ["README.md", "docs/install.md"]
        pages += sorted(str(p.relative_to(samples.ROOT)) for p in (samples.ROOT / "docs/tutorials").glob("*.md"))
        made = script(*pages)
        checked = subprocess.run(["bash", "-n"], input=made, capture_output=True, text=True, check=False)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))
        for command in ("make demo", "make static", "make wheel", "make deb", "cmake --preset install",
                        "venv/bin/pip install .", "-m doctest", "| diff -"):
            self.assertIn(command, made)
        self.assertNotIn("\nmake test", made)

    def test_commands_run_in_order(self):
        status, printed = self.followed("```bash\necho one\necho two &&\n  echo three\n```\n\n    echo four   # a comment\n")
        self.assertEqual(status, 0)
        said = [line for line in printed.splitlines() if not line.startswith("follow:")]
        self.assertEqual(said, ["one", "two", "three", "four"])
        self.assertIn("follow: all of it worked", printed)

    def test_any_failing_command_ends_it(self):
        for command in ("false", "false && true", "true && false", "false | cat", "cd nowhere"):
            with self.subTest(command):
                status, printed = self.followed(f"```bash\n{command}\necho after\n```\n")
                self.assertEqual(status, 1)
                self.assertNotIn("\nafter", printed)

    def test_a_section_that_is_not_there_is_refused(self):
        with self.assertRaises(SystemExit):
            script("docs/install.md#nowhere")


if __name__ == "__main__":
    unittest.main(verbosity=2)
