// Incremental insertion in 3D: the state that the pieces of a surface share, and a piece of it.
//
// The surface is one array of facets. A piece owns some of them and inserts points whose whole
// cavity it owns; facets next to another piece's are never replaced, so what a piece reads beyond
// its border does not change, and pieces work in parallel without locks. docs/algorithm.md, "The
// engine in 3D".
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "exact/orientation/orientation_3d.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// A facet, one cache line. The plane is scaled to normal . (x - O) = 1, see docs/exactness.md,
/// "Cached planes". Vertices are counter-clockwise seen from outside; neighbour j is opposite to
/// vertex j.
struct alignas(64) Facet3D {
  static constexpr std::uint32_t none = 0xFFFFFFFF;

  double normal[3];
  double error;
  std::uint32_t vertices[3];
  std::uint32_t neighbours[3];
  std::uint32_t mark;   // epoch of the last insertion that saw this facet
  std::uint32_t owner;  // `none`: the slot is free

  bool live() const { return owner != none; }
  /// Owner, read and written while other pieces may do so: of facets at borders.
  std::uint32_t owner_now() { return std::atomic_ref(owner).load(std::memory_order_relaxed); }
  void own(std::uint32_t by) { std::atomic_ref(owner).store(by, std::memory_order_relaxed); }
};
static_assert(sizeof(Facet3D) == 64);

/// Points are in insertion order: an id is a position in that order.
struct Shared3D {
  static constexpr unsigned row_stride = 4;  // a row never straddles cache lines

  const Orientation3D* predicates = nullptr;
  const Control* control = nullptr;
  const std::uint32_t* order = nullptr;  // local ids
  const double* rows = nullptr;
  Facet3D* facets = nullptr;

  const double* row(std::uint32_t p) const { return rows + std::size_t{p} * row_stride; }
  /// The mean of a facet's vertices.
  void middle(const Facet3D& f, double* out) const {
    for (unsigned j = 0; j < 3; ++j)
      out[j] = (row(f.vertices[0])[j] + row(f.vertices[1])[j] + row(f.vertices[2])[j]) / 3;
  }
};

struct Cut3D;

/// A point that is not inserted yet, and the facet where the walk to it begins, or `none`.
struct Waiting3D {
  std::uint32_t point, facet;
};

/// Facets where walks begin, one for every block of points, found when the surface was cut.
struct Entries3D {
  static constexpr std::uint32_t block = 256;
  struct Entry {
    std::uint32_t facet, owner;  // when the surface was cut
  };
  const Entry* entries = nullptr;  // of positions / block - first_block
  std::uint32_t first_block = 0;
};

/// A piece of the surface, and the state of the thread that inserts into it. Aligned so that no two
/// threads write to the same cache line.
struct alignas(256) Piece3D {
  std::uint32_t first_owner = 0, owner_count = 1;  // the facets it owns
  // Facets with owners below this belong to the piece where `cut` puts them: piece 0 has this
  // owner, piece 1 the next. So a surface is cut again without visiting all its facets.
  std::uint32_t old_owners = 0;
  const Cut3D* cut = nullptr;
  std::uint32_t epoch = 0;
  std::uint32_t hint = 0;
  XorShift random;
  std::uint32_t next_slot = 0, end_slot = 0;                   // slots never used
  std::vector<std::uint32_t> free;                             // slots used before
  std::vector<std::pair<std::uint32_t, std::uint32_t>> spare;  // ranges of unused slots
  std::vector<Waiting3D> deferred;  // points that involve other pieces' facets
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rungs;
  std::uint64_t steps = 0, inserted = 0;
  Entries3D entries;

  /// Adds what another has counted and found.
  void add_counts(const Piece3D& o) {
    duplicates.insert(duplicates.end(), o.duplicates.begin(), o.duplicates.end());
    rungs += o.rungs;
    steps += o.steps;
    inserted += o.inserted;
  }
  bool owns(std::uint32_t owner) const { return owner - first_owner < owner_count; }

  // Scratch: the visible facets, and the horizon edges in cyclic order.
  struct Crossing {
    std::uint32_t facet, edge;
  };
  std::vector<std::uint32_t> visible;
  std::vector<Crossing> stack;
  std::uint32_t visible_capacity = 0, ring_capacity = 0;
  std::vector<std::uint32_t> ring_start, ring_outside, ring_back, created;
  std::vector<double> ring_x, ring_y, ring_z, planes, gauges;
};

/// Inserts waiting[begin, end), whose facets the piece owns, or the points [begin, end) where
/// `waiting` is null. Appends points that involve facets of other pieces to `deferred`. `progress`:
/// called every 65,536 points with the share done; may be null.
void insert_points(const Shared3D& shared, Piece3D& piece, const Waiting3D* waiting,
                   std::uint32_t begin, std::uint32_t end,
                   const std::function<void(double)>* progress);

/// Appends those of the points at the given positions, or of [begin, end) where `positions` is
/// null, that are outside of the surface to piece.deferred; as surfaces only grow, the others never
/// matter again. Only reads the surface, all of which the piece must own.
void screen_points(const Shared3D& shared, Piece3D& piece, const std::uint32_t* positions,
                   std::uint32_t begin, std::uint32_t end);

/// The facet through which the ray from O through p leaves, up to rounding, or a facet visible from
/// p. Climbs from the better of two facets; only reads.
std::uint32_t climb(const Shared3D& shared, std::uint32_t start, std::uint32_t other,
                    const double* p);

/// Fills normals and errors of facets from their vertices.
void compute_planes(const Shared3D& shared, Facet3D* facets, std::uint32_t count);

}  // namespace cullhull::internal
