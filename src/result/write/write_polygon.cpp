#include "result/write/write_polygon.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "cullhull/batch.hpp"
#include "cullhull/hull.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure.hpp"
#include "result/write/hull_lists.hpp"

namespace cullhull::internal {
namespace {

/// The power of two that scales the points, the same as make_frame chooses. False if coordinates
/// span too many powers of two for scaled doubles: the general code is then needed.
bool find_exponent(const Box& box, int& exponent) {
  double largest = 0;
  for (unsigned j = 0; j < 2; ++j)
    largest = std::max({largest, std::fabs(box.low[j]), std::fabs(box.high[j])});
  exponent = largest > 0 ? std::ilogb(largest) + 1 : 0;
  // Well within the range in which scale_by is a multiplication.
  if (exponent < -900 || exponent > 900) return false;
  bool ordinary = true;
  for (unsigned j = 0; j < 2; ++j)
    ordinary &= scale_by(box.high[j], -exponent) - scale_by(box.low[j], -exponent) > 0x1p-200;
  return ordinary;
}

static_assert(light_grain % 64 == 0);

/// The number of ones in v. std::popcount compiles to a function call for baseline x86-64.
std::uint32_t count_bits(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555ULL;
  v = (v & 0x3333333333333333ULL) + (v >> 2 & 0x3333333333333333ULL);
  v = (v + (v >> 4)) & 0x0F0F0F0F0F0F0F0FULL;
  return static_cast<std::uint32_t>(v * 0x0101010101010101ULL >> 56);
}

/// Reads a point's unchanged coordinates, negative zeros included. T: the scalar type, or void for
/// any.
template <class T>
struct Reader {
  const PointView& points;
  double operator()(std::uint64_t id, unsigned j) const {
    T v;
    std::memcpy(&v, points.address(id, j), sizeof v);
    return static_cast<double>(v);
  }
};
template <>
struct Reader<void> {
  const PointView& points;
  double operator()(std::uint64_t id, unsigned j) const { return points.at(id, j); }
};

/// Writes the result of a polygon in parallel sweeps over the corners in ascending order.
template <class Id, class Target>
class PolygonWriter {
 public:
  PolygonWriter(const PointView& points, const PolygonOfRows<Id>& polygon, int exponent,
                const Run& run, PolygonMemory& memory, Target& target)
      : points_(points),
        polygon_(polygon),
        cycle_(polygon.corners),
        count_(polygon.corners.size()),
        words_(polygon.rows / 64 + 1),
        exponent_(exponent),
        scale_(scale_by(1, -exponent)),
        unscale_(scale_by(1, exponent)),
        run_(run),
        target_(target),
        lists_({2, count_, count_, count_, 2 * count_, 2 * count_}, target),
        sums_(memory.sums) {
    memory.bits.reserve(words_);
    memory.before.reserve(words_);
    memory.corners.reserve(count_);
    if (polygon.rows <= 1 << 15) {
      memory.ranks.reserve(polygon.rows);
      ranks_ = memory.ranks.data();
    }
    bits_ = memory.bits.data();
    before_ = memory.before.data();
    corners_ = memory.corners.data();
  }

  bool run() {
    run_.check();
    run_.report("facets", 0);
    mark_corners();
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
    clear_pages_early(lists_.simplex_neighbours, 2 * count_ * sizeof(std::uint32_t), run_.threads,
                      [&] { run_.check(); });
    link();
    sums_.assign(chunk_count(count_, measure_chunk), {});
    std::atomic<bool> ordinary{true};
    // One job makes room for the list of vertices, whose memory one thread must clear; it begins
    // first. The other jobs write a chunk of edges each.
    std::uint64_t* vertices = nullptr;
    const auto job = [&](std::uint64_t i) {
      if (i == 0) {
        vertices = lists_.vertices();
        return;
      }
      const std::uint64_t begin = (i - 1) * measure_chunk;
      if (!write(begin, std::min(count_, begin + measure_chunk), sums_[i - 1])) ordinary = false;
    };
    if (sums_.size() == 1) {
      job(0);
      job(1);
    } else {
      run_.each_item(sums_.size() + 1, job);
    }
    if (!ordinary) return false;
    write_vertices(vertices);
    Share<2, DoubleDouble> all;
    for (const auto& s : sums_) all.add(s);
    Measures measures;
    if (!finish_plain(points_, corners_[0].id, exponent_, all, measures)) return false;
    write_measures(2, points_.count, measures.volume, measures.area, {measures.centroid, 2},
                   target_);
    lists_.keep();
    return true;
  }

 private:
  std::uint64_t id(std::uint32_t row) const {
    return polygon_.ids != nullptr ? polygon_.ids[row] : row;
  }

  /// As run_.each, without its cost for few items.
  template <class Body>
  void each(std::uint64_t count, std::uint64_t grain, const Body& body) const {
    if (count <= grain)
      body(0, count);
    else
      run_.each(count, grain, body);
  }

  /// Sets a bit for each corner's row, and counts the corners before each word of bits. Small
  /// enough for the cache.
  void mark_corners() {
    if (words_ == 1) {  // in a register: in memory each bit waits for the one before it
      std::uint64_t word = 0;
      for (const std::uint32_t row : cycle_) word |= std::uint64_t{1} << row;
      bits_[0] = word;
      before_[0] = 0;
      return;
    }
    if (run_.threads == 1 || count_ <= light_grain) {
      std::memset(bits_, 0, words_ * sizeof(std::uint64_t));
      for (const std::uint32_t row : cycle_) bits_[row / 64] |= std::uint64_t{1} << row % 64;
    } else {
      gather_bits();
    }
    std::uint32_t sum = 0;
    for (std::uint64_t w = 0; w < words_; ++w) {
      before_[w] = sum;
      sum += count_bits(bits_[w]);
    }
  }
  /// Sets the bits on all threads, by way of bytes: atomic operations on words took 9 % more time
  /// of a circle of 1M points.
  [[gnu::noinline]] void gather_bits() {
    BigArray<std::uint8_t> used(words_ * 64);
    std::memset(used.get(), 0, words_ * 64);
    run_.each(count_, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) used[cycle_[i]] = 1;
    });
    run_.each(words_, light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
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
  }

  /// The rank of a corner: the number of corners in rows below its own.
  std::uint32_t rank(std::uint32_t row) const {
    if (ranks_ != nullptr) return ranks_[row];
    const std::uint64_t lower = (std::uint64_t{1} << row % 64) - 1;
    return before_[row / 64] + count_bits(bits_[row / 64] & lower);
  }

  /// Fills corners_ with the corners in ascending order of rows.
  template <class Read>
  void list_corners(const Read& read) {
    each(words_, light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
      PolygonCorner* out = corners_ + before_[begin];
      for (std::uint64_t w = begin; w < end; ++w)
        for (std::uint64_t word = bits_[w]; word != 0; word &= word - 1) {
          const auto row = static_cast<std::uint32_t>(64 * w + std::countr_zero(word));
          if (ranks_ != nullptr) ranks_[row] = static_cast<std::uint32_t>(out - corners_);
          const std::uint64_t i = id(row);
          *out++ = {scale_ * read(i, 0), scale_ * read(i, 1), i, 0};
        }
    });
  }

  /// Stores for each corner the ranks of the corners before and after it on the polygon.
  void link() {
    each(count_, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      std::uint32_t before = rank(cycle_[begin == 0 ? count_ - 1 : begin - 1]);
      std::uint32_t at = rank(cycle_[begin]);
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint32_t after = rank(cycle_[i + 1 < count_ ? i + 1 : 0]);
        if (at == 0) first_ = i;  // of one thread alone
        std::uint32_t* const to = lists_.simplex_neighbours + std::uint64_t{2} * at;
        to[0] = before;
        to[1] = after;
        before = std::exchange(at, after);
      }
    });
  }

  /// Writes simplices [begin, end), which are whole runs, and adds their shares to `sums`. Returns
  /// false if an edge is too short for doubles.
  bool write(std::uint64_t begin, std::uint64_t end, Share<2, DoubleDouble>& sums) {
    constexpr std::uint64_t ahead = 16, in_cache = 1 << 12;
    const std::uint64_t prefetched = count_ > in_cache ? end : 0;
    const std::uint32_t* const neighbours = lists_.simplex_neighbours;
    bool ordinary = true;
    const double origin[2] = {corners_[0].x, corners_[0].y};
    Share<2> run;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (i + ahead < prefetched) prefetch_line(&corners_[neighbours[2 * (i + ahead)]]);
      const PolygonCorner &here = corners_[i], &there = corners_[neighbours[2 * i]];
      lists_.simplices[2 * i] = lists_.facets[2 * i + 1] = here.id;
      lists_.simplices[2 * i + 1] = lists_.facets[2 * i] = there.id;
      lists_.facet_neighbours[2 * i] = neighbours[2 * i + 1];
      lists_.facet_neighbours[2 * i + 1] = neighbours[2 * i];
      const double corner[2][2] = {{here.x, here.y}, {there.x, there.y}};
      double plane[3];
      Share<2> share;
      ordinary &= plain_facet<2>(corner, origin, unscale_, plane, share);
      std::copy_n(plane, 3, lists_.planes + 3 * i);
      run.add(share);
      if ((i + 1) % measure_run != 0 && i + 1 != end) continue;
      sums.add(run);
      run = {};
    }
    return ordinary;
  }

  /// Writes the vertices counter-clockwise from the lowest id.
  void write_vertices(std::uint64_t* vertices) const {
    each(count_, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint64_t at = first_ + i;
        vertices[i] = id(cycle_[at < count_ ? at : at - count_]);
      }
    });
  }

  const PointView& points_;
  const PolygonOfRows<Id>& polygon_;
  const std::span<const std::uint32_t> cycle_;
  const std::uint64_t count_, words_;
  std::uint64_t first_ = 0;  ///< where the cycle has the corner of the lowest id
  const int exponent_;
  const double scale_, unscale_;  ///< 2^-exponent_ and 2^exponent_
  const Run& run_;
  Target& target_;
  NewLists<Target> lists_;
  std::vector<Share<2, DoubleDouble>>& sums_;
  std::uint64_t* bits_;
  std::uint32_t *before_, *ranks_ = nullptr;
  PolygonCorner* corners_;  // by rank
};

}  // namespace

template <class Id, class Target>
bool write_polygon(const PointView& points, const PolygonOfRows<Id>& polygon, const Run& run,
                   PolygonMemory& memory, Target& target) {
  int exponent = 0;
  return find_exponent(polygon.box, exponent) &&
         PolygonWriter(points, polygon, exponent, run, memory, target).run();
}
template bool write_polygon(const PointView&, const PolygonOfRows<std::uint64_t>&, const Run&,
                            PolygonMemory&, Hull&);
template bool write_polygon(const PointView&, const PolygonOfRows<std::uint32_t>&, const Run&,
                            PolygonMemory&, Hull&);
template bool write_polygon(const PointView&, const PolygonOfRows<std::uint32_t>&, const Run&,
                            PolygonMemory&, HullBatch&);

}  // namespace cullhull::internal
