// The GaugeMap's tests for vectors of points, the core before the map.
// Included once per instruction set (hence Highway's unusual include guard).

#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/byte_order.hpp"

#if defined(CULLHULL_GAUGE_BLOCKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CULLHULL_GAUGE_BLOCKS_INL
#undef CULLHULL_GAUGE_BLOCKS_INL
#else
#define CULLHULL_GAUGE_BLOCKS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using MF = hn::Mask<F>;

/// Points per block of the core and the map. A block of 32 points takes the core some
/// 25 ns, and the processor overlaps reading the next block with testing this one; slower tests
/// gain nothing from that, and blocks of 256 with prefetching were fastest
/// (bench/notes/performance.md, "The pass over all points").
constexpr std::uint32_t core_block = 32, many = 256;
static_assert(gauge_chunk % many == 0 && many % core_block == 0);

// 2^23: adding it to an integer below 2^23 leaves that integer in the low bits of the float.
constexpr float integer_shift = 8388608.0F;
constexpr std::uint32_t integer_shift_bits = 0x4B000000U;
// A point whose norm is smaller is treated as the centre, so that the reciprocal stays finite.
constexpr float tiny = 0x1p-100F;

/// Sorts two lanes by descending key and moves their payloads along.
HWY_INLINE void order(VF& a, VF& b, VI& pa, VI& pb) {
  const I i;
  const MF swap = hn::Lt(a, b);
  const VF hi = hn::IfThenElse(swap, b, a);
  b = hn::IfThenElse(swap, a, b);
  a = hi;
  const auto iswap = hn::RebindMask(i, swap);
  const VI phi = hn::IfThenElse(iswap, pb, pa);
  pb = hn::IfThenElse(iswap, pa, pb);
  pa = phi;
}

template <unsigned K>
HWY_INLINE void sort_descending(VF (&key)[K], VI (&payload)[K]) {
  const auto cmp = [&](unsigned i, unsigned j)
                       HWY_ATTR { order(key[i], key[j], payload[i], payload[j]); };
  if constexpr (K == 2) {
    cmp(0, 1);
  } else if constexpr (K == 3) {
    cmp(0, 1), cmp(1, 2), cmp(0, 1);
  } else if constexpr (K == 4) {
    cmp(0, 1), cmp(2, 3), cmp(0, 2), cmp(1, 3), cmp(1, 2);
  } else if constexpr (K == 5) {
    cmp(0, 1), cmp(3, 4), cmp(2, 4), cmp(2, 3), cmp(1, 4);
    cmp(0, 3), cmp(0, 2), cmp(1, 3), cmp(1, 2);
  }
}

/// The place where the ray from the centre through y meets the cube.
template <unsigned D>
struct Direction {
  VF norm;          // |y|_inf
  VF inverse;       // 1 / norm, finite
  VF face;          // number of the cube's face, an integer
  VF other[D - 1];  // coordinates on that face's grid axes, times norm
  // A defaulted constructor would not be compiled for this target.
  HWY_INLINE Direction() {}
};

template <unsigned D>
HWY_INLINE Direction<D> direction_of(const VF (&y)[D]) {
  const F f;
  const I i;
  const U u;
  Direction<D> out;

  // Dominant axis. As integers the absolute values are ordered as the floats are, and an infinity
  // or a NaN exceeds every number, so neither is lost in the maximum.
  VI prefix[D];
  prefix[0] = hn::BitCast(i, hn::Abs(y[0]));
  for (unsigned k = 1; k < D; ++k)
    prefix[k] = hn::Max(prefix[k - 1], hn::BitCast(i, hn::Abs(y[k])));
  const VI top = prefix[D - 1];
  out.norm = hn::BitCast(f, top);

  // With the first dominant axis j: grid axis k is axis k below j, k + 1 from j on.
  VF dominant = y[D - 1];
  VI axis = hn::Set(i, static_cast<std::int32_t>(D - 1));
  for (unsigned k = D - 1; k-- > 0;) {
    const auto reached = hn::Eq(prefix[k], top);
    const MF at_or_after = hn::RebindMask(f, reached);
    out.other[k] = hn::IfThenElse(at_or_after, y[k + 1], y[k]);
    dominant = hn::IfThenElse(at_or_after, y[k], dominant);
    axis = hn::Add(axis, hn::VecFromMask(i, reached));  // -1 where reached
  }
  const VI negative = hn::BitCast(i, hn::ShiftRight<31>(hn::BitCast(u, dominant)));
  out.face = hn::ConvertTo(f, hn::Add(hn::Add(axis, axis), negative));
  out.inverse = hn::Div(hn::Set(f, 1.0F), hn::Max(out.norm, hn::Set(f, tiny)));
  return out;
}

// The interpolation, in 3D. The ray through y meets a face at a point in cell (i, j) with fractions
// f >= f' of the two axes. Kuhn's triangle has the nodes of the cell's corner, of the corner plus
// the axis of f, and of the opposite corner, with the weights 1 - f, f - f' and f'. They are not
// negative, add up to 1, and combine the nodes to exactly that point, so by convexity of the gauge
// the combination of upper bounds is one. Example: f = 0.7, f' = 0.2 and G = 1.00, 1.02, 1.01: 0.3
// * 1.00 + 0.5 * 1.02 + 0.2 * 1.01 = 1.012, times |y|_inf.

/// The cell of a direction: its lowest corner's node, and the fractions of its edges. For a point
/// with a NaN the corner is arbitrary, but in the table.
template <unsigned D>
HWY_INLINE VU corner_of(const GaugeTable& t, const Direction<D>& direction, VF (&fraction)[D - 1]) {
  const F f;
  const U u;
  // half_cells is a little below cells / 2, so that 0 <= place < cells for every finite point.
  const VF half_cells = hn::Set(f, t.half_cells);
  const VF middle = hn::Set(f, t.middle);
  VF corner = hn::MulAdd(direction.face, hn::Set(f, t.face_stride), hn::Set(f, integer_shift));
  for (unsigned k = 0; k < D - 1; ++k) {
    const VF place =
        hn::Add(hn::Mul(hn::Mul(direction.other[k], direction.inverse), half_cells), middle);
    const VF cell = hn::Floor(place);
    fraction[k] = hn::Sub(place, cell);
    corner = hn::MulAdd(cell, hn::Set(f, t.stride[k]), corner);  // integers: exact
  }
  return hn::Min(hn::Sub(hn::BitCast(u, corner), hn::Set(u, integer_shift_bits)),
                 hn::Set(u, t.last_corner));
}

/// Returns an upper bound of g(y) from the map; NaN or infinity if a coordinate is NaN or infinite.
template <unsigned D>
HWY_INLINE VF gauge_bound(const GaugeTable& t, const float* HWY_RESTRICT nodes, const VF (&y)[D]) {
  const F f;
  const I i;
  const Direction<D> direction = direction_of<D>(y);
  VF fraction[D - 1];
  VI step[D - 1];
  const VU corner_node = corner_of<D>(t, direction, fraction);
  for (unsigned k = 0; k < D - 1; ++k) step[k] = hn::Set(i, static_cast<std::int32_t>(t.stride[k]));

  // Kuhn's simplex: from the lowest corner one step per axis, in the order of falling fractions.
  sort_descending(fraction, step);
  VI node = hn::BitCast(i, corner_node);
  VF sum = hn::Mul(hn::Sub(hn::Set(f, 1.0F), fraction[0]), hn::GatherIndex(f, nodes, node));
  for (unsigned k = 0; k < D - 1; ++k) {
    node = hn::Add(node, step[k]);
    const VF weight =
        k + 1 < D - 1 ? hn::Sub(fraction[k], fraction[k + 1 < D - 1 ? k + 1 : k]) : fraction[k];
    sum = hn::Add(sum, hn::Mul(weight, hn::GatherIndex(f, nodes, node)));
  }
  return hn::Mul(direction.norm, sum);
}

/// Tests whether points are in the core; false if a coordinate is NaN.
template <unsigned D, GaugeCore::Kind kind>
class CoreTest {
 public:
  HWY_INLINE explicit CoreTest(const GaugeCore& c) {
    for (unsigned j = 0; j < D; ++j) weight_[j] = hn::Set(F(), c.weight[j]);
    for (unsigned n = 0; n < GaugeCore::norms; ++n) radius_[n] = hn::Set(F(), c.radius[n]);
  }
  HWY_INLINE MF operator()(const VF (&y)[D]) const {
    if constexpr (kind == GaugeCore::Kind::round) {
      VF sum = hn::Mul(hn::Mul(y[0], y[0]), weight_[0]);
      for (unsigned j = 1; j < D; ++j) sum = hn::MulAdd(hn::Mul(y[j], y[j]), weight_[j], sum);
      return hn::Lt(sum, radius_[0]);
    } else {
      VF z = hn::Mul(hn::Abs(y[0]), weight_[0]);
      VF most = z, least = z, sum = z;
      for (unsigned j = 1; j < D; ++j) {
        z = hn::Mul(hn::Abs(y[j]), weight_[j]);
        most = hn::Max(most, z);
        least = hn::Min(least, z);
        sum = hn::Add(sum, z);
      }
      // The maximum and minimum may lose a NaN; the sum does not.
      return hn::And(hn::Lt(most, radius_[0]),
                     hn::And(hn::Lt(hn::Sub(sum, least), radius_[1]), hn::Lt(sum, radius_[2])));
    }
  }

 private:
  VF weight_[D];
  VF radius_[GaugeCore::norms];
};

/// Survivors of a block as bits: bit k % 8 of byte k / 8 is set if point k survives, k < most.
template <std::uint32_t most>
class SurvivorBits {
 public:
  HWY_INLINE void store(std::uint32_t k, MF survives) {
    const F f;
    if constexpr (hn::MaxLanes(F()) >= 8) {
      hn::StoreMaskBits(f, survives, bits_ + k / 8);
    } else {
      std::uint8_t few[8] = {};
      hn::StoreMaskBits(f, survives, few);
      if (k % 8 == 0) bits_[k / 8] = 0;
      bits_[k / 8] = static_cast<std::uint8_t>(bits_[k / 8] | few[0] << k % 8);
    }
  }
  HWY_INLINE std::size_t list(std::uint32_t first, std::uint32_t count,
                              std::uint32_t* HWY_RESTRICT ids) const {
    std::size_t kept = 0;
    for (std::uint32_t k = 0; k < count; k += 64) {
      auto word = load_little_endian<std::uint64_t>(bits_ + k / 8);
      if (count - k < 64) word &= (std::uint64_t{1} << (count - k)) - 1;
      for (; word != 0; word &= word - 1)
        ids[kept++] = first + k + static_cast<std::uint32_t>(std::countr_zero(word));
    }
    return kept;
  }

 private:
  static_assert(most % 64 == 0);
  alignas(8) std::uint8_t bits_[most / 8] = {};
};

/// Lists the survivors of `count` points; `load(i, y)` fetches the vector of points from i on. Bits
/// are listed after the block, not after each vector: a branch on a comparison just made costs,
/// when mispredicted, the latency of the whole chain, and compressed stores are slow before
/// AVX-512.
template <unsigned D, std::uint32_t most, class Load>
HWY_INLINE std::size_t test_block(const GaugeTable& t, std::uint32_t first, std::uint32_t count,
                                  std::uint32_t* HWY_RESTRICT ids, const Load& load) {
  const F f;
  const float* HWY_RESTRICT nodes = t.nodes.data();
  const VF threshold = hn::Set(f, t.threshold);
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
  SurvivorBits<most> bits;
  for (std::uint32_t k = 0; k < count; k += lanes) {
    VF y[D];
    load(k, y);
    const auto inside = hn::Lt(gauge_bound<D>(t, nodes, y), threshold);  // false for NaN
    bits.store(k, hn::Not(inside));
  }
  return bits.list(first, count, ids);
}

/// Points collected for the next test: their coordinates as columns, and their positions in the
/// chunk.
template <unsigned D>
class OpenPoints {
 public:
  static constexpr std::uint32_t enough = many;  ///< run the next test from this many points on
  static constexpr std::uint32_t most = 2 * enough;

  std::uint32_t count() const { return count_; }
  std::uint32_t place(std::uint32_t k) const { return places_[k]; }
  HWY_INLINE void load(std::uint32_t k, VF (&y)[D]) const {
    for (unsigned j = 0; j < D; ++j) y[j] = hn::LoadU(F(), columns_[j] + k);
  }
  void clear() { count_ = 0; }

  /// Tests at most `enough` points and adds those that are not dropped: dropped(y) is false.
  template <class Load, class Places, class Dropped>
  HWY_INLINE void add(std::uint32_t count, const Load& load, const Places& places,
                      const Dropped& dropped) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(F()));
    std::uint32_t at = count_;
    for (std::uint32_t k = 0; k < count; k += lanes) {
      VF y[D];
      load(k, y);
      MF stays = hn::Not(dropped(y));
      if (count - k < lanes) stays = hn::And(stays, hn::FirstN(F(), count - k));
      // Compress and store, not CompressStore, which takes a hundred cycles on Zen 4.
      for (unsigned j = 0; j < D; ++j) hn::StoreU(hn::Compress(y[j], stays), F(), columns_[j] + at);
      hn::StoreU(hn::Compress(places(k), hn::RebindMask(U(), stays)), U(), places_ + at);
      at += static_cast<std::uint32_t>(hn::CountTrue(F(), stays));
    }
    count_ = at;
  }

 private:
  static constexpr std::size_t row = most + hn::MaxLanes(F());
  std::uint32_t count_ = 0;
  HWY_ALIGN float columns_[D][row] = {};
  HWY_ALIGN std::uint32_t places_[row];
};

// Example: the core tests 256 points and leaves 250: it costs a third of the map's test and saves 2
// % of it, so it pauses for sixteen batches. At an ordered file's change of region, from outside to
// inside, it is back after the pause.

/// Decides whether the core is used: it pauses where it drops too few points. A pause of 16 batches
/// limits the cost of a useless core to about a sixteenth of its test.
class CoreUse {
 public:
  explicit CoreUse(bool there) : there_(there) {}
  bool rests() const { return !there_ || rest_ > 0; }
  /// Whether the core tests the next `points` points; if not, they shorten its pause.
  bool taken(std::uint32_t points) {
    if (!rests()) return true;
    rest_ -= std::min(rest_, points);
    return false;
  }
  /// Reports that the core left `left` of `asked` points: with more than three quarters left it
  /// costs more than it saves, and pauses.
  void saw(std::uint32_t asked, std::uint32_t left) {
    asked_ += asked;
    left_ += left;
    if (asked_ < OpenPoints<2>::enough) return;
    if (left_ > asked_ / 4 * 3) rest_ = 16 * OpenPoints<2>::enough;
    asked_ = left_ = 0;
  }

 private:
  bool there_;
  std::uint32_t asked_ = 0, left_ = 0, rest_ = 0;
};

/// Tests the points of one call: by the core first, if it drops enough, then by the map the points
/// that are left. The survivors are the same with and without a core.
template <unsigned D>
class Blocks {
 public:
  Blocks(const GaugeTable& t, const GaugeCore* core, std::uint32_t* ids)
      : table_(t), core_(core), core_use_(core != nullptr), ids_(ids) {}

  /// Returns how many points may be added next at most.
  std::uint32_t room() const { return core_use_.rests() ? many : core_block; }

  /// fetch(k) prefetches for each vector of points, except where the core tests them: only the
  /// slower test gains from prefetching.
  template <class Load, class Fetch>
  HWY_INLINE void add(std::uint32_t first, std::uint32_t count, const Load& load,
                      const Fetch& fetch) {
    if (core_use_.taken(count)) {
      const std::uint32_t before = left_.count();
      if (core_->kind == GaugeCore::Kind::round)
        ask_core<GaugeCore::Kind::round>(first, count, load);
      else
        ask_core<GaugeCore::Kind::cut>(first, count, load);
      core_use_.saw(count, left_.count() - before);
      if (left_.count() >= left_.enough) ask_map();
      return;
    }
    if (left_.count() > 0) ask_map();
    kept_ += test_block<D, many>(table_, first, count, ids_ + kept_,
                                 [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR {
      fetch(k);
      load(k, y);
    });
  }

  /// Finishes the points added so far; returns how many are kept.
  std::size_t finish() {
    ask_map();
    return kept_;
  }

 private:
  using Open = OpenPoints<D>;

  template <GaugeCore::Kind kind, class Load>
  HWY_INLINE void ask_core(std::uint32_t first, std::uint32_t count, const Load& load) {
    const CoreTest<D, kind> test(*core_);
    const VU lane = hn::Iota(U(), 0);
    left_.add(
        count, load,
        [&](std::uint32_t k) HWY_ATTR { return hn::Add(hn::Set(U(), first + k), lane); },
        [&](const VF(&y)[D]) HWY_ATTR { return test(y); });
  }

  /// Tests the points that the core left.
  HWY_NOINLINE void ask_map() {
    std::uint32_t kept[Open::most];
    const std::size_t n =
        test_block<D, Open::most>(table_, 0, left_.count(), kept,
                                  [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR { left_.load(k, y); });
    for (std::size_t k = 0; k < n; ++k) ids_[kept_++] = left_.place(kept[k]);
    left_.clear();
  }

  const GaugeTable& table_;
  const GaugeCore* core_;
  CoreUse core_use_;
  Open left_;  ///< by the core
  std::uint32_t* ids_;
  std::size_t kept_ = 0;
};

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
