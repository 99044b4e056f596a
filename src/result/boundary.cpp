#include "result/boundary.hpp"

#include <numeric>

#include "exact/determinants/cofactors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"
#include "geometry/simplex.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

using SortSimplex = bool (*)(std::uint32_t*, std::uint32_t*, unsigned);
SortSimplex sort_of(unsigned k) {
  static constexpr SortSimplex few[] = {sort_simplex<3>, sort_simplex<4>, sort_simplex<5>,
                                        sort_simplex<6>, sort_simplex<7>, sort_simplex<8>};
  return k >= 3 && k <= 8 ? few[k - 3] : sort_simplex<0>;
}

/// The findings of a RidgeScan in one chunk.
struct ChunkResult {
  CoplanarPairs pairs;
  std::uint64_t ridges = 0;
  RungCounts rungs;
};

/// Checks the ridges of a boundary and collects the coplanar pairs, in chunks of simplices. K: the
/// dimension, or 0 if it is unknown at compile time.
class RidgeScan {
 public:
  RidgeScan(const Boundary& surface, const LocalPoints& points, const Control& control)
      : surface_(surface),
        count_(surface.facet_count()),
        points_(points),
        control_(control),
        filter_(points.coordinates == points.exact) {}

  /// Checks the ridges between simplices [begin, end) and neighbours of higher number.
  template <unsigned K>
  void chunk(std::uint64_t begin, std::uint64_t end, ChunkResult& out) const {
    const unsigned k = K ? K : surface_.dimension;
    Plane<K> plane;
    for (std::uint64_t f = begin; f < end; ++f) {
      prefetch(f + 8, k);
      const std::uint32_t* ids = surface_.simplex(f);
      for (unsigned i = 1; i < k; ++i)
        if (ids[i - 1] == ids[i]) fail_not_exact("a simplex uses a point twice");
      const bool proved = !surface_.doubtful.empty() && surface_.doubtful[f] == 0;
      if (!proved) plane.set(points_, ids);
      for (unsigned i = 0; i < k; ++i) {
        const std::uint32_t g = surface_.neighbours[f * k + i];
        if (g >= count_ || g == f) fail_not_exact("a ridge has no second facet");
        if (g < f) continue;
        const unsigned j = opposite_slot<K>(surface_, static_cast<std::uint32_t>(f), i, g);
        ++out.ridges;
        if (proved) {
          out.rungs.count(Rung::plane);
          continue;
        }
        const Sign side = this->template side<K>(f, plane, surface_.simplex(g)[j], out);
        if (side == Sign::positive) fail_not_exact("a ridge is not convex");
        if (side == Sign::zero) out.pairs.emplace_back(static_cast<std::uint32_t>(f), g);
      }
    }
  }

  /// Whether the corners of simplex f are affinely dependent; exact.
  template <unsigned K>
  bool degenerate(std::uint64_t f) const {
    Plane<K> plane;
    plane.set(points_, surface_.simplex(f));
    if constexpr (K == 0) {
      control_.check();
      return !plane.ladder.proper();
    } else {
      if (K > 2 && filter_ && plane.surely_proper()) return false;
      const double* rows[K];
      for (unsigned i = 0; i < K; ++i) rows[i] = points_.exact_row(surface_.simplex(f)[i]);
      return affine_rank_exact(K, rows, K) + 1 < K;
    }
  }

 private:
  void prefetch(std::uint64_t f, unsigned k) const {
    if (f + 8 >= count_) return;
    for (unsigned i = 0; i < k; ++i) {
      const std::size_t g = surface_.neighbours[(f + 8) * k + i];
      prefetch_line(surface_.vertices.data() + g * k);
      prefetch_line(surface_.neighbours.data() + g * k);
      prefetch_line(points_.row(surface_.vertices[f * k + i]));
    }
  }

  template <unsigned K>
  struct Plane {
    double normal[K];
    double reach;  // error constant times the product of the rows' largest entries
    /// Whether some cofactor, a determinant of K - 1 rows, is certainly nonzero: then the simplex
    /// is not degenerate.
    bool surely_proper() const {
      const double bound = reach / determinant_error(K) * determinant_error(K - 1) * 1.01;
      double largest = 0;
      for (const double v : normal) largest = std::max(largest, std::fabs(v));
      return largest > bound + determinant_tiny;
    }
    void set(const LocalPoints& points, const std::uint32_t* ids) {
      reach = normal_and_reach<K>([&](unsigned i) { return points.row(ids[i]); }, normal);
    }
  };

  /// The side of point x relative to the plane of simplex f: by the floating-point filter if that
  /// is certain, else exactly. Negative is beneath.
  template <unsigned K>
  Sign side(std::uint64_t f, Plane<K>& plane, std::uint32_t x, ChunkResult& out) const {
    Sign sign = Sign::zero;
    bool known = false;
    if constexpr (K == 0) {
      control_.check();  // an exact sign can take milliseconds
      Rung rung = Rung::exact;
      sign = plane.ladder.side(points_.exact_row(x), &rung);
      out.rungs.count(rung);
      known = true;
    } else {
      if (filter_) {
        const double* origin = points_.row(surface_.simplex(f)[0]);
        const double* p = points_.row(x);
        double value = 0;
        double largest = 0;
        for (unsigned c = 0; c < K; ++c) {
          const double d = p[c] - origin[c];
          value = value + plane.normal[c] * d;
          largest = std::max(largest, std::fabs(d));
        }
        known =
            points_.small_lattice || std::fabs(value) > plane.reach * largest + determinant_tiny;
        sign = sign_of(value);
        out.rungs.of[0] += known;
      }
    }
    if (!known) sign = exact_side(f, x, out);
    return surface_.odd[f] ? -sign : sign;
  }

  /// The exact side of point x relative to the sorted corners of simplex f. Unlike side(), it
  /// ignores `odd`.
  Sign exact_side(std::uint64_t f, std::uint32_t x, ChunkResult& out) const {
    const unsigned k = surface_.dimension;
    std::vector<const double*> rows(k + 1);
    for (unsigned i = 0; i < k; ++i) rows[i] = points_.exact_row(surface_.simplex(f)[i]);
    rows[k] = points_.exact_row(x);
    Rung rung = Rung::exact;
    if (across_an_axis(rows.data(), k)) {
      out.rungs.count(rung);
      return Sign::zero;
    }
    const Sign sign = orientation(k, rows.data(), &rung);
    out.rungs.count(rung);
    return sign;
  }

  /// Whether k + 1 points have one coordinate in common, as most coplanar points of CAD models
  /// have.
  static bool across_an_axis(const double* const* rows, unsigned k) {
    for (unsigned c = 0; c < k; ++c) {
      bool same = true;
      for (unsigned i = 1; i <= k; ++i) same &= rows[i][c] == rows[0][c];
      if (same) return true;
    }
    return false;
  }

  const Boundary& surface_;
  const std::size_t count_;
  const LocalPoints& points_;
  const Control& control_;
  bool filter_;
};

/// The plane in dimensions above those of `cofactors`: an OrientedPlane, whose elimination serves
/// all ridges of a simplex.
template <>
struct RidgeScan::Plane<0> {
  OrientedPlane ladder;
  std::vector<const double*> rows;
  void set(const LocalPoints& points, const std::uint32_t* ids) {
    rows.resize(points.dimension);
    for (unsigned i = 0; i < points.dimension; ++i) rows[i] = points.exact_row(ids[i]);
    ladder.set(points.dimension, rows.data());
  }
};

template <unsigned K>
struct ScanOf {
  static void chunk(const RidgeScan& scan, std::uint64_t b, std::uint64_t e, ChunkResult& out) {
    scan.chunk<K>(b, e, out);
  }
  static bool degenerate(const RidgeScan& scan, std::uint64_t f) { return scan.degenerate<K>(f); }
};

struct Scan {
  void (*chunk)(const RidgeScan&, std::uint64_t, std::uint64_t, ChunkResult&);
  bool (*degenerate)(const RidgeScan&, std::uint64_t);
  template <unsigned K>
  static constexpr Scan of() {
    return {ScanOf<K>::chunk, ScanOf<K>::degenerate};
  }
};

Scan scan_of(unsigned k) {
  static constexpr Scan scans[] = {Scan::of<2>(), Scan::of<3>(), Scan::of<4>(),
                                   Scan::of<5>(), Scan::of<6>(), Scan::of<0>()};
  static_assert(elimination_pays == 7);
  return scans[std::min(k, elimination_pays) - 2];
}

/// Throws Error{not_exact} if a simplex is degenerate. A degenerate simplex has no plane, so its
/// ridges look coplanar: only the simplices in `pairs` need the test.
void check_proper(const RidgeScan& ridge_scan, const Scan& scan, std::size_t count,
                  const CoplanarPairs& pairs, const Run& run) {
  if (pairs.empty()) return;
  std::vector<std::uint8_t> coplanar(count, 0);
  for (const auto& [f, g] : pairs) coplanar[f] = coplanar[g] = 1;
  run.each(count, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f)
      if (coplanar[f] != 0 && scan.degenerate(ridge_scan, f))
        fail_not_exact("a facet is degenerate");
  });
}

}  // namespace

void fail_not_exact(const char* what) {
  throw Error(ErrorCode::not_exact, "the engine's boundary is not that of the exact hull: ", what);
}

void sort_simplices(Boundary& s, const LocalPoints& points, const Run& run) {
  const std::size_t count = s.facet_count();
  const unsigned k = s.dimension;
  if (count < k + std::size_t{1} || s.vertices.size() != count * k ||
      s.neighbours.size() != s.vertices.size())
    fail_not_exact("too few facets");
  std::vector<std::uint32_t> lowest;
  if (!s.duplicates.empty()) {
    lowest.resize(points.count);
    std::iota(lowest.begin(), lowest.end(), 0U);
    for (const auto& [duplicate, vertex] : s.duplicates)
      lowest[vertex] = std::min(lowest[vertex], duplicate);
  }
  if (k == 1) {  // two ends, each the neighbour of the other
    if (count != 2) fail_not_exact("a segment has two ends");
    s.neighbours = {1, 0};
  }
  s.odd.resize(count);
  const SortSimplex sort = sort_of(k);
  run.each(count, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      std::uint32_t* ids = s.vertices.data() + f * k;
      std::uint32_t* neighbours = s.neighbours.data() + f * k;
      for (unsigned i = 0; i < k; ++i) {
        if (ids[i] >= points.count) fail_not_exact("an id is out of range");
        if (!lowest.empty()) ids[i] = lowest[ids[i]];
      }
      s.odd[f] = sort(ids, neighbours, k);
    }
  });
}

CoplanarPairs coplanar_pairs(const Boundary& surface, const LocalPoints& points, const Run& run,
                             std::uint64_t* rung_counts) {
  const Scan scan = scan_of(surface.dimension);
  const RidgeScan ridge_scan(surface, points, run.control);
  std::vector<ChunkResult> results(chunk_count(surface.facet_count(), simplex_chunk));
  run.each_chunk(surface.facet_count(), simplex_chunk,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    scan.chunk(ridge_scan, begin, end, results[chunk]);
  });
  CoplanarPairs pairs;
  std::uint64_t ridges = 0;
  for (const ChunkResult& r : results) {
    pairs.insert(pairs.end(), r.pairs.begin(), r.pairs.end());
    ridges += r.ridges;
    r.rungs.add_to(rung_counts);
  }
  // Each ridge was counted once, from its lower simplex. Two slots belong to a ridge.
  if (2 * ridges != surface.vertices.size()) fail_not_exact("a ridge is not shared by two facets");
  check_proper(ridge_scan, scan, surface.facet_count(), pairs, run);
  return pairs;
}

}  // namespace cullhull::internal
