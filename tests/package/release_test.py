"""What a release is made of: one version, one address, licences, the page on PyPI, release.sh."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

root = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(root / "scripts"), str(root / "packaging")]
sys.dont_write_bytecode = True

import python_metadata  # noqa: E402
import sbom  # noqa: E402
import stamp  # noqa: E402

licences = (root / "packaging/THIRD-PARTY.txt").read_text(encoding="utf-8")
bundled = json.loads((root / "packaging/dependencies.json").read_text(encoding="utf-8"))["bundled"]


class OnePlace(unittest.TestCase):
    def test_versions_and_addresses_agree(self) -> None:
        self.assertEqual(stamp.faults(), [])

    def test_stamp_changes_every_place(self) -> None:
        with copy_of_tree() as folder:
            script = folder / "scripts/stamp.py"
            new = ["--version", "7.8.9", "--repository", "https://github.com/Somebody/hull"]
            subprocess.run([sys.executable, script, *new], check=True)
            self.assertIn('"7.8.9"', (folder / "include/cullhull/version.hpp").read_text())
            self.assertIn("github.com/Somebody/hull", (folder / "CITATION.cff").read_text())
            for path in ("packaging/conda/meta.yaml", "CITATION.cff"):
                self.assertNotIn(stamp.slug(stamp.repository()), (folder / path).read_text())
            # One place that does not follow is a fault.
            recipe = folder / "packaging/conda/meta.yaml"
            recipe.write_text(recipe.read_text().replace("7.8.9", "7.8.8"))
            ran = subprocess.run([sys.executable, script], capture_output=True, text=True)
            self.assertEqual(ran.returncode, 1)
            self.assertIn("meta.yaml: version 7.8.8, not 7.8.9", ran.stderr)


class Licences(unittest.TestCase):
    def test_every_library_is_listed_with_its_text(self) -> None:
        listed = licences.partition("====")[0]
        headings = re.findall(r"^==== (.+) ====$", licences, re.M)
        for entry in bundled:
            self.assertIn(f"{entry['name']} ({entry['for']})\n  Licence: {entry['license']}\n", listed)
            self.assertIn(f"  In: {', '.join(entry['in'])}\n", listed)
            for holder in entry["copyright"].split("; "):
                self.assertIn(f"  Copyright (c) {holder}\n", listed)
            texts = [heading for heading in headings if entry["name"] in heading]
            self.assertTrue(texts, entry["name"])
        for heading in headings:
            text = licences.partition(f"==== {heading} ====")[2].partition("\n====")[0]
            self.assertGreater(len(text), 700, heading)

    def test_bill_of_materials(self) -> None:
        bill = sbom.bill()
        self.assertEqual({part["name"] for part in bill["components"]}, {e["name"] for e in bundled})
        references = {part["bom-ref"] for part in bill["components"]}
        self.assertEqual(len(references), len(bundled))
        self.assertEqual(set(bill["dependencies"][0]["dependsOn"]), references)
        self.assertEqual(bill["metadata"]["component"]["version"], stamp.version())


class PageOnPyPI(unittest.TestCase):
    def test_links_are_absolute_and_their_files_exist(self) -> None:
        text = python_metadata.dynamic_metadata({}, {})["readme"]["text"]
        prose = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
        targets = re.findall(r"\]\(([^)\s]+)", prose) + re.findall(r"""(?:src|href)=["']([^"']+)""", prose)
        self.assertTrue(targets)
        for target in targets:
            self.assertRegex(target, r"^(https?://|#|mailto:)")
            found = re.search(rf"cullhull/(?:blob/)?v{re.escape(stamp.version())}/([^#]+)", target)
            if found:
                self.assertTrue((root / found[1]).exists(), target)

    def test_forms_of_links(self) -> None:
        base = f"{stamp.repository()}/blob/v{stamp.version()}"
        raw = f"https://raw.githubusercontent.com/{stamp.slug(stamp.repository())}/v{stamp.version()}"
        for given, wanted in (
            ("[a](docs/x.md#b)", f"[a]({base}/docs/x.md#b)"),
            ('![a](docs/x.png "t")', f'![a]({raw}/docs/x.png "t")'),
            ('<img src="docs/x.svg">', f'<img src="{raw}/docs/x.svg">'),
            ("[a](https://b.c/d)", "[a](https://b.c/d)"),
            ("[a](#b)", "[a](#b)"),
            ("```\n[a](b)\n```\n", "```\n[a](b)\n```\n"),
        ):
            self.assertEqual(python_metadata.readme(given), wanted)


class Release(unittest.TestCase):
    def test_dry_run(self) -> None:
        """In a clone with a commit of what the tree holds now."""
        with copy_of_tree() as folder:
            (folder / "CHANGELOG.md").write_text(
                "# Changelog\n\n## [Unreleased]\n\n### Added\n- A thing.\n\n## [0.0.1]\n- Old.\n"
            )
            git = ["git", "-C", folder, "-c", "user.name=t", "-c", "user.email=t@localhost"]
            subprocess.run([*git, "init", "--quiet"], check=True)
            subprocess.run([*git, "add", "--all"], check=True)
            subprocess.run([*git, "commit", "--quiet", "-m", "All"], check=True)
            ran = release(folder, "99.1.0", "--dry-run")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            self.assertIn("Release 99.1.0", ran.stdout)
            self.assertIn("tag: v99.1.0", ran.stdout)
            notes = ran.stdout.partition("notes:\n")[2]
            self.assertTrue(notes.startswith("### Added\n- A thing.\n"), notes)
            self.assertNotIn("Old", notes)
            status = subprocess.run([*git, "status", "--porcelain"], capture_output=True, text=True)
            self.assertEqual(status.stdout, "")
            tags = subprocess.run([*git, "tag"], capture_output=True, text=True)
            self.assertEqual(tags.stdout, "")

            # What is built and passes its checks is left here with its size, and nothing else.
            (folder / "scripts/artifacts.sh").rename(folder / "scripts/real.sh")
            (folder / "scripts/artifacts.sh").write_text(
                '[[ $1 != sizes ]] || exec bash scripts/real.sh sizes\n'
                "printf '%1234567s' >build/dist/cullhull-99.1.0-$1\n"
            )
            checks = folder / "scripts/check-artifacts.sh"
            for code, left in ((1, False), (0, True)):
                checks.write_text(f"exit {code}\n")
                for script in ("artifacts.sh", "check-artifacts.sh", "real.sh"):
                    (folder / "scripts" / script).chmod(0o755)
                subprocess.run([*git, "add", "--all"], check=True)
                subprocess.run([*git, "commit", "--quiet", "-m", "Stand-ins"], check=True)
                ran = release(folder, "99.1.0", "--dry-run", artifacts="made")
                self.assertEqual(ran.returncode, code, ran.stderr)
                self.assertEqual((folder / "build/release-99.1.0/cullhull-99.1.0-made").exists(), left)
                row = "| `cullhull-99.1.0-made` | 1.23 |\n"
                self.assertEqual(row in (folder / "docs/install.md").read_text(), left)
            subprocess.run([*git, "checkout", "--quiet", "HEAD^^", "."], check=True)
            subprocess.run([*git, "commit", "--quiet", "-m", "Back"], check=True)

            ran = release(folder, "99.1.0")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            log = (folder / "CHANGELOG.md").read_text()
            self.assertRegex(log, r"## \[Unreleased\]\n\n## \[99\.1\.0\] - \d{4}-\d\d-\d\d\n\n### Added")
            self.assertRegex((folder / "CITATION.cff").read_text(), r"version: 99\.1\.0\ndate-released: 20")
            for version, words in (
                ("99.1.0", "there is a tag v99.1.0"),
                ("98.0.0", "98.0.0 is below v99.1.0"),
                ("99.2.0", "nothing stands under [Unreleased]"),
                ("1.0", "scripts/release.sh VERSION"),
            ):
                ran = release(folder, version, "--dry-run")
                self.assertNotEqual(ran.returncode, 0, version)
                self.assertIn(words, ran.stderr)
            (folder / "LICENSE").write_text("changed")
            self.assertIn("uncommitted", release(folder, "99.2.0", "--dry-run").stderr)


def identity() -> "dict[str, str]":
    who = {}
    for role in ("AUTHOR", "COMMITTER"):
        who[f"GIT_{role}_NAME"], who[f"GIT_{role}_EMAIL"] = "t", "t@localhost"
    return {**os.environ, **who}


def release(folder: Path, *words: str, artifacts: str = "") -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        ["bash", folder / "scripts/release.sh", *words],
        capture_output=True, text=True, env={**identity(), "ARTIFACTS": artifacts},
    )


class copy_of_tree:
    """A folder with copies of what a release touches."""

    def __enter__(self) -> Path:
        self.folder = Path(tempfile.mkdtemp())
        for name in ("packaging", "scripts"):
            shutil.copytree(root / name, self.folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("CITATION.cff", "LICENSE", "README.md", "CHANGELOG.md", ".gitignore",
                     "docs/install.md", "include/cullhull/version.hpp",
                     *(f"tests/package/{kind}/CMakeLists.txt" for kind in ("consumer", "mpi_consumer"))):
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, self.folder / name)
        return self.folder

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self.folder)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
