#include "tracker/simplex_memory.hpp"

#include <algorithm>

#include "cullhull/error.hpp"
#include "filter/pseudo_hull/pseudo_hull_math.hpp"
#include "filter/pseudo_hull/pseudo_hull_start.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// If a larger share of points is outside their simplices, all simplices are discarded: growing
/// them again for all points then costs at most about twice as much as for these points. Untested
/// value.
constexpr double coherent_share = 0.5;

/// The planes of simplices whose corners have moved, in a frame as described in docs/exactness.md,
/// P1.
template <unsigned D>
class MovedSimplices {
 public:
  /// `corners`: packed rows, D + 1 per simplex; scaled in place. False if all corners are in a
  /// flat: simplices then prove nothing.
  bool build(Array<double>& corners, const Run& run) {
    const auto rows = static_cast<std::uint32_t>(corners.size() / D);
    for (std::uint32_t i = 0; i < rows; ++i)
      for (unsigned k = 0; k < D; ++k) {
        box_.low[k] = std::min(box_.low[k], corners[std::size_t{i} * D + k]);
        box_.high[k] = std::max(box_.high[k], corners[std::size_t{i} * D + k]);
      }
    if (!axis_scales(box_, scale_)) return false;
    simplices_.resize(rows / (D + 1));
    run.each(simplices_.size(), 512, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t s = begin; s < end; ++s)
        lay_planes(corners.data() + s * (D + 1) * D, simplices_[s]);
    });
    return true;
  }

  /// True only if x (as doubles, unscaled) is strictly inside simplex s. Points outside the
  /// corners' bounding box are rejected first, because the error bounds hold only inside it.
  bool inside(std::uint32_t s, const double* x) const {
    double y[D];
    bool within = true;
    for (unsigned k = 0; k < D; ++k) {
      within &= x[k] >= box_.low[k] && x[k] <= box_.high[k];  // false for NaN
      y[k] = x[k] * scale_[k];
    }
    if (!within) return false;
    const Simplex& simplex = simplices_[s];
    for (unsigned f = 0; f <= D; ++f)
      within &= pseudo_distance<D>(simplex.normal[f], simplex.base[f == 0 ? 1 : 0], y) <
                -simplex.error[f];
    return within;
  }

 private:
  /// Facet f is opposite to corner f; its first vertex is corner 0 (corner 1 for f = 0).
  struct Simplex {
    double normal[D + 1][D];
    double error[D + 1];
    double base[2][D];
  };

  void lay_planes(double* corners, Simplex& simplex) const {
    for (unsigned i = 0; i <= D; ++i)
      for (unsigned k = 0; k < D; ++k) corners[i * D + k] *= scale_[k];
    std::copy_n(corners, 2 * D, simplex.base[0]);
    for (unsigned f = 0; f <= D; ++f) {
      const double* corner[D];
      for (unsigned i = 0, at = 0; i <= D; ++i)
        if (i != f) corner[at++] = corners + i * D;
      PseudoPlane<D> facet;
      make_plane<D>(corner, corners + f * D, facet);  // an uncertain plane has an infinite error
      std::copy_n(facet.normal, D, simplex.normal[f]);
      simplex.error[f] = facet.error;
    }
  }

  AxisExtremes<D> box_;
  double scale_[D] = {};
  std::vector<Simplex> simplices_;
};

constexpr std::uint64_t scan_chunk_size = 16384;  // tens of us of work

/// Ids of the points that are no longer inside their simplices; these points' records are erased.
template <unsigned D>
std::vector<std::uint64_t> outside_simplices(const PointView& points,
                                             std::vector<std::uint32_t>& simplex_of,
                                             const MovedSimplices<D>& simplices, const Run& run) {
  const std::uint64_t chunks = chunk_count(points.count, scan_chunk_size);
  std::vector<std::vector<std::uint64_t>> kept(chunks);
  run.each_chunk(points.count, scan_chunk_size,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      double x[D];
      load_row(points, i, x);
      if (simplex_of[i] != no_item && simplices.inside(simplex_of[i], x)) continue;
      simplex_of[i] = no_item;
      kept[c].push_back(i);
    }
  });
  std::vector<std::uint64_t> ids;
  for (const auto& list : kept) ids.insert(ids.end(), list.begin(), list.end());
  return ids;
}

}  // namespace

void SimplexMemory::clear() {
  simplex_of_ = {};
  corners_ = {};
  dimension_ = 0;
  after_compaction_ = 0;
}

Filtered SimplexMemory::filter(const PointView& points, const Run& run, bool& led,
                               double& scan_seconds) {
  const auto start = Clock::now();
  run.control.report("scan", 0);
  Filtered result;
  result.survivors.filter = UsedFilter::pseudo_hull;
  result.survivors.reason = "filter as asked; the pseudo-hull runs on the CPU";
  led = dimension_ == points.dimension && simplex_of_.size() == points.count && !corners_.empty();
  if (led) {
    result.survivors.ids = scan(points, run);
    led = static_cast<double>(result.survivors.ids.size()) <=
          coherent_share * static_cast<double>(points.count);
  }
  if (!led) {
    clear();
    dimension_ = points.dimension;
    SimplexRecord found;
    result.survivors.ids = pseudo_hull_survivors(points, {}, run, nullptr, &found);
    remember(found, nullptr, points.count);
  }
  scan_seconds = led ? seconds_since(start) : 0;
  gather_survivors(points, result.survivors.ids, result, run);
  grow(points, result, run);
  return result;
}

/// Ids of the points outside their simplices; all ids if the corners are in a flat.
std::vector<std::uint64_t> SimplexMemory::scan(const PointView& points, const Run& run) {
  Array<double> corners = gather_of_frame(points, corners_, run);
  std::vector<std::uint64_t> ids;
  const bool scanned = with_dimension<2, 7, 8>(dimension_, [&](auto d) {
    MovedSimplices<d()> simplices;
    if (!simplices.build(corners, run)) return false;
    ids = outside_simplices<d()>(points, simplex_of_, simplices, run);
    return true;
  });
  if (scanned) return ids;
  ids.resize(points.count);
  for (std::uint64_t i = 0; i < points.count; ++i) ids[i] = i;
  return ids;
}

/// Grows a pseudo-hull of the remaining points, as one set if the memory budget allows it.
void SimplexMemory::grow(const PointView& points, Filtered& result, const Run& run) {
  const unsigned d = dimension_;
  const std::uint64_t left = result.survivors.ids.size();
  if (left <= d + 1) return;
  PseudoHullSettings settings;
  settings.subsets = left * (8 * d + 49 + d * (12 * d + 8)) <= run.budget / 2 ? 1 : 0;
  SimplexRecord found;
  const PointView rows = PointView::row_major(result.rows.data(), left, d);
  const auto kept = pseudo_hull_survivors(rows, settings, run, nullptr, &found);
  remember(found, &result.survivors.ids, points.count);
  keep_of_survivors(result, d, kept);
}

/// Adds the simplices found for the points `ids` (nullptr: all points).
void SimplexMemory::remember(const SimplexRecord& found, const std::vector<std::uint64_t>* ids,
                             std::uint64_t count) {
  const std::uint64_t first = corners_.size() / (dimension_ + 1);
  if (first + found.corners.size() / (dimension_ + 1) >= no_item)
    throw Error(ErrorCode::out_of_budget, "more simplices than 32-bit numbers tell apart");
  simplex_of_.resize(count, no_item);
  corners_.reserve(corners_.size() + found.corners.size());
  for (const std::uint64_t c : found.corners) corners_.push_back(ids != nullptr ? (*ids)[c] : c);
  for (std::uint64_t i = 0; i < found.simplex_of.size(); ++i)
    if (found.simplex_of[i] != no_item)
      simplex_of_[ids != nullptr ? (*ids)[i] : i] =
          static_cast<std::uint32_t>(first + found.simplex_of[i]);
  if (corners_.size() / (dimension_ + 1) > 2 * after_compaction_) compact();
}

/// Removes the simplices that contain no point.
void SimplexMemory::compact() {
  const unsigned size = dimension_ + 1;
  std::vector<std::uint32_t> number(corners_.size() / size, 0);
  for (const std::uint32_t s : simplex_of_)
    if (s != no_item) number[s] = 1;
  std::uint32_t left = 0;
  for (std::uint32_t s = 0; s < number.size(); ++s) {
    if (number[s] == 0) continue;
    std::copy_n(corners_.begin() + static_cast<std::ptrdiff_t>(std::size_t{s} * size), size,
                corners_.begin() + static_cast<std::ptrdiff_t>(std::size_t{left} * size));
    number[s] = left++;
  }
  for (std::uint32_t& s : simplex_of_)
    if (s != no_item) s = number[s];
  corners_.resize(std::size_t{left} * size);
  after_compaction_ = left;
}

}  // namespace cullhull::internal
