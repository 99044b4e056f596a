// What the steps from a triangulation to its dual share.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline diagrams {

/// Throws Error{invalid_argument} if points or weights are not those of the triangulation.
void require_points_of(const Triangulation& t, const PointView& points,
                       std::span<const double> weights);

/// All points as rows of d doubles, and the weight where there is one.
class DualPoints {
 public:
  DualPoints(const PointView& points, const Triangulation& t, std::span<const double> weights,
             const Run& run);
  bool weighted() const { return weighted_; }
  const double* row(std::uint64_t i) const { return rows_.data() + i * stride_; }

 private:
  unsigned stride_;
  bool weighted_;
  Array<double> rows_;
};

/// Lists that chunks of a loop make, joined in the order of chunks.
class ListsInChunks {
 public:
  explicit ListsInChunks(std::uint64_t count)
      : grain(light_grain / 16), parts_(chunk_count(count, grain)) {}

  void add(std::uint64_t chunk, const std::vector<std::uint32_t>& list) {
    Part& part = parts_[chunk];
    part.items.insert(part.items.end(), list.begin(), list.end());
    part.ends.push_back(part.items.size());
  }
  void join(Array<std::uint64_t>& offsets, Array<std::uint32_t>& items) {
    offsets.assign(1, 0);
    for (Part& part : parts_) {
      const std::uint64_t before = items.size();
      items.insert(items.end(), part.items.begin(), part.items.end());
      for (const std::uint64_t end : part.ends) offsets.push_back(before + end);
      part = {};
    }
  }
  const std::uint64_t grain;

 private:
  struct Part {
    std::vector<std::uint32_t> items;
    std::vector<std::uint64_t> ends;
  };
  std::vector<Part> parts_;
};

/// The edges of a triangulation by their lower point, with the cells around each.
class EdgeCells {
 public:
  EdgeCells(const Triangulation& t, const Run& run);
  struct Item {
    std::uint32_t other, cell;
  };
  /// Of the edges whose lower point is v: by the other point, then by cell.
  std::span<const Item> of(std::uint64_t v) const {
    return {items_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }

 private:
  Array<std::uint64_t> begin_;
  Array<Item> items_;
};

/// The points that share a cell with each point, ascending.
class PointNeighbours {
 public:
  PointNeighbours(const Triangulation& t, const Run& run);
  std::span<const std::uint32_t> of(std::uint64_t v) const {
    return {items_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }

 private:
  Array<std::uint64_t> begin_;
  Array<std::uint32_t> items_;
};

/// The first cell of each group; empty where every cell is a group of its own.
Array<std::uint32_t> first_cells(const Triangulation& t);
/// Vertices into `out`; k >= 1.
void write_vertices(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run);
/// Ridges into `out`.
void write_ridges(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run);

}  // namespace cullhull::internal::inline diagrams
