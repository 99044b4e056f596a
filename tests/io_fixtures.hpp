// Files, bytes and small hulls for the tests of src/io.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/source.hpp"
#include "parallel/byte_order.hpp"
#include "thrown.hpp"

namespace cullhull::testing {

using testing_support::error_of;
using testing_support::has;

/// A folder that is gone when the test is over.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() /
            ("cullhull-io-" + std::to_string(getpid()) + "-" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_),
                                                  std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Whether a reader may give little-endian numbers where they lie.
inline constexpr bool lies_ready = internal::little_endian_machine;

/// Little-endian, as most files are.
template <class... T>
std::string bytes_of(T... values) {
  std::string out;
  ((values = internal::little_endian(values)), ...);
  (out.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return out;
}

template <class T>
std::string bytes_of_big_endian(T value) {
  std::string out = bytes_of(value);
  std::reverse(out.begin(), out.end());
  return out;
}

inline std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  std::string out("\x93NUMPY");
  out += static_cast<char>(version);
  out += '\0';
  out += bytes_of(static_cast<std::uint16_t>(dictionary.size()));
  if (version > 1) out += std::string(2, '\0');
  return out + dictionary + data;
}

inline internal::PointData parse(std::string_view bytes, const std::string& format,
                                 ReadOptions options = {}) {
  options.format = format;
  return internal::read_points({"F", bytes.data(), bytes.size()}, options);
}

using Rows = std::vector<std::vector<double>>;

inline Rows rows_of(const PointView& view) {
  Rows rows(view.count);
  for (std::uint64_t i = 0; i < view.count; ++i)
    for (std::uint32_t j = 0; j < view.dimension; ++j) rows[i].push_back(view.at(i, j));
  return rows;
}

/// Takes points in blocks and drops them.
inline BlockVisitor no_visitor() {
  BlockVisitor visitor;
  visitor.points = [](const PointView&, std::uint64_t) {};
  return visitor;
}

/// Options by which what is remarked goes to `said`.
inline ReadOptions remarks_to(std::vector<std::string>& said) {
  ReadOptions options;
  options.remark = [&](const std::string& line) { said.push_back(line); };
  return options;
}

/// The one line that reading these bytes, whose points are `want`, says to the user.
inline std::string remark_on(std::string_view bytes, const std::string& format, const Rows& want) {
  std::vector<std::string> said;
  EXPECT_EQ(rows_of(parse(bytes, format, remarks_to(said)).view), want) << bytes;
  EXPECT_LE(said.size(), 1U) << bytes;
  return said.empty() ? "" : said[0];
}

/// All points by id, read in blocks of about `block_bytes`, so small that rows are cut everywhere.
inline Rows rows_in_blocks(const std::string& path, const ReadOptions& read = {},
                           std::uint64_t block_bytes = 4096) {
  std::mutex mutex;
  std::map<std::uint64_t, Rows> found;
  BlockVisitor visitor;
  visitor.points = [&](const PointView& block, std::uint64_t first) {
    const std::lock_guard lock(mutex);
    found[first] = rows_of(block);
  };
  BlockOptions options;
  options.read = read;
  options.block_bytes = block_bytes;
  options.readers = 3;
  visit_blocks({path}, visitor, options);
  Rows all;
  for (const auto& [first, part] : found) {
    EXPECT_EQ(first, all.size());
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// The message for bytes that must be refused.
inline std::string refusal(std::string_view bytes, const std::string& format,
                           const ReadOptions& options = {}) {
  return error_of(ErrorCode::bad_file, [&] { parse(bytes, format, options); });
}

/// A hull of 3D points from its facets, counter-clockwise from outside, each from its lowest id, in
/// the order of their first simplex. `normals` with offset, one a facet.
inline Hull hull_from_polygons(const std::vector<std::vector<std::uint64_t>>& facets,
                               const std::vector<double>& planes, std::uint64_t point_count,
                               const std::vector<std::uint64_t>& vertices) {
  Hull h;
  h.dimension = 3;
  h.affine_dimension = 3;
  h.point_count = point_count;
  h.vertices = vertices;
  h.facet_planes.assign(planes.begin(), planes.end());
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const auto& p = facets[f];
    Array<std::uint64_t>& corners = h.facets.items.edit();
    corners.insert(corners.end(), p.begin(), p.end());
    h.facets.offsets.push_back(h.facets.items.size());
    for (std::size_t j = 0; j < p.size(); ++j)
      for (std::uint32_t g = 0; g < facets.size(); ++g)
        for (std::size_t i = 0; i < facets[g].size(); ++i)
          if (facets[g][i] == p[(j + 1) % p.size()] &&
              facets[g][(i + 1) % facets[g].size()] == p[j])
            h.facet_neighbours.items.push_back(g);
    h.facet_neighbours.offsets.push_back(h.facet_neighbours.items.size());
    for (std::size_t j = 1; j + 1 < p.size(); ++j) {
      h.simplices.edit().insert(h.simplices.edit().end(), {p[0], p[j], p[j + 1]});
      h.simplex_facets.push_back(f);
      for (int i = 0; i < 3; ++i)
        h.simplex_neighbours.push_back(static_cast<std::uint32_t>(h.simplex_facets.size() - 1));
    }
  }
  return h;
}

struct Example {
  std::vector<double> coordinates;
  Hull hull;
  PointView view() const {
    return PointView::row_major(coordinates.data(), hull.point_count, hull.dimension);
  }
};

/// The unit cube, and its centre as point 0; corner 1 + (x + 2 y + 4 z).
inline Example cube() {
  Example e;
  e.coordinates = {0.5, 0.5, 0.5};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 3; ++j) e.coordinates.push_back((i >> j) & 1);
  e.hull = hull_from_polygons(
      {{1, 2, 6, 5}, {1, 3, 4, 2}, {1, 5, 7, 3}, {2, 4, 8, 6}, {3, 7, 8, 4}, {5, 6, 8, 7}},
      {0, -1, 0, 0, 0, 0, -1, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1, -1}, 9,
      {1, 2, 3, 4, 5, 6, 7, 8});
  e.hull.volume = 1;
  e.hull.area = 6;
  e.hull.centroid = {0.5, 0.5, 0.5};
  return e;
}

/// A square of the plane with its centre as point 2.
inline Example square() {
  Example e;
  e.coordinates = {0, 0, 1, 0, 0.5, 0.5, 0, 1, 1, 1};
  Hull& h = e.hull;
  h.dimension = 2;
  h.affine_dimension = 2;
  h.point_count = 5;
  h.vertices = {0, 1, 4, 3};
  h.facets = {{0, 2, 4, 6, 8}, {0, 1, 3, 0, 1, 4, 4, 3}};
  h.facet_neighbours = {{0, 2, 4, 6, 8}, {2, 1, 0, 3, 3, 0, 1, 2}};
  h.facet_planes = {0, -1, 0, -1, 0, 0, 1, 0, -1, 0, 1, -1};
  h.simplices = h.facets.items;
  h.simplex_neighbours = h.facet_neighbours.items;
  h.simplex_facets = {0, 1, 2, 3};
  h.volume = 1;
  h.area = 4;
  h.centroid = {0.5, 0.5};
  return e;
}

/// What reading the file says against it, "" if nothing: the same whole and in blocks.
inline std::string error_whole_and_in_blocks(const std::string& path) {
  const auto message_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const std::string whole = message_of([&] { open_points(path); });
  EXPECT_EQ(message_of([&] { visit_blocks({path}, no_visitor(), {}); }), whole);
  return whole;
}

}  // namespace cullhull::testing
