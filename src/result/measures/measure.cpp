#include "result/measures/measure.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "exact/planes/elimination.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/facets/orthogonal_parts.hpp"
#include "result/measures/simplex_measures.hpp"
#include "result/measures/simplex_normals.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {
namespace {

unsigned eliminate_completely(std::vector<double>& m, unsigned k, unsigned* row, unsigned* column,
                              bool& odd) {
  return eliminate(m.data(), k - 1, k, row, column, 0, std::numeric_limits<double>::infinity(),
                   odd);
}
/// The same in double-doubles, without L.
unsigned eliminate_completely(std::vector<DoubleDouble>& m, unsigned k, unsigned*, unsigned* column,
                              bool& odd) {
  const std::size_t stride = elimination_stride(k);
  const auto at = [&](unsigned i, unsigned j) -> DoubleDouble& { return m[i * stride + j]; };
  const auto magnitude = [&](unsigned i, unsigned j) { return std::fabs(at(i, j).high); };
  odd = false;
  for (unsigned c = 0; c < k; ++c) column[c] = c;
  for (unsigned r = 0; r + 1 < k; ++r) {
    unsigned bi = r, bj = r;
    for (unsigned i = r; i + 1 < k; ++i)
      for (unsigned j = r; j < k; ++j)
        if (magnitude(i, j) > magnitude(bi, bj)) bi = i, bj = j;
    if (at(bi, bj).high == 0) return r;
    if (bi != r) {
      for (unsigned j = 0; j < k; ++j) std::swap(at(bi, j), at(r, j));
      odd = !odd;
    }
    if (bj != r) {
      for (unsigned i = 0; i + 1 < k; ++i) std::swap(at(i, bj), at(i, r));
      std::swap(column[bj], column[r]);
      odd = !odd;
    }
    for (unsigned i = r + 1; i + 1 < k; ++i) {
      const DoubleDouble factor = at(i, r) / at(r, r);
      for (unsigned j = r + 1; j < k; ++j) at(i, j) = at(i, j) - factor * at(r, j);
    }
  }
  return k - 1;
}

}  // namespace

template <class Real>
void eliminate_normal(std::vector<Real>& m, unsigned k, Real* normal) {
  std::vector<unsigned> places(2 * std::size_t{k});
  unsigned* const column = places.data() + k;
  const std::size_t stride = elimination_stride(k);
  bool odd = false;
  if (eliminate_completely(m, k, places.data(), column, odd) + 1 < k) {
    std::fill_n(normal, k, Real(0));
    return;
  }
  Real det = 1;
  for (unsigned r = 0; r + 1 < k; ++r) det = det * m[r * stride + r];
  // The normal satisfies normal . x = det [rows; x] for every x. The column without a pivot comes
  // last in pivot order, and its cofactor is det.
  normal[column[k - 1]] = odd ? -det : det;
  for (unsigned r = k - 1; r-- > 0;) {
    const Real* const row = m.data() + r * stride;
    Real sum = 0;
    for (unsigned j = r + 1; j < k; ++j) sum = sum + row[j] * normal[column[j]];
    normal[column[r]] = -(sum / row[r]);
  }
}

template void eliminate_normal(std::vector<double>&, unsigned, double*);
template void eliminate_normal(std::vector<DoubleDouble>&, unsigned, DoubleDouble*);

namespace {

/// Computes the measures and planes of a hull. K: the dimension, or 0 if it is unknown at compile
/// time. The sums are computed in doubles, again in double-doubles if rounding could show, and
/// exactly if it still could.
template <unsigned K>
class Measurer {
 public:
  Measurer(const Frame& frame, const std::vector<std::uint32_t>& index, const Run& run, Hull& hull)
      : frame_(frame),
        index_(index),
        run_(run),
        hull_(hull),
        k_(K ? K : frame.k),
        count_(index.size() / k_),
        plane_(frame) {}

  void run() {
    // In the usual case every facet is one simplex. Its plane and its share of the sums need the
    // same normal, and reading the corners takes most of the time, so both are computed together.
    fused_ = !frame_.wild && hull_.facet_count() == count_;
    resize_big(hull_.facet_planes, hull_.facet_count() * (std::size_t{frame_.dimension} + 1));
    sum();
    if (!fused_) planes();
  }

  /// Only the sums, beginning with double-doubles: the planes exist already.
  void run_thin() { sum_carefully(); }

 private:
  void sum() {
    if (frame_.wild) return sum_exactly();
    const Totals<DoubleDouble> t = totals<double>();
    if (!settled(t, 0x1p-53)) return sum_carefully();
    finish_measures(frame_, t, hull_);
  }

  void sum_carefully() {
    const Totals<DoubleDouble> t = totals<DoubleDouble>();
    if (!settled(t, 0x1p-102)) return sum_exactly();
    finish_measures(frame_, t, hull_);
  }

  /// Computes every facet's plane from its simplex with the longest normal.
  void planes() {
    const unsigned d = frame_.dimension;
    const std::vector<std::uint32_t> best = widest_simplices();
    run_.each(hull_.facet_count(), measure_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        if (K == 0) run_.check();
        plane(best.empty() ? i : best[i], hull_.facet_planes.data() + i * (std::size_t{d} + 1));
      }
    });
  }

  /// Prefetch distance in simplices; their arithmetic takes about as long as a cache miss.
  static constexpr std::uint64_t ahead = 12;
  /// Prefetches the corners of simplex i, which are scattered in memory.
  void prefetch(std::uint64_t i) const {
    if (i >= count_) return;
    for (unsigned j = 0; j < k_; ++j) prefetch_line(frame_.at(simplex(i)[j]));
  }

  const std::uint32_t* simplex(std::uint64_t i) const { return index_.data() + i * k_; }

  using Normals = std::conditional_t<K == 0, ManyNormals, FewNormals<K>>;
  /// Those of all simplices, each thread its own.
  Normals normals_of_all() const { return Normals(frame_, plane_, index_.data(), count_); }

  template <class Real>
  Totals<DoubleDouble> totals() const {
    const unsigned d = frame_.dimension;
    std::vector<Totals<DoubleDouble>> parts(chunk_count(count_, measure_chunk),
                                            Totals<DoubleDouble>(d));
    run_.each_chunk(count_, measure_chunk,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      Normals normals = normals_of_all();
      // Sums of short runs are computed in Real, and added in double-doubles.
      for (std::uint64_t b = begin; b < end; b += measure_run) {
        if (K == 0) run_.check();  // in 50D a run takes hundredths of a second
        add_run<Real>(b, std::min(b + measure_run, end), normals, parts[chunk]);
      }
    });
    Totals<DoubleDouble> all(d);
    for (const auto& p : parts) all.add(p);
    return all;
  }

  template <class Real>
  void add_run(std::uint64_t begin, std::uint64_t end, Normals& normals,
               Totals<DoubleDouble>& out) const {
    const unsigned d = frame_.dimension;
    const double* o = frame_.at(0);
    constexpr unsigned fixed = K ? K : 1;
    Real few[fixed];
    std::vector<Real> many(K ? 0 : k_), scratch;
    Real* n = K ? few : many.data();
    Real volume = 0, area = 0;
    Real moment_few[fixed];
    std::vector<Real> moment_many(d == K ? 0 : d, Real(0));
    Real* moment = d == K ? moment_few : moment_many.data();
    for (unsigned c = 0; c < d; ++c) moment[c] = 0;
    std::vector<Real> sums(K ? 0 : d);
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint32_t* v = simplex(i);
      prefetch(i + ahead);
      bool reliable = true;
      double size = 0, error = 0;
      if constexpr (std::is_same_v<Real, double>)
        size = normals.of(i, n, scratch, &reliable, &error);
      else
        error = simplex_normal<K, Real>(frame_, v, n, scratch);
      const double* p = frame_.at(v[0]);
      Real height = 0;
      double reach = 0;
      for (unsigned c = 0; c < k_; ++c) {
        const Real step = difference<Real>(p[frame_.axes[c]], o[frame_.axes[c]]);
        height = height + n[c] * step;
        reach = std::max(reach, std::fabs(value(step)));
      }
      volume = volume + height;
      out.error += error * reach;
      out.area_error += error;
      area = area + lifted_length(n, size);
      if constexpr (K == 0) {  // row by row: the same sums, in vectors
        std::fill(sums.begin(), sums.end(), Real(0));
        for (unsigned j = 0; j < k_; ++j) {
          const double* q = frame_.at(v[j]);
          for (unsigned c = 0; c < d; ++c) sums[c] = sums[c] + difference<Real>(q[c], o[c]);
        }
        for (unsigned c = 0; c < d; ++c) moment[c] = moment[c] + height * sums[c];
      } else {
        for (unsigned c = 0; c < d; ++c) {
          Real sum = 0;
          for (unsigned j = 0; j < k_; ++j) {
            const double* q = frame_.at(v[j]);
            sum = sum + difference<Real>(q[c], o[c]);
          }
          moment[c] = moment[c] + height * sum;
        }
      }
      if constexpr (std::is_same_v<Real, double>)
        if (fused_)
          plane_.write(v, n, reliable, hull_.facet_planes.data() + i * (d + std::uint64_t{1}));
    }
    out.volume = out.volume + DoubleDouble(volume);
    out.area = out.area + DoubleDouble(area);
    for (unsigned c = 0; c < d; ++c) out.moment[c] = out.moment[c] + DoubleDouble(moment[c]);
  }

  /// The length of a normal as a functional on the flat. `size`: the length of the normal itself in
  /// doubles, which is the result in full dimension.
  template <class Real>
  double lifted_length(const Real* n, double size) const {
    double square = 0;
    if (!frame_.flat() && std::is_same_v<Real, double>) return size;
    if (!frame_.flat())
      for (unsigned c = 0; c < k_; ++c) square += value(n[c]) * value(n[c]);
    for (unsigned r = 0; frame_.flat() && r < k_; ++r) {
      double t = 0;
      for (unsigned c = 0; c < k_; ++c)
        t += frame_.basis[std::size_t{r} * frame_.dimension + frame_.axes[c]] * value(n[c]);
      square += t * t;
    }
    return std::sqrt(square);
  }

  /// The last rung, for hulls so thin that sums in double-doubles are not accurate: computes every
  /// simplex's measures from exact integers. The volumes of all simplices with apex vertex 0 count
  /// as positive.
  void sum_exactly() {
    const unsigned d = frame_.dimension;
    constexpr std::uint64_t chunk_size = 512;
    std::vector<Totals<ExactFloat>> parts(chunk_count(count_, chunk_size), Totals<ExactFloat>(d));
    run_.each_chunk(count_, chunk_size,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        run_.check();
        add_exactly(i, parts[chunk]);
      }
    });
    Totals<ExactFloat> all(d);
    for (const auto& p : parts) all.add(p);
    if (all.volume.zero()) throw Error(ErrorCode::internal, "the hull has no volume");
    finish_measures(frame_, all, 1, 0, hull_);
  }

  void add_exactly(std::uint64_t i, Totals<ExactFloat>& out) const {
    std::vector<const double*> corners;
    for (unsigned j = 0; j < k_; ++j) corners.push_back(frame_.raw_at(simplex(i)[j]));
    corners.push_back(frame_.raw_at(0));
    ExactFloat volume;
    if (frame_.flat()) {
      const ExactOrthogonalParts rests(frame_.dimension, corners.data(), k_);
      out.area = out.area + rests.measure(k_ - 1);
      volume = rests.measure(k_);
    } else {
      const ExactNormal normal(k_, corners.data());
      out.area = out.area + normal.area();
      volume = normal.volume();
    }
    if (volume.zero()) return;
    out.volume = out.volume + volume;
    for (unsigned c = 0; c < frame_.dimension; ++c) {
      ExactFloat sum;
      for (unsigned j = 0; j < k_; ++j)
        sum = sum + (ExactFloat(corners[j][c]) - ExactFloat(corners[k_][c]));
      out.moment[c] = out.moment[c] + volume * sum;
    }
  }

  /// For each facet the simplex with the longest normal, the first of several; empty if every facet
  /// is one simplex.
  std::vector<std::uint32_t> widest_simplices() const {
    std::vector<std::uint32_t> best;
    const std::size_t facets = hull_.facet_count();
    if (facets == count_) return best;
    resize_big(best, facets);
    // Nonnegative doubles are ordered as their bits are, read as integers.
    BigArray<std::uint64_t> longest(facets), lengths(count_);
    const auto each_chunk = [this](std::uint64_t count, const auto& body) {
      run_.each(count, measure_chunk, [&](std::uint64_t begin, std::uint64_t end) {
        Normals normals = normals_of_all();
        for (std::uint64_t i = begin; i < end; ++i) {
          if (K == 0) run_.check();
          body(i, normals);
        }
      });
    };
    each_chunk(facets, [&](std::uint64_t f, Normals&) {
      longest[f] = 0;
      best[f] = 0xFFFFFFFF;
    });
    const auto alone = [this](std::uint32_t f) {
      return hull_.facets.offsets[f + 1] - hull_.facets.offsets[f] == k_;
    };
    constexpr auto relaxed = std::memory_order_relaxed;
    each_chunk(count_, [&](std::uint64_t i, Normals& normals) {
      prefetch(i + ahead);
      const std::uint32_t f = hull_.simplex_facets[i];
      lengths[i] = 0;
      if (alone(f)) return;
      double few[K ? K : 1];
      std::vector<double> many(K ? 0 : k_), scratch;
      bool reliable = false;
      double error = 0;
      const double length = normals.of(i, K ? few : many.data(), scratch, &reliable, &error);
      if (length > 0) lengths[i] = std::bit_cast<std::uint64_t>(length);
      const std::atomic_ref<std::uint64_t> most(longest[f]);
      std::uint64_t now = most.load(relaxed);
      while (lengths[i] > now && !most.compare_exchange_weak(now, lengths[i], relaxed)) {
      }
    });
    each_chunk(count_, [&](std::uint64_t i, Normals&) {
      const std::uint32_t f = hull_.simplex_facets[i];
      if (lengths[i] != longest[f]) return;
      const std::atomic_ref<std::uint32_t> first(best[f]);
      std::uint32_t now = first.load(relaxed);
      while (i < now && !first.compare_exchange_weak(now, static_cast<std::uint32_t>(i), relaxed)) {
      }
    });
    return best;
  }

  void plane(std::uint64_t i, double* out) const {
    double few[K ? K : 1];
    std::vector<double> many(K ? 0 : k_), scratch;
    double* n = K ? few : many.data();
    bool reliable = false;
    double error = 0;
    if (!frame_.wild) plane_.normal(simplex(i), n, scratch, &reliable, &error);
    plane_.write(simplex(i), n, reliable, out);
  }

  const Frame& frame_;
  const std::vector<std::uint32_t>& index_;
  const Run& run_;
  Hull& hull_;
  const unsigned k_;
  const std::uint64_t count_;
  const FacetPlane<K> plane_;
  bool fused_ = false;
};

template <unsigned K>
void measure_all(const Frame& frame, const std::vector<std::uint32_t>& index, const Run& run,
                 Hull& hull, bool thin) {
  Measurer<K> m(frame, index, run, hull);
  thin ? m.run_thin() : m.run();
}

/// k = 1: the two simplices are the end points. Points have no orientation, so the general code
/// does not apply.
void measure_segment(const Frame& frame, const std::vector<std::uint32_t>& index, Hull& hull) {
  const unsigned d = frame.dimension;
  std::vector<ExactFloat> step;
  ExactFloat square;
  for (unsigned c = 0; c < d; ++c) {
    step.push_back(ExactFloat(frame.raw_at(index[1])[c]) - ExactFloat(frame.raw_at(index[0])[c]));
    square = square + step[c] * step[c];
  }
  const ExactFloat norm = square.root();
  hull.volume = norm.to_double();
  hull.area = 2;
  for (unsigned end = 0; end < 2; ++end) {
    ExactFloat offset;
    for (unsigned c = 0; c < d; ++c) {
      const ExactFloat n = (end == 1 ? step[c] : -step[c]) / norm;
      offset = offset - n * ExactFloat(frame.raw_at(index[end])[c]);
      hull.facet_planes.push_back(n.to_double());
    }
    hull.facet_planes.push_back(offset.to_double());
  }
  for (unsigned c = 0; c < d; ++c)
    hull.centroid.push_back(
        (ExactFloat(frame.raw_at(index[0])[c]) + step[c] / ExactFloat(2)).to_double());
}

ExactFloat widened(const DoubleDouble& v) { return ExactFloat(v.high) + ExactFloat(v.low); }

}  // namespace

void finish_measures(const Frame& frame, const Totals<ExactFloat>& sums, const ExactFloat& stretch,
                     long exponent, Hull& hull) {
  const unsigned k = frame.k;
  ExactFloat factorial = 1;
  for (unsigned i = 2; i < k; ++i) factorial = factorial * ExactFloat(i);
  const ExactFloat volume = sums.volume * stretch, area = sums.area * stretch;
  hull.area = (area / factorial).to_double(exponent * (k - 1L));
  hull.volume = (volume / (factorial * ExactFloat(k))).to_double(exponent * static_cast<long>(k));
  hull.centroid.clear();
  for (unsigned c = 0; c < frame.dimension; ++c) {
    const ExactFloat shift = sums.moment[c] / (sums.volume * ExactFloat(k + 1.0));
    const ExactFloat origin = ExactFloat(frame.raw_at(0)[c]);
    hull.centroid.push_back((origin + shift.times_power_of_two(exponent)).to_double());
  }
}

void finish_measures(const Frame& frame, const Totals<DoubleDouble>& sums, Hull& hull) {
  if (!frame.flat()) {
    hull.centroid.resize(frame.dimension);
    if (finish_quickly(frame.k, frame.exponent, frame.at(0), sums.volume, sums.area,
                       sums.moment.data(), &hull.volume, &hull.area, hull.centroid.data()))
      return;
  }
  Totals<ExactFloat> wide(0);
  wide.volume = widened(sums.volume);
  wide.area = widened(sums.area);
  for (const DoubleDouble& v : sums.moment) wide.moment.push_back(widened(v));
  finish_measures(frame, wide, frame.stretch, frame.exponent, hull);
}

template <unsigned K>
void finish_with_care(const PointView& points, std::uint64_t first, int exponent,
                      const double (&origin)[K], const Share<K, DoubleDouble>& sums,
                      Measures& out) {
  const std::vector<std::uint64_t> vertices{first};
  Frame frame;  // of vertex 0 alone: more is not used here
  frame.dimension = frame.k = K;
  frame.exponent = exponent;
  frame.points = &points;
  frame.vertices = &vertices;
  frame.scaled.assign(origin, origin + K);
  Hull hull;
  finish_measures(frame, Totals<DoubleDouble>(sums), hull);
  out.volume = hull.volume;
  out.area = hull.area;
  std::copy_n(hull.centroid.begin(), K, out.centroid);
}
template void finish_with_care(const PointView&, std::uint64_t, int, const double (&)[2],
                               const Share<2, DoubleDouble>&, Measures&);
template void finish_with_care(const PointView&, std::uint64_t, int, const double (&)[3],
                               const Share<3, DoubleDouble>&, Measures&);

namespace {

void measure_in_frame(const Frame& frame, const std::vector<std::uint32_t>& vertex_index,
                      const Run& run, Hull& hull, bool thin) {
  if constexpr (plane_only) return measure_all<2>(frame, vertex_index, run, hull, thin);
  using Measure =
      void (*)(const Frame&, const std::vector<std::uint32_t>&, const Run&, Hull&, bool);
  static constexpr Measure of_dimension[] = {measure_all<0>, measure_all<0>, measure_all<2>,
                                             measure_all<3>, measure_all<4>, measure_all<5>,
                                             measure_all<6>, measure_all<7>, measure_all<8>};
  of_dimension[frame.k <= 8 ? frame.k : 0](frame, vertex_index, run, hull, thin);
}

}  // namespace

void measure(const PointView& points, const std::vector<std::uint64_t>& vertices,
             const std::vector<std::uint32_t>& vertex_index, const unsigned* axes, const Run& run,
             Hull& hull) {
  const auto k = static_cast<unsigned>(hull.affine_dimension);
  hull.facet_planes.clear();
  hull.centroid.clear();
  if (!plane_only && k > measured_as_sum && vertices.size() == k + 1)
    return measure_simplex(make_unscaled_frame(points, vertices, k), vertex_index, run, hull);
  const Frame frame = make_frame(points, vertices, axes, k, run);
  if (k == 1)
    measure_segment(frame, vertex_index, hull);
  else
    measure_in_frame(frame, vertex_index, run, hull, false);
}

void measure_thin(const PointView& points, const std::vector<std::uint64_t>& vertices,
                  const std::vector<std::uint32_t>& vertex_index, const unsigned* axes,
                  const Run& run, Hull& hull) {
  hull.centroid.clear();
  const auto k = static_cast<unsigned>(hull.affine_dimension);
  const Frame frame = make_frame(points, vertices, axes, k, run);
  measure_in_frame(frame, vertex_index, run, hull, true);
}

}  // namespace cullhull::internal
