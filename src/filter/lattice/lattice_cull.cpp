#include "filter/lattice/lattice_cull.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "parallel/memory/raw_array.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Points per chunk: about 50 us of work, as with light_grain, whose steps are half as long.
constexpr std::uint64_t chunk_size = 1 << 14;

std::uint64_t hash_of(std::uint64_t seed, double v) {
  // 0 and -0 are equal, so they must hash alike.
  return mix64(seed + 0x9E3779B97F4A7C15ULL + std::bit_cast<std::uint64_t>(v + 0.0));
}

/// Returns a sample of the points at pseudo-random positions, because input often has a period of
/// its own; a point may be drawn twice.
std::vector<std::uint32_t> sample_of(std::uint32_t count) {
  const auto root = static_cast<std::uint32_t>(4 * std::sqrt(static_cast<double>(count)));
  const std::uint32_t size = std::max(root, 1024U);
  std::vector<std::uint32_t> ids(std::min(size, count));
  for (std::uint32_t k = 0; k < ids.size(); ++k)
    ids[k] = size >= count ? k : static_cast<std::uint32_t>((mix64(k + 1) >> 32) * count >> 32);
  return ids;
}

void sort_sample(std::vector<std::uint32_t>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

/// Counts the points of the sample that share their value on an axis with an earlier one.
std::uint64_t repeated_values(const Array<double>& rows, unsigned d, unsigned axis,
                              const std::vector<std::uint32_t>& sample) {
  const auto bits = static_cast<unsigned>(std::bit_width(sample.size())) + 1;
  const std::uint64_t last = (std::uint64_t{1} << bits) - 1;
  constexpr std::uint32_t nobody = 0xFFFFFFFF;
  std::vector<std::uint32_t> table(last + 1, nobody);
  const auto value = [&](std::uint32_t i) {
    return rows[std::size_t{i} * d + axis] + 0.0;  // 0 and -0 are equal
  };
  std::uint64_t repeated = 0;
  for (const std::uint32_t i : sample) {
    const double v = value(i);
    std::uint64_t at = std::bit_cast<std::uint64_t>(v) * 0x9E3779B97F4A7C15ULL >> (64 - bits);
    while (table[at] != nobody && value(table[at]) != v) at = (at + 1) & last;
    repeated += table[at] != nobody && table[at] != i;
    table[at] = i;
  }
  return repeated;
}

/// Returns how many shared lines in the sample indicate a lattice.
std::uint64_t enough_shared(std::uint64_t size, std::uint32_t count) {
  return std::clamp<std::uint64_t>(size * size / count, 4, size / 16 + 4);
}

// Example: 1,000 sampled points of decimals with three places in [0, 1) repeat values on every
// axis, and lines may be shared; random doubles repeat none, and the lattice filter ends here after
// sorting or hashing two axes of the sample.

/// Excludes lattices quickly. Points on a line along one axis agree on every other axis, so if
/// values on two axes seldom repeat, no axis has many shared lines. This is the usual case.
bool surely_no_lattice(const Array<double>& rows, unsigned d,
                       const std::vector<std::uint32_t>& sample, std::uint32_t count) {
  const auto seldom = [&](unsigned axis) {
    const std::uint64_t repeated = repeated_values(rows, d, axis, sample);
    return repeated < enough_shared(sample.size(), count) && 4 * repeated <= sample.size();
  };
  return d > 1 && seldom(0) && seldom(1);
}

// Confusing two hashes makes a sample look more like a lattice than it is: the thinning is tried
// and drops what it can, which is right for any points, so a false alarm costs time alone. 256 bits
// a hash keep false alarms at one in 256.

/// A set of hashes that may confuse different ones (a Bloom filter with one hash function): 256
/// bits per hash of its capacity.
class HashBits {
 public:
  explicit HashBits(std::uint64_t most) : words_(std::bit_ceil(most) * 4) {}
  void clear() { std::fill(words_.begin(), words_.end(), 0); }
  /// Returns 1 if this hash, or another with the same bit, was inserted before.
  unsigned insert(std::uint64_t hash) {
    const std::uint64_t bit = hash & 63;
    std::uint64_t& word = words_[hash >> 6 & (words_.size() - 1)];
    const auto there = static_cast<unsigned>(word >> bit & 1);
    word |= std::uint64_t{1} << bit;
    return there;
  }

 private:
  std::vector<std::uint64_t> words_;
};

// Example: 10^6 points of a 100 x 100 x 100 grid: a line along x has m = 100 points. A sample of
// 1,000 has about 1000^2 * 100 / (2 * 10^6) = 50 pairs on common lines, where 10^6 random doubles
// have none.

/// Decides whether thinning along some axis will drop many points. With m points on the line of an
/// average point, a sample of s of n points has about s^2 m / 2 n pairs on common lines; m = 2 is
/// required. Lines are counted, not pairs, because a single full line or pair of equal points is no
/// lattice; but if most of the sample is on few lines, or at few places, that is enough.
bool looks_like_a_lattice(const Array<double>& rows, unsigned d,
                          const std::vector<std::uint32_t>& sample, std::uint32_t count) {
  if (d == 1) return true;
  const std::uint64_t size = sample.size();
  const std::uint64_t enough = enough_shared(size, count);
  // A line's hash is the sum of its coordinates' hashes: that of the point without the axis's own.
  const auto hash = [&](std::uint32_t i, unsigned j) {
    return hash_of(mix64(j + 1), rows[std::size_t{i} * d + j]);
  };
  std::vector<std::uint64_t> sums(size, 0);
  for (std::size_t i = 0; i < size; ++i)
    for (unsigned j = 0; j < d; ++j) sums[i] += hash(sample[i], j);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> lines(size);
  HashBits seen(size);
  for (unsigned axis = 0; axis < d; ++axis) {
    std::uint64_t again = 0;
    seen.clear();
    for (std::size_t i = 0; i < size; ++i) {
      lines[i] = {sums[i] - hash(sample[i], axis), sample[i]};
      again += seen.insert(lines[i].first);
    }
    // Points on the same line have the same bit, so too few repetitions rule a lattice out without
    // sorting.
    if (again < enough && 4 * again <= size) continue;
    std::sort(lines.begin(), lines.end());
    std::uint64_t shared = 0, on_shared = 0;
    for (std::size_t i = 0; i < size;) {
      std::size_t end = i + 1;
      bool differ = false;
      for (; end < size && lines[end].first == lines[i].first; ++end)
        differ |= rows[std::size_t{lines[end].second} * d + axis] !=
                  rows[std::size_t{lines[i].second} * d + axis];
      shared += differ;
      on_shared += end - i > 1 ? end - i : 0;
      i = end;
    }
    if (shared >= enough || 2 * on_shared > size) return true;
  }
  return false;
}

// ------------------------------------------------------------------------ numbers for coordinates

// Example: values 0.1, 0.2, 0.3 (rounded decimals) are nearly evenly spaced: round((v - 0.1) / 0.1)
// numbers them 0, 1, 2. Storing each value under its number and reading all of them back shows that
// no two values share one, so a line is a line: rounding can make the numbering fail, never wrong.

/// Numbers for the values of one axis, in the same order: whether a point is between two others on
/// a line depends on the order alone. Where values are nearly evenly spaced, the number is
/// computed; a table then proves that no two values have the same number.
class Spacing {
 public:
  /// Estimates the spacing from a sample's values; returns false if that does not give a moderate
  /// number of even steps.
  bool guess(double low, double high, std::vector<double>&& values, std::uint64_t most) {
    low_ = low;
    if (low == high) return cells_ = 1, true;
    std::sort(values.begin(), values.end());
    double step = high - low;
    for (std::size_t i = 1; i < values.size(); ++i)
      if (values[i] > values[i - 1]) step = std::min(step, values[i] - values[i - 1]);
    const double cells = std::round((high - low) / step) + 1;
    if (!(cells <= static_cast<double>(most))) return false;  // also false for infinite values
    per_unit_ = (cells - 1) / (high - low);
    if (!std::isfinite(per_unit_)) return false;
    cells_ = static_cast<std::uint64_t>(cells);
    values_ = BigArray<double>(cells_);
    return true;
  }
  unsigned bits() const { return static_cast<unsigned>(std::bit_width(cells_ - 1)); }
  /// Returns the number of v. Monotone in v, because each operation is.
  std::uint64_t of(double v) const {
    return std::min(static_cast<std::uint64_t>((v - low_) * per_unit_ + 0.5), cells_ - 1);
  }
  /// Stores v under its number. If, after all values are stored, each is found under its number, no
  /// two different values have the same number, whichever was stored last.
  void note(double v) {
    if (cells_ > 1) std::atomic_ref(values_[of(v)]).store(v, std::memory_order_relaxed);
  }
  bool found(double v) const { return cells_ == 1 || values_[of(v)] == v; }

 private:
  double low_ = 0, per_unit_ = 0;
  std::uint64_t cells_ = 1;
  BigArray<double> values_;
};

/// Ranks among the distinct values of one axis, for any spacing.
class Ranks {
 public:
  /// Returns false, early, if there are more than `most` distinct values.
  bool collect(const Array<double>& rows, std::uint32_t count, unsigned d, unsigned axis,
               std::size_t most, const Control& control) {
    slots_.assign(1024, Slot{});
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i % chunk_size == 0) control.check();
      const double v = rows[std::size_t{i} * d + axis];
      Slot& s = slots_[find(v)];
      if (s.used) continue;
      if (values_.size() == most) return false;
      s = {v, 0, true};
      values_.push_back(v);
      if (2 * values_.size() > slots_.size()) grow();
    }
    std::sort(values_.begin(), values_.end());
    for (std::size_t r = 0; r < values_.size(); ++r)
      slots_[find(values_[r])].rank = static_cast<std::uint32_t>(r);
    return true;
  }
  unsigned bits() const { return static_cast<unsigned>(std::bit_width(values_.size() - 1)); }
  std::uint32_t of(double v) const { return slots_[find(v)].rank; }

 private:
  struct Slot {
    double value = 0;
    std::uint32_t rank = 0;
    bool used = false;
  };
  std::size_t find(double v) const {
    std::size_t at = hash_of(0, v) & (slots_.size() - 1);
    while (slots_[at].used && slots_[at].value != v) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), Slot{});
    for (const double v : values_) slots_[find(v)] = {v, 0, true};
  }
  std::vector<Slot> slots_;
  std::vector<double> values_;
};

// ----------------------------------------------------------------------------------- the thinning

/// A point: its coordinates' numbers, packed, and its index.
struct Keyed {
  std::uint64_t key;
  std::uint32_t id;
};

/// The position of an axis's number in the keys.
struct Field {
  unsigned bits = 0, shift = 0;
};

// Example along x: the key of a point (x, y, z) without its x field is its line. Each point offers
// its x to the least and the greatest of its line, by atomic minima and maxima, so the two ends do
// not depend on the order of threads; of equal points the lower index counts.

/// The two ends of each line along one axis: in a table indexed by line if lines are few, else in a
/// hash table. Which points are kept does not depend on the order of work.
class Lines {
 public:
  Lines(Field axis, unsigned total_bits, std::uint64_t points) : axis_(axis) {
    const unsigned line_bits = total_bits - axis.bits;
    const auto room = static_cast<unsigned>(std::bit_width(2 * points - 1));
    hashed_ = line_bits > room;
    slots_ = std::uint64_t{1} << (hashed_ ? room : line_bits);
    low_ = BigArray<std::uint64_t>(slots_);
    high_ = BigArray<std::uint64_t>(slots_);
    if (hashed_) names_ = BigArray<std::uint64_t>(slots_);
  }
  std::uint64_t slots() const { return slots_; }
  void clear(std::uint64_t begin, std::uint64_t end) {
    std::fill(low_.get() + begin, low_.get() + end, ~std::uint64_t{0});
    std::fill(high_.get() + begin, high_.get() + end, std::uint64_t{0});
    if (hashed_) std::fill(names_.get() + begin, names_.get() + end, nobody);
  }
  /// May be called by several threads concurrently.
  void offer(const Keyed& p) {
    const std::uint64_t s = slot(p.key), low = as_low(p), high = as_high(p);
    const std::atomic_ref lowest(low_[s]), highest(high_[s]);
    std::uint64_t now = lowest.load(std::memory_order_relaxed);
    while (low < now && !lowest.compare_exchange_weak(now, low, std::memory_order_relaxed)) {
    }
    now = highest.load(std::memory_order_relaxed);
    while (high > now && !highest.compare_exchange_weak(now, high, std::memory_order_relaxed)) {
    }
  }
  /// Valid after all points were offered.
  bool is_end(const Keyed& p) {
    const std::uint64_t s = slot(p.key);
    return low_[s] == as_low(p) || high_[s] == as_high(p);
  }

 private:
  static constexpr std::uint64_t nobody = ~std::uint64_t{0};

  // Numbers are below 2^32; of equal points the one with the lowest id is both the lowest and the
  // highest.
  std::uint64_t along(std::uint64_t key) const {
    return key >> axis_.shift & ((std::uint64_t{1} << axis_.bits) - 1);
  }
  std::uint64_t as_low(const Keyed& p) const { return along(p.key) << 32 | p.id; }
  std::uint64_t as_high(const Keyed& p) const { return along(p.key) << 32 | (~p.id & 0xFFFFFFFF); }

  std::uint64_t slot(std::uint64_t key) {
    const unsigned end = axis_.shift + axis_.bits;
    const std::uint64_t above = end < 64 ? key >> end << axis_.shift : 0;
    const std::uint64_t line = above | (key & ((std::uint64_t{1} << axis_.shift) - 1));
    if (!hashed_) return line;
    for (std::uint64_t s = mix64(line) & (slots_ - 1);; s = (s + 1) & (slots_ - 1)) {
      const std::atomic_ref taken(names_[s]);
      std::uint64_t name = taken.load(std::memory_order_relaxed);
      if (name == nobody && taken.compare_exchange_strong(name, line, std::memory_order_relaxed))
        return s;
      if (name == line) return s;
    }
  }

  const Field axis_;
  bool hashed_ = false;
  std::uint64_t slots_ = 0;
  BigArray<std::uint64_t> low_, high_, names_;
};

class Thinner {
 public:
  Thinner(const Array<double>& rows, std::uint32_t count, unsigned d, const Run& run)
      : rows_(rows), count_(count), d_(d), run_(run), left_(count) {}

  bool run(const std::vector<std::uint32_t>& sample, std::vector<std::uint32_t>& kept) {
    if (!number_by_spacing(sample) && !number_by_rank()) return false;
    for (unsigned j = d_; j-- > 0;)
      if (fields_[j].bits > 0 || (j == 0 && total_ == 0)) thin(fields_[j]);
    kept.resize(left_);
    for (std::size_t i = 0; i < left_; ++i) kept[i] = points_[i].id;
    return true;
  }

 private:
  template <class Body>
  void each_chunk(std::uint64_t count, const Body& body) const {
    run_.each_chunk(
        count, chunk_size,
        [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) { body(c, begin, end); });
  }

  /// Packs fields of b_0, b_1, ... bits, the last lowest; returns false if they need more than 64
  /// bits, or a field more than 32.
  bool lay_out(const std::vector<unsigned>& bits) {
    fields_.assign(d_, {});
    total_ = 0;
    for (unsigned j = d_; j-- > 0;) {
      if (bits[j] > 32 || total_ + bits[j] > 64) return false;
      fields_[j] = {bits[j], total_};
      total_ += bits[j];
    }
    return true;
  }

  bool number_by_spacing(const std::vector<std::uint32_t>& sample) {
    const std::uint64_t chunks = chunk_count(count_, chunk_size);
    std::vector<double> low(chunks * d_), high(chunks * d_);
    each_chunk(count_, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      double *l = &low[c * d_], *h = &high[c * d_];
      std::copy_n(&rows_[begin * d_], d_, l);
      std::copy_n(l, d_, h);
      for (std::uint64_t i = begin; i < end; ++i)
        for (unsigned j = 0; j < d_; ++j) {
          l[j] = std::min(l[j], rows_[i * d_ + j]);
          h[j] = std::max(h[j], rows_[i * d_ + j]);
        }
    });
    std::vector<Spacing> axes(d_);
    std::vector<unsigned> bits(d_);
    const std::uint64_t most = std::uint64_t{1} << 20;
    for (unsigned j = 0; j < d_; ++j) {
      double least = low[j], highest = high[j];
      for (std::uint64_t c = 0; c < chunks; ++c) {
        least = std::min(least, low[c * d_ + j]);
        highest = std::max(highest, high[c * d_ + j]);
      }
      std::vector<double> values;
      for (const std::uint32_t i : sample) values.push_back(rows_[std::size_t{i} * d_ + j]);
      if (!axes[j].guess(least, highest, std::move(values),
                         std::min(most, 4 * std::uint64_t{count_})))
        return false;
      bits[j] = axes[j].bits();
    }
    if (!lay_out(bits)) return false;
    each_chunk(count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i)
        for (unsigned j = 0; j < d_; ++j) axes[j].note(rows_[i * d_ + j]);
    });
    std::atomic<bool> all{true};
    points_ = BigArray<Keyed>(count_);
    each_chunk(count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      bool found = true;
      for (std::uint64_t i = begin; i < end; ++i) {
        std::uint64_t key = 0;
        for (unsigned j = 0; j < d_; ++j) {
          const double v = rows_[i * d_ + j];
          found &= axes[j].found(v);
          if (fields_[j].bits > 0) key |= axes[j].of(v) << fields_[j].shift;
        }
        points_[i] = {key, static_cast<std::uint32_t>(i)};
      }
      if (!found) all.store(false, std::memory_order_relaxed);
    });
    return all.load();
  }

  bool number_by_rank() {
    std::vector<Ranks> axes(d_);
    std::vector<unsigned> bits(d_);
    unsigned total = 0;
    for (unsigned j = 0; j < d_; ++j) {
      const unsigned left = std::min(64 - total, 32U);
      if (!axes[j].collect(rows_, count_, d_, j, std::size_t{1} << left, run_.control))
        return false;
      bits[j] = axes[j].bits();
      total += bits[j];
    }
    if (!lay_out(bits)) return false;
    points_ = BigArray<Keyed>(count_);
    each_chunk(count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        std::uint64_t key = 0;
        for (unsigned j = 0; j < d_; ++j)
          if (fields_[j].bits > 0)
            key |= std::uint64_t{axes[j].of(rows_[i * d_ + j])} << fields_[j].shift;
        points_[i] = {key, static_cast<std::uint32_t>(i)};
      }
    });
    return true;
  }

  /// Keeps only the ends of the lines along an axis.
  void thin(Field axis) {
    Lines lines(axis, total_, left_);
    each_chunk(lines.slots(), [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      lines.clear(begin, end);
    });
    each_chunk(left_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) lines.offer(points_[i]);
    });
    // Every chunk moves its kept points to its beginning; then the parts are joined.
    std::vector<std::uint64_t> sizes(chunk_count(left_, chunk_size));
    each_chunk(left_, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint64_t out = begin;
      for (std::uint64_t i = begin; i < end; ++i) {
        const Keyed p = points_[i];
        points_[out] = p;
        out += lines.is_end(p);
      }
      sizes[c] = out - begin;
    });
    left_ = 0;
    for (std::uint64_t c = 0; c < sizes.size(); ++c) {
      std::copy_n(points_.get() + c * chunk_size, sizes[c], points_.get() + left_);
      left_ += sizes[c];
    }
  }

  const Array<double>& rows_;
  const std::uint32_t count_;
  const unsigned d_;
  const Run& run_;
  std::vector<Field> fields_;
  unsigned total_ = 0;  // bits of a key
  BigArray<Keyed> points_;
  std::uint64_t left_;
};

}  // namespace

bool lattice_cull(const Array<double>& rows, std::uint32_t count, unsigned d, const Run& run,
                  std::vector<std::uint32_t>& kept) {
  if (count == 0) return false;
  std::vector<std::uint32_t> sample = sample_of(count);
  if (surely_no_lattice(rows, d, sample, count)) return false;
  sort_sample(sample);
  if (!looks_like_a_lattice(rows, d, sample, count)) return false;
  return Thinner(rows, count, d, run).run(sample, kept);
}

}  // namespace cullhull::internal
