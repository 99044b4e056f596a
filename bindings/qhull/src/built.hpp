// Facets, vertices and sets as programs written for Qhull walk them, made of a hull or a
// triangulation. The layout is that of Qhull's own header, which is not part of this project: it is
// included where it is installed.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "cullhull/hull.hpp"
#include "cullhull/triangulation.hpp"

namespace cullhull::qhull {

/// What the words of a command ask for.
struct Command {
  bool delaunay = false, voronoi = false, furthest_site = false;
  bool triangulated = false;  ///< Qt; QJ, too, whose facets are simplices
  bool area = false;          ///< FA
};
/// Throws Error{invalid_argument} for an option without a meaning here.
Command parse(const char* text);

/// Memory that lives as long as the lists.
class Arena {
 public:
  /// `count` items, cleared.
  template <class T>
  T* make(std::size_t count) {
    return reinterpret_cast<T*>(blocks_.emplace_back(count * sizeof(T) + 1, std::byte{}).data());
  }
  /// The same, not cleared.
  template <class T>
  T* make_raw(std::size_t count) {
    return reinterpret_cast<T*>(blocks_.emplace_back(count * sizeof(T) + 1).data());
  }

 private:
  std::vector<Array<std::byte>> blocks_;
};

/// A full set: its items and a null behind them.
constexpr std::size_t set_bytes(std::size_t items) {
  return sizeof(setT) + items * sizeof(setelemT);
}
/// Sets of one kind in one block.
class Sets {
 public:
  Sets(Arena& arena, std::size_t items, std::size_t sets)
      : begin_(arena.make_raw<char>(items * sizeof(setelemT) + sets * sizeof(setT))) {}
  /// Set `i`, before which there is room for `before` items, to be filled.
  setT* at(std::size_t i, std::size_t before, std::size_t items) const {
    auto* const set =
        reinterpret_cast<setT*>(begin_ + i * sizeof(setT) + before * sizeof(setelemT));
    set->maxsize = static_cast<int>(items);
    set->e[items].p = nullptr;  // full
    return set;
  }

 private:
  char* begin_;
};

/// Everything behind one qhT.
class Built {
 public:
  /// The hull of the points, or of what lifts them. Throws what convex_hull and delaunay throw, and
  /// Error{not_exact} for points in a flat, which Qhull refuses, too.
  Built(qhT* qh, const Command& command, unsigned dimension, std::uint64_t count,
        const double* points);

  /// The lists of simplices instead of merged facets.
  void triangulate(qhT* qh);
  /// The facets around each vertex.
  void vertex_neighbours(qhT* qh);
  /// Around a vertex of points in the plane, facet after facet.
  void order_neighbours(vertexT* vertex) const;
  void centres(qhT* qh);
  double area(const facetT* facet) const;
  /// Gives a facet that is a simplex, or a polygon in space, a ridge for each neighbour.
  void ridges(qhT* qh, facetT* facet);
  /// An empty set that ends with this object at the latest. Throws std::bad_alloc.
  setT* temporary(int items);
  void end_temporary(setT* set) noexcept { temporary_.erase(set); }
  /// The corners of a facet where hull_dim is 3, in Qhull's order: clockwise seen from outside.
  /// `out` has room for them.
  void polygon(const facetT* facet, setT* out) const;
  double volume() const { return hull_.volume; }

 private:
  void list_hull(qhT* qh, bool triangulated);
  void list_cells(qhT* qh, bool triangulated);
  void make_vertices(qhT* qh, std::span<const std::uint64_t> ids);
  double lifted_plane(std::span<const std::uint32_t> cell, double* normal) const;
  static bool shares_ridge(const facetT* facet, const facetT* across);
  void append_ridge(facetT* facet, ridgeT* ridge);
  std::vector<std::uint32_t> outer_neighbours() const;
  void make_facets(qhT* qh, std::size_t count, std::size_t good);
  template <class Ids>
  bool sort_corners(setT* set, const Ids& ids) const;
  void list_members(std::size_t facets, std::size_t members, const auto& facet_of);
  /// `facet` may be what is referred to.
  std::span<const std::uint32_t> members_of(const std::uint32_t& facet) const;
  std::span<const std::uint32_t> members_of(std::uint32_t&&) const = delete;
  template <class Ids>
  double simplex_area(const Ids& ids) const;

  Command command_;
  unsigned dimension_;    ///< of the points
  const double* points_;  ///< as the caller gave them
  std::uint64_t count_;
  double* lifted_ = nullptr;  ///< with a coordinate more, for triangulations
  Hull hull_;
  Triangulation cells_;
  Arena arena_;
  struct Free {
    void operator()(setT* set) const noexcept { std::free(set); }
  };
  std::map<setT*, std::unique_ptr<setT, Free>> temporary_;
  facetT* facets_ = nullptr;
  bool triangulated_ = false;
  std::vector<vertexT*> vertex_of_;  ///< by point
  /// Lower facet i is made of the simplices or cells members_[starts_[i]], ... before
  /// members_[starts_[i + 1]]; of number i where there are no starts.
  std::vector<std::uint32_t> members_, starts_;
  std::size_t lower_ = 0;  ///< facets that are made of such, the first ones
};

}  // namespace cullhull::qhull
