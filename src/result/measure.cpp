#include "result/measure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "parallel/parallel.hpp"
#include "predicates/orientation.hpp"
#include "result/cofactors.hpp"
#include "result/double_double.hpp"
#include "result/wide_float.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t measure_chunk = std::uint64_t{1} << 13;
template <class Real>
Real difference(double a, double b) {
  if constexpr (std::is_same_v<Real, double>) return a - b;
  if constexpr (std::is_same_v<Real, DoubleDouble>) return DoubleDouble::sum(a, -b);
  if constexpr (std::is_same_v<Real, Wide>) return Wide(a) - Wide(b);
}
double value(double v) { return v; }
double value(const DoubleDouble& v) { return v.value(); }
double value(const Wide& v) { return v.to_double(); }
bool is_zero(double v) { return v == 0; }
bool is_zero(const DoubleDouble& v) { return v.high == 0; }
bool is_zero(const Wide& v) { return v.zero(); }
double magnitude(double v) { return std::fabs(v); }
double magnitude(const DoubleDouble& v) { return std::fabs(v.high); }
Wide magnitude(const Wide& v) { return v.magnitude(); }

/// v * 2^e; a multiplication where 2^e is a normal double.
double scale_by(double v, int e) {
  return e > -1022 && e < 1023
             ? v * std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52)
             : std::ldexp(v, e);
}

/// The hull's vertices, in units that keep products within the doubles' range, and the map from
/// the coordinate axes of the projection to the flat.
struct Frame {
  unsigned dimension = 0, k = 0;
  const unsigned* axes = nullptr;
  std::vector<double> raw, scaled;  // vertices x dimension; scaled = raw 2^-exponent
  int exponent = 0;
  bool wild = false;  // spans too many powers of two for scaled doubles
  /// Flat hulls: k orthonormal rows that span the flat, and its measure over its projection's.
  std::vector<Wide> basis;
  std::vector<double> rounded_basis;
  Wide stretch = 1;

  bool flat() const { return k < dimension; }
  const double* at(std::uint32_t v) const { return scaled.data() + std::size_t{v} * dimension; }
  const double* raw_at(std::uint32_t v) const { return raw.data() + std::size_t{v} * dimension; }
};

/// k + 1 affinely independent vertices: greedily the farthest from the span so far, in doubles;
/// where rounding spoils that, the first that raise the exact rank.
std::vector<std::uint32_t> spanning_vertices(const Frame& frame, bool exactly) {
  const auto count = static_cast<std::uint32_t>(frame.raw.size() / frame.dimension);
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

/// |Determinant| of an n x n matrix, by elimination.
Wide wide_determinant(std::vector<Wide> m, unsigned n) {
  Wide det = 1;
  for (unsigned c = 0; c < n; ++c) {
    unsigned pivot = c;
    for (unsigned i = c + 1; i < n; ++i)
      if (m[i * n + c].magnitude() > m[pivot * n + c].magnitude()) pivot = i;
    if (m[pivot * n + c].zero()) return 0;
    for (unsigned j = 0; j < n; ++j) std::swap(m[pivot * n + j], m[c * n + j]);
    det = det * m[c * n + c];
    for (unsigned i = c + 1; i < n; ++i) {
      const Wide factor = m[i * n + c] / m[c * n + c];
      for (unsigned j = c; j < n; ++j) m[i * n + j] = m[i * n + j] - factor * m[c * n + j];
    }
  }
  return det.magnitude();
}

/// Orthonormal rows that span the flat, and its stretch, by Gram-Schmidt in wide floats.
bool span_flat(Frame& frame, bool exactly) {
  const unsigned d = frame.dimension, k = frame.k;
  const auto chosen = spanning_vertices(frame, exactly);
  std::vector<Wide> rows, projected;
  for (unsigned i = 1; i <= k; ++i) {
    for (unsigned c = 0; c < d; ++c)
      rows.push_back(difference<Wide>(frame.raw_at(chosen[i])[c], frame.raw_at(chosen[0])[c]));
    for (unsigned c = 0; c < k; ++c) projected.push_back(rows[(i - 1) * d + frame.axes[c]]);
  }
  const Wide det = wide_determinant(projected, k);
  if (det.zero()) return false;
  Wide measure = 1;
  for (unsigned i = 0; i < k; ++i) {
    Wide* row = rows.data() + std::size_t{i} * d;
    for (unsigned r = 0; r < i; ++r) {
      Wide dot;
      for (unsigned c = 0; c < d; ++c) dot = dot + row[c] * rows[r * d + c];
      for (unsigned c = 0; c < d; ++c) row[c] = row[c] - dot * rows[r * d + c];
    }
    Wide norm;
    for (unsigned c = 0; c < d; ++c) norm = norm + row[c] * row[c];
    norm = norm.root();
    measure = measure * norm;
    for (unsigned c = 0; c < d; ++c) row[c] = row[c] / norm;
  }
  frame.stretch = measure / det;
  frame.basis = rows;
  frame.rounded_basis.clear();
  for (const Wide& w : rows) frame.rounded_basis.push_back(w.to_double());
  return true;
}

Frame make_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                 const unsigned* axes, unsigned k, unsigned threads) {
  Frame f;
  f.dimension = points.dimension;
  f.k = k;
  f.axes = axes;
  const unsigned d = f.dimension;
  f.raw.resize(vertices.size() * d);
  for_each_chunk(vertices.size(), measure_chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i)
                     for (unsigned c = 0; c < d; ++c) f.raw[i * d + c] = points.at(vertices[i], c);
                 });
  double largest = 0;
  for (const double v : f.raw) largest = std::max(largest, std::fabs(v));
  if (largest > 0) f.exponent = std::ilogb(largest) + 1;
  f.scaled.resize(f.raw.size());
  for (std::size_t i = 0; i < f.raw.size(); ++i) f.scaled[i] = scale_by(f.raw[i], -f.exponent);
  // A product of k extents must stay far above the smallest double.
  double narrowest = 1;
  for (unsigned c = 0; c < k; ++c) {
    double low = f.scaled[axes[c]], high = low;
    for (std::size_t i = axes[c]; i < f.scaled.size(); i += d) {
      low = std::min(low, f.scaled[i]);
      high = std::max(high, f.scaled[i]);
    }
    narrowest = std::min(narrowest, high - low);
  }
  f.wild = !(narrowest > std::exp2(-400.0 / k));
  if (f.flat() && !span_flat(f, f.wild) && !span_flat(f, true))
    throw Error(ErrorCode::internal, "the hull's vertices do not span its flat");
  return f;
}

/// Normal of a simplex by elimination with complete pivoting, for k beyond `cofactors`.
template <class Real>
void eliminate_normal(std::vector<Real>& m, unsigned k, Real* normal) {
  std::vector<unsigned> column(k);
  for (unsigned c = 0; c < k; ++c) column[c] = c;
  bool odd = false;
  const auto at = [&](unsigned i, unsigned j) -> Real& {
    return m[std::size_t{i} * k + column[j]];
  };
  Real det = 1;
  for (unsigned r = 0; r + 1 < k; ++r) {
    unsigned bi = r, bj = r;
    for (unsigned i = r; i + 1 < k; ++i)
      for (unsigned j = r; j < k; ++j)
        if (magnitude(at(i, j)) > magnitude(at(bi, bj))) bi = i, bj = j;
    if (is_zero(at(bi, bj))) {
      for (unsigned c = 0; c < k; ++c) normal[c] = 0;
      return;
    }
    if (bi != r) {
      for (unsigned j = 0; j < k; ++j)
        std::swap(m[bi * std::size_t{k} + j], m[r * std::size_t{k} + j]);
      odd = !odd;
    }
    if (bj != r) {
      std::swap(column[bj], column[r]);
      odd = !odd;
    }
    det = det * at(r, r);
    for (unsigned i = r + 1; i + 1 < k; ++i) {
      const Real factor = at(i, r) / at(r, r);
      for (unsigned j = r; j < k; ++j) at(i, j) = at(i, j) - factor * at(r, j);
    }
  }
  // normal . x = det [rows; x]: the free column is last in pivot order, its cofactor is det.
  normal[column[k - 1]] = det;
  if (odd) normal[column[k - 1]] = -det;
  for (unsigned r = k - 1; r-- > 0;) {
    Real sum = 0;
    for (unsigned j = r + 1; j < k; ++j) sum = sum + at(r, j) * normal[column[j]];
    normal[column[r]] = -(sum / at(r, r));
  }
}

/// Cofactor normal (outward) of the simplex with vertices v[0..k), in the frame's axes. Returns the
/// product of its edges' lengths from v[0], which the normal's length cannot exceed.
template <unsigned K, class Real>
double simplex_normal(const Frame& frame, const std::uint32_t* v, Real* normal,
                      std::vector<Real>& scratch) {
  const unsigned k = K ? K : frame.k;
  const double* origin = frame.at(v[0]);
  const double* raw_origin = frame.raw_at(v[0]);
  double lengths = 1;
  const auto fill = [&](unsigned i, Real* row) {
    const double* p = frame.at(v[i]);
    double square = 0;
    for (unsigned c = 0; c < k; ++c) {
      const unsigned a = frame.axes[c];
      if constexpr (std::is_same_v<Real, Wide>) {
        row[c] = difference<Wide>(frame.raw_at(v[i])[a], raw_origin[a]);
      } else {
        row[c] = difference<Real>(p[a], origin[a]);
        square += value(row[c]) * value(row[c]);
      }
    }
    lengths *= std::sqrt(square);
  };
  if constexpr (K != 0) {
    Real edges[K > 1 ? K - 1 : 1][K];
    for (unsigned i = 1; i < K; ++i) fill(i, edges[i - 1]);
    Real out[K];
    cofactors<K, Real>(edges, out);
    for (unsigned c = 0; c < K; ++c) normal[c] = out[c];
  } else {
    scratch.resize(std::size_t{k - 1} * k);
    for (unsigned i = 1; i < k; ++i) fill(i, scratch.data() + std::size_t{i - 1} * k);
    eliminate_normal(scratch, k, normal);
  }
  return lengths;
}

double length(const double* v, unsigned n) {
  double square = 0;
  for (unsigned c = 0; c < n; ++c) square += v[c] * v[c];
  return std::sqrt(square);
}

/// Sums over a run of simplices. `error` bounds, up to a modest constant, what rounding may have
/// done to `volume`.
template <class Sum>
struct Totals {
  Sum volume = 0, area = 0;
  std::vector<Sum> moment;
  double error = 0;
  explicit Totals(unsigned d) : moment(d, Sum(0)) {}
  void add(const Totals& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (std::size_t c = 0; c < moment.size(); ++c) moment[c] = moment[c] + o.moment[c];
    error += o.error;
  }
};

/// A normal shorter than this share of its edges' product is computed again with more bits, so its
/// direction is good to about 2^-38 of a right angle at worst, and usually far better.
constexpr double conditioned = 0x1p-12;

template <unsigned K>
class Measurer {
 public:
  Measurer(const Frame& frame, const std::vector<std::uint32_t>& index, unsigned threads,
           const Control& control, Hull& hull)
      : frame_(frame),
        index_(index),
        threads_(threads),
        control_(control),
        hull_(hull),
        k_(K ? K : frame.k),
        count_(index.size() / k_) {}

  void run() {
    // The usual case: every facet is one simplex, whose plane and share of the sums need the same
    // normal. Reading the corners is what costs here.
    fused_ = !frame_.wild && hull_.facet_count() == count_;
    hull_.facet_planes.resize(hull_.facet_count() * (std::size_t{frame_.dimension} + 1));
    sum();
    if (!fused_) planes();
  }

 private:
  void sum() {
    const double tolerance = 0x1p-42;
    if (!frame_.wild) {
      Totals<DoubleDouble> t = totals<double, DoubleDouble>();
      if (!(t.error * 0x1p-53 <= tolerance * t.volume.value())) {
        t = totals<DoubleDouble, DoubleDouble>();
        if (!(t.error * 0x1p-102 <= tolerance * t.volume.value())) return run_wide();
      }
      finish(t, frame_.exponent);
    } else {
      run_wide();
    }
  }

  void planes() {
    const unsigned d = frame_.dimension;
    const std::vector<std::uint32_t> best = widest_simplices();
    for_each_chunk(hull_.facet_count(), measure_chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     for (std::uint64_t i = begin; i < end; ++i)
                       plane(best.empty() ? i : best[i],
                             hull_.facet_planes.data() + i * (std::size_t{d} + 1));
                   });
  }

  static constexpr std::uint64_t ahead = 12;
  /// Corners lie anywhere in memory where ids do: ask for them early.
  void prefetch(std::uint64_t i) const {
    if (i >= count_) return;
    for (unsigned j = 0; j < k_; ++j) __builtin_prefetch(frame_.at(simplex(i)[j]));
  }

  void run_wide() { finish(totals<Wide, Wide>(), 0); }

  const std::uint32_t* simplex(std::uint64_t i) const { return index_.data() + i * k_; }

  /// Normal in doubles; where badly conditioned, by way of double-doubles. Returns its length, and
  /// in `reliable` whether that was enough.
  double normal(std::uint64_t i, double* n, std::vector<double>& scratch, bool* reliable) const {
    const double lengths = simplex_normal<K, double>(frame_, simplex(i), n, scratch);
    double l = length(n, k_);
    *reliable = true;
    if (l > conditioned * lengths) return l;
    std::vector<DoubleDouble> wide(k_), wide_scratch;
    simplex_normal<K, DoubleDouble>(frame_, simplex(i), wide.data(), wide_scratch);
    for (unsigned c = 0; c < k_; ++c) n[c] = wide[c].value();
    l = length(n, k_);
    *reliable = l > 0x1p-52 * lengths && l > 0x1p-450;  // far from underflow of its square
    return l;
  }

  template <class Real, class Sum>
  Totals<Sum> totals() const {
    const unsigned d = frame_.dimension;
    std::vector<Totals<Sum>> parts(chunk_count(count_, measure_chunk), Totals<Sum>(d));
    for_each_chunk(count_, measure_chunk, threads_,
                   [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     // Short runs in plain arithmetic, then into the wider sum.
                     constexpr std::uint64_t run_length = 32;
                     for (std::uint64_t b = begin; b < end; b += run_length)
                       add_run<Real>(b, std::min(b + run_length, end), parts[chunk]);
                   });
    Totals<Sum> all(d);
    for (const auto& p : parts) all.add(p);
    return all;
  }

  template <class Real, class Sum>
  void add_run(std::uint64_t begin, std::uint64_t end, Totals<Sum>& out) const {
    const unsigned d = frame_.dimension;
    constexpr bool wide = std::is_same_v<Real, Wide>;
    const double* o = wide ? frame_.raw_at(0) : frame_.at(0);
    constexpr unsigned fixed = K ? K : 1;
    Real few[fixed];
    std::vector<Real> many(K ? 0 : k_), scratch;
    Real* n = K ? few : many.data();
    Real volume = 0, area = 0;
    Real moment_few[fixed];
    std::vector<Real> moment_many(d == K ? 0 : d, Real(0));
    Real* moment = d == K ? moment_few : moment_many.data();
    for (unsigned c = 0; c < d; ++c) moment[c] = 0;
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint32_t* v = simplex(i);
      prefetch(i + ahead);
      bool reliable = true;
      double size = 0;
      if constexpr (std::is_same_v<Real, double>) {
        size = normal(i, n, scratch, &reliable);
      } else {
        simplex_normal<K, Real>(frame_, v, n, scratch);
        for (unsigned c = 0; c < k_; ++c) size += std::fabs(value(n[c]));
      }
      const double* p = wide ? frame_.raw_at(v[0]) : frame_.at(v[0]);
      Real height = 0;
      double reach = 0;
      for (unsigned c = 0; c < k_; ++c) {
        const Real step = difference<Real>(p[frame_.axes[c]], o[frame_.axes[c]]);
        height = height + n[c] * step;
        if constexpr (!wide) reach = std::max(reach, std::fabs(value(step)));
      }
      volume = volume + height;
      out.error += size * reach;
      area = area + lifted_length(n, size);
      for (unsigned c = 0; c < d; ++c) {
        Real sum = 0;
        for (unsigned j = 0; j < k_; ++j) {
          const double* q = wide ? frame_.raw_at(v[j]) : frame_.at(v[j]);
          sum = sum + difference<Real>(q[c], o[c]);
        }
        moment[c] = moment[c] + height * sum;
      }
      if constexpr (std::is_same_v<Real, double>)
        if (fused_)
          write_plane(i, n, reliable, hull_.facet_planes.data() + i * (d + std::uint64_t{1}));
    }
    out.volume = out.volume + Sum(volume);
    out.area = out.area + Sum(area);
    for (unsigned c = 0; c < d; ++c) out.moment[c] = out.moment[c] + Sum(moment[c]);
  }

  /// Length of a normal, seen as a functional on the flat.
  template <class Real>
  Real lifted_length(const Real* n, double size) const {
    if constexpr (std::is_same_v<Real, Wide>) {
      Wide square;
      if (!frame_.flat())
        for (unsigned c = 0; c < k_; ++c) square = square + n[c] * n[c];
      for (unsigned r = 0; frame_.flat() && r < k_; ++r) {
        Wide t;
        for (unsigned c = 0; c < k_; ++c)
          t = t + frame_.basis[std::size_t{r} * frame_.dimension + frame_.axes[c]] * n[c];
        square = square + t * t;
      }
      return square.root();
    } else {
      double square = 0;
      if (!frame_.flat() && std::is_same_v<Real, double>) return size;
      if (!frame_.flat())
        for (unsigned c = 0; c < k_; ++c) square += value(n[c]) * value(n[c]);
      for (unsigned r = 0; frame_.flat() && r < k_; ++r) {
        double t = 0;
        for (unsigned c = 0; c < k_; ++c)
          t += frame_.rounded_basis[std::size_t{r} * frame_.dimension + frame_.axes[c]] *
               value(n[c]);
        square += t * t;
      }
      return std::sqrt(square);
    }
  }

  static Wide widened(const DoubleDouble& v) { return Wide(v.high) + Wide(v.low); }
  static Wide widened(const Wide& v) { return v; }

  /// Sums are in units of 2^exponent per coordinate.
  template <class Sum>
  void finish(const Totals<Sum>& t, int exponent) {
    Wide factorial = 1;
    for (unsigned i = 2; i < k_; ++i) factorial = factorial * Wide(i);
    const Wide volume = widened(t.volume);
    hull_.area =
        k_ == 1
            ? 2
            : (widened(t.area) * frame_.stretch / factorial).to_double(long{exponent} * (k_ - 1));
    hull_.volume =
        (volume * frame_.stretch / (factorial * Wide(k_))).to_double(long{exponent} * k_);
    for (unsigned c = 0; c < frame_.dimension; ++c) {
      Wide shift;
      if (!volume.zero()) shift = widened(t.moment[c]) / (volume * Wide(k_ + 1.0));
      const double origin = exponent == 0 ? frame_.raw_at(0)[c] : frame_.at(0)[c];
      hull_.centroid.push_back((Wide(origin) + shift).to_double(exponent));
    }
  }

  /// For each facet the simplex with the longest normal, the first of equals; empty where every
  /// facet is one simplex.
  std::vector<std::uint32_t> widest_simplices() const {
    std::vector<std::uint32_t> best;
    if (hull_.facet_count() == count_) return best;
    best.resize(hull_.facet_count());
    std::vector<double> longest(best.size(), -1);
    std::vector<double> n(k_), scratch;
    for (std::uint32_t i = 0; i < count_; ++i) {
      bool reliable = false;
      const double l = normal(i, n.data(), scratch, &reliable);
      const std::uint32_t f = hull_.simplex_facets[i];
      if (l > longest[f]) {
        longest[f] = l;
        best[f] = i;
      }
    }
    return best;
  }

  void plane(std::uint64_t i, double* out) const {
    double few[K ? K : 1];
    std::vector<double> many(K ? 0 : k_), scratch;
    double* n = K ? few : many.data();
    bool reliable = false;
    if (!frame_.wild) normal(i, n, scratch, &reliable);
    write_plane(i, n, reliable, out);
  }

  /// From the normal of simplex i, which is overwritten.
  void write_plane(std::uint64_t i, double* n, bool reliable, double* out) const {
    const unsigned d = frame_.dimension;
    if (!reliable) exact_normal(i, n);
    double largest = 0;
    for (unsigned c = 0; c < k_; ++c) largest = std::max(largest, std::fabs(n[c]));
    if (!(largest > 0x1p-400 && largest < 0x1p400)) {
      const int e = largest > 0 ? std::ilogb(largest) : 0;
      for (unsigned c = 0; c < k_; ++c) n[c] = std::ldexp(n[c], -e);
    }
    if (frame_.flat()) {
      std::fill(out, out + d, 0.0);
      for (unsigned r = 0; r < k_; ++r) {
        const double* row = frame_.rounded_basis.data() + std::size_t{r} * d;
        double t = 0;
        for (unsigned c = 0; c < k_; ++c) t += row[frame_.axes[c]] * n[c];
        for (unsigned c = 0; c < d; ++c) out[c] += t * row[c];
      }
    } else {
      std::copy(n, n + k_, out);
    }
    const double l = length(out, d);
    const double* p = frame_.at(simplex(i)[0]);
    double offset = 0;
    for (unsigned c = 0; c < d; ++c) {
      out[c] /= l;
      offset -= out[c] * p[c];
    }
    out[d] = scale_by(offset, frame_.exponent);
  }

  void exact_normal(std::uint64_t i, double* n) const {
    std::vector<double> packed;
    for (unsigned j = 0; j < k_; ++j)
      for (unsigned c = 0; c < k_; ++c)
        packed.push_back(frame_.raw_at(simplex(i)[j])[frame_.axes[c]]);
    std::vector<const double*> rows;
    for (unsigned j = 0; j < k_; ++j) rows.push_back(packed.data() + std::size_t{j} * k_);
    if (!plane_exact(k_, rows.data(), n))
      throw Error(ErrorCode::internal, "a simplex of the hull is degenerate");
  }

  const Frame& frame_;
  const std::vector<std::uint32_t>& index_;
  const unsigned threads_;
  const Control& control_;
  Hull& hull_;
  const unsigned k_;
  const std::uint64_t count_;
  bool fused_ = false;
};

template <unsigned K>
void measure_all(const Frame& frame, const std::vector<std::uint32_t>& index, unsigned threads,
                 const Control& control, Hull& hull) {
  Measurer<K> m(frame, index, threads, control, hull);
  m.run();
}

/// k = 1: the two simplices are the ends, which no orientation tells apart.
void measure_segment(const Frame& frame, const std::vector<std::uint32_t>& index, Hull& hull) {
  const unsigned d = frame.dimension;
  std::vector<Wide> step;
  Wide square;
  for (unsigned c = 0; c < d; ++c) {
    step.push_back(difference<Wide>(frame.raw_at(index[1])[c], frame.raw_at(index[0])[c]));
    square = square + step[c] * step[c];
  }
  const Wide norm = square.root();
  hull.volume = norm.to_double();
  hull.area = 2;
  for (unsigned end = 0; end < 2; ++end) {
    Wide offset;
    for (unsigned c = 0; c < d; ++c) {
      const Wide n = (end == 1 ? step[c] : -step[c]) / norm;
      offset = offset - n * Wide(frame.raw_at(index[end])[c]);
      hull.facet_planes.push_back(n.to_double());
    }
    hull.facet_planes.push_back(offset.to_double());
  }
  for (unsigned c = 0; c < d; ++c)
    hull.centroid.push_back((Wide(frame.raw_at(index[0])[c]) + step[c] / Wide(2)).to_double());
}

}  // namespace

void measure(const PointView& points, const std::vector<std::uint64_t>& vertices,
             const std::vector<std::uint32_t>& vertex_index, const unsigned* axes, unsigned threads,
             const Control& control, Hull& hull) {
  const auto k = static_cast<unsigned>(hull.affine_dimension);
  hull.facet_planes.clear();
  hull.centroid.clear();
  const Frame frame = make_frame(points, vertices, axes, k, threads);
  using Run =
      void (*)(const Frame&, const std::vector<std::uint32_t>&, unsigned, const Control&, Hull&);
  static constexpr Run runs[] = {measure_all<0>, measure_all<0>, measure_all<2>,
                                 measure_all<3>, measure_all<4>, measure_all<5>,
                                 measure_all<6>, measure_all<7>, measure_all<8>};
  if (k == 1)
    measure_segment(frame, vertex_index, hull);
  else
    runs[k <= 8 ? k : 0](frame, vertex_index, threads, control, hull);
}

}  // namespace cullhull::internal
