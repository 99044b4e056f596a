#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_frame.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/gauge/gauge_leaders.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "geometry/box_of_rows.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/run.hpp"

#ifndef CULLHULL_LEADER_COLUMNS
#define CULLHULL_LEADER_COLUMNS
namespace cullhull::internal {
namespace {

constexpr unsigned power(unsigned base, unsigned e) {
  return e == 0 ? 1 : base * power(base, e - 1);
}

/// The leaders around a node, as columns of f32, and what was found with them.
template <unsigned D>
struct Columns {
  static constexpr unsigned row = 4;  ///< leaders side by side that are copied together
  static constexpr unsigned width = D <= 4 ? 4 : 3;  ///< on the other axes
  static constexpr unsigned rows = power(width, D - 2);
  static constexpr unsigned count = row * rows;
  static constexpr unsigned padded = (count + 15) / 16 * 16;
  static constexpr std::uint32_t none = ~0U;

  HWY_ALIGN float q[D][padded] = {};
  std::uint32_t start[rows];  ///< place in the grid of the first of each row

  // The basis, kept from node to node.
  bool warm = false;         ///< it has only leaders
  std::uint32_t at[D] = {};  ///< places in the grid; `none`: one of the first columns
  float inverse[D][D] = {};  ///< of the matrix with these columns
  float mu[D] = {};
};

}  // namespace
}  // namespace cullhull::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The simplex method for the least sum of weights mu >= 0 with Sum mu q = v. Example in the plane:
// v = (1, 0.5), leaders (1, 1), (1, -1), (0.9, 0.6). The basis (1, 1), (1, -1) gives mu = 0.75,
// 0.25 and the line x = 1 with y = (1, 0), y . q = 1 on it. y . (0.9, 0.6) = 0.9 is not beyond the
// line, so it is the least sum; a leader (1.1, 0.6) would be, and would replace (1, -1).
//
// A node's basis suits the next node but for a weight or two, which become negative: these leave
// first (the dual method), each for the leader that keeps the others on their side of the plane.
// Where there is no basis yet, v and D vectors around it are the first columns, of so high a price
// that leaders replace them.
//
// What is found is a suggestion: the weights are computed again in doubles, and any weights give a
// bound (exactness.md, G2).

template <unsigned D>
struct Simplex {
  using F = hn::CappedTag<float, 16>;
  using V = hn::Vec<F>;

  Columns<D>& c;
  float y[D];

  HWY_INLINE explicit Simplex(Columns<D>& columns) : c(columns) {}

  /// Column `in` takes the place of basis vector `out`, of cost `cost`; w = inverse * q_in.
  HWY_INLINE void pivot(unsigned out, unsigned in, const float (&w)[D], float value) {
    const float factor = 1 / w[out], ratio = c.mu[out] * factor;
    for (unsigned j = 0; j < D; ++j) c.inverse[out][j] *= factor;
    for (unsigned i = 0; i < D; ++i) {
      if (i == out) continue;
      c.mu[i] -= ratio * w[i];
      for (unsigned j = 0; j < D; ++j) c.inverse[i][j] -= w[i] * c.inverse[out][j];
    }
    c.mu[out] = ratio;
    c.at[out] = c.start[in / Columns<D>::row] + in % Columns<D>::row;
    for (unsigned j = 0; j < D; ++j) y[j] += (1 - value) * c.inverse[out][j];
  }

  HWY_INLINE void apply(unsigned in, float (&w)[D]) const {
    for (unsigned i = 0; i < D; ++i) {
      w[i] = 0;
      for (unsigned j = 0; j < D; ++j) w[i] += c.inverse[i][j] * c.q[j][in];
    }
  }

  static HWY_INLINE V dot(const V (&a)[D], const Columns<D>& c, std::size_t k) {
    const F f;
    V sum = hn::Mul(a[0], hn::LoadU(f, c.q[0] + k));
    for (unsigned j = 1; j < D; ++j) sum = hn::MulAdd(a[j], hn::LoadU(f, c.q[j] + k), sum);
    return sum;
  }

  /// The column with the largest value of `score(k)`, if above `least`; else `none`.
  template <class Score>
  static HWY_INLINE std::uint32_t largest(float least, const Score& score, float& value) {
    const F f;
    const hn::RebindToSigned<F> i32;
    V best = hn::Set(f, least);
    auto place = hn::Set(i32, -1);
    for (std::size_t k = 0; k < Columns<D>::count; k += hn::Lanes(f)) {
      const V found = score(k);
      const auto more = hn::Gt(found, best);
      best = hn::IfThenElse(more, found, best);
      place = hn::IfThenElse(hn::RebindMask(i32, more), hn::Set(i32, static_cast<std::int32_t>(k)),
                             place);
    }
    const V top = hn::MaxOfLanes(f, best);
    value = hn::GetLane(top);
    if (value <= least) return Columns<D>::none;
    const std::size_t lane = hn::FindKnownFirstTrue(f, hn::Eq(best, top));
    return static_cast<std::uint32_t>(hn::ExtractLane(place, lane)) +
           static_cast<std::uint32_t>(lane);
  }

  HWY_INLINE bool mend(const float (&v)[D]) {
    const F f;
    for (unsigned i = 0; i < D; ++i) {
      c.mu[i] = y[i] = 0;
      for (unsigned j = 0; j < D; ++j) c.mu[i] += c.inverse[i][j] * v[j];
    }
    for (unsigned i = 0; i < D; ++i)
      for (unsigned j = 0; j < D; ++j) y[j] += c.inverse[i][j];
    for (unsigned step = 0; step < 3 * D; ++step) {
      unsigned out = 0;
      for (unsigned i = 1; i < D; ++i) out = c.mu[i] < c.mu[out] ? i : out;
      if (c.mu[out] > -0x1p-20F) return true;
      V plane[D], row[D];
      for (unsigned j = 0; j < D; ++j) {
        plane[j] = hn::Set(f, y[j]);
        row[j] = hn::Set(f, c.inverse[out][j]);
      }
      // The least (1 - y . q) / -(row . q): the largest of its inverse.
      const V one = hn::Set(f, 1.0F), tiny = hn::Set(f, 0x1p-20F);
      float rate;
      const std::uint32_t in = largest(
          0x1p-10F,
          [&](std::size_t k) HWY_ATTR {
        return hn::Div(hn::Neg(dot(row, c, k)), hn::Max(hn::Sub(one, dot(plane, c, k)), tiny));
          },
          rate);
      if (in == Columns<D>::none) return false;
      float w[D], value = 0;
      apply(in, w);
      for (unsigned j = 0; j < D; ++j) value += y[j] * c.q[j][in];
      if (w[out] > -0x1p-16F) return false;
      pivot(out, in, w, value);
    }
    return false;
  }

  /// The first columns: v + width e_k for each axis k but the longest, and v - width (1, ..., 1).
  HWY_INLINE void begin(const float (&v)[D], unsigned axis, float width) {
    constexpr float price = 4096;
    float all = 0;
    for (unsigned j = 0; j < D; ++j) all += j == axis ? 0 : v[j];
    for (unsigned j = 0; j < D; ++j)
      c.inverse[axis][j] = j == axis ? v[axis] * (1 + all / width) / D : -1 / (width * D);
    for (unsigned i = 0; i < D; ++i) {
      for (unsigned j = 0; j < D && i != axis; ++j)
        c.inverse[i][j] = c.inverse[axis][j] + (j == axis ? -v[axis] * v[i]
                                                : j == i  ? 1.0F
                                                          : 0.0F) /
                                                   width;
      c.mu[i] = 1.0F / D;
      c.at[i] = Columns<D>::none;
    }
    for (unsigned j = 0; j < D; ++j) {
      y[j] = 0;
      for (unsigned i = 0; i < D; ++i) y[j] += price * c.inverse[i][j];
    }
  }

  HWY_INLINE void improve() {
    const F f;
    for (unsigned step = 0; step < 12 * D; ++step) {
      V plane[D];
      for (unsigned j = 0; j < D; ++j) plane[j] = hn::Set(f, y[j]);
      float value;
      const std::uint32_t in = largest(
          1 + 0x1p-18F, [&](std::size_t k) HWY_ATTR { return dot(plane, c, k); }, value);
      if (in == Columns<D>::none) return;
      float w[D], ratio = 1e30F;
      apply(in, w);
      unsigned out = D;
      for (unsigned i = 0; i < D; ++i)
        if (w[i] > 0x1p-20F && c.mu[i] < ratio * w[i]) {
          ratio = c.mu[i] / w[i];
          out = i;
        }
      if (out == D) return;
      pivot(out, in, w, value);
    }
  }
};

template <unsigned D>
HWY_INLINE void least_weights(Columns<D>& c, const float (&v)[D], unsigned axis, float width) {
  Simplex<D> simplex(c);
  if (!c.warm || !simplex.mend(v)) simplex.begin(v, axis, width);
  simplex.improve();
  c.warm = true;
  for (const std::uint32_t at : c.at) c.warm = c.warm && at != Columns<D>::none;
}

}  // namespace

void least_weights_3(Columns<3>& c, const float (&v)[3], unsigned axis, float width) {
  least_weights(c, v, axis, width);
}
void least_weights_4(Columns<4>& c, const float (&v)[4], unsigned axis, float width) {
  least_weights(c, v, axis, width);
}
void least_weights_5(Columns<5>& c, const float (&v)[5], unsigned axis, float width) {
  least_weights(c, v, axis, width);
}
void least_weights_6(Columns<6>& c, const float (&v)[6], unsigned axis, float width) {
  least_weights(c, v, axis, width);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(least_weights_3);
HWY_EXPORT(least_weights_4);
HWY_EXPORT(least_weights_5);
HWY_EXPORT(least_weights_6);

namespace {

template <unsigned D>
void find_weights(Columns<D>& c, const float (&v)[D], unsigned axis, float width) {
  if constexpr (D == 3) HWY_DYNAMIC_DISPATCH(least_weights_3)(c, v, axis, width);
  if constexpr (D == 4) HWY_DYNAMIC_DISPATCH(least_weights_4)(c, v, axis, width);
  if constexpr (D == 5) HWY_DYNAMIC_DISPATCH(least_weights_5)(c, v, axis, width);
  if constexpr (D == 6) HWY_DYNAMIC_DISPATCH(least_weights_6)(c, v, axis, width);
}

/// The leaders of all cells, laid out so that those around a node lie side by side: each side's
/// grid has a border of cells of the sides next to it.
template <unsigned D>
class LeaderGrid {
 public:
  LeaderGrid(const Array<double>& rows, const GaugeTable& before, const LeaderCells& cells,
             const Run& run)
      : rows_(rows),
        before_(before),
        run_(run),
        box_(box_of_rows(
            rows.size() / D, D, [&](std::uint64_t i) { return rows.data() + i * D; }, run)),
        edge_(cells.leaders) {
    for (unsigned j = 0; j < D; ++j) centre_[j] = before.offset[j] / before.scale[j];
  }

  bool build(const LeaderCells& cells, GaugeTable& t) {
    if (cells.recentre) {
      edge_ = std::min(cells.leaders, coarse);
      if (!fill(t, edge_, 8)) return false;
      move_centre(t);
      edge_ = cells.leaders;
    }
    filled_ = cells.filled;
    return fill(t, cells.nodes, 1);
  }

 private:
  static constexpr std::uint32_t no_leader = 0xFFFFFFFF;
  static constexpr std::uint32_t some = 2048;
  static constexpr std::uint32_t room = some + gauge_room;

  static std::uint64_t face_of(std::uint64_t line) {
    std::uint64_t face = 1;
    for (unsigned k = 0; k + 1 < D; ++k) face *= line;
    return face;
  }

  /// Cells of leaders along an edge that tell the centre well enough.
  static constexpr unsigned coarse = D == 3 ? 8 : D == 4 ? 4 : 2;

  /// Builds the table from one in `every` pieces of the rows.
  bool fill(GaugeTable& t, unsigned nodes, unsigned every) {
    if (!find(t, every)) return false;
    lay();
    if (!frame_.bound_axes([&](const double* v, std::uint32_t* ids, double(&mu)[D]) {
          weights_towards(v, ids, mu);
        }))
      return false;
    allowance_ = gauge_allowance(D, frame_.lipschitz());
    if (!(allowance_ < most_gauge_allowance) || !fill_constants(t, nodes)) return false;
    t.nodes.resize(2 * D * static_cast<std::size_t>(t.face_stride));
    // Nodes of one line follow one another, so that a basis serves the next.
    run_.each(t.nodes.size(), 64, [&](std::uint64_t begin, std::uint64_t end) {
      Columns<D> columns;
      for (std::uint64_t node = begin; node < end; ++node) t.nodes[node] = value(t, node, columns);
    });
    for (unsigned sweep = 0; sweep < 2; ++sweep) level(t);
    return true;
  }

  // A node for which no good simplex was found would make its cells' bounds, and with them the core
  // of all points, several times too small: of 5,046 nodes of a cube one was at twice its gauge,
  // and a pass of 10 million points took a sixth longer for it.

  /// Lowers each node to the mean of the two beside it where that is less: as the gauge is convex,
  /// it bounds the gauge halfway between them, too.
  void level(GaugeTable& t) const {
    const auto before = t.nodes;
    const std::uint64_t line = t.cells + 1, face = static_cast<std::uint64_t>(t.face_stride);
    run_.each(before.size(), 2048, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t node = begin; node < end; ++node) {
        std::uint64_t rest = node % face, stride = 1;
        for (unsigned k = 0; k + 1 < D; ++k, rest /= line, stride *= line) {
          if (rest % line == 0 || rest % line == t.cells) continue;
          const double sum = static_cast<double>(before[node - stride]) + before[node + stride];
          t.nodes[node] = std::min(t.nodes[node], round_up(sum / 2 * (1 + 0x1p-49)));
        }
      }
    });
  }

  bool fill_constants(GaugeTable& t, unsigned cells) const {
    t.dimension = D;
    t.cells = cells;
    return frame_.fill(t);
  }

  // The outermost point of a cell is that of the largest gauge, by the map before: of all points
  // near a flat facet the farthest ones lie at the cell's edge, not at the facet. A cell's entry is
  // the gauge's bits above the complement of the row: the larger gauge wins, of equal ones the
  // lower row, whatever the order of threads.

  /// Chooses the frame and finds the leaders. `t` serves as the table of the cells.
  bool find(GaugeTable& t, unsigned every) {
    const std::uint64_t count = rows_.size() / D;
    double reach[D];
    for (unsigned j = 0; j < D; ++j)
      reach[j] = std::max(box_.high[j] - centre_[j], centre_[j] - box_.low[j]);
    if (!frame_.set(centre_, reach, true) || !fill_constants(t, edge_)) return false;
    std::vector<std::uint64_t> best(2 * D * face_of(edge_ + 1), 0);
    run_.each(count, some, [&](std::uint64_t begin, std::uint64_t end) {
      if (begin / some % every != 0) return;
      float gauges[room];
      std::uint32_t cells[room];
      const auto n = static_cast<std::uint32_t>(end - begin);
      gauge_bounds(before_, rows_.data() + begin * D, n, gauges);
      gauge_corners(t, rows_.data() + begin * D, n, cells);
      for (std::uint32_t k = 0; k < n; ++k) {
        if (!(gauges[k] > 0 && gauges[k] < std::numeric_limits<float>::infinity())) continue;
        const std::uint64_t entry = std::uint64_t{std::bit_cast<std::uint32_t>(gauges[k])} << 32 |
                                    (no_leader - static_cast<std::uint32_t>(begin + k));
        const std::atomic_ref<std::uint64_t> cell(best[cells[k]]);
        std::uint64_t known = cell.load(std::memory_order_relaxed);
        while (known < entry &&
               !cell.compare_exchange_weak(known, entry, std::memory_order_relaxed)) {
        }
      }
    });
    number_.assign(best.size(), no_leader);
    pack(
        best.size(), 8192, run_, [&](std::uint64_t c) { return best[c] != 0; },
        [&](std::uint64_t all) {
      frame_.make_room(all);
      return true;
        },
        [&](std::uint64_t c, std::uint64_t k) {
      number_[c] = static_cast<std::uint32_t>(k);
      const std::uint64_t i = no_leader - static_cast<std::uint32_t>(best[c]);
      frame_.place(k, rows_.data() + i * D);
    });
    const auto all = static_cast<double>(2 * D * face_of(edge_));
    return frame_.size() > D && static_cast<double>(frame_.size()) >= filled_ * all;
  }

  /// Moves the centre to the centroid of the body that the map describes. A deep centre makes the
  /// gauge smooth and the core (GaugeCore) large. A node v on the cube stands for a cell of its
  /// side, and the cone from the centre to v / G over it has a volume as G^-D.
  void move_centre(const GaugeTable& t) {
    double shift[D] = {}, all = 0, v[D];
    for (std::uint64_t node = 0; node < t.nodes.size(); ++node) {
      direction_of_node(t, node, v);
      double volume = 1;
      for (unsigned j = 0; j < D; ++j) volume /= static_cast<double>(t.nodes[node]);
      all += volume;
      for (unsigned j = 0; j < D; ++j)
        shift[j] += volume * v[j] / static_cast<double>(t.nodes[node]) * D / ((D + 1) * t.cells);
    }
    for (double& s : shift) {
      s /= all;
      if (!(std::abs(s) < 0.5)) return;
    }
    frame_.moved(shift, centre_);
  }

  /// A node as a vector of integers, the largest of which is +-cells.
  static void direction_of_node(const GaugeTable& t, std::uint64_t node, double (&v)[D]) {
    const auto face = static_cast<std::uint64_t>(t.face_stride);
    const auto side = static_cast<unsigned>(node / face);
    std::uint64_t rest = node % face;
    v[side / 2] = side % 2 ? -static_cast<double>(t.cells) : t.cells;
    for (unsigned j = 0; j < D; ++j) {
      if (j == side / 2) continue;
      v[j] = 2.0 * static_cast<double>(rest % (t.cells + 1)) - t.cells;
      rest /= t.cells + 1;
    }
  }

  /// Lays the leaders out, with a border of two cells around each side's grid.
  void lay() {
    line_ = edge_ + 4;
    padded_face_ = face_of(line_);
    const std::uint64_t all = 2 * D * padded_face_, face = face_of(edge_ + 1);
    id_.resize(all + 4);
    for (auto& q : q_) q.resize(all + 4);
    run_.each(all, 2048, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t at = begin; at < end; ++at) {
        const auto side = static_cast<unsigned>(at / padded_face_);
        std::uint64_t rest = at % padded_face_;
        double v[D];
        v[side / 2] = side % 2 ? -1 : 1;
        for (unsigned j = 0; j < D; ++j) {
          if (j == side / 2) continue;
          v[j] = (2 * static_cast<double>(rest % line_) - 3) / edge_ - 1;  // the cell's middle
          rest /= line_;
        }
        const Place place = place_of(v);
        std::uint64_t cell = place.side * face, stride = 1;
        for (unsigned k = 0; k + 1 < D; ++k, stride *= edge_ + 1)
          cell +=
              std::min<std::uint64_t>(static_cast<std::uint64_t>(place.at[k]), edge_ - 1) * stride;
        const std::uint32_t k = number_[cell];
        id_[at] = k;
        for (unsigned j = 0; j < D && k != no_leader; ++j)
          q_[j][at] = static_cast<float>(frame_.point(k)[j]);
      }
    });
  }

  /// Where a direction meets the cube: the side, and the place on it in cells, from 0 to edge_.
  struct Place {
    unsigned side;
    double at[D - 1];
  };
  Place place_of(const double* v) const {
    unsigned axis = 0;
    for (unsigned j = 1; j < D; ++j) axis = std::abs(v[j]) > std::abs(v[axis]) ? j : axis;
    Place place{2 * axis + (v[axis] < 0 ? 1 : 0), {}};
    for (unsigned k = 0; k + 1 < D; ++k)
      place.at[k] = std::max(0.0, (v[k < axis ? k : k + 1] / std::abs(v[axis]) + 1) / 2 * edge_);
    return place;
  }

  /// Suggests weights for v, with |v|_inf = 1.
  void weights(const double* v, std::uint32_t* ids, double (&mu)[D], Columns<D>& c) const {
    // The window around the place: its first cell on each axis, in the padded grid.
    const Place place = place_of(v);
    std::uint64_t base = place.side * padded_face_, stride = 1;
    for (unsigned k = 0; k + 1 < D; ++k, stride *= line_) {
      const double first = std::floor(place.at[k] + (k == 0 || Columns<D>::width == 4 ? 0.5 : 1));
      base += std::min<std::uint64_t>(static_cast<std::uint64_t>(first), edge_) * stride;
    }
    for (unsigned r = 0; r < Columns<D>::rows; ++r) {
      std::uint64_t at = base;
      stride = line_;
      for (unsigned k = 1, rest = r; k + 1 < D; ++k, rest /= Columns<D>::width, stride *= line_)
        at += rest % Columns<D>::width * stride;
      c.start[r] = static_cast<std::uint32_t>(at);
      for (unsigned j = 0; j < D; ++j)
        std::memcpy(&c.q[j][Columns<D>::row * r], &q_[j][at], Columns<D>::row * sizeof(float));
    }
    float w[D];
    for (unsigned j = 0; j < D; ++j) w[j] = static_cast<float>(v[j]);
    find_weights<D>(c, w, place.side / 2, 2.0F / static_cast<float>(edge_));
    for (unsigned i = 0; i < D; ++i) {
      const bool none = c.at[i] == Columns<D>::none || id_[c.at[i]] == no_leader;
      ids[i] = none ? 0 : id_[c.at[i]];
      mu[i] = none ? 0 : static_cast<double>(c.mu[i]);
    }
    if (c.warm) frame_.weights(ids, v, mu);
  }

  void weights_towards(const double* v, std::uint32_t* ids, double (&mu)[D]) const {
    Columns<D> columns;
    weights(v, ids, mu, columns);
  }

  /// An upper bound of the gauge at a node.
  float value(const GaugeTable& t, std::uint64_t node, Columns<D>& columns) const {
    double v[D], u[D], norm = 0;
    direction_of_node(t, node, v);
    for (unsigned j = 0; j < D; ++j) {
      u[j] = v[j] / t.cells;
      norm += std::abs(v[j]);
    }
    std::uint32_t ids[D];
    double mu[D];
    weights(u, ids, mu, columns);
    for (double& m : mu) m *= t.cells;
    const GaugeBound b = frame_.bound(ids, v, mu);
    const double fallback = frame_.lipschitz() * norm;
    double g = b.weight + frame_.lipschitz() * b.residual;
    if (!(g < fallback)) g = fallback;  // also for NaN
    return round_up((g / t.cells + allowance_) * (1 + 0x1p-49));
  }

  const Array<double>& rows_;
  const GaugeTable& before_;
  const Run& run_;
  const BoxOfRows box_;
  unsigned edge_;  ///< cells of leaders along an edge of the cube
  double filled_ = 0;
  double centre_[D];
  GaugeFrame<D> frame_;
  double allowance_ = 0;
  std::vector<std::uint32_t> number_;  ///< of a cell's leader, by the cell's lowest corner
  std::uint64_t line_ = 0, padded_face_ = 0;
  std::vector<std::uint32_t> id_;  ///< in the padded grid
  std::vector<float> q_[D];        ///< likewise; 0 where there is none
};

}  // namespace

bool build_gauge_of_leaders(const Array<double>& rows, const GaugeTable& before,
                            const LeaderCells& cells, const Run& run, GaugeTable& table) {
  return with_dimension<3, 5, 6>(before.dimension, [&](auto D) {
    return rows.size() / D() > D() && LeaderGrid<D()>(rows, before, cells, run).build(cells, table);
  });
}

}  // namespace cullhull::internal
#endif
