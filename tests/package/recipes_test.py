"""The recipes of packaging/: their syntax, and that they are of the version of version.hpp."""

import ast
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

root = Path(__file__).resolve().parents[2]
packaging = root / "packaging"
version = re.search(
    r'#define CULLHULL_VERSION "(.+)"', (root / "include/cullhull/version.hpp").read_text()
)[1]


def text(name: str) -> str:
    return (packaging / name).read_text()


class Recipes(unittest.TestCase):
    def test_vcpkg(self) -> None:
        manifest = json.loads(text("vcpkg/cullhull/vcpkg.json"))
        self.assertEqual(manifest["version"], version)
        script = "function(%s)\nendfunction()\n"
        known = re.findall(r"^\s*(vcpkg_\w+)\(", text("vcpkg/cullhull/portfile.cmake"), re.M)
        self.assertIn("vcpkg_cmake_install", known)
        stubs = "".join(script % name for name in sorted(set(known)))
        stubs = "cmake_minimum_required(VERSION 3.25)\n" + stubs
        run_cmake(self, stubs + text("vcpkg/cullhull/portfile.cmake"))

    def test_conan(self) -> None:
        tree = ast.parse(text("conan/conanfile.py"))
        recipe = next(node for node in tree.body if isinstance(node, ast.ClassDef))
        defined = {node.name for node in recipe.body if isinstance(node, ast.FunctionDef)}
        self.assertLessEqual({"set_version", "build", "package", "package_info"}, defined)
        # The version is read where it stands, by this expression:
        self.assertIn("../../include/cullhull/version.hpp", text("conan/conanfile.py"))
        for copied in re.findall(r'"([\w./-]+)(?:/\*)?"', text("conan/conanfile.py")):
            if copied in ("cmake", "include", "src", "LICENSE", "packaging/THIRD-PARTY.txt"):
                self.assertTrue((root / copied).exists(), copied)

    def test_conda(self) -> None:
        recipe = text("conda/meta.yaml")
        self.assertEqual(re.search(r'set version = "(.+)"', recipe)[1], version)
        try:
            import yaml
        except ImportError:
            self.skipTest("no PyYAML to read meta.yaml with")
        plain = re.sub(r"\{%.*?%\}", "", recipe)
        plain = re.sub(r"\{\{(.*?)\}\}", "filled", plain)
        tree = yaml.safe_load(plain)
        self.assertEqual(tree["package"]["name"], "cullhull")
        for name in tree["about"]["license_file"]:
            self.assertTrue((root / name).exists(), name)

    def test_spack(self) -> None:
        recipe = text("spack/cullhull/package.py")
        ast.parse(recipe)
        self.assertEqual(re.findall(r'^    version\("(.+)"\)', recipe, re.M), [version])
        self.assertIn(f"cullhull@{version}", recipe)

    def test_homebrew(self) -> None:
        self.assertEqual(
            re.search(r'^  version "(.+)"', text("homebrew/cullhull.rb"), re.M)[1], version
        )
        ruby = shutil.which("ruby")
        if ruby is None:
            self.skipTest("no ruby to read the formula with")
        subprocess.run([ruby, "-c", packaging / "homebrew/cullhull.rb"], check=True)

    def test_docker(self) -> None:
        recipe = text("docker/Dockerfile")
        self.assertEqual(set(re.findall(r"cullhull:(\d[\w.]*)", recipe)), {version})
        self.assertEqual(re.search(r'image.version="(.+?)"', recipe)[1], version)
        joined = re.sub(r"\\\n", " ", recipe)
        words = {"FROM", "WORKDIR", "COPY", "RUN", "LABEL", "ENTRYPOINT"}
        for line in joined.splitlines():
            if line and not line.startswith("#"):
                self.assertIn(line.split()[0], words, line)

    def test_options_exist(self) -> None:
        """No recipe sets an option that the project does not have."""
        known = (root / "CMakeLists.txt").read_text() + "".join(
            path.read_text() for path in (root / "cmake").glob("*.cmake")
        )
        for path in packaging.rglob("*"):
            # Compiled Python is of python_metadata.py, where that was run.
            if path.is_file() and path.suffix != ".pyc":
                for name in re.findall(r"\b(CULLHULL_(?:BUILD|WITH)_[A-Z]+)\b", path.read_text()):
                    self.assertRegex(known, rf"\b{name}\b", f"{path}: {name}")
        self.assertIn(f"cullhull@{version}", text("README.md"))


def run_cmake(test: unittest.TestCase, script: str) -> None:
    cmake = shutil.which("cmake")
    if cmake is None:
        test.skipTest("no cmake")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "script.cmake"
        file.write_text(script)
        settings = [f"-DCURRENT_PORT_DIR={packaging}/vcpkg/cullhull", "-DFEATURES=tools"]
        settings.append(f"-DCURRENT_PACKAGES_DIR={folder}")
        ran = subprocess.run(
            [cmake, *settings, "-P", file], capture_output=True, text=True, check=False
        )
    test.assertEqual(ran.returncode, 0, ran.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main(verbosity=2))
