// Whole numbers of 128 bits in two words: fixed values everywhere, and beside the compiler's own.
#include "parallel/int128.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "parallel/random_stream.hpp"

namespace cullhull::internal {
namespace int128_test {

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
using Portable = PortableInt128;

TEST(Int128, SignsCarriesAndBorrows) {
  static_assert(Portable{most} + Portable{1} > Portable{most});
  static_assert(Portable{least} - Portable{1} < Portable{least});
  static_assert(-Portable{least} == Portable{most} + Portable{1});
  static_assert(Portable{-1} * Portable{-1} == Portable{1});
  static_assert(Portable{-3} < Portable{0} && Portable{0} > Portable{-3});
  static_assert(Portable{least} * Portable{least} ==
                Portable{most} * Portable{most} + Portable{most} + Portable{most} + Portable{1});
  EXPECT_EQ(static_cast<double>(Portable{}), 0);
  EXPECT_EQ(static_cast<double>(Portable{least} * Portable{least}), 0x1p126);
  EXPECT_EQ(static_cast<double>(Portable{least} * Portable{most}), -0x1p126);
}

TEST(Int128, DoublesAreRoundedToNearestTiesToEven) {
  const Portable two_54 = Portable{std::int64_t{1} << 54}, shift = Portable{std::int64_t{1} << 62};
  const auto at = [&](std::int64_t more) {
    return static_cast<double>((two_54 + Portable{more}) * shift);
  };
  EXPECT_EQ(at(0), 0x1p116);
  EXPECT_EQ(at(2), 0x1p116);           // a tie, to even
  EXPECT_EQ(at(6), 0x1p116 + 0x1p65);  // a tie, to even: up
  EXPECT_EQ(at(3), 0x1p116 + 0x1p64);  // above the tie
  EXPECT_EQ(static_cast<double>((two_54 + Portable{2}) * shift + Portable{1}),  // by a hair
            0x1p116 + 0x1p64);
  EXPECT_EQ(static_cast<double>(-((two_54 + Portable{2}) * shift + Portable{1})),
            -(0x1p116 + 0x1p64));
}

TEST(Int128, RemaindersOfProducts) {
  constexpr std::uint64_t top = std::numeric_limits<std::uint64_t>::max();
  static_assert(portable_multiply_add_modulo(top, top, top, top) == 0);
  static_assert(portable_multiply_add_modulo(top, top, 1, top) == 1);
  static_assert(portable_multiply_add_modulo(top, 2, 0, top - 1) == 2);
  static_assert(portable_multiply_add_modulo(7, 9, 5, 10) == 8);
  static_assert(portable_multiply_add_modulo(7, 9, 5, 1) == 0);
  static_assert(multiply_add_modulo(top, top, top, top - 2) ==
                portable_multiply_add_modulo(top, top, top, top - 2));
}

#if defined(__SIZEOF_INT128__)
/// Words of every length, many of them all zeros or all ones.
std::uint64_t word(RandomStream& random) {
  const std::uint64_t bits = random.bits() >> (random.bits() % 64);
  return random.bits() % 4 == 0 ? ~bits : bits;
}

TEST(Int128, EveryOperationBesideTheCompilersOwn) {
  RandomStream random(128, 0);
  for (int i = 0; i < 200'000; ++i) {
    const auto a = static_cast<std::int64_t>(word(random));
    const auto b = static_cast<std::int64_t>(word(random));
    const auto c = static_cast<std::int64_t>(word(random));
    // What the exact rungs compute: products of products, within 128 bits.
    const std::int64_t f = c >> 40;
    const Portable ours = Portable{a} * Portable{b} - Portable{c} * Portable{f};
    const Int128 theirs = Int128{a} * b - Int128{c} * f;
    ASSERT_EQ(static_cast<double>(ours), static_cast<double>(theirs)) << a << " " << b << " " << c;
    ASSERT_EQ(ours > Portable{0}, theirs > 0);
    ASSERT_EQ(ours < Portable{a}, theirs < a);
    ASSERT_EQ(ours == Portable{a} * Portable{b}, theirs == Int128{a} * b);
    // The low word, which a double does not show: what is left of it times 2^64.
    const Portable low = ours * Portable{std::int64_t{1} << 32} * Portable{std::int64_t{1} << 32};
    const auto turned = static_cast<Int128>(static_cast<Uint128>(theirs) << 64);
    ASSERT_EQ(static_cast<double>(low), static_cast<double>(turned));
    const std::uint64_t n = word(random) | 1;
    const auto p = static_cast<std::uint64_t>(a), q = static_cast<std::uint64_t>(b);
    ASSERT_EQ(portable_multiply_add_modulo(p, q, n, n), multiply_add_modulo(p, q, n, n));
  }
}
#endif

}  // namespace int128_test
}  // namespace cullhull::internal
