// Fields of a record that the point-wise and the layered chunks of LAZ code alike: colours, GPS
// times, wave packets. Each turns the field of the last record into that of the next.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "io/formats/laz_models.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {

template <class T>
void store_little_endian(char* to, T value) {
  value = little_endian(value);
  std::memcpy(to, &value, sizeof value);
}

/// Adds to a coordinate, modulo 2^32.
inline void add_to_coordinate(char* at, std::int32_t step) {
  const auto sum = load_little_endian<std::uint32_t>(at) + static_cast<std::uint32_t>(step);
  store_little_endian(at, sum);
}

/// The next number of a field of 16 bits, which is predicted to be the last.
inline void next_half(LazDecoder& decoder, LazIntegers& numbers, char* at, unsigned context = 0) {
  const std::int32_t next = numbers.next(decoder, load_little_endian<std::uint16_t>(at), context);
  store_little_endian(at, static_cast<std::uint16_t>(next));
}

/// Adds a coded step to a byte, modulo 256.
inline void step_byte(LazDecoder& decoder, LazSymbolModel& steps, char& byte) {
  byte = static_cast<char>(static_cast<unsigned char>(byte) + decoder.symbol(steps, 256));
}

/// Red, green and blue of 16 bits: which of the six bytes change, and by how much. Green and blue
/// are predicted to change as red does.
class LazColour {
 public:
  void next(LazDecoder& decoder, char* item) {
    constexpr unsigned not_grey = 64;
    const unsigned changed = decoder.symbol(changed_, 128);
    const auto byte = [&](std::size_t i) { return int{static_cast<unsigned char>(item[i])}; };
    const auto step = [&](std::size_t i, int change) {
      if ((changed >> i & 1) == 0) return 0;
      const int before = byte(i);
      item[i] = static_cast<char>(std::clamp(before + change, 0, 255));
      step_byte(decoder, steps_[i], item[i]);
      return byte(i) - before;
    };
    const int red[] = {step(0, 0), step(1, 0)};
    if ((changed & not_grey) == 0) {
      std::copy_n(item, 2, item + 2);
      std::copy_n(item, 2, item + 4);
      return;
    }
    for (std::size_t half = 0; half < 2; ++half) {
      const int green = step(2 + half, red[half]);
      step(4 + half, (red[half] + green) / 2);
    }
  }

 private:
  LazSymbolModel changed_;
  std::array<LazSymbolModel, 6> steps_;
};

/// GPS times as integers of their bits: multiples of the last step, in up to four sequences that
/// alternate, as those of several scanners.
class LazTime {
 public:
  /// `unchanged`: whether a time can equal the last one;
  /// layered chunks code elsewhere that it does.
  explicit LazTime(bool unchanged) : unchanged_(unchanged ? 1 : 0) {}

  void begin(std::uint64_t time) { at_[0].time = time; }
  std::uint64_t next(LazDecoder& decoder) {
    // After a change of the sequence comes the time itself.
    for (int changes = 0; changes < 2; ++changes) {
      if (at_[now_].step == 0 ? after_no_step(decoder) : after_step(decoder)) return at_[now_].time;
    }
    throw LazDamage{"its GPS times change their sequence twice"};
  }

 private:
  struct Sequence {
    std::uint64_t time = 0;
    std::int32_t step = 0;
    int extremes = 0;  ///< in succession: steps far from the last one
  };

  /// These return whether the time is found.
  bool after_no_step(LazDecoder& decoder) {
    const unsigned code = decoder.symbol(first_codes_, 5 + unchanged_);
    if (code < unchanged_) return true;
    switch (code - unchanged_) {
      case 0:
        at_[now_].step = steps_.next(decoder, 0, 0);
        at_[now_].extremes = 0;
        move(at_[now_].step);
        return true;
      case 1:
        jump(decoder);
        return true;
      default:
        now_ = (now_ + code - unchanged_ - 1) & 3;
        return false;
    }
  }
  bool after_step(LazDecoder& decoder) {
    constexpr unsigned most = 500, least = 510, full = 511;  // multiples 0 to 500, -1 to -10
    unsigned code = decoder.symbol(codes_, 515 + unchanged_);
    if (code >= full) {
      code -= unchanged_;
      if (code < full) return true;
      if (code == full)
        jump(decoder);
      else
        now_ = (now_ + code - full) & 3;
      return code == full;
    }
    Sequence& s = at_[now_];
    const auto multiple = [&](unsigned of) {
      return static_cast<std::int32_t>(of * static_cast<std::uint32_t>(s.step));
    };
    if (code == 1) {
      s.extremes = 0;
      move(steps_.next(decoder, s.step, 1));
    } else if (code == 0) {
      move_far(steps_.next(decoder, 0, 7));
    } else if (code < most) {
      move(steps_.next(decoder, multiple(code), code < 10 ? 2 : 3));
    } else if (code == most) {
      move_far(steps_.next(decoder, multiple(most), 4));
    } else if (code < least) {
      move(steps_.next(decoder, multiple(most - code), 5));
    } else {
      move_far(steps_.next(decoder, multiple(most - code), 6));
    }
    return true;
  }
  void move(std::int32_t step) { at_[now_].time += static_cast<std::uint64_t>(std::int64_t{step}); }
  /// The fourth such step becomes the one of which others are multiples.
  void move_far(std::int32_t step) {
    Sequence& s = at_[now_];
    if (++s.extremes > 3) {
      s.step = step;
      s.extremes = 0;
    }
    move(step);
  }
  /// Begins a sequence in the place of the oldest.
  void jump(LazDecoder& decoder) {
    const auto high = static_cast<std::int32_t>(at_[now_].time >> 32);
    const auto next = static_cast<std::uint32_t>(steps_.next(decoder, high, 8));
    newest_ = now_ = (newest_ + 1) & 3;
    at_[now_] = {std::uint64_t{next} << 32 | decoder.bits(32), 0, 0};
  }

  unsigned unchanged_, now_ = 0, newest_ = 0;
  std::array<Sequence, 4> at_{};
  LazSymbolModel codes_, first_codes_;
  LazIntegers steps_{32, 9};
};

/// 29 bytes: the descriptor's index, the packet's offset and size, the return point, its direction.
class LazWavePacket {
 public:
  void next(LazDecoder& decoder, char* item) {
    item[0] = static_cast<char>(decoder.symbol(index_, 256));
    const auto size = load_little_endian<std::uint32_t>(item + 9);
    auto offset = load_little_endian<std::uint64_t>(item + 1);
    kind_ = decoder.symbol(kinds_[kind_], 4);
    if (kind_ == 1) offset += size;
    if (kind_ == 2) {
      step_ = steps_.next(decoder, step_);
      offset += static_cast<std::uint64_t>(std::int64_t{step_});
    }
    if (kind_ == 3) offset = decoder.wide();
    store_little_endian(item + 1, offset);
    number(decoder, sizes_, item + 9, 0);
    number(decoder, points_, item + 13, 0);
    for (unsigned j = 0; j < 3; ++j) number(decoder, directions_, item + 17 + 4 * j, j);
  }

 private:
  static void number(LazDecoder& decoder, LazIntegers& numbers, char* at, unsigned context) {
    store_little_endian(at, numbers.next(decoder, load_little_endian<std::int32_t>(at), context));
  }

  LazSymbolModel index_;
  std::array<LazSymbolModel, 4> kinds_;
  unsigned kind_ = 0;
  std::int32_t step_ = 0;
  LazIntegers steps_{32}, sizes_{32}, points_{32}, directions_{32, 3};
};

}  // namespace cullhull::internal
