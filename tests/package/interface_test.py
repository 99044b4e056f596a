#!/usr/bin/env python3
"""The public headers in a stranger's program: no warning of a strict compiler, and old spellings
that either work with a warning or fail with a message that names the new one.

    interface_test.py SOURCE COMPILER [COMPILER ...]

A compiler is a command line ("clang++-16 -stdlib=libc++"); those after the first are left out where
they do not compile an empty program of the same standard headers."""
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror"]

PROLOGUE = """
#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <cullhull/cullhull.hpp>
"""

# What a program writes now; compiled with STRICT.
NOW = """
std::uint64_t count(const std::vector<std::array<double, 3>>& points) {
  cullhull::Options options;
  options.with_coordinates = true;
  const cullhull::Hull hull = cullhull::convex_hull(points, options);
  std::uint64_t ids = 0;
  for (const std::span<const std::uint64_t> facet : hull.facets) ids += facet.size();
  ids += hull.facet(0).size() + hull.simplex(0).size() + hull.plane(0).size();
  const cullhull::HullQuery query(hull);
  const std::vector<std::uint64_t> offsets{0, points.size()};
  ids += cullhull::convex_hulls(points, offsets).size();
  const cullhull::Triangulation cells = cullhull::delaunay(points);
  for (const auto ridge : cullhull::voronoi(points, cells).ridges) ids += ridge.size();
  return cullhull::certify(hull).valid ? ids + cullhull::HullState(hull).ids().size() : 0;
}
"""

# A statement of before 1.0, and what the compiler says of it.
BEFORE = [
    ("voronoi.ridge_offsets[0];", "use ridges.offsets, or ridges"),
    ("voronoi.ridge_vertices[0];", "use ridges.items, or ridges"),
    ("voronoi.region_offsets[0];", "use regions.offsets, or regions"),
    ("voronoi.region_vertices[0];", "use regions.items, or regions"),
    ("polygons.ids[0];", "use rings.items, or rings"),
    ("polygons.ring_offsets[0];", "use rings.offsets, or rings"),
    ("survivors.method;", "use filter, and filter_name"),
    ("hull.statistics.cull_method;", "use filter, and filter_name"),
    ("const char* text = hull.statistics.engine;", "Engine"),
    ("const char* text = hull.statistics.backend;", "Backend"),
    ("cullhull::convex_hulls(view, offsets, 1);", "pass the offsets as a span"),
    ("std::vector<std::array<long long, 3>> wide(4); cullhull::convex_hull(wide);",
     "cullhull takes integers of at most 32 bits"),
    ("std::vector<std::array<char32_t, 3>> odd(4); cullhull::PointView::row_major(&flag, 1, 1);",
     "coordinates are float, double or integers"),
]
FUNCTION = """
void before(const cullhull::Voronoi& voronoi, const cullhull::CellPolygons& polygons,
            const cullhull::Survivors& survivors, const cullhull::Hull& hull,
            const cullhull::PointView& view, const std::uint64_t* offsets, long double flag) {
  (void)voronoi, (void)polygons, (void)survivors, (void)hull, (void)view, (void)offsets, (void)flag;
  %s
}
"""


def compiled(compiler, source, text, options=()):
    """The exit status and all that the compiler says."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.cpp"
        path.write_text(text)
        done = subprocess.run(
            [*shlex.split(compiler), "-std=c++20", "-fsyntax-only", f"-I{source}/include", *options,
             str(path)], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def usable(compiler, source):
    try:
        return compiled(compiler, source, "#include <ranges>\n#include <vector>\nint main() {}")[0] == 0
    except FileNotFoundError:
        return False


def check(compiler, source):
    problems = []
    headers = sorted((Path(source) / "include/cullhull").glob("*.hpp"))
    all_of_them = "".join(f"#include <cullhull/{h.name}>\n" for h in headers if h.name != "mpi.hpp")
    for what, text in (("all headers", all_of_them), ("a program", PROLOGUE + NOW)):
        status, said = compiled(compiler, source, text, STRICT)
        if status != 0:
            problems.append(f"{compiler}: {what}:\n{said}")
    for statement, message in BEFORE:
        status, said = compiled(compiler, source, PROLOGUE + FUNCTION % statement, ["-Wall"])
        if not re.search(re.escape(message), said):
            problems.append(f"{compiler}: {statement} does not name what to write:\n{said[:800]}")
    return problems


def main():
    source, *compilers = sys.argv[1:]
    problems, left_out = [], []
    for i, compiler in enumerate(compilers):
        if i > 0 and not usable(compiler, source):
            left_out.append(compiler)
            continue
        problems += check(compiler, source)
        print(f"{compiler}: {len(BEFORE)} old spellings, all headers")
    if left_out:
        print("not here:", ", ".join(left_out))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
