#!/usr/bin/env python3
"""pages_test.py: what must hold of the pages as they lie in the tree, whoever shows them: links and
pictures lead to something, lines are not long, files that are named exist, the version is one."""

import re
import subprocess
import sys
import unittest

import samples

ROOT = samples.ROOT
FACE = [ROOT / f"{name}.md" for name in ("README", "HACKING", "CHANGELOG", "CONTRIBUTING", "SECURITY")]
PAGES = FACE + sorted((ROOT / "docs").rglob("*.md"))


def without_code(text):
    return re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)


class Pages(unittest.TestCase):
    def test_links_and_pictures_lead_somewhere(self):
        broken, checked = [], 0
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text())):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = target.partition("#")
                file = (page.parent / name).resolve() if name else page
                checked += 1
                if not file.exists():
                    broken.append(f"{page.relative_to(ROOT)}: {target}")
        self.assertEqual(broken, [])
        self.assertGreater(checked, 100)

    def test_lines_are_at_most_100_columns(self):
        long = []
        for page in PAGES:
            for number, line in enumerate(page.read_text().splitlines(), 1):
                # Tables cannot be broken; combining marks take no column.
                width = len(re.sub("[\u0300-\u036f]", "", line))
                if width > 100 and not line.lstrip().startswith(("|", "!")):
                    long.append(f"{page.relative_to(ROOT)}:{number}: {width}")
        self.assertEqual(long, [])

    def test_subjects_of_commits_are_short(self):
        """Of those since the rule; where there is no history, nothing can be said."""
        first = "fc3828e080"
        told = subprocess.run(
            ["git", "-C", str(ROOT), "log", "--format=%s", f"{first}..HEAD"],
            capture_output=True, text=True, check=False)
        if told.returncode != 0:
            self.skipTest("no history here")
        self.assertEqual([line for line in told.stdout.splitlines() if len(line) > 72], [])

    def test_files_that_are_named_exist(self):
        absent = []
        name = re.compile(r"`((?:src|include|apps|tests|bench|bindings|viewer|scripts|examples|docs|fuzz)/[^`\s]*)`")
        for page in PAGES:
            if page.name == "CHANGELOG.md":
                continue  # tells of what was
            for target in name.findall(page.read_text()):
                if re.search(r"NAME|[<>(){}]", target):
                    continue
                # `src/x/y_*`, `src/x/y.*` and folders are patterns
                # a benchmark is named by its program
                if not list(ROOT.glob(target.rstrip("/"))) and not list(ROOT.glob(target + ".cpp")):
                    absent.append(f"{page.relative_to(ROOT)}: {target}")
        self.assertEqual(absent, [])

    def test_the_version_is_one(self):
        header = (ROOT / "include" / "cullhull" / "version.hpp").read_text()
        version = re.search(r'define CULLHULL_VERSION "([^"]+)"', header)[1]
        parts = re.findall(r"CULLHULL_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header)
        self.assertEqual(".".join(parts), version)
        cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)[1]
        self.assertEqual(cited, version)
        package = (ROOT / "bindings" / "r" / "DESCRIPTION").read_text()
        self.assertIn(f"\nVersion: {version}\n", package)
        self.assertIn(f"## [{version}]", (ROOT / "CHANGELOG.md").read_text())
        self.assertNotRegex((ROOT / "CMakeLists.txt").read_text(), r"project\(cullhull VERSION \d")

    def test_every_header_is_in_the_reference(self):
        listed = (ROOT / "docs" / "reference" / "cpp.md").read_text()
        for header in (ROOT / "include" / "cullhull").glob("*.hpp"):
            if header.stem not in ("cullhull", "version"):
                self.assertIn(f"/{header.name})", listed)

    def test_every_page_is_in_a_list_of_the_site(self):
        index = (ROOT / "docs" / "index.md").read_text()
        for page in (ROOT / "docs").glob("*.md"):
            if page.stem != "index":
                self.assertRegex(index, rf"(?m)^(?:.*<)?{page.stem}>?$")

    def test_the_commands_of_pages_are_a_script(self):
        tutorials = sorted(f"docs/tutorials/{page.name}" for page in (ROOT / "docs" / "tutorials").glob("*.md"))
        pages = ["README.md", "docs/install.md", "docs/install.md#python-package", *tutorials]
        follow = [sys.executable, str(ROOT / "tests" / "docs" / "follow_pages.py"), *pages]
        script = subprocess.run(follow, check=True, capture_output=True, text=True).stdout
        subprocess.run(["bash", "-n"], input=script, check=True, text=True)
        for command in ("make demo", "make static", "make deb", "make wheel", "cmake --preset install", "pipx install"):
            self.assertIn(f"\n{command}", script)
        self.assertGreater(script.count("\necho 'follow: docs/tutorials/"), 25)

    def test_the_chart_of_speed_is_that_of_the_table(self):
        sys.path.insert(0, str(ROOT / "scripts"))
        import speed_chart

        self.assertEqual((ROOT / "docs" / "speed.svg").read_text(), speed_chart.chart(), "run scripts/speed_chart.py")

    def test_pictures_of_the_gallery_are_small(self):
        pictures = [p for p in (ROOT / "docs").rglob("*") if p.suffix in (".png", ".svg")]
        self.assertLess(sum(p.stat().st_size for p in pictures), 2_000_000)
        named = (ROOT / "docs" / "gallery.md").read_text()
        for picture in (ROOT / "docs" / "gallery").iterdir():
            self.assertIn(f"gallery/{picture.name}", named)


if __name__ == "__main__":
    unittest.main(verbosity=2)
