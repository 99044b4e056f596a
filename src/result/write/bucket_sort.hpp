// Sorts simplices by their lowest vertices, in buckets that each fit the cache.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cullhull::internal {

/// Returns the shift that defines the buckets: a vertex's bucket is its position shifted right by
/// this number of bits. Buckets hold about `size` simplices, but there are at most 2048 buckets,
/// because each thread writes to all of them. 256 to 2048 buckets took the same time on a sphere of
/// 1M points.
inline unsigned bucket_shift(std::uint64_t simplices, std::uint64_t vertices, std::uint64_t size) {
  const std::uint64_t wanted = std::clamp<std::uint64_t>(std::bit_ceil(simplices / size), 1, 2048);
  const int bits = static_cast<int>(std::bit_width(vertices - 1)) - std::countr_zero(wanted);
  return static_cast<unsigned>(std::max(bits, 0));
}

/// Sorts one bucket after another and reuses its memory.
template <class Key>
class BucketSort {
 public:
  /// Sorts the `size` records of a bucket by their lowest vertex (counting sort), and those with
  /// the same lowest vertex by `before`. each(visit) must call visit(record) for each record; it is
  /// called twice. lowest(record) < `vertices` is the lowest vertex relative to the bucket's first
  /// one. key(record), called once for each record, returns the key that `before` compares and that
  /// operator[] returns.
  template <class Each, class Lowest, class KeyOf, class Before>
  void sort(std::size_t size, std::size_t vertices, const Each& each, const Lowest& lowest,
            const KeyOf& key, const Before& before) {
    ends_.assign(vertices + 1, 0);
    keys_.resize(size);
    std::uint32_t* const ends = ends_.data();
    Key* const keys = keys_.data();
    each([&](const auto& record) { ++ends[lowest(record) + 1]; });
    for (std::size_t v = 1; v <= vertices; ++v) ends[v] += ends[v - 1];
    each([&](const auto& record) { keys[ends[lowest(record)]++] = key(record); });
    for (std::size_t v = 0, from = 0; v < vertices; from = ends[v++])
      sort_run(keys + from, keys + ends[v], before);
  }

  /// Key i of the sorted bucket.
  const Key& operator[](std::size_t i) const { return keys_[i]; }

 private:
  /// Up to this many keys are sorted by insertion. A vertex is the lowest of only about six
  /// triangles, but of hundreds of simplices in 6D. Hulls of 50,000 points on a sphere in 4D take
  /// 2% more time with 4, and 2% less with 64.
  static constexpr std::ptrdiff_t few = 16;

  template <class Before>
  static void sort_run(Key* begin, Key* end, const Before& before) {
    if (end - begin > few) return std::sort(begin, end, before);
    for (Key* i = begin; i < end; ++i) {
      const Key key = *i;
      Key* j = i;
      for (; j > begin && before(key, j[-1]); --j) *j = j[-1];
      *j = key;
    }
  }

  std::vector<std::uint32_t> ends_;  // end of the keys of each lowest vertex
  std::vector<Key> keys_;
};

}  // namespace cullhull::internal
