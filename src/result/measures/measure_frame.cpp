#include "result/measures/measure_frame.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "cullhull/error.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"
#include "result/facets/orthogonal_parts.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t gather_chunk = std::uint64_t{1} << 11;  // ten us of work

/// Chooses k + 1 vertices that span the flat. `exactly` false: greedily the vertex farthest from
/// the span of those chosen, computed in doubles; rounding may make the result affinely dependent.
/// `exactly` true: each vertex, in order, that raises the exact rank.
std::vector<std::uint32_t> spanning_vertices(const Frame& frame, bool exactly) {
  const auto count = static_cast<std::uint32_t>(frame.scaled.size() / frame.dimension);
  const unsigned d = frame.dimension;
  std::vector<std::uint32_t> chosen{0};
  if (exactly) {
    std::vector<const double*> rows{frame.raw_at(0)};
    for (std::uint32_t v = 1; v < count && chosen.size() <= frame.k; ++v) {
      rows.push_back(frame.raw_at(v));
      if (affine_rank_exact(d, rows.data(), static_cast<unsigned>(rows.size())) + 1 == rows.size())
        chosen.push_back(v);
      else
        rows.pop_back();
    }
    return chosen;
  }
  std::vector<double> rest(frame.scaled.size());
  for (std::uint32_t v = 0; v < count; ++v)
    for (unsigned c = 0; c < d; ++c) rest[std::size_t{v} * d + c] = frame.at(v)[c] - frame.at(0)[c];
  while (chosen.size() <= frame.k) {
    std::uint32_t best = 0;
    double longest = 0;
    for (std::uint32_t v = 0; v < count; ++v) {
      double norm = 0;
      for (unsigned c = 0; c < d; ++c)
        norm += rest[std::size_t{v} * d + c] * rest[std::size_t{v} * d + c];
      if (norm > longest) {
        longest = norm;
        best = v;
      }
    }
    chosen.push_back(best);
    const std::vector<double> q(rest.begin() + std::size_t{best} * d,
                                rest.begin() + (std::size_t{best} + 1) * d);
    for (std::uint32_t v = 0; v < count && longest > 0; ++v) {
      double* r = rest.data() + std::size_t{v} * d;
      double dot = 0;
      for (unsigned c = 0; c < d; ++c) dot += r[c] * q[c];
      for (unsigned c = 0; c < d; ++c) r[c] -= dot / longest * q[c];
    }
  }
  return chosen;
}

/// The spanning vertices' coordinates on k axes.
std::vector<double> project(const Frame& frame, const std::vector<unsigned>& axes) {
  std::vector<double> rows;
  for (const std::uint32_t v : frame.spanning)
    for (const unsigned a : axes) rows.push_back(frame.raw_at(v)[a]);
  return rows;
}

/// Replaces frame.axes by axes onto which the flat projects with little shrinking: the pivots of an
/// elimination of its orthonormal basis. Orientations in the projection stay the same.
void choose_axes(Frame& frame) {
  const unsigned d = frame.dimension, k = frame.k;
  std::vector<double> m = frame.basis;
  std::vector<unsigned> axes;
  for (unsigned r = 0; r < k; ++r) {
    unsigned row = r, column = 0;
    for (unsigned i = r; i < k; ++i)
      for (unsigned c = 0; c < d; ++c)
        if (std::fabs(m[i * d + c]) > std::fabs(m[row * d + column])) row = i, column = c;
    if (m[row * d + column] == 0)
      throw Error(ErrorCode::internal, "the hull's vertices do not span its flat");
    for (unsigned c = 0; c < d; ++c) std::swap(m[row * d + c], m[r * d + c]);
    axes.push_back(column);
    for (unsigned i = r + 1; i < k; ++i) {
      const double factor = m[i * d + column] / m[r * d + column];
      for (unsigned c = 0; c < d; ++c) m[i * d + c] -= factor * m[r * d + c];
      m[i * d + column] = 0;
    }
  }
  std::sort(axes.begin(), axes.end());
  const auto sign = [&](const std::vector<unsigned>& on) {
    const std::vector<double> packed = project(frame, on);
    std::vector<const double*> rows;
    for (unsigned i = 0; i <= k; ++i) rows.push_back(packed.data() + std::size_t{i} * k);
    return orientation_exact(k, rows.data());
  };
  const Sign kept = sign(axes);
  if (kept == Sign::zero) return;  // degenerate on the new axes: keep the given ones
  if (kept != sign(frame.axes)) std::swap(axes[0], axes[1]);
  frame.axes = axes;
}

/// Fills the frame's data of a flat hull: spanning vertices, basis, axes and stretch.
void span_flat(Frame& frame) {
  const unsigned d = frame.dimension, k = frame.k;
  const auto span = [&](bool exactly) {
    frame.spanning = spanning_vertices(frame, exactly);
    std::vector<const double*> rows;
    for (const std::uint32_t v : frame.spanning) rows.push_back(frame.raw_at(v));
    return affine_rank_exact(d, rows.data(), k + 1) == k;
  };
  if (!span(false) && !span(true))
    throw Error(ErrorCode::internal, "the hull's vertices do not span its flat");
  std::vector<const double*> corners;
  for (const std::uint32_t v : frame.spanning) corners.push_back(frame.raw_at(v));
  const ExactOrthogonalParts rests(d, corners.data(), k);
  for (unsigned i = 0; i < k; ++i)
    for (const RoundedFloat& w : rests.direction(i)) frame.basis.push_back(w.to_double());
  if (k > 1) choose_axes(frame);
  const std::vector<double> projected = project(frame, frame.axes);
  for (unsigned i = 0; i <= k; ++i) corners[i] = projected.data() + std::size_t{i} * k;
  const ExactOrthogonalParts in_axes(k, corners.data(), k);
  const RoundedFloat shadow = in_axes.measure<RoundedFloat>(k);
  if (shadow.zero()) throw Error(ErrorCode::internal, "the flat does not project onto its axes");
  frame.stretch = ExactFloat(rests.measure<RoundedFloat>(k) / shadow);
}

struct Range {
  double low, high;
};

/// Copies the coordinate rows of vertices [begin, end) to `out` and writes the range of each
/// coordinate to ranges[0 .. d). D: the dimension d, or 0 if it is unknown at compile time.
template <unsigned D, class T>
void gather_in(const PointView& points, const std::vector<std::uint64_t>& ids, std::uint64_t begin,
               std::uint64_t end, double* out, Range* ranges) {
  const unsigned d = D ? D : points.dimension;
  Range few[D ? D : 1];
  Range* const seen = D ? few : ranges;
  std::fill_n(
      seen, d,
      Range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::byte* p = points.address(ids[i], 0);
    for (unsigned c = 0; c < d; ++c) {
      T v;
      std::memcpy(&v, p + static_cast<std::ptrdiff_t>(c) * points.coordinate_stride, sizeof v);
      const auto x = static_cast<double>(v);
      *out++ = x;
      seen[c].low = std::min(seen[c].low, x);
      seen[c].high = std::max(seen[c].high, x);
    }
  }
  if (D) std::copy_n(seen, d, ranges);
}

template <class T>
void gather(const PointView& points, const std::vector<std::uint64_t>& ids, std::uint64_t begin,
            std::uint64_t end, double* out, Range* ranges) {
  if (points.dimension == 3) return gather_in<3, T>(points, ids, begin, end, out, ranges);
  gather_in<0, T>(points, ids, begin, end, out, ranges);
}

void gather(const PointView& points, const std::vector<std::uint64_t>& ids, std::uint64_t begin,
            std::uint64_t end, double* out, Range* ranges) {
  with_scalar(points.scalar,
              [&](auto scalar) { gather<decltype(scalar)>(points, ids, begin, end, out, ranges); });
}

/// Fills f.scaled and f.exponent. Returns the unscaled range of each coordinate.
std::vector<Range> gather_scaled(Frame& f, const Run& run) {
  const std::vector<std::uint64_t>& ids = *f.vertices;
  const unsigned d = f.dimension;
  f.scaled.resize(ids.size() * d);
  std::vector<Range> parts(chunk_count(ids.size(), gather_chunk) * d);
  run.each_chunk(ids.size(), gather_chunk,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    gather(*f.points, ids, begin, end, f.scaled.data() + begin * d, parts.data() + chunk * d);
  });
  std::vector<Range> ranges(parts.begin(), parts.begin() + d);
  double largest = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Range& r = ranges[i % d];
    r = {std::min(r.low, parts[i].low), std::max(r.high, parts[i].high)};
    largest = std::max({largest, std::fabs(r.low), std::fabs(r.high)});
  }
  if (largest > 0) f.exponent = std::ilogb(largest) + 1;
  if (f.exponent != 0)
    run.each(f.scaled.size(), gather_chunk * 4, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) f.scaled[i] = scale_by(f.scaled[i], -f.exponent);
    });
  return ranges;
}

}  // namespace

const double* Frame::raw_at(std::uint32_t v) const {
  raw_->gathered.call([&] {
    raw_->rows.resize(scaled.size());
    std::vector<Range> ranges(dimension);
    gather(*points, *vertices, 0, vertices->size(), raw_->rows.data(), ranges.data());
  });
  return raw_->rows.data() + std::size_t{v} * dimension;
}

Frame make_unscaled_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                          unsigned k) {
  Frame f;
  f.dimension = points.dimension;
  f.k = k;
  f.points = &points;
  f.vertices = &vertices;
  f.scaled.resize(vertices.size() * points.dimension);  // raw_at() has as many numbers
  return f;
}

Frame make_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                 const unsigned* axes, unsigned k, const Run& run) {
  Frame f;
  f.dimension = points.dimension;
  f.k = k;
  f.axes.assign(axes, axes + k);
  f.points = &points;
  f.vertices = &vertices;
  const std::vector<Range> ranges = gather_scaled(f, run);
  const auto extent = [&](unsigned c) {
    return scale_by(ranges[c].high, -f.exponent) - scale_by(ranges[c].low, -f.exponent);
  };
  if (f.flat()) span_flat(f);
  // The product of k extents must not come near underflow.
  double narrowest = 1;
  for (const unsigned a : f.axes) narrowest = std::min(narrowest, extent(a));
  // In a flat, neither must the extents of the other coordinates, which the centroid needs.
  bool lost = false;
  for (unsigned c = 0; c < f.dimension; ++c)
    lost = lost || (ranges[c].low != ranges[c].high && !(extent(c) > 0x1p-400));
  f.wild = lost || !(narrowest > std::exp2(-400.0 / k)) ||
           !(f.stretch > 0 && ExactFloat(0x1p8) > f.stretch);
  return f;
}

}  // namespace cullhull::internal
