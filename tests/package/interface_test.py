#!/usr/bin/env python3
"""The public headers in a stranger's program: no warning of a strict compiler, and a message that
says what to write where an argument is refused.

    interface_test.py SOURCE COMPILER [COMPILER ...]

A compiler is a command line ("clang++-16 -stdlib=libc++"); those after the first are left out where
they do not compile an empty program of the same standard headers. Each compiles all headers, a
program (also in C++23) and the C++ blocks of the documentation; the first one also every header as
the first of a program, and the examples, all in C++23, too. em++ compiles for 32-bit addresses."""
import concurrent.futures
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Werror"]
# Fragments of pages declare what they do not use, and their names stand for any.
LOOSE = ["-Wno-unused", "-Wno-shadow"]

PROLOGUE = """
#include <array>
#include <cstdint>
#include <iostream>
#include <span>
#include <string>
#include <vector>
#include <cullhull/cullhull.hpp>
#include <cullhull/group_hulls.hpp>
#include <cullhull/triangulation_io.hpp>
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
  ids += cullhull::convex_hull(std::vector<std::array<double, 3>>(4)).point_count;
  ids += query.contains({1, 2, 3}) + query.contains(points[0]) + query.support(std::array{1, 0, 0});
  const std::vector<float> scalars(12);
  ids += cullhull::cull(cullhull::PointView::row_major(scalars, 3)).id(0);
  struct Vertex {
    double x, y, z;
    int colour;
  };
  const std::vector<Vertex> vertices(4);
  ids += cullhull::convex_hull(cullhull::PointView::records(vertices, &Vertex::x, 3)).point_count;
  std::cout << hull.statistics.backend << hull.statistics.filter;
  return cullhull::certify(hull).valid ? ids + cullhull::HullState(hull).ids().size() : 0;
}

// Every struct of options is an aggregate, its members named where it is made.
void options(const std::vector<std::array<double, 3>>& points,
             const std::vector<std::array<double, 2>>& plane, const cullhull::stop_source& source) {
  using namespace cullhull;
  const Hull hull = convex_hull(points, {.threads = 2});
  (void)convex_hull(points, {.stop = source.get_token(), .backend = Backend::cpu});
  (void)extreme_points(points, {.memory_budget = 1000, .progress = [](const char*, double) {}});
  (void)certify(points, hull, {.threads = 1, .poll = [] {}});
  const Triangulation cells = delaunay(points, {.threads = 2, .furthest_site = false});
  (void)certify(points, cells, {.threads = 2});
  (void)constrained_delaunay(plane, {}, {.threads = 2, .inside_only = true});
  (void)alpha_shape(points, cells, 1, {.threads = 2});
  (void)clip_voronoi(points, cells, points, {}, {.threads = 2, .shapes = false});
  (void)alpha_shape(points, cells, 1, Options{.threads = 2});
  (void)gabriel_graph(points, cells, options_as<TriangulationOptions>(RunOptions{.threads = 2}));
  (void)convex_hulls_on_device({}, nullptr, 0, {.device = 1}, {.planes = true, .padded = true});
  (void)convex_hull_on_device({}, {.device = 1}).memory;
  (void)open_points("a.csv", {.columns = "x,y", .threads = 2, .decimal = ','});
  (void)visit_blocks({}, {.pause_seconds = 1}, {.read = {.skip_nan = true}, .readers = 2});
  (void)write_group_shapes({}, "a.geojson", {.alpha = 1}, {.readers = 2}, {.threads = 2},
                           {.crs = "EPSG:25832"});
}
"""

# What is refused, and a part of what the compiler says of it.
REFUSED = [
    ("cullhull::CertifyStream stream(cullhull::convex_hull(view), {});", "CertifyStream"),
    ("struct Place { double x, y, z; }; std::vector<Place> places(4); cullhull::convex_hull(places);",
     "cullhull::PointView::records(points, &Point::x, 3)"),
    ("cullhull::delaunay(std::vector<std::vector<double>>(4));", "PointView::records"),
    ("std::vector<std::array<long long, 3>> wide(4); cullhull::convex_hull(wide);",
     "cullhull takes integers of at most 32 bits"),
    ("cullhull::PointView::row_major(&number, 1, 1);", "coordinates are float, double or integers"),
]
FUNCTION = """
#line 1 "statement{number}.cpp"
void refused{number}(const cullhull::PointView& view, long double number) {{
  (void)view, (void)number;
  {statement}
}}
"""


def compiled(compiler, source, text, options=(), standard="20"):
    """The exit status and all that the compiler says."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.cpp"
        path.write_text(text)
        done = subprocess.run(
            [*shlex.split(compiler), f"-std=c++{standard}", "-fsyntax-only", f"-I{source}/include",
             *options, str(path)], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def usable(compiler, source, standard="20"):
    """Whether it is here and compiles a program; its remarks on the standard library are no matter."""
    try:
        return compiled(compiler, source, "#include <ranges>\n#include <vector>\nint main() {}",
                        ["-w"], standard)[0] == 0
    except FileNotFoundError:
        return False


def refusals(compiler, source):
    """Statements of REFUSED about which the compiler does not say what it should."""
    functions = [FUNCTION.format(number=i, statement=statement)
                 for i, (statement, _) in enumerate(REFUSED)]
    options = ["-Wall", "-ferror-limit=0" if "clang" in compiler else "-fmax-errors=0"]
    said = compiled(compiler, source, PROLOGUE + "".join(functions), options)[1]
    # From one message about a statement to the next about another one, with its notes.
    parts = re.split(r"^(?=.*?statement\d+\.cpp:)", said, flags=re.M)
    for i, (statement, message) in enumerate(REFUSED):
        about = "".join(p for p in parts if f"statement{i}.cpp:" in p.split("\n")[0])
        if message not in about:  # perhaps before the line that names the statement
            about = compiled(compiler, source, PROLOGUE + functions[i], options)[1]
        if message not in about:
            yield f"{compiler}: {statement} does not name what to write:\n{about[:800]}"


def old_standard(compiler, source, name):
    """What a header is to a compiler that was not told C++20."""
    status, said = compiled(compiler, source, f"#include <cullhull/{name}>\n", ["-Wfatal-errors"], "17")
    if status == 0 or "cullhull needs C++20" not in said:
        yield f"{compiler}, C++17: {name} does not say that it needs C++20:\n{said[:800]}"


def programs(source, headers):
    """What is compiled strictly: (what, text, more options)."""
    includes = [f"#include <cullhull/{name}>\n" for name in headers if name != "mpi.hpp"]
    yield "all headers", "".join(includes), []
    yield "a program", PROLOGUE + NOW, []
    for path in sorted((source / "examples").glob("*.cpp")):
        if "mpi" not in path.name:
            yield f"examples/{path.name}", path.read_text(), []
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "samples.cpp"
        subprocess.run([sys.executable, source / "tests/docs/cpp_samples.py", made], check=True)
        samples = made.read_text()
    # Their programs print what they show elsewhere (docs_samples_test); here they are compiled.
    samples = re.sub(r"^#include <gtest/gtest.h>\n", "", samples, flags=re.M)
    samples = re.sub(r"^TEST\(.*?^}\n", "", samples, flags=re.M | re.S)
    assert "fragment()" in samples and "program()" in samples and "TEST" not in samples
    yield "the documentation", samples, LOOSE


def checks(compilers, source):
    """Functions that return a problem, or nothing."""
    headers = sorted(h.name for h in (source / "include/cullhull").glob("*.hpp"))

    def strict(compiler, what, text, options, standard):
        status, said = compiled(compiler, source, text, STRICT + options, standard)
        return [f"{compiler}, C++{standard}: {what}:\n{said[:3000]}"] if status != 0 else []

    for name in headers:
        if name != "mpi.hpp":
            text = f"#include <cullhull/{name}>\nint main() {{}}\n"
            yield strict, (compilers[0], name, text, [], "20")
            yield lambda c, n: list(old_standard(c, source, n)), (compilers[0], name)
    for compiler in compilers:
        # libc++ warns of clang 16, which it no longer supports.
        more = ["-Wno-#warnings"] if "clang" in compiler else []
        later = "23" if usable(compiler, source, "23") else "2b"
        for what, text, options in programs(source, headers):
            first = compiler == compilers[0]
            example = what.startswith("examples")  # in C++20 the build itself compiles them
            if not example:
                yield strict, (compiler, what, text, options + more, "20")
            if first or what == "a program":
                yield strict, (compiler, what, text, options + more, later)
        yield lambda c: list(refusals(c, source)), (compiler,)
    if usable("em++", source):
        for what, text, options in programs(source, headers):
            if what in ("all headers", "a program"):
                yield strict, ("em++", what, text, options, "20")


def main():
    source, *named = sys.argv[1:]
    source = Path(source).resolve()
    here = [c for i, c in enumerate(named) if i == 0 or usable(c, source)]
    left_out = [c for c in named + ["em++"] if c not in here and (c != "em++" or not usable(c, source))]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [pool.submit(check, *given) for check, given in checks(here, source)]
        problems = [problem for job in jobs for problem in job.result()]
    print(f"{len(jobs)} programs, {len(REFUSED)} refused statements with each of: {', '.join(here)}")
    if left_out:
        print("not here:", ", ".join(left_out))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
