// Volume, area, centroid and planes, computed again another way: orthogonalised edges in extended
// precision. These are rounded numbers, so they are compared within a tolerance.
#include <algorithm>
#include <cmath>
#include <limits>

#include "result/certificate.hpp"

namespace cullhull::internal {
namespace {

using Long = long double;

/// Far above what either side rounds, far below any mistake worth the name.
constexpr double relative_tolerance = 1e-9;

/// The measure of a parallelotope, and the product of its edges' lengths, in units of which
/// rounding shows.
struct Measure {
  Long value = 1, size = 1;
};

/// Row m of a parallelotope in R^d joins the rows before it, which are orthonormal, by
/// Gram-Schmidt; the row is replaced.
void add_row(Long* rows, unsigned m, unsigned d, Measure& measure) {
  Long* row = rows + std::size_t{m} * d;
  const auto norm = [&] {
    Long square = 0;
    for (unsigned c = 0; c < d; ++c) square += row[c] * row[c];
    return std::sqrt(square);
  };
  measure.size *= norm();
  for (unsigned r = 0; r < m; ++r) {
    const Long* unit = rows + std::size_t{r} * d;
    Long dot = 0;
    for (unsigned c = 0; c < d; ++c) dot += row[c] * unit[c];
    for (unsigned c = 0; c < d; ++c) row[c] -= dot * unit[c];
  }
  const Long rest = norm();
  measure.value *= rest;
  if (rest > 0)
    for (unsigned c = 0; c < d; ++c) row[c] /= rest;
}

struct Sums {
  Long volume = 0, area = 0, volume_error = 0, area_error = 0;
  std::vector<Long> moment;
};

class Numbers {
 public:
  explicit Numbers(const Subject& s) : s_(s), h_(s.hull), d_(s.hull.dimension), k_(s.k) {}

  void run() {
    Sums t = sums();
    Long factorial = 1;
    for (unsigned i = 2; i < k_; ++i) factorial *= i;
    const Long volume = t.volume / (factorial * k_);
    compare("volume", h_.volume, volume, t.volume_error / (factorial * k_));
    compare("area", h_.area, k_ == 1 ? 2 : t.area / factorial, t.area_error / factorial);
    if (t.volume > 0) check_centroid(t);
    check_planes();
  }

 private:
  const double* at(std::uint32_t v) const { return s_.full.data() + std::size_t{v} * d_; }

  Sums sums() const {
    constexpr std::uint64_t chunk = std::uint64_t{1} << 12;
    std::vector<Sums> parts((s_.simplex_count() + chunk - 1) / chunk);
    check_chunks(s_, s_.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
      Sums& out = parts[begin / chunk];
      out.moment.assign(d_, 0);
      std::vector<Long> rows(std::size_t{k_} * d_);
      for (std::uint64_t i = begin; i < end; ++i) {
        s_.prefetch_corners(i);
        add(static_cast<std::uint32_t>(i), rows.data(), out);
      }
    });
    Sums all;
    all.moment.assign(d_, 0);
    for (const Sums& p : parts) {
      all.volume += p.volume;
      all.area += p.area;
      all.volume_error += p.volume_error;
      all.area_error += p.area_error;
      for (unsigned c = 0; c < d_; ++c) all.moment[c] += p.moment[c];
    }
    return all;
  }

  /// The simplex with the first vertex as apex: its base's edges, then the step to the apex.
  void add(std::uint32_t i, Long* rows, Sums& out) const {
    const std::uint32_t* v = s_.simplex(i);
    const double* base = at(v[0]);
    const double* origin = at(0);
    Measure measure;
    for (unsigned r = 0; r < k_; ++r) {
      const double* to = r + 1 < k_ ? at(v[r + 1]) : origin;
      if (r + 1 == k_) {
        out.area += measure.value;
        out.area_error += measure.size;
      }
      for (unsigned c = 0; c < d_; ++c) rows[std::size_t{r} * d_ + c] = Long{to[c]} - base[c];
      add_row(rows, r, d_, measure);
    }
    out.volume += measure.value;
    out.volume_error += measure.size;
    for (unsigned c = 0; c < d_; ++c) {
      Long sum = 0;
      for (unsigned j = 0; j < k_; ++j) sum += Long{at(v[j])[c]} - origin[c];
      out.moment[c] += measure.value * sum;
    }
  }

  /// `size`: what rounding is measured in; a very thin hull loses all digits here.
  void compare(const char* what, double given, Long expected, Long size) const {
    constexpr Long largest = std::numeric_limits<double>::max();
    const Long allowed = relative_tolerance * std::fabs(expected) +
                         64 * (k_ + 1) * std::numeric_limits<Long>::epsilon() * size +
                         std::numeric_limits<double>::min();
    if (given == std::numeric_limits<double>::infinity() && expected + allowed >= largest) return;
    if (!(std::fabs(given - expected) <= allowed))
      fault("the ", what, " ", std::to_string(given), " should be ",
            std::to_string(static_cast<double>(expected)));
  }

  void check_centroid(const Sums& t) const {
    for (unsigned c = 0; c < d_; ++c) {
      Long low = at(0)[c], high = low;
      for (std::uint32_t v = 0; v < s_.ids.size(); ++v) {
        low = std::min<Long>(low, at(v)[c]);
        high = std::max<Long>(high, at(v)[c]);
      }
      const Long expected = at(0)[c] + t.moment[c] / (t.volume * (k_ + 1));
      const Long blur =
          std::numeric_limits<Long>::epsilon() * 64 * (k_ + 1) * t.volume_error / t.volume;
      const Long allowed =
          (relative_tolerance + blur) * (high - low) +
          4 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(low), std::fabs(high)) +
          std::numeric_limits<double>::denorm_min();
      if (!(std::fabs(h_.centroid[c] - expected) <= allowed))
        fault("coordinate ", c, " of the centroid is wrong");
    }
  }

  /// Unit normals that vanish on their facet and leave the neighbours' corners beneath.
  void check_planes() const {
    Long extent = 0, largest = 0;
    for (unsigned c = 0; c < d_; ++c) {
      Long low = at(0)[c], high = low;
      for (std::uint32_t v = 0; v < s_.ids.size(); ++v) {
        low = std::min<Long>(low, at(v)[c]);
        high = std::max<Long>(high, at(v)[c]);
      }
      extent = std::max(extent, high - low);
      largest = std::max({largest, std::fabs(low), std::fabs(high)});
    }
    const Long allowed = relative_tolerance * extent +
                         8 * (d_ + 1) * std::numeric_limits<double>::epsilon() * largest +
                         std::numeric_limits<double>::min();
    check_chunks(s_, s_.simplex_count(), std::uint64_t{1} << 13,
                 [&](std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i) {
                     s_.prefetch(i);
                     check_plane(static_cast<std::uint32_t>(i), allowed);
                   }
                 });
  }

  void check_plane(std::uint32_t i, Long allowed) const {
    const std::uint32_t f = h_.simplex_facets[i];
    const double* plane = h_.facet_planes.data() + std::size_t{f} * (d_ + 1);
    Long square = 0;
    for (unsigned c = 0; c < d_; ++c) square += Long{plane[c]} * plane[c];
    if (!(std::fabs(square - 1) <= relative_tolerance))
      fault("the normal of facet ", f, " is not a unit vector");
    if (std::isinf(plane[d_])) return;  // beyond the doubles
    const auto value = [&](std::uint32_t v) {
      Long sum = plane[d_];
      for (unsigned c = 0; c < d_; ++c) sum += Long{plane[c]} * at(v)[c];
      return sum;
    };
    for (unsigned j = 0; j < k_; ++j) {
      if (!(std::fabs(value(s_.simplex(i)[j])) <= allowed))
        fault("the plane of facet ", f, " misses vertex ", s_.ids[s_.simplex(i)[j]]);
      // Of a neighbour's corners all but one are corners of this simplex.
      const std::uint32_t* g = s_.simplex(s_.neighbour(i, j));
      const std::uint32_t* v = s_.simplex(i);
      for (unsigned c = 0; c < k_; ++c)
        if (std::find(v, v + k_, g[c]) == v + k_ && !(value(g[c]) <= allowed))
          fault("the plane of facet ", f, " leaves vertex ", s_.ids[g[c]], " outside");
    }
    // Some corner of the basis is off the facet by more than rounding, unless the hull is thin.
    Long highest = 0;
    for (const std::uint32_t v : s_.basis) highest = std::max(highest, value(v));
    if (highest > allowed) fault("the plane of facet ", f, " faces inward");
  }

  const Subject& s_;
  const Hull& h_;
  const unsigned d_, k_;
};

}  // namespace

void check_numbers(const Subject& s) { Numbers(s).run(); }

}  // namespace cullhull::internal
