// Builds the cells; the kernel that tests points by them is compiled once per instruction set and
// chosen at run time.
#include "parallel/simd_targets.hpp"
#include "parallel/threads/run.hpp"
#include "query/facet_search.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/facet_cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/planner.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

constexpr double least_reach = FacetCellTable::least_reach;

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

/// Working data of a block of points.
template <unsigned K>
struct Block {
  HWY_ALIGN double x[K][FacetCells::block];  // localised; 0 for a point beyond the box
  HWY_ALIGN double most[FacetCells::block];  // the largest value of any facet
  HWY_ALIGN std::int32_t cells[FacetCells::block];
};

/// Localises a vector of points and finds their cells, as DirectionCube::cell does. False if a
/// coordinate is not finite.
template <unsigned K>
HWY_INLINE bool find_cells(const FacetCellTable& t, const double* HWY_RESTRICT columns,
                           std::uint32_t i, Block<K>& b) {
  const D d;
  V q[K];
  auto in_box = hn::Eq(hn::Zero(d), hn::Zero(d)), finite = in_box;
  for (unsigned j = 0; j < K; ++j) {
    q[j] = hn::LoadU(d, columns + j * FacetCells::block + i);
    finite = hn::And(finite, hn::Le(hn::Abs(q[j]), hn::Set(d, hwy::HighestValue<double>())));
    in_box = hn::And(
        in_box, hn::And(hn::Ge(q[j], hn::Set(d, t.low[j])), hn::Le(q[j], hn::Set(d, t.high[j]))));
  }
  V y[K], largest = hn::Zero(d);
  for (unsigned j = 0; j < K; ++j) {
    const V local = hn::Sub(hn::Mul(q[j], hn::Set(d, t.factor[j])), hn::Set(d, t.centre[j]));
    y[j] = hn::IfThenElseZero(in_box, local);
    largest = hn::Max(largest, hn::Abs(y[j]));
    hn::Store(y[j], d, b.x[j] + i);
  }
  // With the first dominant axis a: grid axis j is axis j below a, j + 1 from a on.
  V other[K - 1], dominant = y[K - 1], face = hn::Set(d, 2.0 * (K - 1));
  auto at_or_after = hn::Lt(largest, hn::Zero(d));  // false in every lane
  for (unsigned j = 0; j + 1 < K; ++j) {
    const auto here = hn::AndNot(at_or_after, hn::Eq(hn::Abs(y[j]), largest));
    dominant = hn::IfThenElse(here, y[j], dominant);
    face = hn::IfThenElse(here, hn::Set(d, 2.0 * j), face);
    at_or_after = hn::Or(at_or_after, here);
    other[j] = hn::IfThenElse(at_or_after, y[j + 1], y[j]);
  }
  face = hn::Add(face, hn::IfThenElseZero(hn::Lt(dominant, hn::Zero(d)), hn::Set(d, 1.0)));
  const V resolution = hn::Set(d, static_cast<double>(t.resolution));
  const V half = hn::Mul(hn::Set(d, 0.5), resolution), top = hn::Sub(resolution, hn::Set(d, 1.0));
  const V scale = hn::Div(half, hn::Max(largest, hn::Set(d, least_reach)));
  V cell = face;
  for (unsigned j = 0; j + 1 < K; ++j) {
    const V at = hn::Add(hn::Mul(other[j], scale), half);
    const V column = hn::Floor(hn::Min(hn::Max(at, hn::Zero(d)), top));
    cell = hn::Add(hn::Mul(cell, resolution), column);  // integers: exact
  }
  const hn::Rebind<std::int32_t, D> d32;
  hn::StoreU(hn::DemoteTo(d32, cell), d32, b.cells + i);
  return hn::AllTrue(d, finite);
}

/// The largest value of the facets in the list of the point's cell; a NaN for an empty list.
template <unsigned K>
HWY_INLINE double most_of_list(const FacetCellTable& t, const double* HWY_RESTRICT normals,
                               const std::uint32_t* HWY_RESTRICT facets, const Block<K>& b,
                               std::uint32_t i) {
  const auto cell = static_cast<std::uint32_t>(b.cells[i]);
  const std::uint32_t begin = t.starts[cell], end = t.starts[cell + 1];
  if (HWY_UNLIKELY(begin == end)) return std::numeric_limits<double>::quiet_NaN();
  double x[K], most = -std::numeric_limits<double>::infinity();
  for (unsigned j = 0; j < K; ++j) x[j] = b.x[j][i];
  for (std::uint32_t g = begin; g < end; ++g) {
    double values[FacetCellTable::group];
    for (unsigned m = 0; m < FacetCellTable::group; ++m) {
      const double* n = normals + std::size_t{facets[g * FacetCellTable::group + m]} * K;
      values[m] = n[0] * x[0];
      for (unsigned j = 1; j < K; ++j) values[m] += n[j] * x[j];
    }
    most = std::max(most, std::max(std::max(values[0], values[1]), std::max(values[2], values[3])));
  }
  return most;
}

/// value +- error_factor (reach + |value|) +- value_tiny is monotone in the value, so testing the
/// largest value suffices. A NaN decides nothing.
template <unsigned K>
HWY_INLINE void decide(const FacetCellTable& t, const double* HWY_RESTRICT columns, std::uint32_t i,
                       const Block<K>& b, std::int8_t* HWY_RESTRICT out) {
  const D d;
  V reach = hn::Zero(d);
  auto beyond = hn::Lt(reach, reach);
  for (unsigned j = 0; j < K; ++j) {
    const V q = hn::LoadU(d, columns + j * FacetCells::block + i);
    beyond =
        hn::Or(beyond, hn::Or(hn::Lt(q, hn::Set(d, t.low[j])), hn::Gt(q, hn::Set(d, t.high[j]))));
    reach = hn::Max(reach, hn::Abs(hn::Load(d, b.x[j] + i)));
  }
  const V one = hn::Set(d, 1.0), most = hn::Load(d, b.most + i);
  const V error = hn::Add(hn::Mul(hn::Set(d, t.error_factor), hn::Add(reach, hn::Abs(most))),
                          hn::Set(d, FacetSearch::value_tiny));
  const auto known = hn::Ge(reach, hn::Set(d, least_reach));
  const auto above = hn::Or(beyond, hn::And(known, hn::Gt(hn::Sub(most, error), one)));
  const auto below = hn::And(known, hn::Lt(hn::Add(most, error), one));
  const V sides = hn::Sub(hn::IfThenElseZero(above, one), hn::IfThenElseZero(below, one));
  const hn::Rebind<std::int32_t, D> d32;
  HWY_ALIGN std::int32_t few[hn::MaxLanes(D())];
  hn::StoreU(hn::DemoteTo(d32, sides), d32, few);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    out[i + lane] = static_cast<std::int8_t>(few[lane]);
}

template <unsigned K>
bool sides_as(const FacetCellTable& t, double* columns, std::uint32_t count, std::int8_t* out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(D()));
  const std::uint32_t whole = (count + lanes - 1) / lanes * lanes;
  for (unsigned j = 0; j < K; ++j)
    std::fill(columns + j * FacetCells::block + count, columns + j * FacetCells::block + whole,
              columns[j * FacetCells::block]);
  Block<K> b;
  bool finite = true;
  for (std::uint32_t i = 0; i < whole; i += lanes) finite &= find_cells(t, columns, i, b);
  for (std::uint32_t i = 0; i < whole; ++i)
    b.most[i] = most_of_list(t, t.normals.data(), t.facets.data(), b, i);
  for (std::uint32_t i = 0; i < whole; i += lanes) decide(t, columns, i, b, out);
  return finite;
}

}  // namespace

bool cell_sides(const FacetCellTable& t, double* columns, std::uint32_t count, std::int8_t* out) {
  return with_dimension<2, 3, 4>(t.k,
                                 [&](auto k) { return sides_as<k()>(t, columns, count, out); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(cell_sides);

namespace {

/// A cell with a facet of a larger error factor gets an empty list: that facet would leave many
/// points undecided.
constexpr double worst_factor = 0x1p-24;

/// Computes the list of one cell.
class CellLister {
 public:
  static constexpr std::size_t most = 64;  // longer lists save little over climbing; untested

  explicit CellLister(const FacetSearch& search) : search_(search), k_(search.k()) {
    corners_.resize((std::size_t{1} << (k_ - 1)) * k_);
  }

  /// Facets that may have the largest value somewhere in the cell; empty where they are too many or
  /// one has too large an error.
  const std::vector<std::uint32_t>& list(const DirectionCube& cube, std::size_t cell) {
    found_.clear();
    double centre[FacetCellTable::max_k];
    cube.centre(cell, centre);
    const std::uint32_t first = search_.climb(search_.start(centre), centre);
    found_.push_back(first);
    // The corners of a slightly larger cell.
    const double half = cube.half_width() + 0x1p-45;
    const std::size_t count = corners_.size() / k_;
    for (std::size_t c = 0; c < count; ++c) {
      unsigned bit = 0;
      for (unsigned j = 0; j < k_; ++j) {
        double& at = corners_[c * k_ + j];
        at = centre[j];
        if (j != cube.axis(cell)) at += c >> bit++ & 1 ? half : -half;
      }
    }
    for (std::size_t c = 0; c < count; ++c)
      if (!add_above(first, corners_.data() + c * k_)) {
        found_.clear();
        return found_;
      }
    drop_dominated(count);
    // Such a facet would leave too many points undecided.
    if (std::any_of(found_.begin(), found_.end(),
                    [this](std::uint32_t f) { return !(search_.error_factor(f) <= worst_factor); }))
      found_.clear();
    return found_;
  }

 private:
  double value(std::uint32_t f, const double* x, double& error) const {
    const double v = search_.value<0>(f, x);
    double reach = 0;
    for (unsigned j = 0; j < k_; ++j) reach = std::max(reach, std::fabs(x[j]));
    error = FacetSearch::value_error(search_.error_factor(f), reach, v);
    return v;
  }

  /// Adds the facets that may have a larger value than `first` at x; false if there are too many.
  bool add_above(std::uint32_t first, const double* x) {
    double error = 0;
    const double floor = value(first, x, error) - error;
    ring_.assign(1, first);
    seen_.assign(1, first);
    while (!ring_.empty()) {
      const std::uint32_t f = ring_.back();
      ring_.pop_back();
      for (const std::uint32_t g : search_.neighbours(f)) {
        if (std::find(seen_.begin(), seen_.end(), g) != seen_.end()) continue;
        const double v = value(g, x, error);
        if (v + error < floor) continue;
        if (seen_.size() == most) return false;
        seen_.push_back(g);
        ring_.push_back(g);
        if (std::find(found_.begin(), found_.end(), g) == found_.end()) found_.push_back(g);
      }
    }
    return found_.size() <= most;
  }

  /// Drops facets that are certainly below another one at every corner, and so in the whole cell.
  /// Being certainly below is transitive, so a facet that is kept is above each that is dropped.
  void drop_dominated(std::size_t corners) {
    low_.resize(found_.size() * corners);
    high_.resize(found_.size() * corners);
    for (std::size_t i = 0; i < found_.size(); ++i)
      for (std::size_t c = 0; c < corners; ++c) {
        double error = 0;
        const double v = value(found_[i], corners_.data() + c * k_, error);
        low_[i * corners + c] = v - error;
        high_[i * corners + c] = v + error;
      }
    kept_.clear();
    for (std::size_t i = 0; i < found_.size(); ++i) {
      bool dominated = false;
      for (std::size_t o = 0; o < found_.size() && !dominated; ++o) {
        dominated = true;
        for (std::size_t c = 0; c < corners && dominated; ++c)
          dominated = high_[i * corners + c] < low_[o * corners + c];
      }
      if (!dominated) kept_.push_back(found_[i]);
    }
    found_.swap(kept_);
  }

  const FacetSearch& search_;
  const unsigned k_;
  std::vector<double> corners_, low_, high_;
  std::vector<std::uint32_t> found_, kept_, ring_, seen_;
};

/// The number of cells: more cells make lists shorter but take longer to build. At most 2^17, whose
/// offsets take half a megabyte and fit L2. Eight per facet and at least 2048 are untested.
double cell_count(const FacetSearch& search) {
  constexpr double least = 2048, most = 1 << 17, a_facet = 8;
  return std::clamp(a_facet * static_cast<double>(search.count()), least, most);
}

DirectionCube cube_of(const FacetSearch& search) {
  if (search.exhaustive() || search.k() > FacetCellTable::max_k) return {};
  return {search.k(), cell_count(search)};
}

}  // namespace

std::uint64_t FacetCells::count(const FacetSearch& search) {
  const DirectionCube cube = cube_of(search);
  return cube.empty() ? 0 : cube.size();
}

std::uint64_t FacetCells::worthwhile(const FacetSearch& search) {
  return sides_worth_a_cell * static_cast<std::uint64_t>(cell_count(search));
}

/// A point x in a cell is a combination with weights >= 0 of the cell's corners. `first` is in the
/// list; a facet that is not has at every corner at most the value of one that is, so also at x:
/// the largest value at x is that of a facet in the list. For a corner u the facets of at least the
/// value of `first` at u are connected (facet_search.hpp) and all of them are visited.
///
/// Rounding: the cell found is that of a direction whose coordinates, on a face of the unit cube,
/// are off by less than 2^-49: localising is two operations (u = 2^-53 relative each, and no
/// underflow that counts where max|x| >= least_reach), so are the two of the scaled coordinate,
/// whose sum with `half` is off by at most 2 u half. The centres are off by 2^-52 at most. Corners
/// 2^-45 farther out than the cell's hold all such directions.
std::unique_ptr<FacetCells> FacetCells::build(const FacetSearch& search, const QueryPoints& points,
                                              const Run& run) {
  const unsigned k = search.k();
  const DirectionCube cube = cube_of(search);
  if (cube.empty()) return nullptr;
  constexpr std::uint64_t chunk = 512;  // cells; tens of us of work
  std::vector<std::vector<std::uint32_t>> lists(chunk_count(cube.size(), chunk));
  std::unique_ptr<FacetCells> cells(new FacetCells);
  FacetCellTable& t = cells->table_;
  t.starts.assign(cube.size() + 1, 0);
  run.each_chunk(cube.size(), chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    CellLister lister(search);
    for (std::uint64_t cell = begin; cell < end; ++cell) {
      const std::vector<std::uint32_t>& list = lister.list(cube, cell);
      const std::size_t groups = (list.size() + FacetCellTable::group - 1) / FacetCellTable::group;
      t.starts[cell + 1] = static_cast<std::uint32_t>(groups);
      for (std::size_t i = 0; i < groups * FacetCellTable::group; ++i)
        lists[c].push_back(i < list.size() ? list[i] : list[0]);
    }
  });
  for (std::size_t cell = 0; cell < cube.size(); ++cell) t.starts[cell + 1] += t.starts[cell];
  for (const auto& list : lists) t.facets.insert(t.facets.end(), list.begin(), list.end());
  t.k = k;
  search.copy_frame(t.factor, t.centre);
  std::copy(points.low.begin(), points.low.end(), t.low);
  std::copy(points.high.begin(), points.high.end(), t.high);
  t.normals.resize(search.count() * k);
  for (std::uint32_t f = 0; f < search.count(); ++f) {
    std::copy_n(search.normal(f), k, t.normals.begin() + static_cast<std::ptrdiff_t>(f * k));
    if (search.error_factor(f) <= worst_factor)
      t.error_factor = std::max(t.error_factor, search.error_factor(f));
  }
  t.resolution = cube.resolution();
  return cells;
}

bool FacetCells::sides(double* columns, std::uint32_t count, std::int8_t* out) const {
  return HWY_DYNAMIC_DISPATCH(cell_sides)(table_, columns, count, out);
}

}  // namespace cullhull::internal
#endif
