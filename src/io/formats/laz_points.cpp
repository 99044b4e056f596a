// Point-wise chunks of LAZ: one arithmetic code, record after record; the point formats 0 to 5.
#include <string_view>

#include "io/formats/laz.hpp"
#include "io/formats/laz_fields.hpp"

namespace cullhull::internal {
namespace {

/// A part of the record.
class Item {
 public:
  Item() = default;
  Item(const Item&) = delete;
  Item& operator=(const Item&) = delete;
  virtual ~Item() = default;
  virtual void begin(const char*) {}
  /// Turns the last record's part into the next one's.
  virtual void next(LazDecoder& decoder, char* item) = 0;
};

/// The bits of byte 14.
unsigned return_number(unsigned bits) { return bits & 7; }
unsigned number_of_returns(unsigned bits) { return bits >> 3 & 7; }

/// What both versions of POINT10 code alike.
class BasicPoint : public Item {
 protected:
  static unsigned byte(char c) { return static_cast<unsigned char>(c); }
  static void replace(LazDecoder& decoder, std::array<LazSymbolModel, 256>& models, char& byte) {
    byte = static_cast<char>(decoder.symbol(models[static_cast<unsigned char>(byte)], 256));
  }

  LazSymbolModel changed_;
  std::array<LazSymbolModel, 256> bits_, classes_, users_;
  LazIntegers sources_{16};
};

class Point1 : public BasicPoint {
 public:
  void next(LazDecoder& decoder, char* item) override {
    constexpr unsigned most = 19;
    const std::int32_t x = dx_.next(decoder, median(0));
    unsigned length = dx_.length();
    const std::int32_t y = dy_.next(decoder, median(1), std::min(length, most));
    length = (length + dy_.length()) / 2;
    add_to_coordinate(item, x);
    add_to_coordinate(item + 4, y);
    const auto z = load_little_endian<std::int32_t>(item + 8);
    store_little_endian(item + 8, dz_.next(decoder, z, std::min(length, most)));
    const unsigned changed = decoder.symbol(changed_, 64);
    if ((changed & 32) != 0) next_half(decoder, intensities_, item + 12);
    if ((changed & 16) != 0) replace(decoder, bits_, item[14]);
    if ((changed & 8) != 0) replace(decoder, classes_, item[15]);
    if ((changed & 4) != 0)
      item[16] = static_cast<char>(angles_.next(decoder, item[16], length < 3 ? 1 : 0));
    if ((changed & 2) != 0) replace(decoder, users_, item[17]);
    if ((changed & 1) != 0) next_half(decoder, sources_, item + 18);
    steps_[0][turn_] = x;
    steps_[1][turn_] = y;
    turn_ = (turn_ + 1) % 3;
  }

 private:
  /// Of the last three steps.
  std::int32_t median(std::size_t axis) const {
    const auto& [a, b, c] = steps_[axis];
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  }

  LazIntegers dx_{32}, dy_{32, 20}, dz_{32, 20}, intensities_{16}, angles_{8, 2};
  std::array<std::array<std::int32_t, 3>, 2> steps_{};
  std::size_t turn_ = 0;
};

class Point2 : public BasicPoint {
 public:
  void next(LazDecoder& decoder, char* item) override {
    const unsigned changed = decoder.symbol(changed_, 64);
    if ((changed & 32) != 0) replace(decoder, bits_, item[14]);
    const unsigned bits = byte(item[14]);
    const unsigned r = return_number(bits), n = number_of_returns(bits);
    const unsigned kind = kind_of_return(n, r);
    if ((changed & 16) != 0)
      intensity_[kind] = static_cast<std::uint16_t>(
          intensities_.next(decoder, intensity_[kind], std::min(kind, 3U)));
    store_little_endian(item + 12, intensity_[kind]);
    if ((changed & 8) != 0) replace(decoder, classes_, item[15]);
    if ((changed & 4) != 0) step_byte(decoder, angles_[bits >> 6 & 1], item[16]);
    if ((changed & 2) != 0) replace(decoder, users_, item[17]);
    if ((changed & 1) != 0) next_half(decoder, sources_, item + 18);
    coordinates(decoder, item, kind, n == 1 ? 1 : 0, n > r ? n - r : r - n);
  }

 private:
  /// A number from 0 to 15 of return r of n; single, first and last ones have numbers of their own.
  static unsigned kind_of_return(unsigned n, unsigned r) {
    constexpr std::string_view kinds[] = {"FEDCBA98", "E0136AA9", "D1247BBA", "C3458CCB",
                                          "B6789DDC", "AABCDEED", "9ABCDEFE", "89ABCDEF"};
    const char kind = kinds[n][r];
    return static_cast<unsigned>(kind <= '9' ? kind - '0' : kind - 'A' + 10);
  }
  /// `level`: how many returns are below.
  void coordinates(LazDecoder& decoder, char* item, unsigned kind, unsigned single,
                   unsigned level) {
    const std::int32_t x = dx_.next(decoder, x_[kind].get(), single);
    x_[kind].add(x);
    const unsigned length = dx_.length();
    const std::int32_t y =
        dy_.next(decoder, y_[kind].get(), single + (std::min(length, 20U) & ~1U));
    y_[kind].add(y);
    const unsigned mean = (length + dy_.length()) / 2;
    height_[level] = z_.next(decoder, height_[level], single + (std::min(mean, 18U) & ~1U));
    add_to_coordinate(item, x);
    add_to_coordinate(item + 4, y);
    store_little_endian(item + 8, height_[level]);
  }

  LazIntegers dx_{32, 2}, dy_{32, 22}, z_{32, 20}, intensities_{16, 4};
  std::array<LazSymbolModel, 2> angles_;
  std::array<LazMedian, 16> x_, y_;
  std::array<std::uint16_t, 16> intensity_{};
  std::array<std::int32_t, 8> height_{};
};

/// GPS times of version 1: multiples of the last step, in one sequence.
class Time1 : public Item {
 public:
  void begin(const char* item) override { time_ = load_little_endian<std::uint64_t>(item); }
  void next(LazDecoder& decoder, char* item) override {
    constexpr unsigned most = 509, unchanged = 511;
    if (step_ == 0) {
      const unsigned code = decoder.symbol(first_codes_, 3);
      if (code == 1) move(step_ = steps_.next(decoder, 0, 0));
      if (code == 2) time_ = decoder.wide();
    } else if (const unsigned code = decoder.symbol(codes_, 512); code > most) {
      if (code < unchanged) time_ = decoder.wide();
    } else if (code == 1) {
      step_ = steps_.next(decoder, step_, 1);
      extremes_ = 0;
      move(step_);
    } else {
      const auto scaled = code * static_cast<std::uint32_t>(step_);
      const std::int32_t guess = code == 0 ? step_ / 4 : static_cast<std::int32_t>(scaled);
      const std::int32_t step = steps_.next(decoder, guess,
                                            code == 0   ? 2
                                            : code < 10 ? 3
                                            : code < 50 ? 4
                                                        : 5);
      if ((code == 0 || code == most) && ++extremes_ > 3) {
        step_ = step;
        extremes_ = 0;
      }
      move(step);
    }
    store_little_endian(item, time_);
  }

 private:
  void move(std::int32_t step) { time_ += static_cast<std::uint64_t>(std::int64_t{step}); }

  LazSymbolModel codes_, first_codes_;
  LazIntegers steps_{32, 6};
  std::uint64_t time_ = 0;
  std::int32_t step_ = 0;
  int extremes_ = 0;
};

class Time2 : public Item {
 public:
  void begin(const char* item) override { times_.begin(load_little_endian<std::uint64_t>(item)); }
  void next(LazDecoder& decoder, char* item) override {
    store_little_endian(item, times_.next(decoder));
  }

 private:
  LazTime times_{true};
};

/// Colours of version 1 are bytes of which a symbol says whether they change, extra bytes of
/// version 1 such as all do.
class Bytes1 : public Item {
 public:
  Bytes1(unsigned count, bool colour) : count_(count), colour_(colour), bytes_(8, count) {}
  void next(LazDecoder& decoder, char* item) override {
    const unsigned changed = colour_ ? decoder.symbol(changed_, 64) : 0;
    for (unsigned i = 0; i < count_; ++i)
      if (!colour_ || (changed >> i & 1) != 0)
        item[i] = static_cast<char>(bytes_.next(decoder, static_cast<unsigned char>(item[i]), i));
  }

 private:
  unsigned count_;
  bool colour_;
  LazSymbolModel changed_;
  LazIntegers bytes_;
};

class Bytes2 : public Item {
 public:
  explicit Bytes2(unsigned count) : steps_(count) {}
  void next(LazDecoder& decoder, char* item) override {
    for (LazSymbolModel& steps : steps_) step_byte(decoder, steps, *item++);
  }

 private:
  std::vector<LazSymbolModel> steps_;
};

template <class Field>
class Plain : public Item {
 public:
  void next(LazDecoder& decoder, char* item) override { field_.next(decoder, item); }

 private:
  Field field_;
};

std::unique_ptr<Item> make_item(const LazItem& item) {
  const bool old = item.version == 1;
  switch (item.type) {
    case LazItem::point10:
      if (old) return std::make_unique<Point1>();
      return std::make_unique<Point2>();
    case LazItem::gps_time:
      if (old) return std::make_unique<Time1>();
      return std::make_unique<Time2>();
    case LazItem::rgb:
      if (old) return std::make_unique<Bytes1>(item.size, true);
      return std::make_unique<Plain<LazColour>>();
    case LazItem::wave_packet:
      return std::make_unique<Plain<LazWavePacket>>();
    default:
      if (old) return std::make_unique<Bytes1>(item.size, false);
      return std::make_unique<Bytes2>(item.size);
  }
}

}  // namespace

void decode_points(const LazChunk& chunk, const std::vector<LazItem>& items, const LazRows& rows,
                   const ReadOptions& options) {
  std::vector<std::unique_ptr<Item>> parts;
  for (const LazItem& item : items) parts.push_back(make_item(item));
  std::string record(chunk.begin, rows.record);
  const auto each = [&](const auto& visit) {
    char* at = record.data();
    for (std::size_t i = 0; i < parts.size(); at += items[i].size, ++i) visit(*parts[i], at);
  };
  each([](Item& part, const char* at) { part.begin(at); });
  std::memcpy(rows.out, record.data(), rows.stride);
  if (chunk.count == 1) return;
  LazDecoder decoder(chunk.begin + rows.record, chunk.end);
  for (std::uint64_t i = 1; i < chunk.count; ++i) {
    if (i % 65536 == 0) check_stop(options);
    each([&](Item& part, char* at) { part.next(decoder, at); });
    std::memcpy(rows.out + i * rows.stride, record.data(), rows.stride);
  }
}

}  // namespace cullhull::internal
