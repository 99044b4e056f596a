#!/usr/bin/env python3
"""shell_samples.py CULLHULL: runs the shell samples of README.md and docs/. Blocks of a page share a
folder. `console`: each line after "$ " is run and must print what follows it ("..." for what varies).
`sh`: every line must succeed."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import samples

APP = os.path.abspath(sys.argv.pop(1)) if __name__ == "__main__" and len(sys.argv) > 1 else "cullhull"
# So that a test takes seconds: the same commands over fewer points.
SMALLER = {"-n 8M": "-n 80k", "--scale 0.05": "--scale 0.0005"}


def prepared(folder):
    """The files that samples call theirs."""
    os.symlink(samples.ROOT / "data", os.path.join(folder, "data"))
    os.mkdir(os.path.join(folder, "bin"))
    os.symlink(APP, os.path.join(folder, "bin", "cullhull"))
    for name, words in {
        "cloud.npy": ("ball", "-n", "2k", "-d", "5"),
        "frames.npy": ("cube", "-n", "2k", "-d", "3", "--frames", "3", "--motion", "twist"),
        "cube.npy": ("cube", "-n", "2k", "-d", "3"),
    }.items():
        subprocess.run([APP, "generate", *words, "-o", name, "-q"], check=True, cwd=folder)
    shutil.copyfile(samples.ROOT / "data" / "autzen-150k.ply", os.path.join(folder, "scan.ply"))
    environment = dict(os.environ)
    environment["PATH"] = os.path.join(folder, "bin") + os.pathsep + environment["PATH"]
    return environment


def smaller(line):
    for large, small in SMALLER.items():
        line = line.replace(large, small)
    return line


def commands(block):
    """Pairs of a command and what it must print (None: anything)."""
    if block.language == "sh":
        return [(line, None) for line in block.text.replace("\\\n", "").splitlines() if line.strip()]
    parts = re.split(r"^\$ ", block.text, flags=re.M)[1:]
    return [tuple(part.split("\n", 1)) for part in parts]


def missing_program(line):
    """Another program that the line needs and this machine lacks."""
    first = [re.split(r"\s+", part.strip())[0] for part in line.split("#")[0].split("|")]
    return next((name for name in first if name and shutil.which(name) is None and name != "cullhull"), None)


class ShellSamples(unittest.TestCase):
    def run_page(self, path):
        todo = [b for b in samples.blocks(path) if b.language in ("sh", "console")]
        if not todo:
            return 0
        ran = 0
        with tempfile.TemporaryDirectory(prefix="cullhull-docs-") as folder:
            environment = prepared(folder)
            for block in todo:
                for line, expected in commands(block):
                    where = f"{block.page}:{block.line}: {line}"
                    if missing_program(line) or line.startswith(("git clone", "pip ", "make ", "sudo ")):
                        continue
                    done = subprocess.run(["bash", "-c", smaller(line)], cwd=folder, env=environment,
                                          capture_output=True, text=True, timeout=300)
                    self.assertEqual(done.returncode, 0, where + "\n" + done.stderr)
                    if expected is not None:
                        self.assertTrue(samples.matches(expected, done.stdout), f"{where}\n{done.stdout}")
                    ran += 1
        return ran

    def test_every_page(self):
        ran = 0
        for path in samples.pages():
            with self.subTest(path.name):
                ran += self.run_page(path)
        self.assertGreater(ran, 20)


if __name__ == "__main__":
    unittest.main(verbosity=2)
