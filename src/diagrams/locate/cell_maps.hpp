// A triangulation of few cells, stored so that doubles alone answer nearly all questions: of each
// cell the map from coordinates to barycentric ones with a bound on its error, and a grid of cells
// to start from. What it leaves in doubt the walks of walk.hpp decide.
//
// Example in the plane: a cell with the corners (0, 0), (1, 0), (0, 1) maps (x, y) to (1 - x - y,
// x, y), with errors below 2^-46. (0.25, 0.5) is inside, (0.25, -2^-40) certainly beyond the facet
// opposite to the third corner. (0.25, 2^-50) is in doubt.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "diagrams/dual.hpp"
#include "diagrams/locate/walk_mesh.hpp"
#include "exact/determinants/cofactors.hpp"
#include "exact/determinants/minors.hpp"

namespace cullhull::internal {

/// The most bytes of maps (192 a cell in space): the walks of more cells need less memory.
constexpr std::uint64_t most_map_bytes = std::uint64_t{1} << 24;

/// The box of a mesh's vertices and their mean.
struct Extent {
  explicit Extent(const WalkMesh& mesh)
      : low(mesh.row(0), mesh.row(0) + mesh.dimension), high(low), middle(mesh.dimension, 0.0) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      for (unsigned j = 0; j < mesh.dimension; ++j) {
        const double x = mesh.row(v)[j];
        low[j] = std::min(low[j], x);
        high[j] = std::max(high[j], x);
        middle[j] += x / mesh.vertex_count();
      }
  }
  std::vector<double> low, high, middle;
};

enum class Found : std::uint8_t { inside, outside, doubtful, far };

/// inside: the point is strictly in the cell `place` and has these barycentric coordinates;
/// outside: it is beyond that cell's facet opposite to corner `facet`, which is on the hull;
/// doubtful: exact tests must go on from `place`; far: it is out of the box of all points, by more
/// than the margin. `refined`: the shares are the doubles nearest to the exact ones.
template <unsigned K>
struct MappedAnswer {
  double shares[K + 1];
  std::uint32_t place;
  std::uint8_t facet;
  Found found;
  bool refined;
};

/// The map of a cell and its neighbours: for axis j, columns[j][i] is what corner i + 1 gains a
/// unit.
template <unsigned K>
struct MappedCell {
  double columns[K][K];
  double origin[K], corners[K][K];
  double doubt;
  std::uint32_t next[K + 1];
};

/// Barycentric coordinates by the map. No products are fused and sums have one order, so that all
/// machines agree.
template <unsigned K>
inline void map_to_shares(const MappedCell<K>& cell, const double* q, double* shares) {
  double x[K], own[4] = {};
  for (unsigned j = 0; j < K; ++j) x[j] = q[j] - cell.origin[j];
  for (unsigned i = 0; i < K; ++i) {
    own[i] = cell.columns[0][i] * x[0] + cell.columns[1][i] * x[1];
    if constexpr (K == 3) own[i] += cell.columns[2][i] * x[2];
    if constexpr (K == 4) own[i] += cell.columns[2][i] * x[2] + cell.columns[3][i] * x[3];
    shares[i + 1] = own[i];
  }
  shares[0] = 1 - ((own[0] + own[3]) + (own[1] + own[2]));
}

/// The most questions that are answered at once.
constexpr std::size_t answered_at_once = 64;

template <unsigned K>
class CellMaps;

/// Answers n <= answered_at_once questions, packed rows. `refined`: shares of points inside are
/// refined where no rounding is in doubt; else they are within 2^-20. `margin`, at least 2^-40: how
/// far out of the box, as a share of its width, a point is `far`.
void answer(const CellMaps<2>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<2>* out);
void answer(const CellMaps<3>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<3>* out);
void answer(const CellMaps<4>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<4>* out);

template <unsigned K>
class CellMaps {
 public:
  static constexpr unsigned dimension = K;

  /// The mesh's points must span all K dimensions.
  CellMaps(const WalkMesh& mesh, const Extent& extent, const Run& run)
      : cells_(mesh.numbers.size()) {
    run.each(cells_.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t c = begin; c < end; ++c) lay(mesh, static_cast<std::uint32_t>(c));
    });
    lay_grid(mesh, extent);
  }

  const std::vector<MappedCell<K>>& cells() const { return cells_; }

  /// The cell from which a walk to q begins, that of its bin or, if q is out of the box, of the
  /// nearest one; `far`: it is out by more than `margin`, a share of the box's width.
  std::uint32_t start(const double* q, double margin, bool& far) const {
    return grid_[bin_of(q, margin, far)];
  }

  /// Whether the point is certainly outside, by its shares of the cell at `place`: beyond a facet
  /// of the hull and farther beyond it than beyond any other.
  bool is_outside(std::uint32_t place, const double* q) const {
    double shares[K + 1];
    map_to_shares(cells_[place], q, shares);
    const auto least = std::min_element(shares, shares + K + 1) - shares;
    // After an overflow the first share, and so the lowest, is infinite or NaN: nothing is below a
    // NaN.
    return shares[least] < -cells_[place].doubt && shares[least] > -0x1p1000 &&
           cells_[place].next[least] == no_index;
  }

 private:
  std::size_t bin_of(const double* q, double margin, bool& far) const {
    std::size_t at = 0;
    const auto most = static_cast<double>(bins_);
    far = false;
    for (unsigned j = K; j-- > 0;) {
      const double bin = (q[j] - low_[j]) * scale_[j];
      far |= (bin < -margin * most) | (bin > most + margin * most);
      // A NaN, of an overflow, gives 0.
      at = at * bins_ + static_cast<std::size_t>(std::min(std::max(0.0, bin), most - 1));
    }
    return at;
  }

  /// Map and bound of a cell. The map C is any approximate inverse of the edges' matrix A; with F =
  /// 1 - C A, what it says of q differs from the truth s by F s and by roundings of at most (K + 2)
  /// u |C| |A| |s|. If all shares are at least -t, none exceeds 1 + K t: hence a bound that holds
  /// for cells that contain q or nearly, and signs beyond it are certain everywhere, as |s| <= 1 +
  /// K |least share|. Four times the first-order bound is taken, which covers the rest.
  void lay(const WalkMesh& mesh, std::uint32_t c) {
    MappedCell<K>& cell = cells_[c];
    const std::uint32_t *v = mesh.corners_of(c), *across = mesh.neighbours_of(c);
    std::copy_n(across, K + 1, cell.next);
    std::copy_n(mesh.row(v[0]), K, cell.origin);
    double edges[K][K], inverse[K][K], reach = 0;
    for (unsigned i = 0; i < K; ++i) {
      std::copy_n(mesh.row(v[i + 1]), K, cell.corners[i]);
      for (unsigned j = 0; j < K; ++j) {
        edges[i][j] = cell.corners[i][j] - cell.origin[j];
        reach = std::max(reach, std::abs(edges[i][j]));
      }
    }
    // Times a power of two that brings the largest entry to [1/4, 1/2): products do not overflow.
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(reach) & std::uint64_t{0x7FF} << 52;
    const auto factor = std::bit_cast<double>((std::uint64_t{0x7FC} << 52) - exponent);
    double scaled[K][K];
    for (unsigned i = 0; i < K; ++i)
      for (unsigned j = 0; j < K; ++j) scaled[i][j] = edges[i][j] * factor;
    for (unsigned i = 0; i < K; ++i) {
      double others[K - 1][K], normal[K], along = 0;
      for (unsigned m = 0; m + 1 < K; ++m) std::copy_n(scaled[m < i ? m : m + 1], K, others[m]);
      cofactors<K>(others, normal);
      for (unsigned j = 0; j < K; ++j) along += normal[j] * scaled[i][j];
      for (unsigned j = 0; j < K; ++j) inverse[i][j] = normal[j] * (factor / along);
    }
    double wrong = 0, size = 0, largest = 0, finite = 0;
    for (unsigned i = 0; i < K; ++i) {
      double wrong_row = 0, size_row = 0;
      for (unsigned j = 0; j < K; ++j) {
        double entry = i == j ? 1 : 0;
        for (unsigned l = 0; l < K; ++l) {
          entry -= inverse[i][l] * edges[j][l];
          size_row += std::abs(inverse[i][l] * edges[j][l]);
        }
        wrong_row += std::abs(entry);
        cell.columns[j][i] = inverse[i][j];
        largest = std::max(largest, std::abs(inverse[i][j]));
        finite += 0 * inverse[i][j];  // else a NaN, which std::max leaves out
      }
      wrong = std::max(wrong, wrong_row);
      size = std::max(size, size_row);
    }
    cell.doubt =
        4 * (K + 1) * (wrong + (2 * K + 6) * unit_roundoff * size + (K + 2) * unit_roundoff);
    // Below 2^900 underflows amount to less than 2^-170.
    if (!(cell.doubt < 0x1p-20 && largest < 0x1p900 && finite == 0))
      cell.doubt = std::numeric_limits<double>::infinity();
  }

  /// About half as many bins as cells; each has the cell of its middle or, if that is outside, the
  /// last one on the way there.
  void lay_grid(const WalkMesh& mesh, const Extent& extent) {
    const double wanted = std::max(1.0, static_cast<double>(cells_.size()) / 2);
    bins_ = static_cast<std::size_t>(std::pow(wanted, 1.0 / K));
    std::size_t all = 1;
    for (unsigned j = 0; j < K; ++j) {
      all *= bins_;
      low_[j] = extent.low[j];
      const double scale = static_cast<double>(bins_) / (extent.high[j] - extent.low[j]);
      scale_[j] = std::isfinite(scale) ? scale : 0;
    }
    // At first a cell at a vertex in the bin or in one before it.
    grid_.assign(all, no_index);
    bool far = false;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      grid_[bin_of(mesh.row(v), 1, far)] = mesh.lowest_cell[v];
    std::uint32_t last = mesh.lowest_cell[0];
    for (std::uint32_t& place : grid_) {
      if (place == no_index) place = last;
      last = place;
    }
    double middles[answered_at_once * K];
    MappedAnswer<K> answers[answered_at_once];
    for (std::size_t first = 0; first < all; first += answered_at_once) {
      const std::size_t n = std::min(answered_at_once, all - first);
      for (std::size_t i = 0; i < n; ++i) {
        std::size_t bin = first + i;
        for (unsigned j = 0; j < K; ++j, bin /= bins_)
          middles[i * K + j] = extent.low[j] + (static_cast<double>(bin % bins_) + 0.5) *
                                                   (scale_[j] == 0 ? 0 : 1 / scale_[j]);
      }
      answer(*this, middles, n, false, 1, answers);
      for (std::size_t i = 0; i < n; ++i) grid_[first + i] = answers[i].place;
    }
  }

  std::vector<MappedCell<K>> cells_;
  std::vector<std::uint32_t> grid_;  ///< bins_^K places
  std::size_t bins_ = 1;
  double low_[K], scale_[K];
};

}  // namespace cullhull::internal
