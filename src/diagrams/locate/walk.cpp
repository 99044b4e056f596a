#include "diagrams/locate/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagrams/locate/power_sign.hpp"
#include "exact/determinants/minors.hpp"

namespace cullhull::internal {

Sign NearestVertex::compare(const double* q, std::uint32_t a, std::uint32_t b) const {
  const Sign sign =
      power_sign(mesh_.dimension, mesh_.stride > mesh_.dimension, q, mesh_.row(a), mesh_.row(b));
  return mesh_.furthest ? -sign : sign;
}

NearestVertex::Power NearestVertex::power(const double* q, std::uint32_t row) const {
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
bool NearestVertex::descend(const double* q, std::uint32_t& row) const {
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

std::uint32_t NearestVertex::find(const double* q, std::uint32_t key) {
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

std::uint32_t NearestVertex::lowest_of_equal(const double* q, std::uint32_t row) {
  std::uint32_t best = mesh_.ids[row];
  flood_.run(row, [&](std::uint32_t v, const auto& add) {
    best = std::min(best, mesh_.ids[v]);
    for (const std::uint32_t next : graph_[v])
      if (!flood_.reached(next) && compare(q, next, row) == Sign::zero) add(next);
  });
  return best;
}

}  // namespace cullhull::internal
