// Walks in a triangulation: to the cell that contains a point, and to the nearest vertex.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <vector>

#include "diagrams/dual.hpp"
#include "diagrams/locate/power_sign.hpp"
#include "diagrams/locate/walk_mesh.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/orientation/column_filter.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// The exact sign of the orientation of k + 1 points: by the filter of column_filter.hpp, or by
/// orientation() if the filter does not decide, as after an overflow. K: k if it is a compile-time
/// constant, otherwise 0.
template <unsigned K>
inline Sign cell_orientation(unsigned k, const double* const* p) {
  // Underflows add up to less than this; coordinates are not limited.
  constexpr double tiny = K == 2 ? 0x1p-1000 : 0x1p-340;
  Sign sign = Sign::zero;
  if constexpr (K != 0)
    if (filtered_by_columns<K, false>(p, tiny, sign)) return sign;
  return orientation(k, p);
}

/// Visits the items connected to a start; for sets that are small compared with the mesh.
class Flood {
 public:
  /// Calls visit(item, add) once for each item reached; visit calls add(next) to reach another
  /// item.
  template <class Visit>
  void run(std::uint32_t start, const Visit& visit) {
    reached_.clear();
    reached_.insert(start);
    todo_.assign(1, start);
    while (!todo_.empty()) {
      const std::uint32_t item = todo_.back();
      todo_.pop_back();
      visit(item, [&](std::uint32_t next) {
        if (reached_.insert(next).second) todo_.push_back(next);
      });
    }
  }

  bool reached(std::uint32_t item) const { return reached_.contains(item); }

 private:
  std::unordered_set<std::uint32_t> reached_;
  std::vector<std::uint32_t> todo_;
};

/// Visibility walks of one thread. Each starts where the last one ended, or at a vertex that is
/// near on the curve.
template <unsigned K>
class Walk {
 public:
  explicit Walk(const WalkMesh& mesh) : mesh_(mesh), probe_(mesh.corners) {}

  /// The place of the cell that contains q, of several that with the lowest number; no_index if
  /// there is none. `q`: in the mesh's columns; `key`: its curve key. Requires k >= 1.
  std::uint32_t find(const double* q, std::uint32_t key) {
    const std::uint32_t row = mesh_.row_at(key, key >= key_ ? row_ : 0);
    const bool from_last =
        cell_ != no_index && distance(key, key_) <= distance(key, mesh_.keys[row]);
    row_ = row;
    key_ = key;
    return find_from(from_last ? cell_ : mesh_.lowest_cell[row], q);
  }
  /// The same from this cell.
  std::uint32_t find_from(std::uint32_t place, const double* q) {
    cell_ = place;
    return walk(q) ? lowest() : no_index;
  }
  /// Where the last walk ended.
  std::uint32_t place() const { return cell_; }

 private:
  static constexpr std::uint32_t nowhere = 0xfffffffe;
  static std::uint32_t distance(std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; }
  unsigned k() const { return K ? K : mesh_.corners - 1; }

  /// Sets cell_ to a cell that contains q, or to the cell where the walk left the hull (then
  /// false).
  bool walk(const double* q) {
    // In a triangulation as documented no cell is met twice.
    std::size_t left = mesh_.numbers.size();
    for (std::uint32_t from = nowhere;;) {
      if (left-- == 0) bad_neighbours();
      const std::uint32_t* v = mesh_.corners_of(cell_);
      const std::uint32_t* across = mesh_.neighbours_of(cell_);
      zeros_.clear();
      for (unsigned i = 0; i <= k(); ++i) probe_[i] = mesh_.row(v[i]);
      unsigned j = 0;
      for (; j <= k(); ++j) {
        if (across[j] == from) continue;
        const double* const corner = probe_[j];
        probe_[j] = q;
        const Sign sign = cell_orientation<K>(k(), probe_.data());
        probe_[j] = corner;
        if (sign == Sign::negative) break;
        if (sign == Sign::zero) zeros_.push_back(j);
      }
      if (j > k()) return true;
      if (across[j] == no_index) return false;
      from = cell_;
      cell_ = across[j];
    }
  }

  /// The cell of lowest number around the face that contains q, whose corners are those of cell_
  /// not in zeros_.
  std::uint32_t lowest() {
    if (zeros_.empty()) return cell_;
    const std::uint32_t* v = mesh_.corners_of(cell_);
    if (zeros_.size() == 1) return lower(cell_, mesh_.neighbours_of(cell_)[zeros_[0]]);
    face_.assign(v, v + k() + 1);
    for (const unsigned j : zeros_) face_[j] = nowhere;
    std::erase(face_, nowhere);
    if (face_.size() == 1) return mesh_.lowest_cell[face_[0]];
    return lowest_around();
  }
  std::uint32_t lower(std::uint32_t a, std::uint32_t b) const {
    return b == no_index || mesh_.numbers[a] < mesh_.numbers[b] ? a : b;
  }
  std::uint32_t lowest_around() {
    std::uint32_t best = cell_;
    flood_.run(cell_, [&](std::uint32_t c, const auto& add) {
      best = lower(best, c);
      for (unsigned j = 0; j <= k(); ++j) {
        const std::uint32_t next = mesh_.neighbours_of(c)[j], v = mesh_.corners_of(c)[j];
        if (next != no_index && std::find(face_.begin(), face_.end(), v) == face_.end()) add(next);
      }
    });
    return best;
  }

  const WalkMesh& mesh_;
  std::vector<const double*> probe_;
  std::uint32_t cell_ = no_index, row_ = 0, key_ = 0;
  std::vector<unsigned> zeros_;
  std::vector<std::uint32_t> face_;
  Flood flood_;
};

/// Walks of one thread to the nearest vertex. The lifted vertices are those of a convex surface,
/// and the power distance to q is the height over that surface minus a linear function. So a vertex
/// with no nearer neighbour is a nearest vertex, and all nearest vertices are connected.
class NearestVertex {
 public:
  /// `graph`: for each row of the mesh its neighbours, neighbour_rows(mesh). Both must outlive
  /// this.
  NearestVertex(const WalkMesh& mesh, const Adjacency<std::uint32_t>& graph)
      : mesh_(mesh), graph_(graph) {}

  /// The id of the nearest vertex; of several, the lowest. `key`: q's curve key.
  std::uint32_t find(const double* q, std::uint32_t key) {
    std::uint32_t row = mesh_.row_at(key, key >= key_ ? near_ : 0);
    near_ = row;
    key_ = key;
    if (row_ != no_index && power(q, row_).value < power(q, row).value) row = row_;
    const bool done = descend(q, row);
    bool tied = false;
    for (bool moved = !done; moved;) {
      moved = false;
      tied = false;
      for (const std::uint32_t next : graph_[row]) {
        const Sign sign = compare(q, next, row);
        tied = tied || sign == Sign::zero;
        if (sign != Sign::negative) continue;
        row = next;
        moved = true;
        break;
      }
    }
    row_ = row;
    return tied ? lowest_of_equal(q, row) : mesh_.ids[row];
  }

 private:
  /// The computed power distance of a row, and a bound on its error. Negated for the furthest site.
  struct Power {
    double value, doubt;
  };
  Power power(const double* q, std::uint32_t row) const {
    const unsigned d = mesh_.dimension;
    const double* a = mesh_.row(row);
    double square = 0;
    for (unsigned j = 0; j < d; ++j) square += (a[j] - q[j]) * (a[j] - q[j]);
    const double weight = mesh_.stride > d ? a[d] : 0;
    return {mesh_.furthest ? weight - square : square - weight,
            (d + 8) * unit_roundoff * (square + std::abs(weight)) + 0x1p-1000};
  }
  /// Moves to the nearest neighbour as long as doubles decide which it is. Returns whether doubles
  /// prove that `row` is the nearest vertex.
  bool descend(const double* q, std::uint32_t& row) const {
    for (Power best = power(q, row);;) {
      Power nearest{std::numeric_limits<double>::infinity(), 0};
      std::uint32_t to = row;
      double doubt = 0;
      for (const std::uint32_t next : graph_[row]) {
        const Power other = power(q, next);
        const bool nearer = other.value < nearest.value;
        nearest.value = nearer ? other.value : nearest.value;
        to = nearer ? next : to;
        doubt = std::max(doubt, other.doubt);
      }
      doubt += best.doubt;
      if (!(nearest.value < best.value - doubt)) return nearest.value > best.value + doubt;
      row = to;
      best = power(q, to);
    }
  }
  /// Negative if a is nearer to q than b is; for the furthest site, if it is farther.
  Sign compare(const double* q, std::uint32_t a, std::uint32_t b) const {
    const Sign sign =
        power_sign(mesh_.dimension, mesh_.stride > mesh_.dimension, q, mesh_.row(a), mesh_.row(b));
    return mesh_.furthest ? -sign : sign;
  }
  std::uint32_t lowest_of_equal(const double* q, std::uint32_t row) {
    std::uint32_t best = mesh_.ids[row];
    flood_.run(row, [&](std::uint32_t v, const auto& add) {
      best = std::min(best, mesh_.ids[v]);
      for (const std::uint32_t next : graph_[v])
        if (!flood_.reached(next) && compare(q, next, row) == Sign::zero) add(next);
    });
    return best;
  }

  const WalkMesh& mesh_;
  const Adjacency<std::uint32_t>& graph_;
  std::uint32_t row_ = no_index, near_ = 0, key_ = 0;
  Flood flood_;
};

}  // namespace cullhull::internal
