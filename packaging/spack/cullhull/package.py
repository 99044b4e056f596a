"""Spack package, built from a checkout:
spack repo add packaging/spack && spack dev-build -d . cullhull@0.1.0"""

from spack.package import *


class Cullhull(CMakePackage):
    """Exact convex hulls of very large point sets, in any dimension."""

    homepage = "https://github.com/cullhull/cullhull"
    git = "https://github.com/cullhull/cullhull.git"

    license("MIT")
    version("0.1.0")

    variant("shared", default=True, description="The shared library in the place of static ones")
    variant("apps", default=True, description="The program cullhull")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("highway@1.0:")
    depends_on("gmp")
    depends_on("fmt@9:")
    depends_on("zlib-api")
    depends_on("zstd")
    depends_on("nlohmann-json@3.11:", type="build")
    depends_on("fast-float", type="build")
    depends_on("cli11@2.1:", type="build", when="+apps")

    def cmake_args(self):
        off = ("TESTS", "BENCH", "EXAMPLES")
        return [
            *(self.define(f"CULLHULL_BUILD_{part}", False) for part in off),
            self.define("CULLHULL_WITH_HDF5", "OFF"),
            self.define_from_variant("CULLHULL_SHARED", "shared"),
            self.define_from_variant("CULLHULL_BUILD_APPS", "apps"),
        ]
