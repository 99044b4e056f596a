#include "result/write/polygon_result.hpp"

#include <atomic>
#include <bit>
#include <cstring>

#include "cullhull/hull.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/facets/facet_plane.hpp"

namespace cullhull::internal {

// Chooses the same exponent as make_frame.
EdgeKernel::EdgeKernel(const Box& box) {
  double largest = 0;
  for (unsigned j = 0; j < 2; ++j)
    largest = std::max({largest, std::fabs(box.low[j]), std::fabs(box.high[j])});
  if (largest > 0) exponent_ = std::ilogb(largest) + 1;
  // Well within the range in which scale_by is a multiplication.
  if (exponent_ < -900 || exponent_ > 900) return;
  unscale_ = scale_by(1, exponent_);
  ordinary_ = true;
  for (unsigned j = 0; j < 2; ++j) {
    const double extent = scale_by(box.high[j], -exponent_) - scale_by(box.low[j], -exponent_);
    ordinary_ = ordinary_ && extent > 0x1p-200;
  }
}

bool finish_polygon(const EdgeKernel& kernel, const Share<2, DoubleDouble>& sums,
                    const PointView& points, std::uint64_t first, PlanarMeasures& measures) {
  if (!settled(sums, 0x1p-53)) return false;
  const PlanarPoint p = kernel.scaled({points.at(first, 0), points.at(first, 1)});
  const double origin[2] = {p.x, p.y};
  if (finish_quickly(2, kernel.exponent(), origin, sums.volume, sums.area, sums.moment,
                     &measures.volume, &measures.area, measures.centroid))
    return true;
  const std::vector<std::uint64_t> vertices{first};
  Frame frame;
  frame.dimension = frame.k = 2;
  frame.axes = {0, 1};
  frame.exponent = kernel.exponent();
  frame.points = &points;
  frame.vertices = &vertices;
  frame.scaled = {p.x, p.y};
  Hull hull;
  finish_measures(frame, Totals<DoubleDouble>(sums), hull);
  measures = {hull.volume, hull.area, {hull.centroid[0], hull.centroid[1]}};
  return true;
}

namespace {

static_assert(light_grain % 64 == 0);

/// The number of ones in v. std::popcount compiles to a function call for baseline x86-64.
std::uint32_t count_bits(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555ULL;
  v = (v & 0x3333333333333333ULL) + (v >> 2 & 0x3333333333333333ULL);
  v = (v + (v >> 4)) & 0x0F0F0F0F0F0F0F0FULL;
  return static_cast<std::uint32_t>(v * 0x0101010101010101ULL >> 56);
}

/// The rank of each corner among the corners in ascending order of rows: a bit for each row, and
/// the number of corners before each word of 64 bits. Small enough for the cache.
class Ranks {
 public:
  Ranks(const Array<std::uint32_t>& corners, std::uint64_t rows, const Run& run)
      : words_(rows / 64 + 1), before_(words_) {
    BigArray<std::uint8_t> used(words_ * 64);
    std::memset(used.get(), 0, words_ * 64);
    run.each(corners.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) used[corners[i]] = 1;
    });
    bits_ = BigArray<std::uint64_t>(words_);
    run.each(words_, light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t w = begin; w < end; ++w) {
        std::uint64_t word = 0;
        for (std::uint64_t b = 0; b < 64; b += 8) {
          // Eight flags at a time: a multiplication gathers their lowest bits in the highest byte.
          std::uint64_t flags = 0;
          for (std::uint64_t k = 0; k < 8; ++k)
            flags |= std::uint64_t{used[64 * w + b + k]} << (8 * k);
          word |= (flags * 0x0102040810204080ULL >> 56) << b;
        }
        bits_[w] = word;
      }
    });
    std::uint32_t sum = 0;
    for (std::uint64_t w = 0; w < words_; ++w) {
      before_[w] = sum;
      sum += count_bits(bits_[w]);
    }
  }

  /// The number of corners in rows below `row`.
  std::uint32_t operator()(std::uint32_t row) const {
    const std::uint64_t lower = (std::uint64_t{1} << row % 64) - 1;
    return before_[row / 64] + count_bits(bits_[row / 64] & lower);
  }
  std::uint64_t words() const { return words_; }
  std::uint64_t word(std::uint64_t w) const { return bits_[w]; }
  std::uint32_t before_word(std::uint64_t w) const { return before_[w]; }

 private:
  std::uint64_t words_;
  BigArray<std::uint64_t> bits_;
  BigArray<std::uint32_t> before_;
};

/// Reads a point's unchanged coordinates, negative zeros included. T: the scalar type, or void for
/// any.
template <class T>
struct Reader {
  const PointView& points;
  PlanarPoint operator()(std::uint64_t id) const {
    const std::byte* p = points.address(id, 0);
    T x, y;
    std::memcpy(&x, p, sizeof x);
    std::memcpy(&y, p + points.coordinate_stride, sizeof y);
    return {static_cast<double>(x), static_cast<double>(y)};
  }
};
template <>
struct Reader<void> {
  const PointView& points;
  PlanarPoint operator()(std::uint64_t id) const { return {points.at(id, 0), points.at(id, 1)}; }
};

/// The data of a corner in one record: the sweep over the edges accesses corners in random order.
struct Corner {
  PlanarPoint point;         // scaled by the kernel
  std::uint64_t id, unused;  // four words: no record straddles cache lines
};

/// Writes the result of a polygon in parallel sweeps over the corners in ascending order.
class Writer {
 public:
  Writer(const PointView& points, const std::uint64_t* ids, const Polygon& polygon,
         const EdgeKernel& kernel, const Run& run)
      : points_(points),
        ids_(ids),
        cycle_(polygon.corners),
        count_(polygon.corners.size()),
        kernel_(kernel),
        run_(run),
        ranks_(polygon.corners, polygon.rows, run) {}

  bool run(Hull& hull) {
    run_.check();
    run_.report("facets", 0);
    switch (points_.scalar) {
      case ScalarType::f64:
        list_corners(Reader<double>{points_});
        break;
      case ScalarType::f32:
        list_corners(Reader<float>{points_});
        break;
      default:
        list_corners(Reader<void>{points_});
    }
    neighbours_.resize(2 * count_);
    clear_pages_early(neighbours_.data(), 2 * count_ * sizeof(std::uint32_t), run_.threads,
                      [&] { run_.check(); });
    link();
    simplices_.resize(2 * count_);
    facets_.resize(2 * count_);
    across_.resize(2 * count_);
    planes_.resize(3 * count_);
    std::vector<Share<2, DoubleDouble>> parts(chunk_count(count_, measure_chunk));
    std::atomic<bool> ordinary{true};
    // One job writes the list of vertices, whose memory one thread must clear; it begins first. The
    // other jobs write a chunk of edges each.
    run_.each_item(parts.size() + 1, [&](std::uint64_t job) {
      if (job == 0) return write_vertices(hull);
      const std::uint64_t begin = (job - 1) * measure_chunk;
      if (!write(begin, std::min(count_, begin + measure_chunk), parts[job - 1])) ordinary = false;
    });
    if (!ordinary) return false;
    Share<2, DoubleDouble> all;
    for (const auto& p : parts) all.add(p);
    PlanarMeasures measures;
    if (!finish_polygon(kernel_, all, points_, corners_[0].id, measures)) return false;
    hull.volume = measures.volume;
    hull.area = measures.area;
    hull.centroid.assign(measures.centroid, measures.centroid + 2);
    using Ids = SharedArray<std::uint64_t>;
    hull.simplices = Ids(std::move(simplices_));
    hull.simplex_neighbours = std::move(neighbours_);
    hull.simplex_facets = EvenArray<std::uint32_t>::of_step(count_, 1);
    hull.facets = Lists<std::uint64_t, Ids>::of_length(2, Ids(std::move(facets_)));
    hull.facet_neighbours = Lists<std::uint32_t>::of_length(2, std::move(across_));
    hull.facet_planes = std::move(planes_);
    return true;
  }

 private:
  std::uint64_t id(std::uint32_t row) const { return ids_ != nullptr ? ids_[row] : row; }

  /// Fills corners_ with the corners in ascending order of rows.
  template <class Read>
  void list_corners(const Read& read) {
    corners_ = BigArray<Corner>(count_);
    run_.each(ranks_.words(), light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
      Corner* out = corners_.get() + ranks_.before_word(begin);
      for (std::uint64_t w = begin; w < end; ++w)
        for (std::uint64_t word = ranks_.word(w); word != 0; word &= word - 1) {
          const std::uint64_t i = id(static_cast<std::uint32_t>(64 * w + std::countr_zero(word)));
          *out++ = {kernel_.scaled(read(i)), i, 0};
        }
    });
  }

  /// Stores for each corner the ranks of the corners before and after it on the polygon.
  void link() {
    run_.each(count_, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      std::uint32_t before = ranks_(cycle_[begin == 0 ? count_ - 1 : begin - 1]);
      std::uint32_t at = ranks_(cycle_[begin]);
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint32_t after = ranks_(cycle_[i + 1 < count_ ? i + 1 : 0]);
        std::uint32_t* const to = neighbours_.data() + std::uint64_t{2} * at;
        to[0] = before;
        to[1] = after;
        before = std::exchange(at, after);
      }
    });
  }

  /// Writes simplices [begin, end), which are whole runs, and adds their shares to `sums`. Returns
  /// false if an edge is too short for doubles.
  bool write(std::uint64_t begin, std::uint64_t end, Share<2, DoubleDouble>& sums) {
    constexpr std::uint64_t ahead = 16;
    bool ordinary = true;
    const PlanarPoint origin = corners_[0].point;
    Share<2> run;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (i + ahead < end) prefetch_line(&corners_[neighbours_[2 * (i + ahead)]]);
      const Corner &here = corners_[i], &there = corners_[neighbours_[2 * i]];
      simplices_[2 * i] = facets_[2 * i + 1] = here.id;
      simplices_[2 * i + 1] = facets_[2 * i] = there.id;
      across_[2 * i] = neighbours_[2 * i + 1];
      across_[2 * i + 1] = neighbours_[2 * i];
      Share<2> share;
      if (!kernel_.edge(here.point, there.point, origin, planes_.data() + 3 * i, share))
        ordinary = false;
      run.add(share);
      if ((i + 1) % measure_run != 0 && i + 1 != end) continue;
      sums.add(run);
      run = {};
    }
    return ordinary;
  }

  /// Writes the vertices counter-clockwise from the lowest id.
  void write_vertices(Hull& hull) {
    const auto first =
        static_cast<std::uint64_t>(std::min_element(cycle_.begin(), cycle_.end()) - cycle_.begin());
    resize_big(hull.vertices, count_);
    for (std::uint64_t i = 0; i < count_; ++i) {
      const std::uint64_t at = first + i;
      hull.vertices[i] = id(cycle_[at < count_ ? at : at - count_]);
    }
  }

  const PointView& points_;
  const std::uint64_t* const ids_;
  const Array<std::uint32_t>& cycle_;
  const std::uint64_t count_;
  const EdgeKernel& kernel_;
  const Run& run_;
  const Ranks ranks_;
  BigArray<Corner> corners_;  // by rank
  // The lists of the result; neighbours of simplices, of facets.
  Array<std::uint64_t> simplices_, facets_;
  Array<std::uint32_t> neighbours_, across_;
  Array<double> planes_;
};

}  // namespace

bool write_polygon(const PointView& points, const std::uint64_t* ids, const Polygon& polygon,
                   const Run& run, Hull& hull) {
  const EdgeKernel kernel(polygon.box);
  if (!kernel.ordinary()) return false;
  return Writer(points, ids, polygon, kernel, run).run(hull);
}

}  // namespace cullhull::internal
