// Planes and measures of hulls of few points.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "cullhull/hull.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure.hpp"
#include "result/write/few_triangles.hpp"

namespace cullhull::internal {

/// Computes planes and measures as the general path does, bit for bit.
template <class Points, class Hull>
class SmallMeasurer {
  using Number = typename Hull::Number;

 public:
  /// `names`: the view's index for each of `points`; nullptr: 0, 1, ...
  SmallMeasurer(const PointView& view, const std::uint64_t* names, const Points& points,
                const Hull& hull, SmallShares<Hull::max_facets>& shares)
      : view_(view), names_(names), points_(points), hull_(hull), shares_(shares) {}

  /// Writes planes for a multiple of eight facets. False where doubles do not suffice.
  bool run(double* planes, Measures& out) {
    if (!find_exponent()) return false;
    small_shares(points_, hull_, exponent_, shares_, planes);
    for (unsigned w = 0; w < std::size(shares_.open); ++w)
      for (std::uint64_t rest = shares_.open[w]; rest != 0; rest &= rest - 1)
        look_again(64 * w + static_cast<unsigned>(std::countr_zero(rest)), planes);
    if (!hull_.simplicial()) choose_planes(planes);
    const std::uint64_t first = names_ != nullptr ? names_[hull_.ids[0]] : hull_.ids[0];
    return finish_plain(view_, first, exponent_, total(), out);
  }

 private:
  /// Finds the frame's exponent as make_frame does; false where that would set `wild`.
  bool find_exponent() {
    double largest = 0;
    for (unsigned c = 0; c < 3; ++c)
      largest = std::max({largest, std::fabs(hull_.low[c]), std::fabs(hull_.high[c])});
    exponent_ = std::ilogb(largest) + 1;
    double narrowest = 1;
    for (unsigned c = 0; c < 3; ++c)
      narrowest = std::min(
          narrowest, scale_by(hull_.high[c], -exponent_) - scale_by(hull_.low[c], -exponent_));
    return narrowest > std::exp2(-400.0 / 3);
  }

  const Frame& frame() {
    if (!frame_) {
      ids_.assign(hull_.ids, hull_.ids + hull_.vertex_count);
      if (names_ != nullptr)
        for (std::uint64_t& v : ids_) v = names_[v];
      constexpr unsigned axes_of_space[3] = {0, 1, 2};
      frame_.emplace(make_frame(view_, ids_, axes_of_space, 3, short_run()));
    }
    return *frame_;
  }

  /// Recomputes facet i, which may need more than the vectors' doubles.
  void look_again(unsigned i, double* planes) {
    const Frame& f = frame();
    std::uint32_t corners[3];
    FacetBlock<3> block;
    for (unsigned c = 0; c < 3; ++c) std::fill_n(block.origin[c], FacetBlock<3>::lanes, f.at(0)[c]);
    for (unsigned j = 0; j < 3; ++j) {
      const Number* at =
          std::lower_bound(hull_.ids, hull_.ids + hull_.vertex_count, hull_.vertices[3 * i + j]);
      corners[j] = static_cast<std::uint32_t>(at - hull_.ids);
      for (unsigned c = 0; c < 3; ++c)
        std::fill_n(block.corner[j][c], FacetBlock<3>::lanes, f.at(corners[j])[c]);
    }
    facet_block(block);
    const double normal[3] = {block.normal[0][0], block.normal[1][0], block.normal[2][0]};
    const double sum[3] = {block.sum[0][0], block.sum[1][0], block.sum[2][0]};
    const Share<3> share = facet_share<3>(f, FacetPlane<3>(f), corners,
                                          !(block.length[0] > conditioned * block.edges[0]), normal,
                                          sum, planes + std::size_t{4} * i);
    shares_.set(i, share);
  }

  /// Gives each facet the plane of its simplex with the longest normal, the first of equal ones.
  void choose_planes(double* planes) const {
    Number best[Hull::max_facets];
    unsigned facets = 0;
    for (unsigned i = 0; i < hull_.count; ++i) {
      const Number f = hull_.facet_of[i];
      if (f == facets)
        best[facets++] = static_cast<Number>(i);
      else if (shares_.area[i] > shares_.area[best[f]])
        best[f] = static_cast<Number>(i);
    }
    // The simplices of facet f have numbers of at least f: no plane is overwritten before it is
    // read.
    for (unsigned f = 0; f < facets; ++f)
      std::copy_n(planes + std::size_t{4} * best[f], 4, planes + std::size_t{4} * f);
  }

  /// Runs are summed in doubles, then added, as total_of_runs does for a single chunk.
  Share<3, DoubleDouble> total() const {
    static_assert(Hull::max_facets <= measure_chunk);
    Share<3, DoubleDouble> all;
    for (unsigned first = 0; first < hull_.count; first += measure_run)
      all.add(shares_.sum(first, std::min<unsigned>(hull_.count, first + measure_run)));
    return all;
  }

  const PointView& view_;
  const std::uint64_t* const names_;
  const Points& points_;
  const Hull& hull_;
  int exponent_ = 0;
  SmallShares<Hull::max_facets>& shares_;
  std::vector<std::uint64_t> ids_;
  std::optional<Frame> frame_;
};

}  // namespace cullhull::internal
