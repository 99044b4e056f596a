// Sorting keys of simplices: the vertices of a simplex, packed into 128 bits.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace cullhull::internal {

/// A stack of numbers in 128 bits; the number pushed last is in the lowest bits. Bits pushed out at
/// the top are lost.
struct FacetKey {
  std::uint64_t high = 0, low = 0;

  /// Pushes a number of `bits` bits, 0 < bits < 64.
  void push(std::uint64_t value, unsigned bits) {
    high = high << bits | low >> (64 - bits);
    low = low << bits | value;
  }
  /// Removes and returns the last number, of `bits` bits, 0 < bits <= 32.
  std::uint32_t pop(unsigned bits) {
    const auto value = static_cast<std::uint32_t>(low & ((std::uint64_t{1} << bits) - 1));
    low = low >> bits | high << (64 - bits);
    high >>= bits;
    return value;
  }
  friend bool operator<(const FacetKey& a, const FacetKey& b) {
    return a.high < b.high || (a.high == b.high && a.low < b.low);
  }
};

/// Packs the keys of simplices with K vertices. A key consists of as many of the vertices as fit,
/// in stored order, and then the simplex's number.
template <unsigned K>
class FacetKeys {
 public:
  /// For `count` simplices whose vertices are below `vertices`, in keys of `key_bits` bits. A key
  /// needs only the lowest `first_bits` bits of the first vertex; the others follow from its
  /// bucket.
  FacetKeys(std::uint64_t vertices, std::uint64_t count, unsigned first_bits, unsigned key_bits)
      : vertex_bits_(std::max(1U, static_cast<unsigned>(std::bit_width(vertices - 1)))),
        number_bits_(std::max(1U, static_cast<unsigned>(std::bit_width(count - 1)))),
        first_mask_((std::uint32_t{1} << first_bits) - 1) {
    packed_ = 1;
    for (unsigned bits = number_bits_ + first_bits + vertex_bits_; packed_ < K && bits <= key_bits;
         bits += vertex_bits_)
      ++packed_;
  }
  /// Whether keys contain all vertices.
  bool complete() const { return packed_ == K; }

  FacetKey key(const std::uint32_t* vertex, std::uint32_t number) const {
    FacetKey key;
    for (unsigned j = 0; j < packed_; ++j) key.push(vertex[j], vertex_bits_);
    key.push(number, number_bits_);
    return key;
  }
  /// The lowest `first_bits` bits of the first vertex.
  std::uint32_t first(const FacetKey& key) const {
    const unsigned shift = number_bits_ + (packed_ - 1) * vertex_bits_;
    const std::uint64_t bits =
        shift >= 64 ? key.high >> (shift - 64) : key.low >> shift | key.high << (64 - shift);
    return static_cast<std::uint32_t>(bits) & first_mask_;
  }
  /// The simplex's number.
  std::uint32_t number(const FacetKey& key) const {
    return static_cast<std::uint32_t>(key.low & ((std::uint64_t{1} << number_bits_) - 1));
  }
  /// Whether two keys contain the same vertices.
  bool alike(const FacetKey& a, const FacetKey& b) const {
    return a.high == b.high && (a.low ^ b.low) >> number_bits_ == 0;
  }
  /// Writes the vertices of a complete key. `base`: the upper bits of the first vertex.
  void unpack(FacetKey key, std::uint32_t base, std::uint32_t* vertex) const {
    key.pop(number_bits_);
    for (unsigned j = K; j-- > 1;) vertex[j] = key.pop(vertex_bits_);
    vertex[0] = base | (key.pop(vertex_bits_) & first_mask_);
  }

 private:
  unsigned vertex_bits_, number_bits_, packed_;
  std::uint32_t first_mask_;
};

}  // namespace cullhull::internal
