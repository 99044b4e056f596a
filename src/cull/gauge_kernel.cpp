// The GaugeMap's SIMD kernel, compiled once per instruction set and chosen at run time.
//
// A block of points is translated, scaled and rounded to f32 into a buffer that stays in L1 (the
// only step that knows the input's layout and type), then tested a vector at a time. Every target
// performs the same IEEE operations per point, so all of them keep the same points. Products are
// fused only where the product is exact, or where the map has the last word.
//
// Blocks are short, so that the processor reads the next while it tests one: that is as fast as
// memory allows, and asking for lines ahead of time is slower.

#include "cull/gauge_shortcuts.hpp"
#include "cull/gauge_table.hpp"

// Vectors are kept in arrays below, which sizeless types do not allow: NEON serves those machines.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cull/gauge_kernel.cpp"
#include <hwy/foreach_target.h>
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

constexpr std::uint32_t block_size = 64;
static_assert(gauge_chunk % block_size == 0);

// 2^23: adding it to an integer below 2^23 leaves that integer in the low bits of the float.
constexpr float integer_shift = 8388608.0F;
constexpr std::uint32_t integer_shift_bits = 0x4B000000U;
// Below this the point is the centre for all purposes; keeps the reciprocal finite.
constexpr float tiny = 0x1p-100F;

/// Descending by key; carries the payload along.
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

/// Where the ray from the centre through y meets the cube.
template <unsigned D>
struct Direction {
  VF norm;          // |y|_inf
  VF inverse;       // of it, finite
  VF face;          // number of the cube's face, an integer
  VF other[D - 1];  // coordinates on that face's grid axes, times norm
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

/// The bound of g(y) that the map gives; NaN or infinity where a coordinate is.
template <unsigned D>
HWY_INLINE VF gauge_bound(const GaugeTable& t, const float* HWY_RESTRICT nodes, const VF (&y)[D]) {
  const F f;
  const I i;
  const U u;
  const Direction<D> direction = direction_of<D>(y);

  // Cell and fractions. half_cells is shrunk so that 0 <= place < cells for every finite point.
  const VF half_cells = hn::Set(f, t.half_cells);
  const VF middle = hn::Set(f, t.middle);
  VF fraction[D - 1];
  VI step[D - 1];
  VF corner = hn::MulAdd(direction.face, hn::Set(f, t.face_stride), hn::Set(f, integer_shift));
  for (unsigned k = 0; k < D - 1; ++k) {
    const VF place =
        hn::Add(hn::Mul(hn::Mul(direction.other[k], direction.inverse), half_cells), middle);
    const VF cell = hn::Floor(place);
    fraction[k] = hn::Sub(place, cell);
    corner = hn::MulAdd(cell, hn::Set(f, t.stride[k]), corner);  // integers: exact
    step[k] = hn::Set(i, static_cast<std::int32_t>(t.stride[k]));
  }
  // For a point with a NaN the corner may be anything: as an unsigned minimum it stays a node.
  const VU corner_node = hn::Min(hn::Sub(hn::BitCast(u, corner), hn::Set(u, integer_shift_bits)),
                                 hn::Set(u, t.last_corner));

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

/// Whether points are in the core: false where a coordinate is no number.
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
      // A NaN may be lost in the extremes but not in the sum.
      return hn::And(hn::Lt(most, radius_[0]),
                     hn::And(hn::Lt(hn::Sub(sum, least), radius_[1]), hn::Lt(sum, radius_[2])));
    }
  }

 private:
  VF weight_[D];
  VF radius_[GaugeCore::norms];
};

/// The cell of the levels that y is in.
HWY_INLINE VU level_cell(const GaugeLevels& l, const Direction<3>& direction) {
  const F f;
  const U u;
  const VF half_cells = hn::Set(f, l.half_cells), middle = hn::Set(f, l.middle);
  const auto cell = [&](unsigned k) HWY_ATTR {
    return hn::Floor(
        hn::Add(hn::Mul(hn::Mul(direction.other[k], direction.inverse), half_cells), middle));
  };
  // Integers below 2^23: exact.
  const VF number = hn::MulAdd(direction.face, hn::Set(f, l.face_stride),
                               hn::MulAdd(cell(1), hn::Set(f, static_cast<float>(l.cells)),
                                          hn::Add(cell(0), hn::Set(f, integer_shift))));
  return hn::Min(hn::Sub(hn::BitCast(u, number), hn::Set(u, integer_shift_bits)),
                 hn::Set(u, l.last));
}

/// Bit k of the little-endian words: point k survives, k < most.
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
      std::uint64_t word;
      std::memcpy(&word, bits_ + k / 8, 8);
      if (count - k < 64) word &= (std::uint64_t{1} << (count - k)) - 1;
      for (; word != 0; word &= word - 1)
        ids[kept++] = first + k + static_cast<std::uint32_t>(std::countr_zero(word));
    }
    return kept;
  }

 private:
  static_assert(std::endian::native == std::endian::little && most % 64 == 0);
  alignas(8) std::uint8_t bits_[most / 8] = {};
};

/// Lists the survivors of `count` points; `load(i, y)` fetches the vector of points from i on.
/// Bits are listed after the block, not a vector at a time: a branch on a fresh comparison, when
/// mispredicted, costs the latency of the whole chain, and compressed stores are slow before
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

/// Points that wait for the next test: columns, and where they are in the chunk.
template <unsigned D>
class OpenPoints {
 public:
  static constexpr std::uint32_t enough = 256;  ///< to go on with them
  static constexpr std::uint32_t most = 2 * enough;

  std::uint32_t count() const { return count_; }
  std::uint32_t place(std::uint32_t k) const { return places_[k]; }
  HWY_INLINE VU places(std::uint32_t k) const { return hn::LoadU(U(), places_ + k); }
  HWY_INLINE void load(std::uint32_t k, VF (&y)[D]) const {
    for (unsigned j = 0; j < D; ++j) y[j] = hn::LoadU(F(), columns_[j] + k);
  }
  void clear() { count_ = 0; }

  /// Of `count` points, at most `enough` and no more than there is room for, those that
  /// dropped(k, y) does not hold for, k being the first of a vector y of them.
  template <class Load, class Places, class Dropped>
  HWY_INLINE void add(std::uint32_t count, const Load& load, const Places& places,
                      const Dropped& dropped) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(F()));
    std::uint32_t at = count_;
    for (std::uint32_t k = 0; k < count; k += lanes) {
      VF y[D];
      load(k, y);
      MF stays = hn::Not(dropped(k, y));
      if (count - k < lanes) stays = hn::And(stays, hn::FirstN(F(), count - k));
      // Not CompressStore: some processors take a hundred cycles for one.
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

/// Whether a shortcut is taken: one that drops too little is left out for a while.
class Shortcut {
 public:
  explicit Shortcut(bool there) : there_(there) {}
  /// Of so many points.
  bool taken(std::uint32_t points) {
    if (!there_ || rest_ == 0) return there_;
    rest_ -= std::min(rest_, points);
    return false;
  }
  /// It was asked about so many points and left so many of them.
  void saw(std::uint32_t asked, std::uint32_t left, std::uint32_t most_of_four) {
    asked_ += asked;
    left_ += left;
    if (asked_ < OpenPoints<2>::enough) return;
    if (left_ > asked_ / 4 * most_of_four) rest_ = 16 * OpenPoints<2>::enough;
    asked_ = left_ = 0;
  }

 private:
  bool there_;
  std::uint32_t asked_ = 0, left_ = 0, rest_ = 0;
};

/// The points of one call: shortcuts first where those drop enough, then the map for the points
/// they leave, so that survivors are the same.
template <unsigned D>
class Blocks {
 public:
  Blocks(const GaugeTable& t, const GaugeShortcuts* shortcuts, std::uint32_t* ids)
      : table_(t),
        shortcuts_(shortcuts),
        core_(shortcuts != nullptr && shortcuts->core),
        levels_(D == 3 && shortcuts != nullptr && shortcuts->levels),
        ids_(ids) {}

  template <class Load>
  HWY_INLINE void add(std::uint32_t first, std::uint32_t count, const Load& load) {
    const VU lane = hn::Iota(U(), 0);
    const auto places = [&](std::uint32_t k)
                            HWY_ATTR { return hn::Add(hn::Set(U(), first + k), lane); };
    if (core_.taken(count)) {
      const std::uint32_t before = for_levels_.count();
      if (shortcuts_->core->kind == GaugeCore::Kind::round)
        ask_core<GaugeCore::Kind::round>(count, load, places);
      else
        ask_core<GaugeCore::Kind::cut>(count, load, places);
      core_.saw(count, for_levels_.count() - before, 3);
      if (for_levels_.count() >= for_levels_.enough) pass_on();
      return;
    }
    if (for_levels_.count() > 0) pass_on();
    if constexpr (D == 3) {
      if (levels_.taken(count)) {
        ask_levels(count, load, places);
        return;
      }
    }
    if (for_map_.count() > 0) ask_map(for_map_);
    kept_ += test_block<D, block_size>(table_, first, count, ids_ + kept_, load);
  }

  /// All points so far; returns how many are kept.
  std::size_t finish() {
    pass_on();
    ask_map(for_map_);
    return kept_;
  }

 private:
  using Open = OpenPoints<D>;

  template <GaugeCore::Kind kind, class Load, class Places>
  HWY_INLINE void ask_core(std::uint32_t count, const Load& load, const Places& places) {
    const CoreTest<D, kind> test(*shortcuts_->core);
    for_levels_.add(count, load, places,
                    [&](std::uint32_t, const VF(&y)[D]) HWY_ATTR { return test(y); });
  }

  /// What the core has left.
  HWY_NOINLINE void pass_on() {
    if constexpr (D == 3) {
      if (levels_.taken(for_levels_.count())) {
        for (std::uint32_t k = 0; k < for_levels_.count(); k += block_size)
          ask_levels(
              std::min(block_size, for_levels_.count() - k),
              [&](std::uint32_t i, VF(&y)[D]) HWY_ATTR { for_levels_.load(k + i, y); },
              [&](std::uint32_t i) HWY_ATTR { return for_levels_.places(k + i); });
        for_levels_.clear();
        return;
      }
    }
    ask_map(for_map_);
    ask_map(for_levels_);
  }

  /// Of at most block_size points; lanes beyond may hold anything.
  template <class Load, class Places>
  HWY_INLINE void ask_levels(std::uint32_t count, const Load& load, const Places& places) {
    const F f;
    const U u;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
    HWY_ALIGN std::uint32_t cells[block_size];
    HWY_ALIGN float norms[block_size];
    std::uint8_t found[block_size + hn::MaxLanes(F())];
    const GaugeLevels& levels = *shortcuts_->levels;
    for (std::uint32_t k = 0; k < count; k += lanes) {
      VF y[3];
      load(k, y);
      const Direction<3> direction = direction_of<3>(y);
      hn::Store(level_cell(levels, direction), u, cells + k);
      hn::Store(direction.norm, f, norms + k);
    }
    // One by one: gathering bytes costs more than the rest of the test.
    const std::uint8_t* HWY_RESTRICT of_cell = levels.of_cell.data();
    for (std::uint32_t k = 0; k < count; ++k) found[k] = of_cell[cells[k]];
    const VF unit = hn::Set(f, levels.unit);
    const hn::Rebind<std::uint8_t, F> bytes;
    const std::uint32_t before = for_map_.count();
    for_map_.add(count, load, places, [&](std::uint32_t k, const VF(&)[D]) HWY_ATTR {
      const VU level = hn::PromoteTo(u, hn::LoadU(bytes, found + k));
      // False where a coordinate is no number.
      return hn::Lt(hn::Load(f, norms + k),
                    hn::Mul(hn::ConvertTo(f, hn::BitCast(I(), level)), unit));
    });
    levels_.saw(count, for_map_.count() - before, 2);
    if (for_map_.count() >= for_map_.enough) ask_map(for_map_);
  }

  HWY_NOINLINE void ask_map(Open& open) {
    std::uint32_t kept[Open::most];
    const std::size_t n =
        test_block<D, Open::most>(table_, 0, open.count(), kept,
                                  [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR { open.load(k, y); });
    for (std::size_t k = 0; k < n; ++k) ids_[kept_++] = open.place(kept[k]);
    open.clear();
  }

  const GaugeTable& table_;
  const GaugeShortcuts* shortcuts_;
  Shortcut core_, levels_;
  Open for_levels_, for_map_;
  std::uint32_t* ids_;
  std::size_t kept_ = 0;
};

// ---------------------------------------------------------------- packed rows of f32 or f64

/// scale and offset of the elements of D consecutive vectors of rows.
template <unsigned D, class T>
struct RowPattern {
  static constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<T>());
  HWY_ALIGN T scale[D * lanes];
  HWY_ALIGN T offset[D * lanes];
  RowPattern(const T* s, const T* o) {
    for (std::size_t e = 0; e < D * lanes; ++e) scale[e] = s[e % D], offset[e] = o[e % D];
  }
};

HWY_INLINE void store_f32(hn::ScalableTag<float> d, hn::Vec<hn::ScalableTag<float>> v, float* to) {
  hn::StoreU(v, d, to);
}
#if HWY_HAVE_FLOAT64
HWY_INLINE void store_f32(hn::ScalableTag<double> d, hn::Vec<hn::ScalableTag<double>> v,
                          float* to) {
  const hn::Rebind<float, decltype(d)> half;
  hn::StoreU(hn::DemoteTo(half, v), half, to);
}
#endif

/// `count` rows from `from` to `to`, translated, scaled, rounded to f32, zero-padded.
template <unsigned D, class T>
HWY_INLINE void convert_rows(const RowPattern<D, T>& pattern, const T* HWY_RESTRICT from,
                             std::uint32_t count, float* HWY_RESTRICT to) {
  std::size_t done = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  for (; done + lanes <= count; done += lanes) {
    for (unsigned k = 0; k < D; ++k) {
      const auto x = hn::LoadU(d, from + done * D + k * lanes);
      // The product is exact, so fusing it changes nothing.
      store_f32(d,
                hn::MulSub(x, hn::Load(d, pattern.scale + k * lanes),
                           hn::Load(d, pattern.offset + k * lanes)),
                to + done * D + k * lanes);
    }
  }
#endif
  for (std::size_t e = done * D; e < std::size_t{count} * D; ++e)
    to[e] = static_cast<float>(from[e] * pattern.scale[e % D] - pattern.offset[e % D]);
  const std::size_t padded = (count + hn::Lanes(F()) - 1) / hn::Lanes(F()) * hn::Lanes(F());
  std::fill(to + std::size_t{count} * D, to + padded * D, 0.0F);
}

template <unsigned D>
HWY_INLINE void load_rows(const float* HWY_RESTRICT rows, VF (&y)[D]) {
  const F f;
  if constexpr (D == 2) {
    hn::LoadInterleaved2(f, rows, y[0], y[1]);
  } else if constexpr (D == 3) {
    hn::LoadInterleaved3(f, rows, y[0], y[1], y[2]);
  } else if constexpr (D == 4) {
    hn::LoadInterleaved4(f, rows, y[0], y[1], y[2], y[3]);
  } else {
    const I i;
    const VI row = hn::Mul(hn::Iota(i, 0), hn::Set(i, static_cast<std::int32_t>(D)));
    for (unsigned k = 0; k < D; ++k) y[k] = hn::GatherIndex(f, rows + k, row);
  }
}

template <unsigned D, class T>
std::size_t survivors_rows(const GaugeTable& t, const GaugeShortcuts* shortcuts, const T* data,
                           const T* scale, const T* offset, std::uint32_t count,
                           std::uint32_t* ids) {
  const RowPattern<D, T> pattern(scale, offset);
  Blocks<D> blocks(t, shortcuts, ids);
  HWY_ALIGN float rows[(block_size + hn::MaxLanes(F())) * D];
  for (std::uint32_t b = 0; b < count; b += block_size) {
    const std::uint32_t n = std::min(block_size, count - b);
    convert_rows<D, T>(pattern, data + std::size_t{b} * D, n, rows);
    blocks.add(b, n, [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR {
      load_rows<D>(rows + std::size_t{k} * D, y);
    });
  }
  return blocks.finish();
}

// ---------------------------------------------------------------- any layout, any scalar

/// One coordinate of `count` points; computes in C, which holds T exactly.
template <class C, class T>
void convert_axis(const std::byte* from, std::ptrdiff_t stride, std::uint32_t count, C scale,
                  C offset, float* HWY_RESTRICT to) {
  const auto convert = [&](const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);  // any alignment
    return static_cast<float>(static_cast<C>(value) * scale - offset);
  };
  if (stride == static_cast<std::ptrdiff_t>(sizeof(T))) {
    for (std::uint32_t k = 0; k < count; ++k) to[k] = convert(from + k * sizeof(T));
  } else {
    for (std::uint32_t k = 0; k < count; ++k)
      to[k] = convert(from + static_cast<std::ptrdiff_t>(k) * stride);
  }
}

void convert_axis(const GaugeTable& t, const PointView& v, std::uint64_t first, std::uint32_t count,
                  unsigned axis, float* to) {
  const std::byte* p = v.address(first, axis);
  const double s = t.scale[axis];
  const double o = t.offset[axis];
  switch (v.scalar) {
    case ScalarType::f64:
      return convert_axis<double, double>(p, v.point_stride, count, s, o, to);
    case ScalarType::f32:
      if (t.single_precision)
        return convert_axis<float, float>(p, v.point_stride, count, t.scale_f32[axis],
                                          t.offset_f32[axis], to);
      return convert_axis<double, float>(p, v.point_stride, count, s, o, to);
    case ScalarType::i8:
      return convert_axis<double, std::int8_t>(p, v.point_stride, count, s, o, to);
    case ScalarType::u8:
      return convert_axis<double, std::uint8_t>(p, v.point_stride, count, s, o, to);
    case ScalarType::i16:
      return convert_axis<double, std::int16_t>(p, v.point_stride, count, s, o, to);
    case ScalarType::u16:
      return convert_axis<double, std::uint16_t>(p, v.point_stride, count, s, o, to);
    case ScalarType::i32:
      return convert_axis<double, std::int32_t>(p, v.point_stride, count, s, o, to);
    case ScalarType::u32:
      return convert_axis<double, std::uint32_t>(p, v.point_stride, count, s, o, to);
  }
}

template <unsigned D>
std::size_t survivors_any(const GaugeTable& t, const GaugeShortcuts* shortcuts, const PointView& v,
                          std::uint64_t begin, std::uint32_t count, std::uint32_t* ids) {
  Blocks<D> blocks(t, shortcuts, ids);
  constexpr std::size_t row = block_size + hn::MaxLanes(F());
  HWY_ALIGN float columns[D * row];
  for (std::uint32_t b = 0; b < count; b += block_size) {
    const std::uint32_t n = std::min(block_size, count - b);
    for (unsigned k = 0; k < D; ++k) {
      float* column = columns + k * row;
      convert_axis(t, v, begin + b, n, k, column);
      std::fill(column + n, column + n + hn::Lanes(F()), 0.0F);
    }
    blocks.add(b, n, [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR {
      for (unsigned j = 0; j < D; ++j) y[j] = hn::LoadU(F(), columns + j * row + k);
    });
  }
  return blocks.finish();
}

template <unsigned D>
std::size_t survivors_in(const GaugeTable& t, const GaugeShortcuts* shortcuts, const PointView& v,
                         std::uint64_t begin, std::uint32_t count, std::uint32_t* ids) {
  const std::byte* p = v.address(begin, 0);
  const auto aligned = [&](std::size_t a) { return reinterpret_cast<std::uintptr_t>(p) % a == 0; };
  if (v.packed_rows() && v.scalar == ScalarType::f64 && aligned(alignof(double)))
    return survivors_rows<D, double>(t, shortcuts, reinterpret_cast<const double*>(p), t.scale,
                                     t.offset, count, ids);
  if (v.packed_rows() && v.scalar == ScalarType::f32 && aligned(alignof(float)) &&
      t.single_precision)
    return survivors_rows<D, float>(t, shortcuts, reinterpret_cast<const float*>(p), t.scale_f32,
                                    t.offset_f32, count, ids);
  return survivors_any<D>(t, shortcuts, v, begin, count, ids);
}

}  // namespace

std::size_t survivors(const GaugeTable& t, const GaugeShortcuts* shortcuts, const PointView& v,
                      std::uint64_t begin, std::uint64_t end, std::uint32_t* ids) {
  const auto count = static_cast<std::uint32_t>(end - begin);
  switch (t.dimension) {
    case 2:
      return survivors_in<2>(t, shortcuts, v, begin, count, ids);
    case 3:
      return survivors_in<3>(t, shortcuts, v, begin, count, ids);
    case 4:
      return survivors_in<4>(t, shortcuts, v, begin, count, ids);
    case 5:
      return survivors_in<5>(t, shortcuts, v, begin, count, ids);
    default:
      return survivors_in<6>(t, shortcuts, v, begin, count, ids);
  }
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(survivors);

std::size_t gauge_survivors(const GaugeTable& table, const PointView& points, std::uint64_t begin,
                            std::uint64_t end, std::uint32_t* ids,
                            const GaugeShortcuts* shortcuts) {
  return HWY_DYNAMIC_DISPATCH(survivors)(table, shortcuts, points, begin, end, ids);
}

}  // namespace cullhull::internal
#endif
