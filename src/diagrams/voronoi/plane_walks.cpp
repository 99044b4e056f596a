// Ridges and regions of a diagram in the plane, by one walk around each point.
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "diagrams/dual.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

/// For each point the lowest cell at it; no_index without any.
Array<std::uint32_t> lowest_cells(const Triangulation& t) {
  Array<std::uint32_t> lowest(t.point_count, no_index);
  for (auto c = static_cast<std::uint32_t>(t.size()); c-- > 0;)
    for (const std::uint32_t v : t.cell(c)) lowest[v] = c;
  return lowest;
}

/// The lists of a chunk of points, one after another.
struct PlaneLists {
  std::vector<std::uint32_t> ridge_points, ridges, regions;
  std::vector<std::uint64_t> region_ends;
};

/// Walks around points, whose lists it adds to others.
class PlaneWalk {
 public:
  PlaneWalk(const Triangulation& t, PlaneLists& out) : t_(t), out_(out) {}

  /// Adds the region of v, and the ridges between it and higher points. `start`: a cell at v.
  ///
  /// The edge to a corner is a ridge unless both cells at it are of one group. At the hull it is
  /// always one: the corners of a group are extreme points of the lift, so no three of them are on
  /// a line of the plane.
  void add(std::uint32_t v, std::uint32_t start) {
    std::vector<std::uint32_t>& regions = out_.regions;
    const std::size_t before = regions.size();
    higher_.clear();
    if (start != no_index) {
      const std::uint32_t first = most_clockwise(v, start);
      if (first_is_open_) regions.push_back(at_infinity);
      std::uint32_t right = first_is_open_ ? at_infinity : t_.group(across(first, v, 2));
      std::uint64_t steps = 0;
      for (std::uint32_t c = first;;) {
        const std::uint32_t group = t_.group(c);
        const unsigned at = place_in(t_.cell(c), v);
        add_ridge(v, t_.cell(c)[(at + 1) % 3], group, right);
        if (regions.size() == before || regions.back() != group) regions.push_back(group);
        right = group;
        const std::uint32_t next = t_.neighbours_of(c)[(at + 1) % 3];
        if (next == no_index) add_ridge(v, t_.cell(c)[(at + 2) % 3], at_infinity, right);
        if (next == no_index || next == first) break;
        if (++steps > t_.size()) bad_neighbours();
        c = next;
      }
      if (!first_is_open_) begin_with_lowest(before);
    }
    out_.region_ends.push_back(regions.size());
    std::sort(higher_.begin(), higher_.end(),
              [](const Ridge& a, const Ridge& b) { return a.high < b.high; });
    for (const Ridge& ridge : higher_) {
      out_.ridge_points.push_back(v);
      out_.ridge_points.push_back(ridge.high);
      out_.ridges.push_back(ridge.left);
      out_.ridges.push_back(ridge.right);
    }
  }

 private:
  /// Seen from the lower point.
  struct Ridge {
    std::uint32_t high, left, right;
  };

  std::uint32_t across(std::uint32_t c, std::uint32_t v, unsigned turn) const {
    return t_.neighbours_of(c)[(place_in(t_.cell(c), v) + turn) % 3];
  }
  /// For a point on the hull the cell from which a counterclockwise walk meets all others at it;
  /// else `start`.
  std::uint32_t most_clockwise(std::uint32_t v, std::uint32_t start) {
    first_is_open_ = false;
    std::uint32_t first = start;
    std::uint64_t steps = 0;
    for (std::uint32_t c = across(start, v, 2); c != start; c = across(c, v, 2)) {
      if (++steps > t_.size()) bad_neighbours();
      if (c == no_index) {
        first_is_open_ = true;
        return first;
      }
      first = c;
    }
    return start;
  }
  void add_ridge(std::uint32_t v, std::uint32_t other, std::uint32_t left, std::uint32_t right) {
    if (other > v && left != right) higher_.push_back({other, left, right});
  }
  /// Rotates the cycle of a closed region so that its lowest number is first.
  void begin_with_lowest(std::size_t begin) {
    std::vector<std::uint32_t>& regions = out_.regions;
    if (regions.size() > begin + 1 && regions.back() == regions[begin]) regions.pop_back();
    const auto own = regions.begin() + static_cast<std::ptrdiff_t>(begin);
    std::rotate(own, std::min_element(own, regions.end()), regions.end());
  }

  const Triangulation& t_;
  PlaneLists& out_;
  bool first_is_open_ = false;
  std::vector<Ridge> higher_;
};

}  // namespace

void write_plane(const Triangulation& t, Voronoi& out, const Run& run) {
  const Array<std::uint32_t> lowest = lowest_cells(t);
  const std::uint64_t grain = light_grain / 16;
  std::vector<PlaneLists> parts(chunk_count(t.point_count, grain));
  run.each_chunk(t.point_count, grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    PlaneLists& own = parts[chunk];
    // Three ridges and six corners a point, on average at most.
    own.ridge_points.reserve(6 * (end - begin));
    own.ridges.reserve(6 * (end - begin));
    own.regions.reserve(6 * (end - begin));
    own.region_ends.reserve(end - begin);
    PlaneWalk walk(t, own);
    for (std::uint64_t v = begin; v < end; ++v) walk.add(static_cast<std::uint32_t>(v), lowest[v]);
  });
  std::uint64_t ridges = 0, corners = 0;
  for (const PlaneLists& part : parts) {
    ridges += part.ridges.size();
    corners += part.regions.size();
  }
  Array<std::uint32_t> ridge_items, region_items;
  Array<std::uint64_t> region_offsets;
  out.ridge_points.reserve(ridges);
  ridge_items.reserve(ridges);
  region_items.reserve(corners);
  region_offsets.reserve(t.point_count + 1);
  region_offsets.push_back(0);
  const auto append = [](auto& list, const auto& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  for (PlaneLists& part : parts) {
    const std::uint64_t before = region_items.size();
    for (const std::uint64_t end : part.region_ends) region_offsets.push_back(before + end);
    append(out.ridge_points, part.ridge_points);
    append(ridge_items, part.ridges);
    append(region_items, part.regions);
    part = {};
  }
  out.ridges = {EvenArray<std::uint64_t>::of_step(ridge_items.size() / 2 + 1, 2),
                std::move(ridge_items)};
  out.regions = {std::move(region_offsets), std::move(region_items)};
}

}  // namespace cullhull::internal
