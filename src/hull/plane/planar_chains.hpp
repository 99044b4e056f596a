// Lower and upper chains of points of the plane that arrive in buckets from left to right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "hull/plane/planar.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// The lexicographically first and last point: points above the chord between them cannot be on the
/// lower chain, points below it not on the upper one.
struct Chord {
  Entry first, last;
};

/// Keys of points with x in [low, high]: 32 bits, monotone in x, over the whole range of values.
class KeyMap {
 public:
  KeyMap() = default;
  KeyMap(double low, double high);

  std::uint32_t key(double x) const {
    const double q = (x * half_ - low_) * scale_;
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(q < top ? q : top));
  }
  /// False where the range is too near underflow: all keys are 0.
  bool useful() const { return scale_ > 0; }

 private:
  static constexpr double top = 0x1p32 - 1;
  double half_ = 1, low_ = 0, scale_ = 0;
};

/// Strictly convex chains of all points added so far, each from left to right. Reuses its memory.
class ChainBuilder {
 public:
  ChainBuilder(const Chord& chord, const Turn& turn, const Control& control)
      : chord_(chord), turn_(turn), control_(&control) {}

  /// Starts anew with empty chains, for other points.
  void restart(const Chord& chord) {
    chord_ = chord;
    turn_.restart();
    lower_count_ = upper_count_ = 0;
  }
  /// Adds points whose keys differ at most in the `low_bits` lowest bits, none lexicographically
  /// before those of earlier calls.
  void add(const Entry* points, std::uint32_t count, unsigned low_bits);

  const Entry* lower() const { return lower_.data(); }
  const Entry* upper() const { return upper_.data(); }
  std::uint32_t lower_count() const { return lower_count_; }
  std::uint32_t upper_count() const { return upper_count_; }
  const Turn& turn() const { return turn_; }

 private:
  using Entries = Array<Entry>;

  void divide(const Entry* points, std::uint32_t count, unsigned low_bits);
  void extend(Entries& chain, std::uint32_t& size, const Entry* points, std::uint32_t count,
              int side);

  Chord chord_;
  Turn turn_;
  const Control* control_;
  Entries lower_, upper_;
  std::uint32_t lower_count_ = 0, upper_count_ = 0;
  // For one bucket: the points below the chord, sorted, then those above; each point's cell; the
  // position of each cell's next point.
  Entries sorted_;
  std::vector<Entry> both_;
  Array<std::uint32_t> cells_, next_;
  std::uint32_t below_ = 0, above_ = 0;
};

/// Sorts by `before`. Among points with the same x only the lowest and the highest are correct, the
/// others may be replaced by copies of them: they are not extreme.
void sort_entries(Entry* begin, Entry* end, const Control& control);

}  // namespace cullhull::internal
