// Layered chunks of LAZ: an arithmetic code for each group of fields, so that those nobody asks for
// are skipped; the point formats 6 to 10. Each of the four scanner channels has models of its own.
#include <string_view>

#include "io/formats/laz.hpp"
#include "io/formats/laz_fields.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned channels = 4;

/// A chunk's layers, in their order: decoders of those that are there and needed, else null.
class Layers {
 public:
  Layers(const char* sizes, const char* end, std::size_t count)
      : sizes_(sizes), end_(end), next_(sizes + 4 * count), decoders_(count) {}

  LazDecoder* take(bool needed) {
    const std::size_t i = taken_++;
    const std::size_t size = load_little_endian<std::uint32_t>(sizes_ + 4 * i);
    if (size > static_cast<std::size_t>(end_ - next_))
      throw LazDamage{"its layers need more bytes than it has"};
    const char* const begin = next_;
    next_ += size;
    if (size == 0 || !needed) return nullptr;
    decoders_[i] = LazDecoder(begin, next_);
    return &decoders_[i];
  }

 private:
  const char *sizes_, *end_, *next_;
  std::vector<LazDecoder> decoders_;
  std::size_t taken_ = 0;
};

/// POINT14: 30 bytes, in nine layers.
class Points {
 public:
  Points(const LazItem& item, const char* first, Layers& layers, const LazRows& rows)
      : xy_(layers.take(true)),
        z_(layers.take(rows.needs(8, 4))),
        classes_(layers.take(rows.needs(16, 1))),
        flags_(layers.take(rows.needs(15, 1))),
        intensities_(layers.take(rows.needs(12, 2))),
        angles_(layers.take(rows.needs(18, 2))),
        users_(layers.take(rows.needs(17, 1))),
        sources_(layers.take(rows.needs(20, 2))),
        times_(layers.take(rows.needs(22, 8))),
        fixed_(item.version > 3),
        size_(item.size) {
    if (xy_ == nullptr) throw LazDamage{"it has no layer of x and y"};
    channel_ = of_others_ = static_cast<unsigned char>(first[15]) >> 4 & 3;
    begin(channel_, first);
  }
  /// The channel whose models the other parts of the record use. Version 3 says 0 unless the
  /// channel has just changed.
  unsigned channel_of_others() const { return of_others_; }

  /// Returns the next point, which is kept until this is called again.
  const char* next() {
    Channel* c = of_[channel_].get();
    const unsigned before = byte(c->last[14]);
    const unsigned last_kind = (return_of(before) == 1 ? 1U : 0U) +
                               (return_of(before) >= returns_of(before) ? 2U : 0U) +
                               (c->time_changed ? 4U : 0U);
    const unsigned changed = xy_->symbol(c->changed[last_kind], 128);
    if ((changed & 64) != 0) c = change_channel();
    of_others_ = fixed_ || (changed & 64) != 0 ? channel_ : 0;
    const bool time_changed = (changed & 16) != 0;
    char* const item = c->last.data();
    const unsigned n = number_of_returns(*c, changed), r = return_number(*c, changed);
    item[14] = static_cast<char>(n << 4 | r);
    const unsigned kind = (r == 1 ? 2U : 0U) + (r >= n ? 1U : 0U);
    coordinates(*c, n, r, time_changed);
    other_fields(*c, changed, kind);
    c->time_changed = time_changed;
    return item;
  }

 private:
  /// The models of a channel and its last point.
  struct Channel {
    std::string last;
    bool time_changed = false;
    std::array<LazSymbolModel, 8> changed;
    LazSymbolModel channel, same_time_returns;
    std::array<LazSymbolModel, 16> returns, return_numbers;
    std::array<LazMedian, 12> x, y;
    std::array<std::int32_t, 8> height{};
    LazIntegers dx{32, 2}, dy{32, 22}, z{32, 20};
    std::array<LazSymbolModel, 64> classes, flags, users;
    std::array<std::uint16_t, 8> intensity{};
    LazIntegers intensities{16, 4}, angles{16, 2}, sources{16};
    LazTime times{false};
  };

  static unsigned byte(char c) { return static_cast<unsigned char>(c); }
  static unsigned return_of(unsigned byte) { return byte & 15; }
  static unsigned returns_of(unsigned byte) { return byte >> 4; }

  void begin(unsigned channel, const char* first) {
    of_[channel] = std::make_unique<Channel>();
    Channel& c = *of_[channel];
    c.last.assign(first, size_);
    c.height.fill(load_little_endian<std::int32_t>(first + 8));
    c.intensity.fill(load_little_endian<std::uint16_t>(first + 12));
    c.times.begin(load_little_endian<std::uint64_t>(first + 22));
  }
  Channel* change_channel() {
    Channel& from = *of_[channel_];
    channel_ = (channel_ + xy_->symbol(from.channel, 3) + 1) % channels;
    if (of_[channel_] == nullptr) begin(channel_, from.last.data());
    char& bits = of_[channel_]->last[15];
    bits = static_cast<char>((byte(bits) & 0xCFU) | channel_ << 4);
    return of_[channel_].get();
  }

  unsigned number_of_returns(Channel& c, unsigned changed) {
    const unsigned last = returns_of(byte(c.last[14]));
    return (changed & 4) == 0 ? last : xy_->symbol(c.returns[last], 16);
  }
  unsigned return_number(Channel& c, unsigned changed) {
    const unsigned last = return_of(byte(c.last[14]));
    switch (changed & 3) {
      case 0:
        return last;
      case 1:
        return (last + 1) & 15;
      case 2:
        return (last + 15) & 15;
      default:
        if ((changed & 16) != 0) return xy_->symbol(c.return_numbers[last], 16);
        return (last + xy_->symbol(c.same_time_returns, 13) + 2) & 15;
    }
  }

  /// A number from 0 to 5 of return r of n, for predictions of steps.
  static unsigned kind_of_step(unsigned n, unsigned r) {
    constexpr std::string_view kinds[] = {
        "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
        "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
        "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
        "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};
    return static_cast<unsigned>(kinds[n][r] - '0');
  }
  void coordinates(Channel& c, unsigned n, unsigned r, bool time_changed) {
    const std::size_t kind = 2 * kind_of_step(n, r) + (time_changed ? 1 : 0);
    const unsigned single = n == 1 ? 1 : 0, level = std::min(n > r ? n - r : r - n, 7U);
    const std::int32_t x = c.dx.next(*xy_, c.x[kind].get(), single);
    c.x[kind].add(x);
    const unsigned length = c.dx.length();
    const std::int32_t y = c.dy.next(*xy_, c.y[kind].get(), single + (std::min(length, 20U) & ~1U));
    c.y[kind].add(y);
    add_to_coordinate(c.last.data(), x);
    add_to_coordinate(c.last.data() + 4, y);
    if (z_ == nullptr) return;
    const unsigned mean = (length + c.dy.length()) / 2;
    c.height[level] = c.z.next(*z_, c.height[level], single + (std::min(mean, 18U) & ~1U));
    store_little_endian(c.last.data() + 8, c.height[level]);
  }

  /// `kind`: 2 of a first return, 1 of a last one, their sum of both.
  void other_fields(Channel& c, unsigned changed, unsigned kind) {
    char* const item = c.last.data();
    const unsigned time_changed = changed >> 4 & 1;
    if (classes_ != nullptr) {
      const unsigned context = (byte(item[16]) & 31) << 1 | (kind == 3 ? 1U : 0U);
      item[16] = static_cast<char>(classes_->symbol(c.classes[context], 256));
    }
    if (flags_ != nullptr) {
      const unsigned bits = byte(item[15]);
      const unsigned flags = flags_->symbol(c.flags[(bits >> 2 & 0x30) | (bits & 15)], 64);
      item[15] = static_cast<char>((bits & 0x30) | (flags & 0x30) << 2 | (flags & 15));
    }
    if (intensities_ != nullptr) {
      std::uint16_t& last = c.intensity[kind << 1 | time_changed];
      last = static_cast<std::uint16_t>(c.intensities.next(*intensities_, last, kind));
      store_little_endian(item + 12, last);
    }
    if (angles_ != nullptr && (changed & 8) != 0)
      next_half(*angles_, c.angles, item + 18, time_changed);
    if (users_ != nullptr)
      item[17] = static_cast<char>(users_->symbol(c.users[byte(item[17]) / 4], 256));
    if (sources_ != nullptr && (changed & 32) != 0) next_half(*sources_, c.sources, item + 20);
    if (times_ != nullptr && time_changed != 0)
      store_little_endian(item + 22, c.times.next(*times_));
  }

  LazDecoder *xy_, *z_, *classes_, *flags_, *intensities_, *angles_, *users_, *sources_, *times_;
  bool fixed_;
  std::size_t size_;
  unsigned channel_ = 0, of_others_ = 0;
  std::array<std::unique_ptr<Channel>, channels> of_;
};

/// A part of the record behind the point.
class Part {
 public:
  Part(const LazItem& item, const char* first, unsigned channel)
      : size_(item.size), fixed_(item.version > 3), channel_(channel) {
    last_[channel].assign(first, size_);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  virtual ~Part() = default;

  void next(unsigned channel, char* out) {
    // Version 3 predicts the first point after a change of the channel by the channel before and
    // puts it there, unless the channel is new.
    unsigned from = fixed_ ? channel : channel_;
    if (last_[channel].empty()) {
      last_[channel] = last_[channel_];
      from = channel;
    }
    channel_ = channel;
    decode(channel, last_[from].data());
    std::memcpy(out, last_[from].data(), size_);
  }

 protected:
  /// Turns the last record's part into the next one's, by the channel's models.
  virtual void decode(unsigned channel, char* item) = 0;

 private:
  std::size_t size_;
  bool fixed_;
  unsigned channel_;
  std::array<std::string, channels> last_;
};

/// RGB14 and WAVEPACKET14.
template <class Field>
class OneLayer : public Part {
 public:
  OneLayer(const LazItem& item, const char* first, unsigned channel, LazDecoder* layer)
      : Part(item, first, channel), layer_(layer) {}

 private:
  void decode(unsigned channel, char* item) override {
    if (layer_ != nullptr) of_[channel].next(*layer_, item);
  }
  LazDecoder* layer_;
  std::array<Field, channels> of_;
};

class ColourAndInfrared : public Part {
 public:
  ColourAndInfrared(const LazItem& item, const char* first, unsigned channel, LazDecoder* colour,
                    LazDecoder* infrared)
      : Part(item, first, channel), colour_(colour), infrared_(infrared) {}

 private:
  struct Infrared {
    LazSymbolModel changed;
    std::array<LazSymbolModel, 2> steps;
  };
  void decode(unsigned channel, char* item) override {
    if (colour_ != nullptr) colours_[channel].next(*colour_, item);
    if (infrared_ == nullptr) return;
    Infrared& models = infrareds_[channel];
    const unsigned changed = infrared_->symbol(models.changed, 4);
    for (std::size_t half = 0; half < 2; ++half)
      if ((changed >> half & 1) != 0) step_byte(*infrared_, models.steps[half], item[6 + half]);
  }

  LazDecoder *colour_, *infrared_;
  std::array<LazColour, channels> colours_;
  std::array<Infrared, channels> infrareds_;
};

class ExtraBytes : public Part {
 public:
  ExtraBytes(const LazItem& item, const char* first, unsigned channel,
             std::vector<LazDecoder*>&& layers)
      : Part(item, first, channel), layers_(std::move(layers)) {
    for (auto& steps : steps_) steps = std::vector<LazSymbolModel>(layers_.size());
  }

 private:
  void decode(unsigned channel, char* item) override {
    for (std::size_t i = 0; i < layers_.size(); ++i)
      if (layers_[i] != nullptr) step_byte(*layers_[i], steps_[channel][i], item[i]);
  }

  std::vector<LazDecoder*> layers_;
  std::array<std::vector<LazSymbolModel>, channels> steps_;
};

std::size_t layers_of(const LazItem& item) {
  switch (item.type) {
    case LazItem::point14:
      return 9;
    case LazItem::rgb_nir14:
      return 2;
    case LazItem::bytes14:
      return item.size;
    default:
      return 1;
  }
}

/// `at`: the item's first byte in a record.
std::unique_ptr<Part> make_part(const LazItem& item, const char* first, std::size_t at,
                                unsigned channel, Layers& layers, const LazRows& rows) {
  const auto take = [&](std::size_t begin, std::size_t size) {
    return layers.take(rows.needs(at + begin, size));
  };
  first += at;
  switch (item.type) {
    case LazItem::rgb14:
      return std::make_unique<OneLayer<LazColour>>(item, first, channel, take(0, 6));
    case LazItem::wave_packet14:
      return std::make_unique<OneLayer<LazWavePacket>>(item, first, channel, take(0, item.size));
    case LazItem::rgb_nir14: {
      LazDecoder* const colour = take(0, 6);
      return std::make_unique<ColourAndInfrared>(item, first, channel, colour, take(6, 2));
    }
    default: {
      std::vector<LazDecoder*> all;
      for (std::size_t i = 0; i < item.size; ++i) all.push_back(take(i, 1));
      return std::make_unique<ExtraBytes>(item, first, channel, std::move(all));
    }
  }
}

}  // namespace

void decode_layers(const LazChunk& chunk, const std::vector<LazItem>& items, const LazRows& rows,
                   const ReadOptions& options) {
  std::size_t count = 0;
  for (const LazItem& item : items) count += layers_of(item);
  const char* const sizes = chunk.begin + rows.record + 4;
  if (rows.record + 4 + 4 * count > static_cast<std::size_t>(chunk.end - chunk.begin))
    throw LazDamage{"it ends before its layers"};
  if (load_little_endian<std::uint32_t>(sizes - 4) != chunk.count)
    throw LazDamage{"it has another number of points than the chunk table says"};
  std::memcpy(rows.out, chunk.begin, rows.stride);
  if (chunk.count == 1) return;
  Layers layers(sizes, chunk.end, count);
  Points points(items[0], chunk.begin, layers, rows);
  std::vector<std::pair<std::size_t, std::unique_ptr<Part>>> parts;
  for (std::size_t i = 1, at = items[0].size; i < items.size(); at += items[i].size, ++i) {
    auto part = make_part(items[i], chunk.begin, at, points.channel_of_others(), layers, rows);
    if (rows.needs(at, items[i].size)) parts.emplace_back(at, std::move(part));
  }
  const std::size_t own = std::min(rows.stride, std::size_t{items[0].size});
  for (std::uint64_t i = 1; i < chunk.count; ++i) {
    if (i % 65536 == 0) check_stop(options);
    char* const out = rows.out + i * rows.stride;
    std::memcpy(out, points.next(), own);
    for (const auto& [at, part] : parts) part->next(points.channel_of_others(), out + at);
  }
}

}  // namespace cullhull::internal
