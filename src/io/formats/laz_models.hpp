// The entropy coder of LAZ files: an adaptive arithmetic decoder, its models, and numbers coded as
// the difference from a prediction. Facts of the format are from the LAZ specification 1.4 R1 and
// M. Isenburg, "LASzip: lossless compression of LiDAR data", 2013.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace cullhull::internal {

/// Thrown where no encoder can have written the bytes.
struct LazDamage {
  const char* what;
};

/// Probability of a bit, in 1/2^13.
class LazBitModel {
 public:
  static constexpr unsigned shift = 13;
  std::uint32_t zero() const { return zero_; }
  void count(bool bit) {
    zeros_ += bit ? 0U : 1U;
    if (--until_update_ == 0) update();
  }

 private:
  void update() {
    constexpr std::uint32_t most = 1U << shift, longest = 64;
    if ((total_ += cycle_) > most) {
      total_ = (total_ + 1) >> 1;
      zeros_ = (zeros_ + 1) >> 1;
      if (zeros_ == total_) ++total_;
    }
    zero_ = zeros_ * (0x80000000U / total_) >> (31 - shift);
    cycle_ = std::min(5 * cycle_ >> 2, longest);
    until_update_ = cycle_;
  }

  std::uint32_t zero_ = 1U << (shift - 1), zeros_ = 1, total_ = 2, cycle_ = 4, until_update_ = 4;
};

/// Probabilities of symbols, in 1/2^15. The tables are made at the first use: of the thousands of
/// models of a chunk few are used.
class LazSymbolModel {
 public:
  static constexpr unsigned shift = 15;

  void ready(unsigned symbols) {
    if (store_ == nullptr) start(symbols);
  }
  unsigned last() const { return symbols_ - 1U; }
  std::uint32_t begin_of(unsigned symbol) const { return store_[symbol]; }

  /// The symbol whose share contains `value`, which is below 2^15 + 64.
  unsigned find(std::uint32_t value) const {
    unsigned low = 0, high = symbols_;
    if (table_ != nullptr) {
      const std::uint16_t* const t = table_ + (value >> table_shift_);
      low = t[0];
      high = t[1] + 1U;
    }
    while (high > low + 1) {
      const unsigned middle = (low + high) >> 1;
      (store_[middle] > value ? high : low) = middle;
    }
    return low;
  }
  void count(unsigned symbol) {
    ++counts_[symbol];
    if (--until_update_ == 0) update();
  }

 private:
  void start(unsigned symbols) {
    constexpr unsigned without_table = 16;
    unsigned bits = 0;
    if (symbols > without_table) {
      bits = 3;
      while (symbols > 1U << (bits + 2)) ++bits;
    }
    const std::size_t table_size = bits == 0 ? 0 : (std::size_t{1} << bits) + 2;
    store_ = std::make_unique<std::uint16_t[]>(2 * symbols + table_size);
    counts_ = store_.get() + symbols;
    table_ = bits == 0 ? nullptr : counts_ + symbols;
    table_shift_ = static_cast<std::uint8_t>(shift - bits);
    symbols_ = static_cast<std::uint16_t>(symbols);
    std::fill_n(counts_, symbols, std::uint16_t{1});
    cycle_ = symbols;
    update();
    cycle_ = until_update_ = (symbols + 6) >> 1;
  }

  void update() {
    if ((total_ += cycle_) > 1U << shift) {
      total_ = 0;
      for (unsigned i = 0; i < symbols_; ++i)
        total_ += counts_[i] = static_cast<std::uint16_t>((counts_[i] + 1U) >> 1);
    }
    const std::uint32_t scale = 0x80000000U / total_;
    std::uint32_t sum = 0;
    for (unsigned i = 0; i < symbols_; ++i) {
      store_[i] = static_cast<std::uint16_t>(scale * sum >> (31 - shift));
      sum += counts_[i];
    }
    if (table_ != nullptr) fill_table();
    cycle_ = std::min(5 * cycle_ >> 2, (symbols_ + 6U) << 3);
    until_update_ = cycle_;
  }

  /// Entry t: the last symbol that begins at or before t steps of the table, less one step.
  void fill_table() {
    const unsigned entries = (1U << (shift - table_shift_)) + 2;
    unsigned filled = 1;
    table_[0] = 0;
    for (unsigned i = 1; i < symbols_; ++i)
      for (const unsigned step = store_[i] >> table_shift_; filled <= step; ++filled)
        table_[filled] = static_cast<std::uint16_t>(i - 1);
    for (; filled < entries; ++filled) table_[filled] = static_cast<std::uint16_t>(symbols_ - 1);
  }

  std::unique_ptr<std::uint16_t[]> store_;  ///< where each symbol begins, counts, table
  std::uint16_t *counts_ = nullptr, *table_ = nullptr;
  std::uint32_t total_ = 0, cycle_ = 0, until_update_ = 0;
  std::uint16_t symbols_ = 0;
  std::uint8_t table_shift_ = 0;
};

/// Decodes bytes [begin, end), and never reads beyond. `value_ < length_` always holds, so that
/// searches stay within their models whatever the bytes are.
class LazDecoder {
 public:
  LazDecoder() = default;
  LazDecoder(const char* begin, const char* end) : next_(begin), end_(end) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | byte();
    if (value_ >= length_) throw LazDamage{"its first bytes are no arithmetic code"};
  }
  bool at_end() const { return next_ == end_; }

  bool bit(LazBitModel& model) {
    const std::uint32_t split = model.zero() * (length_ >> LazBitModel::shift);
    const bool bit = value_ >= split;
    if (bit) {
      value_ -= split;
      length_ -= split;
    } else {
      length_ = split;
    }
    refill();
    model.count(bit);
    return bit;
  }
  unsigned symbol(LazSymbolModel& model, unsigned symbols) {
    model.ready(symbols);
    const std::uint32_t unit = length_ >> LazSymbolModel::shift;
    const unsigned found = model.find(value_ / unit);
    const std::uint32_t begin = model.begin_of(found) * unit;
    const std::uint32_t end = found == model.last() ? length_ : model.begin_of(found + 1) * unit;
    value_ -= begin;
    length_ = end - begin;
    refill();
    model.count(found);
    return found;
  }
  /// Bits that are all equally likely, at most 32.
  std::uint32_t bits(unsigned count) {
    constexpr unsigned most = 19, low = 16;
    if (count > most) {
      const std::uint32_t first = bits(low);
      return bits(count - low) << low | first;
    }
    const std::uint32_t unit = length_ >> count, found = value_ / unit;
    if (found >> count != 0) throw LazDamage{"it has bits that no encoder writes"};
    value_ -= found * unit;
    length_ = unit;
    refill();
    return found;
  }
  std::uint64_t wide() {
    const std::uint64_t low = bits(32);
    return std::uint64_t{bits(32)} << 32 | low;
  }

 private:
  std::uint32_t byte() {
    if (next_ == end_) throw LazDamage{"its compressed bytes end too early"};
    return static_cast<unsigned char>(*next_++);
  }
  void refill() {
    constexpr std::uint32_t least = 1U << 24;
    while (length_ < least) {
      value_ = value_ << 8 | byte();
      length_ <<= 8;
    }
  }

  const char *next_ = nullptr, *end_ = nullptr;
  std::uint32_t value_ = 0, length_ = ~std::uint32_t{0};
};

/// Integers of up to 32 bits as corrections of a prediction: first the number of bits of the
/// correction, by a model of its context, then the correction among those of so many bits.
class LazIntegers {
 public:
  explicit LazIntegers(unsigned bits, unsigned contexts = 1) : bits_(bits), lengths_(contexts) {}

  std::int32_t next(LazDecoder& decoder, std::int32_t predicted, unsigned context = 0) {
    const auto sum = static_cast<std::uint32_t>(predicted) + correction(decoder, context);
    return static_cast<std::int32_t>(bits_ == 32 ? sum : sum & ((1U << bits_) - 1));
  }
  /// The bits of the last correction.
  unsigned length() const { return length_; }

 private:
  std::uint32_t correction(LazDecoder& decoder, unsigned context) {
    length_ = decoder.symbol(lengths_[context], bits_ + 1);
    if (length_ == 0) return decoder.bit(smallest_) ? 1 : 0;
    if (length_ == 32) return 0x80000000U;
    constexpr unsigned modelled = 8;  // bits; those below are equally likely
    std::uint32_t c = decoder.symbol(corrections_[length_], 1U << std::min(length_, modelled));
    if (length_ > modelled) {
      const unsigned low = length_ - modelled;
      c = c << low | decoder.bits(low);
    }
    return c >= 1U << (length_ - 1) ? c + 1 : c - ((1U << length_) - 1);
  }

  unsigned bits_, length_ = 0;
  LazBitModel smallest_;
  std::vector<LazSymbolModel> lengths_;
  std::array<LazSymbolModel, 32> corrections_;
};

/// The median of the last five numbers, nearly: a new one displaces the greatest of the five or,
/// after one above the median, the least.
class LazMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }
  void add(std::int32_t v) {
    const std::int32_t median = sorted_[2];
    const std::size_t first = drop_greatest_ ? 0 : 1;
    std::array<std::int32_t, 4> kept;
    std::copy_n(sorted_.begin() + first, 4, kept.begin());
    sorted_[0] = std::min(v, kept[0]);
    for (std::size_t i = 1; i < 4; ++i) sorted_[i] = std::min(std::max(v, kept[i - 1]), kept[i]);
    sorted_[4] = std::max(v, kept[3]);
    drop_greatest_ = drop_greatest_ ? v < median : v <= median;
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool drop_greatest_ = true;
};

}  // namespace cullhull::internal
