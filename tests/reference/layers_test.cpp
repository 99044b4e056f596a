// Which folder may include which: the layers of HACKING.md, held against every include.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace layers_test {

namespace fs = std::filesystem;

/// Folders of src/ from below: each may include those of lower layers and itself.
const std::vector<std::vector<std::string>> layers = {
    {"parallel"},
    {"exact"},
    {"geometry"},
    {"extreme", "filter"},
    {"hull"},
    {"result"},
    {"few", "cuda"},
    {"flow"},
    {"query", "tracker", "batch", "stream", "delaunay"},
    {"constrained", "diagrams"},
    {"distributed"},
};
/// Folders beside the layers, and all that they may include but themselves.
const std::map<std::string, std::vector<std::string>> beside = {
    {"certify", {"exact", "geometry", "parallel"}},
    {"generate", {"parallel"}},
    {"io", {"parallel"}},
};

/// The number of a folder's layer; -1: it has none.
int layer_of(const std::string& folder) {
  for (std::size_t i = 0; i < layers.size(); ++i)
    if (std::count(layers[i].begin(), layers[i].end(), folder) > 0) return static_cast<int>(i);
  return -1;
}

bool may_include(const std::string& from, const std::string& to, bool is_header) {
  if (from == to) return true;
  if (const auto only = beside.find(from); only != beside.end())
    return std::count(only->second.begin(), only->second.end(), to) > 0;
  // Headers of cuda/ lie below the flow; its sources implement what flow and tracker declare.
  if (from == "cuda" && !is_header)
    return to == "flow" || to == "tracker" || layer_of(to) < layer_of(from);
  return layer_of(to) >= 0 && layer_of(to) < layer_of(from);
}

/// The first folder of a path; empty for a file alone.
std::string folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.begin()->string() : std::string();
}

std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex include(R"re(^\s*#\s*include\s+["<]([^">]+)[">])re");
  std::vector<std::string> names;
  std::ifstream in(file);
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_search(line, match, include)) names.push_back(match[1]);
  return names;
}

std::vector<fs::path> sources_below(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  static const std::vector<std::string> kinds{".cpp", ".hpp", ".cu", ".cuh"};
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (std::count(kinds.begin(), kinds.end(), entry.path().extension()) > 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// What is wrong with the tree under `root`, one line each: src/ by its layers, include/ by itself
/// alone, viewer/ over public headers and parallel.
std::vector<std::string> faults(const fs::path& root) {
  std::vector<std::string> found;
  for (const char* part : {"src", "include", "viewer"})
    for (const fs::path& file : sources_below(root / part)) {
      const std::string name = file.lexically_relative(root).generic_string();
      const std::string from = folder_of(file.lexically_relative(root / part));
      const bool in_src = std::string(part) == "src";
      if (in_src && layer_of(from) < 0 && beside.count(from) == 0) {
        found.push_back(name + " is in no folder that has a layer");
        continue;
      }
      for (const std::string& included : includes_of(file)) {
        if (!fs::exists(root / "src" / included)) continue;  // public, or none of ours
        const std::string to = folder_of(included);
        const std::string extension = file.extension().string();
        const bool is_header = extension == ".hpp" || extension == ".cuh";
        if (in_src ? !may_include(from, to, is_header)
                   : std::string(part) == "include" || to != "parallel")
          found.push_back(name + " includes " + included);
      }
    }
  return found;
}

/// The sources that may name what only some systems or compilers have (docs/machines.md).
const std::vector<std::string> portable_places = {
    "src/parallel/threads/fork_guard.cpp",
    "src/parallel/threads/helpers.cpp",
    "src/parallel/threads/span_account.hpp",
    "src/parallel/int128.hpp",
    "src/parallel/memory/memory.cpp",
    "src/parallel/memory/pages.cpp",
    "src/parallel/prefetch.hpp",
    "src/parallel/simd_targets.cpp",
    "src/parallel/two_doubles.hpp",
    "src/parallel/windows.hpp",
    "src/io/system.cpp",
    "src/io/system.hpp",
    "src/cuda/backend.cpp",
    "apps/cullhull/signals.cpp",
    "apps/cullhull/system.cpp",
};

/// Every other source that does, one line each.
std::vector<std::string> unportable(const fs::path& root) {
  static const std::regex word(
      R"re(^\s*#\s*include\s+<(sys/|windows|unistd|fcntl|poll|glob|pthread|io\.h|process\.h)|__builtin_|__int128|std::(call_once\(|once_flag))re");
  std::vector<std::string> found;
  for (const char* part : {"src", "include", "viewer", "apps", "bindings/python/src"})
    for (const fs::path& file : sources_below(root / part)) {
      const std::string name = file.lexically_relative(root).generic_string();
      if (std::count(portable_places.begin(), portable_places.end(), name) > 0) continue;
      if (file.extension() == ".cu" || file.extension() == ".cuh") continue;  // for one compiler
      std::ifstream in(file);
      std::size_t number = 0;
      for (std::string line; std::getline(in, line);)
        if (++number; line.find_first_of("#_") < line.size() && std::regex_search(line, word))
          found.push_back(name + ":" + std::to_string(number) + ": " + line);
    }
  return found;
}

TEST(Layers, SystemsAndCompilersAreNamedInTheirPlaces) {
  const fs::path root = CULLHULL_ROOT;
  EXPECT_EQ(unportable(root), std::vector<std::string>());
  for (const std::string& place : portable_places) EXPECT_TRUE(fs::exists(root / place)) << place;
  const fs::path planted = fs::path(::testing::TempDir()) / "cullhull_unportable";
  fs::create_directories(planted / "src/io/formats");
  std::ofstream(planted / "src/io/formats/npy.cpp")
      << "#include <sys/mman.h>\nauto b = __builtin_clz(1);\nstd::once_flag f;\n";
  std::ofstream(planted / "src/io/system.cpp") << "#include <sys/mman.h>\n";
  EXPECT_EQ(unportable(planted),
            (std::vector<std::string>{"src/io/formats/npy.cpp:1: #include <sys/mman.h>",
                                      "src/io/formats/npy.cpp:2: auto b = __builtin_clz(1);",
                                      "src/io/formats/npy.cpp:3: std::once_flag f;"}));
  fs::remove_all(planted);
}

/// Sources of src/ that open another namespace below `internal` than the certificate's own, which
/// is kept apart so that nothing of the engines is visible in it by accident.
std::vector<std::string> strays(const fs::path& root) {
  static const std::regex opened(
      R"(^namespace (?:cullhull::)?internal\b(?:::(?:inline )?(\w+))?.*\{)");
  static const std::set<std::string> plain{"", "HWY_NAMESPACE", "system"};
  std::vector<std::string> found;
  for (const fs::path& file : sources_below(root / "src")) {
    const fs::path path = file.lexically_relative(root / "src");
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, opened)) continue;
      const bool right =
          folder_of(path) == "certify" ? match[1] == "certify" : plain.count(match[1].str()) > 0;
      if (!right) found.push_back(path.generic_string() + ": " + line);
    }
  }
  return found;
}

/// The sources outside src/exact that bound the rounding of doubles, each with what stands behind
/// its bound. All other signs are those of src/exact: a filter that is new comes here with its
/// argument, or there. (src/certify has arithmetic of its own, on purpose.)
const std::map<std::string, std::string> bounds_elsewhere = {
    {"src/cuda/kernels/hull_questions_kernel.cu", "what is in doubt is left to vertex_search"},
    {"src/cuda/kernels/set_hulls_kernel.cu", "measures in doubt are left to the CPU"},
    {"src/delaunay/final_cells.hpp", "a cell in doubt is not final"},
    {"src/delaunay/lift_planes.cpp", "lanes of lift_side; what is in doubt is left to it"},
    {"src/delaunay/lift_planes.hpp", "the bound of lift_planes.cpp and when it is zero"},
    {"src/delaunay/plane_insertion.hpp", "a corner in doubt is left to point_signs"},
    {"src/delaunay/point_signs.hpp", "one bound for all facets of a cell, else orientation()"},
    {"src/diagrams/locate/cell_maps.hpp", "cells in doubt are left to walk.hpp"},
    {"src/diagrams/locate/nearest_tree.cpp", "all that may be nearest are left to power_sign"},
    {"src/diagrams/locate/power_sign.hpp", "the nearer point, else sums of difference products"},
    {"src/diagrams/locate/triangulation_query.cpp",
     "coordinates in double-doubles, else rationals"},
    {"src/diagrams/locate/walk.hpp",
     "the nearest neighbour; what is in doubt is left to power_sign"},
    {"src/extreme/hull_membership.cpp", "signs of one direction, else rationals"},
    {"src/extreme/inside_exact.cpp", "columns in doubt are priced in rationals"},
    {"src/filter/gauge/gauge_planes.cpp", "an upper bound of the gauge; points in doubt survive"},
    {"src/filter/gauge/gauge_frame.hpp", "an upper bound of the gauge; points in doubt survive"},
    {"src/filter/pseudo_hull/pseudo_hull_math.hpp", "points in doubt survive"},
    {"src/filter/star_hull/star_math.hpp", "points and edges in doubt are left to the CPU's hull"},
    {"src/flow/sample_map.cpp", "random numbers"},
    {"src/hull/general/facet_planes_any.cpp", "cached planes, else orientation()"},
    {"src/hull/general/laplace.hpp", "cached planes, else orientation()"},
    {"src/hull/plane/planar.hpp", "the turn of three points, else turn_exact()"},
    {"src/hull/space/insertion_3d.cpp", "lanes of Orientation3D; what is in doubt is left to it"},
    {"src/hull/space/moved_surface.cpp", "triangles in doubt are left to Orientation3D"},
    {"src/parallel/random_stream.hpp", "random numbers"},
    {"src/query/facet_cells.cpp", "cells in single precision; points in doubt are left to queries"},
    {"src/query/halfspaces.cpp", "an interior point in doubt is refused"},
    {"src/query/nearest_in_hull.cpp", "a bound of a distance that is reported, no sign"},
    {"src/query/shared_planes.cpp", "facets in doubt do not share a plane"},
    {"src/query/simplify.cpp", "the default of a distance, no sign"},
    {"src/query/vertex_search.cpp", "signs of one direction, else floats that are exact"},
    {"src/result/measures/measure.cpp", "measures in doubt are computed with more bits"},
    {"src/result/measures/measure.hpp", "measures in doubt are computed with more bits"},
};

/// Other sources that bound the rounding of doubles.
std::vector<std::string> other_bounds(const fs::path& root) {
  static const std::regex word(R"(\b(unit_roundoff|minor_roundings|0x1p-53|0x1p-24)\b)");
  std::vector<std::string> found;
  for (const fs::path& file : sources_below(root / "src")) {
    const std::string name = file.lexically_relative(root).generic_string();
    const std::string folder = folder_of(file.lexically_relative(root / "src"));
    if (folder == "exact" || folder == "certify" || bounds_elsewhere.count(name) > 0) continue;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
      if (std::regex_search(line, word)) {
        found.push_back(name);
        break;
      }
  }
  return found;
}

TEST(Layers, BoundsOfRoundingHaveAnArgument) {
  EXPECT_EQ(other_bounds(CULLHULL_ROOT), std::vector<std::string>());
  for (const auto& [place, why] : bounds_elsewhere) {
    std::ifstream in(fs::path(CULLHULL_ROOT) / place);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_TRUE(text.find("roundoff") < text.size() || text.find("0x1p-53") < text.size() ||
                text.find("0x1p-24") < text.size() || text.find("minor_roundings") < text.size())
        << place << " (" << why << ")";
  }
  const fs::path planted = fs::path(::testing::TempDir()) / "cullhull_bounds";
  fs::create_directories(planted / "src/hull");
  fs::create_directories(planted / "src/exact");
  std::ofstream(planted / "src/hull/a.cpp") << "const double bound = 4 * unit_roundoff * size;\n";
  std::ofstream(planted / "src/exact/a.cpp") << "const double bound = 4 * unit_roundoff * size;\n";
  EXPECT_EQ(other_bounds(planted), (std::vector<std::string>{"src/hull/a.cpp"}));
  fs::remove_all(planted);
}

TEST(Layers, OnlyTheCertificateHasANamespaceOfItsOwn) {
  EXPECT_EQ(strays(CULLHULL_ROOT), std::vector<std::string>());
  const fs::path planted = fs::path(::testing::TempDir()) / "cullhull_strays";
  fs::create_directories(planted / "src/certify");
  fs::create_directories(planted / "src/hull");
  const auto plant = [&](const char* name, const std::string& opened) {
    std::ofstream(planted / "src" / name) << "namespace " << opened << " {\n}\n";
  };
  plant("certify/a.cpp", "cullhull::internal::certify");
  plant("certify/b.cpp", "cullhull::internal");
  plant("hull/a.cpp", "cullhull::internal");
  plant("hull/b.cpp", "cullhull::internal::inline hull");
  std::vector<std::string> found = strays(planted);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found,
            (std::vector<std::string>{"certify/b.cpp: namespace cullhull::internal {",
                                      "hull/b.cpp: namespace cullhull::internal::inline hull {"}));
  fs::remove_all(planted);
}

TEST(Layers, NoIncludeRunsUpOrSideways) {
  const fs::path root = CULLHULL_ROOT;
  EXPECT_GT(sources_below(root / "src").size(), 200U);
  EXPECT_GT(sources_below(root / "include").size(), 15U);
  EXPECT_EQ(faults(root), std::vector<std::string>());
}

TEST(Layers, PlantedFaultsAreFound) {
  const fs::path root = fs::path(::testing::TempDir()) / "cullhull_layers";
  fs::remove_all(root);
  const auto plant = [&](const char* name, const char* included) {
    fs::create_directories((root / name).parent_path());
    std::ofstream(root / name) << "// a file\n#include <vector>\n  # include \"" << included
                               << "\"\n";
  };
  // In order: these are as they should be …
  plant("src/parallel/a.hpp", "cullhull/a.hpp");
  plant("src/geometry/a.hpp", "parallel/a.hpp");
  plant("src/result/b.hpp", "geometry/a.hpp");
  plant("src/flow/a.hpp", "result/b.hpp");
  plant("src/filter/a.hpp", "geometry/a.hpp");
  plant("src/cuda/a.cpp", "flow/a.hpp");
  plant("src/certify/a.cpp", "geometry/a.hpp");
  plant("include/cullhull/a.hpp", "cullhull/b.hpp");
  plant("viewer/a.cpp", "parallel/a.hpp");
  EXPECT_EQ(faults(root), std::vector<std::string>());
  // … and these are not: up, sideways, the certificate, a public header, and where there is no
  // layer.
  plant("src/geometry/up.hpp", "result/b.hpp");
  plant("src/extreme/sideways.cpp", "filter/a.hpp");
  plant("src/cuda/up.hpp", "flow/a.hpp");
  plant("src/certify/trusting.cpp", "result/b.hpp");
  plant("src/io/knowing.cpp", "geometry/a.hpp");
  plant("src/elsewhere/a.cpp", "parallel/a.hpp");
  plant("src/loose.cpp", "parallel/a.hpp");
  plant("include/cullhull/private.hpp", "parallel/a.hpp");
  plant("viewer/deep.cpp", "geometry/a.hpp");
  EXPECT_EQ(faults(root), (std::vector<std::string>{
                              "src/certify/trusting.cpp includes result/b.hpp",
                              "src/cuda/up.hpp includes flow/a.hpp",
                              "src/elsewhere/a.cpp is in no folder that has a layer",
                              "src/extreme/sideways.cpp includes filter/a.hpp",
                              "src/geometry/up.hpp includes result/b.hpp",
                              "src/io/knowing.cpp includes geometry/a.hpp",
                              "src/loose.cpp is in no folder that has a layer",
                              "include/cullhull/private.hpp includes parallel/a.hpp",
                              "viewer/deep.cpp includes geometry/a.hpp",
                          }));
  fs::remove_all(root);
}

}  // namespace layers_test
