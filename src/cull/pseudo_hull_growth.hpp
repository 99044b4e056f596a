// One pseudo-hull, grown round by round over the data-parallel primitives (the paper's Algorithm
// 1).
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "control.hpp"
#include "cull/pseudo_hull.hpp"
#include "cull/pseudo_hull_math.hpp"
#include "cull/pseudo_hull_start.hpp"
#include "parallel/big_array.hpp"
#include "parallel/primitives.hpp"

namespace cullhull::internal {

/// An exterior point: a row, the facet it is assigned to, and how far outside of it it lies.
struct ExteriorPoint {
  std::uint32_t row;
  std::uint32_t facet;
  double distance;
};

/// Reusable: memory is kept from one subset to the next.
template <unsigned D, class Executor>
class PseudoHullGrowth {
 public:
  explicit PseudoHullGrowth(Executor executor) : executor_(std::move(executor)) {}

  /// Room for `count` rows, which the caller fills before `run`. A row that must survive is NaN in
  /// every coordinate.
  double* rows(std::uint32_t count) {
    count_ = count;
    if (capacity_ < count) {
      rows_ = BigArray<double>(std::size_t{count} * D);
      points_ = BigArray<ExteriorPoint>(count);
      next_points_ = BigArray<ExteriorPoint>(count);
      place_ = BigArray<std::uint32_t>(count);
      capacity_ = count;
    }
    return rows_.get();
  }

  /// Grows to the end; afterwards culled()[i] tells whether row i is strictly inside. `rounds`
  /// gets longer where needed and is added to.
  void run(unsigned max_rounds, const Control& control, std::vector<PseudoHullRound>& rounds) {
    culled_.assign(count_, 0);
    if (recording_) simplex_of_.assign(count_, no_item);
    corners_.clear();
    if (!start(rounds)) return;
    for (unsigned r = 1; r <= max_rounds && exterior_ != 0; ++r) {
      control.check();
      round(at(rounds, r));
    }
  }
  const std::vector<char>& culled() const { return culled_; }

  /// From now on each run remembers which simplex culled a row: simplex_of()[row], no_item if none
  /// did; simplex s has the rows corners()[s (D + 1) ... (s + 1) (D + 1)).
  void record() { recording_ = true; }
  const std::vector<std::uint32_t>& simplex_of() const { return simplex_of_; }
  const std::vector<std::uint32_t>& corners() const { return corners_; }

  // What the tests look at.
  const std::vector<PseudoFacet<D>>& facets() const { return facets_; }
  std::uint32_t exterior_count() const { return exterior_; }
  const ExteriorPoint& exterior_point(std::uint32_t i) const { return points_[i]; }
  const double* vertex(std::uint32_t v) const { return vertices_.data() + std::size_t{v} * D; }

  /// Algorithm 1's first part: the simplex and the exterior sets of its facets. False if there is
  /// no simplex; then nothing is culled.
  bool start(std::vector<PseudoHullRound>& rounds) {
    exterior_ = 0;
    facets_.clear();
    vertices_.clear();
    vertex_rows_.clear();
    double scale[D];
    std::uint32_t simplex[D + 1];
    const AxisExtremes<D> e = extremes();
    if (!axis_scales(e, scale)) return false;
    executor_.for_each(blocks(), [&](std::uint32_t b) {
      for (std::size_t i = std::size_t{b} * block; i < std::min(count_, (b + 1) * block); ++i)
        for (unsigned k = 0; k < D; ++k) rows_[i * D + k] *= scale[k];
    });
    if (!choose_simplex(rows_.get(), count_, e, executor_, simplex)) return false;
    for (const std::uint32_t v : simplex) vertices_.insert(vertices_.end(), row(v), row(v) + D);
    if (!first_facets()) return false;
    if (recording_) {
      vertex_rows_.assign(simplex, simplex + D + 1);
      corners_ = vertex_rows_;
    }
    assign_first(at(rounds, 0));
    compact(D + 1);
    return true;
  }

  /// Every facet with an exterior set is replaced by the D facets through its apex.
  void round(PseudoHullRound& report) {
    const auto facets = static_cast<std::uint32_t>(facets_.size());
    apex_.resize(facets);
    executor_.segmented_argmax(
        exterior_, facets, [&](std::uint32_t i) { return points_[i].facet; },
        [&](std::uint32_t i) { return points_[i].distance; }, apex_.data());
    const auto first_simplex = static_cast<std::uint32_t>(corners_.size() / (D + 1));
    if (recording_) record_simplices();
    const std::uint32_t first_apex = replace_facets();
    reassign(first_apex, facets, first_simplex);
    tally(report);
    report.facets += facets;
    compact(facets * D);
  }

 private:
  static constexpr std::uint32_t block = 512;

  static PseudoHullRound& at(std::vector<PseudoHullRound>& rounds, std::size_t r) {
    if (rounds.size() <= r) rounds.resize(r + 1);
    return rounds[r];
  }
  std::uint32_t blocks() const { return static_cast<std::uint32_t>(chunk_count(count_, block)); }
  const double* row(std::uint32_t i) const { return rows_.get() + std::size_t{i} * D; }

  AxisExtremes<D> extremes() const {
    return executor_.reduce(
        blocks(), AxisExtremes<D>{},
        [&](std::uint32_t b) {
          return axis_extremes<D>(rows_.get(), b * block, std::min(count_, (b + 1) * block));
        },
        [](AxisExtremes<D> a, const AxisExtremes<D>& b) {
          a.take(b);
          return a;
        });
  }

  bool first_facets() {
    facets_.resize(D + 1);
    for (unsigned f = 0; f <= D; ++f) {
      const double* corner[D];
      for (unsigned k = 0, v = 0; v <= D; ++v) {
        if (v == f) continue;
        facets_[f].vertex[k] = v;
        corner[k++] = vertex(v);
      }
      if (!make_plane<D>(corner, vertex(f), facets_[f])) return false;
    }
    return true;
  }

  /// All rows become exterior points of the simplex for a moment; compact() leaves those that are.
  void assign_first(PseudoHullRound& report) {
    exterior_ = count_;
    PseudoFacet<D> facet[D + 1];  // copies, and so known not to change in the loop
    double base[D + 1][D];
    for (unsigned f = 0; f <= D; ++f) {
      facet[f] = facets_[f];
      std::copy_n(vertex(facet[f].vertex[0]), D, base[f]);
    }
    executor_.for_each(count_, [&](std::uint32_t i) {
      const double* x = row(i);
      PlaceSearch search;
      for (unsigned f = 0; f <= D; ++f)
        search.offer(f, pseudo_distance<D>(facet[f].normal, base[f], x), facet[f].error);
      const Place place = search.result();
      points_[i] = {i, 0, place.distance};
      place_[i] = place.facet;
      culled_[i] = place.facet == place_inside;
      if (recording_ && place.facet == place_inside) simplex_of_[i] = 0;
    });
    tally(report);
  }

  /// Each facet with its apex is a simplex; those of a round lie one after another.
  void record_simplices() {
    const auto facets = static_cast<std::uint32_t>(facets_.size());
    const std::size_t first = corners_.size(), first_vertex = vertex_rows_.size();
    corners_.resize(first + std::size_t{facets} * (D + 1));
    vertex_rows_.resize(first_vertex + facets);
    executor_.for_each(facets, [&](std::uint32_t j) {
      std::uint32_t* corner = corners_.data() + first + std::size_t{j} * (D + 1);
      for (unsigned k = 0; k < D; ++k) corner[k] = vertex_rows_[facets_[j].vertex[k]];
      corner[D] = vertex_rows_[first_vertex + j] = points_[apex_[j]].row;
    });
  }

  /// The apexes become vertices, the facet stream grows to D cells a facet. Returns the vertex of
  /// facet 0's apex; the others follow.
  std::uint32_t replace_facets() {
    const auto facets = static_cast<std::uint32_t>(facets_.size());
    const auto first_apex = static_cast<std::uint32_t>(vertices_.size() / D);
    vertices_.resize(vertices_.size() + std::size_t{facets} * D);
    facets_.resize(std::size_t{facets} * D);
    executor_.for_each(facets, [&](std::uint32_t j) {
      const std::uint32_t v = first_apex + j;
      const double* apex = row(points_[apex_[j]].row);
      for (unsigned k = 0; k < D; ++k) vertices_[std::size_t{v} * D + k] = apex[k];
      const PseudoFacet<D> parent = facets_[j];
      for (unsigned i = 0; i < D; ++i) {
        // Facet i: the apex in the place of vertex i, which is on the inner side.
        PseudoFacet<D>& child = facets_[child_address<D>(facets, j, i)];
        const double* corner[D] = {apex};
        child.vertex[0] = v;
        for (unsigned k = 0, at = 1; k < D; ++k) {
          if (k == i) continue;
          child.vertex[at] = parent.vertex[k];
          corner[at++] = vertex(parent.vertex[k]);
        }
        make_plane<D>(corner, vertex(parent.vertex[i]), child);
      }
    });
    return first_apex;
  }

  /// Each exterior point of a facet moves to the nearest of the new ones it is outside of.
  void reassign(std::uint32_t first_apex, std::uint32_t facets, std::uint32_t first_simplex) {
    executor_.for_each(exterior_, [&](std::uint32_t i) {
      ExteriorPoint& p = points_[i];
      const double* x = row(p.row);
      const double* apex = vertex(first_apex + p.facet);
      PlaceSearch search;
      for (unsigned c = 0; c < D; ++c) {
        const std::uint32_t address = child_address<D>(facets, p.facet, c);
        const PseudoFacet<D>& f = facets_[address];
        search.offer(address, pseudo_distance<D>(f.normal, apex, x), f.error);
      }
      const Place place = search.result();
      p.distance = place.distance;
      place_[i] = place.facet;
      culled_[p.row] = place.facet == place_inside;
      if (recording_ && place.facet == place_inside) simplex_of_[p.row] = first_simplex + p.facet;
    });
  }

  void tally(PseudoHullRound& report) {
    struct Sum {
      std::uint64_t culled, kept;
    };
    const Sum sum = executor_.reduce(
        exterior_, Sum{0, 0},
        [&](std::uint32_t i) {
          return Sum{place_[i] == place_inside ? 1U : 0U, place_[i] == place_uncertain ? 1U : 0U};
        },
        [](const Sum& a, const Sum& b) {
          return Sum{a.culled + b.culled, a.kept + b.kept};
        });
    report.exterior += exterior_;
    report.culled += sum.culled;
    report.kept += sum.kept;
  }

  /// Removes the null cells of the facet stream and the points that have found their place.
  void compact(std::uint32_t cells) {
    // The cell after the last stands for all points that have found their place.
    number_.assign(std::size_t{cells} + 1, 0);
    executor_.for_each(exterior_,
                       [&](std::uint32_t i) { mark(number_[std::min(place_[i], cells)]); });
    const auto facets = executor_.exclusive_scan(number_.data(), cells);
    number_[cells] = facets;
    next_facets_.resize(facets);
    executor_.for_each(cells, [&](std::uint32_t c) {
      if (number_[c] != number_[c + 1]) next_facets_[number_[c]] = facets_[c];
    });
    facets_.swap(next_facets_);

    exterior_ = executor_.select(
        exterior_, [&](std::uint32_t i) { return place_[i] < cells; },
        [&](std::uint32_t i, std::uint32_t k) {
          next_points_[k] = {points_[i].row, number_[std::min(place_[i], cells)],
                             points_[i].distance};
        });
    std::swap(points_, next_points_);
  }

  Executor executor_;
  std::uint32_t count_ = 0, capacity_ = 0, exterior_ = 0;
  BigArray<double> rows_;
  BigArray<ExteriorPoint> points_, next_points_;
  BigArray<std::uint32_t> place_;
  std::vector<double> vertices_;
  std::vector<char> culled_;
  bool recording_ = false;
  std::vector<std::uint32_t> simplex_of_, corners_, vertex_rows_;
  std::vector<PseudoFacet<D>> facets_, next_facets_;
  std::vector<std::uint32_t> apex_, number_;
};

}  // namespace cullhull::internal
