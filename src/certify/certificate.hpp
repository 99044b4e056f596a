// The parts of certify(): each throws Fault for the first fault it finds.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/id_places.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::certify {

struct Fault {
  std::string reason;
};

template <class... Parts>
[[noreturn]] void fault(Parts&&... parts) {
  std::string text;
  const auto append = [&](auto&& part) {
    if constexpr (std::is_integral_v<std::decay_t<decltype(part)>>)
      text += std::to_string(part);
    else
      text += part;
  };
  (append(parts), ...);
  throw Fault{std::move(text)};
}

/// The simplices of each facet, ascending.
using FacetSimplices = Adjacency<std::uint32_t, std::uint32_t>;

/// The hull under test, and what has been established about it so far.
struct Subject {
  const PointView& points;
  const Hull& hull;
  const Run& run;
  unsigned k = 0;

  /// CertifyStream, where points arrive in blocks: `points` has their count and no data, and this
  /// has the coordinates claimed for the vertices, by ascending id. Else null.
  const std::vector<double>* claimed = nullptr;

  std::vector<std::uint64_t> ids;    ///< the hull's vertices, ascending
  Array<double> full;                ///< coordinates of the vertices
  std::vector<double> low, high;     ///< the vertices' box
  std::vector<unsigned> axes;        ///< the projection of the flat onto these axes is one to one
  std::vector<double> projected;     ///< vertex coordinates on the axes, in a flat
  Array<std::uint32_t> index;        ///< simplices x k: positions in `ids`
  std::vector<std::uint32_t> basis;  ///< k + 1 affinely independent vertices
  std::vector<double> centre;        ///< the interior point in doubles; empty if none was found
  FacetSimplices members;  ///< set once simplex_facets has been checked; empty: all_simple
  mutable std::atomic<std::uint64_t> exact_decisions{0};
  mutable std::atomic<std::uint64_t> vertices_met{0};  ///< vertices found among the points so far
  IdPlaces position;  ///< index in `ids`; ids.size() if not a vertex

  Subject(const PointView& p, const Hull& h, const Run& r) : points(p), hull(h), run(r) {}

  std::uint32_t simplex_count() const { return static_cast<std::uint32_t>(index.size() / k); }
  const std::uint32_t* simplex(std::uint32_t f) const { return index.data() + std::size_t{f} * k; }
  const double* row(std::uint32_t v) const {
    return (k == hull.dimension ? full.data() : projected.data()) + std::size_t{v} * k;
  }
  /// The axis of the points that coordinate j of a row is of.
  unsigned axis(unsigned j) const { return k == hull.dimension ? j : axes[j]; }
  /// Whether facet i is simplex i alone, if simplex_facets is right.
  bool all_simple() const { return hull.facets.size() == simplex_count(); }
  std::uint32_t neighbour(std::uint32_t f, unsigned j) const {
    return hull.simplex_neighbours[std::size_t{f} * k + j];
  }

  /// The side of the plane of simplex f that x is on; positive is outside. scratch: k + 1 pointers.
  Sign side(std::uint32_t f, const double* x, const double** scratch) const;
  /// Orientation of (rows[0], ..., rows[k-1], interior point); rows has room for k + 1.
  Sign seen(const double** rows) const;
  /// The simplex whose closed cone from the interior point contains x. Walks from `start`.
  std::uint32_t locate(const double* x, std::uint32_t start, const double** scratch) const;
  bool in_cone(std::uint32_t f, const double* x, const double** scratch) const;
};

/// As Run::each_chunk, but throws the fault of the first faulty chunk after all chunks have run.
void check_chunks(const Run& run, std::uint64_t count, std::uint64_t chunk_size,
                  const std::function<void(std::uint64_t begin, std::uint64_t end)>& body,
                  CodePlace where = CodePlace::current());

void check_shape(Subject& s);  // sizes, ranges, order; sets ids, full, index
void check_flat(Subject& s);   // sets basis, axes, rows
class Cones;
void check_interior(Subject& s, Cones& cones);  // a point beneath all; sets centre, cones
std::uint64_t check_ridges(const Subject& s,    // pairing, orientation, convexity; counts
                           const Cones& cones);
void check_covering(Subject& s, Cones& cones);         // a ray that meets exactly one simplex
std::uint64_t check_single_simplex(const Subject& s);  // these three, of k + 1 vertices; counts
void check_facets(Subject& s);  // merged facets, extreme vertices, triangulation; sets members

/// Checks all input points, block by block, against data that are prepared once. Thread safe.
class PointCheck {
 public:
  PointCheck(const Subject& s, const Cones& cones);
  ~PointCheck();
  /// Checks the points of a block, which have the ids first_id, first_id + 1, ...
  void check(const PointView& block, std::uint64_t first_id) const;

 private:
  class Scan;
  std::unique_ptr<const Scan> scan_;
  const Subject& s_;
};

void check_numbers(const Subject& s);  // planes, volume, area, centroid

}  // namespace cullhull::internal::certify
