"""Conan 2 recipe of the checkout it lies in: conan create packaging/conan"""

import re
from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy


class Cullhull(ConanFile):
    name = "cullhull"
    description = "Exact convex hulls of very large point sets, in any dimension"
    license = "MIT"
    package_type = "library"
    settings = "os", "compiler", "build_type", "arch"
    options = {"shared": [True, False]}
    default_options = {"shared": False}

    def set_version(self):
        header = Path(self.recipe_folder, "../../include/cullhull/version.hpp").read_text()
        self.version = re.search(r'CULLHULL_VERSION "(.+)"', header)[1]
        address = Path(self.recipe_folder, "../repository.txt").read_text().strip()
        self.homepage = self.url = address

    def export_sources(self):
        root = Path(self.recipe_folder).parents[1]
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "src/*",
                        "packaging/THIRD-PARTY.txt",
                        "packaging/repository.txt"):
            copy(self, pattern, root, self.export_sources_folder)

    def requirements(self):
        for name in ("highway/[>=1.0]", "gmp/[>=6]", "fmt/[>=9]", "zlib/[>=1.2.11 <2]",
                     "zstd/[>=1.5]"):
            self.requires(name)
        for name in ("nlohmann_json/[>=3.11]", "fast_float/[>=3]"):
            self.requires(name, visible=False)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        dependencies = CMakeDeps(self)
        dependencies.set_property("highway", "cmake_file_name", "hwy")
        dependencies.set_property("highway", "cmake_target_name", "hwy::hwy")
        dependencies.set_property("gmp", "cmake_target_name", "GMP::gmp")
        dependencies.set_property("fast_float", "cmake_file_name", "FastFloat")
        dependencies.generate()
        toolchain = CMakeToolchain(self)
        for part in ("C", "APPS", "TESTS", "BENCH", "EXAMPLES"):
            toolchain.cache_variables[f"CULLHULL_BUILD_{part}"] = False
        toolchain.cache_variables["CULLHULL_SHARED"] = bool(self.options.shared)
        toolchain.cache_variables["CULLHULL_WITH_HDF5"] = "OFF"
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["cullhull"] if self.options.shared else ["cullhull_io", "cullhull"]
        self.cpp_info.system_libs = ["pthread"]
        self.cpp_info.set_property("cmake_target_name", "cullhull::cullhull")
        self.cpp_info.set_property("cmake_target_aliases", ["cullhull::io"])
        self.cpp_info.set_property("pkg_config_name", "cullhull")
