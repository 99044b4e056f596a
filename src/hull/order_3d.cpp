#include "hull/order_3d.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "parallel/parallel.hpp"

namespace cullhull::internal {
namespace {

/// Each round is this many times larger than all before it (8 to 32 measured alike).
constexpr unsigned round_bits = 4;
constexpr std::uint32_t first_round = 64;

std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser: a fixed pseudo-random hash
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

struct Cell {
  std::uint32_t face, x, y;
};

/// Face of the cube that y looks at and the cell on it.
Cell cell_of(const double* y, double cells) {
  const double ax = std::abs(y[0]), ay = std::abs(y[1]), az = std::abs(y[2]);
  const unsigned axis = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
  const double m = axis == 0 ? ax : axis == 1 ? ay : az;
  const double u = axis == 0 ? y[1] : y[0], v = axis == 2 ? y[1] : y[2];
  // A direction that is zero, or not a number, gets some cell.
  const double scale = m > 0x1p-900 ? 0.5 * cells / m : 0;
  const auto place = [&](double c) {
    const double t = c * scale + 0.5 * cells;
    return static_cast<std::uint32_t>(std::clamp(t, 0.0, cells - 1));
  };
  const double w = axis == 0 ? y[0] : axis == 1 ? y[1] : y[2];
  return {axis + (w < 0 ? 3U : 0U), place(u), place(v)};
}

bool cholesky(const double (&a)[3][3], double (&l)[3][3]) {
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j <= i; ++j) {
      double s = a[i][j];
      for (unsigned k = 0; k < j; ++k) s -= l[i][k] * l[j][k];
      if (i == j) {
        if (!(s > 1e-6 * a[i][i])) return false;
        l[i][i] = std::sqrt(s);
      } else {
        l[i][j] = s / l[j][j];
      }
    }
  return true;
}

/// Inverse of the matrix with the given columns; false where it has none in doubles.
bool invert(const double (&c)[3][3], double (&out)[3][3]) {
  double det = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const double *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
    for (unsigned j = 0; j < 3; ++j)
      out[i][j] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
  }
  for (unsigned j = 0; j < 3; ++j) det += c[0][j] * out[0][j];
  if (!(std::abs(det) > 0x1p-900)) return false;
  for (auto& row : out)
    for (double& v : row) {
      v /= det;
      if (!(std::abs(v) < 0x1p400)) return false;
    }
  return true;
}

}  // namespace

DirectionKey::DirectionKey(const LocalPoints& points, const double* centre,
                           const std::uint32_t* simplex)
    : centre_{centre[0], centre[1], centre[2]}, map_{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}} {
  // Coordinates along the simplex's edges first: that makes the sums below well-conditioned however
  // thin the body is.
  double edges[3][3], rough[3][3];
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j)
      edges[i][j] = points.row(simplex[i + 1])[j] - points.row(simplex[0])[j];
  if (!invert(edges, rough)) return;
  std::copy(&rough[0][0], &rough[0][0] + 9, &map_[0][0]);
  double moments[3][3] = {};
  const std::uint32_t stride = points.count / 1024 + 1;
  for (std::uint64_t i = 0; i < points.count; i += stride) {
    const double* p = points.row(static_cast<std::uint32_t>(i));
    double y[3];
    for (unsigned k = 0; k < 3; ++k)
      y[k] = rough[k][0] * (p[0] - centre[0]) + rough[k][1] * (p[1] - centre[1]) +
             rough[k][2] * (p[2] - centre[2]);
    for (unsigned a = 0; a < 3; ++a)
      for (unsigned b = 0; b <= a; ++b) moments[a][b] += y[a] * y[b];
  }
  double l[3][3] = {};
  if (!cholesky(moments, l)) return;
  for (unsigned j = 0; j < 3; ++j)
    for (unsigned i = 0; i < 3; ++i) {  // forward substitution, column by column
      double s = rough[i][j];
      for (unsigned k = 0; k < i; ++k) s -= l[i][k] * map_[k][j];
      map_[i][j] = s / l[i][i];
    }
}

void DirectionKey::keys(const double* const* rows, std::uint32_t count, unsigned bits,
                        std::uint32_t* keys) const {
  constexpr std::uint32_t block = 64;
  std::uint32_t x[block], y[block], key[block];
  const double cells = static_cast<double>(1U << bits);
  for (std::uint32_t begin = 0; begin < count; begin += block) {
    const std::uint32_t n = std::min(block, count - begin);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double* p = rows[begin + i];
      const double a = p[0] - centre_[0], b = p[1] - centre_[1], c = p[2] - centre_[2];
      const double d[3] = {map_[0][0] * a + map_[0][1] * b + map_[0][2] * c,
                           map_[1][0] * a + map_[1][1] * b + map_[1][2] * c,
                           map_[2][0] * a + map_[2][1] * b + map_[2][2] * c};
      const Cell cell = cell_of(d, cells);
      x[i] = cell.x;
      y[i] = cell.y;
      key[i] = cell.face;
    }
    std::fill(x + n, x + block, 0);
    std::fill(y + n, y + block, 0);
    std::fill(key + n, key + block, 0);
    // Hilbert's curve without branches, digit by digit for the whole block: a compiler's vectors.
    for (unsigned digit = bits; digit-- > 0;)
      for (std::uint32_t i = 0; i < block; ++i) {
        const std::uint32_t rx = (x[i] >> digit) & 1U, ry = (y[i] >> digit) & 1U;
        key[i] = (key[i] << 2) | ((3 * rx) ^ ry);
        const std::uint32_t turn = ry - 1;  // all ones where ry == 0
        const std::uint32_t flip = turn & (0 - rx);
        const std::uint32_t fx = x[i] ^ flip, fy = y[i] ^ flip;
        const std::uint32_t swap = (fx ^ fy) & turn;
        x[i] = fx ^ swap;
        y[i] = fy ^ swap;
      }
    std::copy_n(key, n, keys + begin);
  }
}

namespace {

struct Keyed {
  std::uint32_t key, id;
};

/// Least significant digit first, stable, in chunks: counts of all chunks give each chunk its
/// places.
void radix_sort(BigArray<Keyed>& a, BigArray<Keyed>& scratch, std::uint32_t n, unsigned bits,
                std::uint64_t chunk_size, unsigned threads) {
  const unsigned passes = (bits + 11) / 12;
  const unsigned digit_bits = (bits + passes - 1) / passes, buckets = 1U << digit_bits;
  const std::uint64_t chunks = chunk_count(n, chunk_size);
  std::vector<std::uint32_t> places(chunks * buckets);
  for (unsigned pass = 0; pass < passes; ++pass) {
    const unsigned shift = pass * digit_bits;
    const auto digit = [&](const Keyed& k) { return (k.key >> shift) & (buckets - 1); };
    std::fill(places.begin(), places.end(), 0U);
    for_each_chunk(n, chunk_size, threads,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t* counts = places.data() + c * buckets;
                     for (std::uint64_t i = begin; i < end; ++i) ++counts[digit(a[i])];
                   });
    std::uint32_t sum = 0;
    for (unsigned b = 0; b < buckets; ++b)
      for (std::uint64_t c = 0; c < chunks; ++c) {
        const std::uint32_t size = places[c * buckets + b];
        places[c * buckets + b] = sum;
        sum += size;
      }
    for_each_chunk(n, chunk_size, threads,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t* place = places.data() + c * buckets;
                     for (std::uint64_t i = begin; i < end; ++i) scratch[place[digit(a[i])]++] = a[i];
                   });
    std::swap(a, scratch);
  }
}

}  // namespace

InsertionOrder3D insertion_order_3d(const LocalPoints& points, const DirectionKey& key,
                                    const std::uint32_t* simplex, unsigned threads) {
  const std::uint32_t n = points.count;
  InsertionOrder3D order;
  unsigned rounds = 1;
  for (std::uint64_t size = first_round; size < n; size <<= round_bits) ++rounds;
  // About as many cells as points.
  order.key_bits = std::clamp((static_cast<unsigned>(std::bit_width(n)) + 1) / 2, 2U,
                              DirectionKey::max_bits);
  const unsigned key_width = 2 * order.key_bits + 3;
  const auto width = key_width + static_cast<unsigned>(std::bit_width(rounds));
  BigArray<Keyed> keyed(n), scratch(n);
  const std::uint64_t chunk_size = std::max<std::uint64_t>(1 << 16, n / 64);
  std::vector<std::array<std::uint32_t, 16>> sizes(chunk_count(n, chunk_size));
  for_each_chunk(n, chunk_size, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint32_t block = 256;
    const double* rows[block];
    std::uint32_t keys[block];
    std::array<std::uint32_t, 16> count{};
    for (std::uint64_t at = begin; at < end; at += block) {
      const auto size = static_cast<std::uint32_t>(std::min<std::uint64_t>(block, end - at));
      for (std::uint32_t i = 0; i < size; ++i)
        rows[i] = points.row(static_cast<std::uint32_t>(at + i));
      key.keys(rows, size, order.key_bits, keys);
      for (std::uint32_t i = 0; i < size; ++i) {
        // Round r > 1 has a share (1 - 1/ratio) ratio^(r - rounds) of the points; 0 is the simplex.
        const auto id = static_cast<std::uint32_t>(at + i);
        const auto back = static_cast<unsigned>(std::countr_zero(mix(id))) / round_bits;
        unsigned r = back < rounds ? rounds - back : 1;
        if (id == simplex[0] || id == simplex[1] || id == simplex[2] || id == simplex[3]) r = 0;
        keyed[id] = {(r << key_width) | (r > 1 ? keys[i] : 0), id};
        ++count[r];
      }
    }
    sizes[c] = count;
  });
  radix_sort(keyed, scratch, n, width, chunk_size, threads);
  order.ids = BigArray<std::uint32_t>(n);
  for_each_chunk(n, chunk_size, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i) order.ids[i] = keyed[i].id;
                 });
  std::uint32_t sum = 0;
  for (unsigned r = 0; r <= rounds; ++r) {
    for (const auto& count : sizes) sum += count[r];
    if (order.round_ends.empty() || sum > order.round_ends.back()) order.round_ends.push_back(sum);
  }
  return order;
}

}  // namespace cullhull::internal
