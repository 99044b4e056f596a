#include "batch/small_sets.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>

#include "batch/small_kernels.hpp"
#include "hull/small_3d.hpp"
#include "result/facet_kernel.hpp"
#include "result/facet_share.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned axes_of_space[3] = {0, 1, 2};

/// Room for `count` items more; sizes follow later.
template <class T>
T* extend(Array<T>& to, std::size_t count) {
  const std::size_t size = to.size();
  to.resize(size + count);
  return to.data() + size;
}

/// `count` numbers more, written a vector at a time.
template <class T>
void append_bytes(Array<T>& to, const std::uint8_t* from, std::size_t count) {
  constexpr std::size_t room = 64 / sizeof(T);
  const std::size_t size = to.size();
  widen(from, count, extend(to, count + room));
  to.resize(size + count);
}

/// `count` lists of three items more.
void append_threes(EvenArray<std::uint64_t>& offsets, std::size_t count) {
  const std::uint64_t* step = offsets.step();
  if (step != nullptr && (*step == 3 || offsets.size() == 1)) {
    offsets = EvenArray<std::uint64_t>::of_step(offsets.size() + count, 3);
    return;
  }
  std::uint64_t at = offsets.back();
  for (std::size_t i = 0; i < count; ++i) offsets.push_back(at += 3);
}

/// A list more for each facet; their length together.
std::uint64_t append_sizes(EvenArray<std::uint64_t>& offsets, const SmallHull3D& hull) {
  const std::uint64_t begin = offsets.back();
  std::uint64_t at = begin;
  Array<std::uint64_t>& items = offsets.edit();
  for (unsigned i = 0; i < hull.facet_count; ++i) items.push_back(at += hull.facet_size[i]);
  return at - begin;
}

void load(const PointView& set, SmallPoints3D& points) {
  for (unsigned c = 0; c < 3; ++c) {
    double* const axis = points.axes[c];
    if (set.scalar == ScalarType::f64)
      for (std::uint64_t i = 0; i < set.count; ++i)
        std::memcpy(axis + i, set.address(i, c), sizeof(double));
    else
      for (std::uint64_t i = 0; i < set.count; ++i) axis[i] = set.at(i, c);
    std::fill(axis + set.count, axis + (set.count + 15) / 16 * 16, axis[0]);
  }
}

struct Measures {
  double volume = 0, area = 0, centroid[3] = {};
};

/// Sums as Totals<DoubleDouble>, without memory of their own.
struct SmallTotals {
  DoubleDouble volume = 0, area = 0, moment[3];
  double error = 0, area_error = 0;
};

/// Planes and measures, as the general path computes them.
class SmallMeasurer {
  using Number = std::uint8_t;

 public:
  SmallMeasurer(const PointView& set, const SmallPoints3D& points, const SmallHull3D& hull)
      : set_(set), points_(points), hull_(hull) {}

  /// Planes are written for a multiple of eight facets. False where doubles do not do.
  bool run(double* planes, Measures& out) {
    if (!find_exponent()) return false;
    small_shares(points_, hull_, exponent_, shares_, planes);
    for (unsigned w = 0; w < std::size(shares_.open); ++w)
      for (std::uint64_t rest = shares_.open[w]; rest != 0; rest &= rest - 1)
        look_again(64 * w + static_cast<unsigned>(std::countr_zero(rest)), planes);
    if (!hull_.simplicial()) choose_planes(planes);
    const SmallTotals all = total();
    if (!settled(all, 0x1p-53)) return false;
    double origin[3];
    for (unsigned c = 0; c < 3; ++c)
      origin[c] = scale_by(points_.axes[c][hull_.ids[0]], -exponent_);
    if (!finish_quickly(3, exponent_, origin, all.volume, all.area, all.moment, &out.volume,
                        &out.area, out.centroid))
      finish_slowly(all, out);
    return true;
  }

 private:
  /// As make_frame finds it; false for frames it calls wild.
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
      frame_.emplace(make_frame(set_, ids_, axes_of_space, 3, 1));
    }
    return *frame_;
  }

  /// Facet i, which may need more than the vectors do.
  void look_again(unsigned i, double* planes) {
    const Frame& f = frame();
    std::uint32_t corners[3];
    FacetBlock<3> block;
    for (unsigned c = 0; c < 3; ++c) std::fill_n(block.origin[c], FacetBlock<3>::lanes, f.at(0)[c]);
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint8_t* at =
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
    shares_.volume[i] = share.volume;
    shares_.area[i] = share.area;
    for (unsigned c = 0; c < 3; ++c) shares_.moment[c][i] = share.moment[c];
    shares_.error[i] = share.error;
    shares_.area_error[i] = share.area_error;
  }

  /// Of the planes of a facet's simplices that of the longest normal, the first of equals.
  void choose_planes(double* planes) const {
    Number best[SmallHull3D::max_facets];
    unsigned facets = 0;
    for (unsigned i = 0; i < hull_.count; ++i) {
      const Number f = hull_.facet_of[i];
      if (f == facets)
        best[facets++] = static_cast<Number>(i);
      else if (shares_.area[i] > shares_.area[best[f]])
        best[f] = static_cast<Number>(i);
    }
    double chosen[4 * SmallHull3D::max_facets];
    for (unsigned f = 0; f < facets; ++f)
      std::copy_n(planes + std::size_t{4} * best[f], 4, chosen + std::size_t{4} * f);
    std::copy_n(chosen, std::size_t{4} * facets, planes);
  }

  /// Runs in doubles, then their sum: as total_of_runs, for a single chunk.
  SmallTotals total() const {
    static_assert(SmallHull3D::max_facets <= measure_chunk);
    SmallTotals all;
    for (unsigned first = 0; first < hull_.count; first += measure_run) {
      const unsigned end = std::min<unsigned>(hull_.count, first + measure_run);
      Share<3> run;
      for (unsigned i = first; i < end; ++i) {
        run.volume += shares_.volume[i];
        run.area += shares_.area[i];
        for (unsigned c = 0; c < 3; ++c) run.moment[c] += shares_.moment[c][i];
        run.error += shares_.error[i];
        run.area_error += shares_.area_error[i];
      }
      all.volume = all.volume + DoubleDouble(run.volume);
      all.area = all.area + DoubleDouble(run.area);
      for (unsigned c = 0; c < 3; ++c) all.moment[c] = all.moment[c] + DoubleDouble(run.moment[c]);
      all.error += run.error;
      all.area_error += run.area_error;
    }
    return all;
  }

  void finish_slowly(const SmallTotals& all, Measures& out) {
    Totals<DoubleDouble> sums(3);
    sums.volume = all.volume;
    sums.area = all.area;
    std::copy_n(all.moment, 3, sums.moment.begin());
    Hull h;
    finish_measures(frame(), sums, h);
    out.volume = h.volume;
    out.area = h.area;
    std::copy_n(h.centroid.begin(), 3, out.centroid);
  }

  const PointView& set_;
  const SmallPoints3D& points_;
  const SmallHull3D& hull_;
  int exponent_ = 0;
  SmallShares shares_;
  std::vector<std::uint64_t> ids_;
  std::optional<Frame> frame_;
};

void write(const PointView& set, const SmallHull3D& hull, const Measures& measures, HullBatch& to) {
  constexpr auto numbers = [] {
    std::array<std::uint8_t, SmallHull3D::max_facets + 64> n{};
    std::iota(n.begin(), n.begin() + SmallHull3D::max_facets, std::uint8_t{0});
    return n;
  }();
  to.point_counts.push_back(set.count);
  to.affine_dimensions.push_back(3);
  to.volumes.push_back(measures.volume);
  to.areas.push_back(measures.area);
  to.centroids.insert(to.centroids.end(), measures.centroid, measures.centroid + 3);
  append_bytes(to.vertices.items, hull.ids, hull.vertex_count);
  to.vertices.offsets.push_back(to.vertices.items.size());

  const std::size_t n = hull.count;
  to.facet_starts.push_back(to.facet_starts.back() + hull.facet_count);
  append_bytes(to.simplices.items, hull.vertices, 3 * n);
  append_bytes(to.simplex_neighbours.items, hull.opposite, 3 * n);
  if (hull.simplicial()) {
    append_threes(to.facets.offsets, n);
    append_threes(to.facet_neighbours.offsets, n);
    append_bytes(to.facets.items, hull.vertices, 3 * n);
    append_bytes(to.facet_neighbours.items, hull.beside, 3 * n);
    append_bytes(to.simplex_facets.items, numbers.data(), n);
  } else {
    const std::uint64_t size = append_sizes(to.facets.offsets, hull);
    append_sizes(to.facet_neighbours.offsets, hull);
    append_bytes(to.facets.items, hull.corners, size);
    append_bytes(to.facet_neighbours.items, hull.beside, size);
    append_bytes(to.simplex_facets.items, hull.facet_of, n);
  }
  to.simplices.offsets.push_back(to.simplices.items.size());
  to.simplex_neighbours.offsets.push_back(to.simplex_neighbours.items.size());
  to.simplex_facets.offsets.push_back(to.simplex_facets.items.size());
}

}  // namespace

bool append_small_3d(const PointView& set, HullBatch& to) {
  if (set.dimension != 3 || set.count < 4 || set.count > SmallHull3D::max_points) return false;
  SmallPoints3D points;
  SmallHull3D hull;
  load(set, points);
  if (!small_hull_3d(points, static_cast<unsigned>(set.count), hull)) return false;
  const std::size_t planes = to.facet_planes.size();
  Measures measures;
  const bool done =
      SmallMeasurer(set, points, hull)
          .run(extend(to.facet_planes, std::size_t{4} * ((hull.count + 7) / 8 * 8)), measures);
  to.facet_planes.resize(done ? planes + std::size_t{4} * hull.facet_count : planes);
  if (done) write(set, hull, measures, to);
  return done;
}

}  // namespace cullhull::internal
