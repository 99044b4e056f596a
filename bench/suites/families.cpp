#include "families.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "cullhull/error.hpp"

namespace cullhull::bench {
namespace {

using Rows = std::vector<double>;

/// Multiplies by an orthogonal matrix, with rounding.
Rows turned(Rows rows) {
  const double a = 0.7, b = 1.1;
  for (std::size_t i = 0; i + 2 < rows.size(); i += 3) {
    double* p = rows.data() + i;
    const double x = std::cos(a) * p[0] - std::sin(a) * p[1];
    const double y = std::sin(a) * p[0] + std::cos(a) * p[1];
    p[0] = x;
    p[1] = std::cos(b) * y - std::sin(b) * p[2];
    p[2] = std::sin(b) * y + std::cos(b) * p[2];
  }
  return rows;
}

Rows squashed(std::uint64_t n) {
  Rows rows = generate("sphere", n, 3);
  for (std::size_t i = 2; i < rows.size(); i += 3) rows[i] *= 1e-9;
  return rows;
}

Rows lattice_surface(std::uint64_t n) {
  const auto k = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(n) / 6)));
  Rows rows;
  for (int x = 0; x <= k; ++x)
    for (int y = 0; y <= k; ++y)
      for (int z = 0; z <= k; z += (x == 0 || y == 0 || x == k || y == k) ? 1 : k)
        rows.insert(rows.end(), {double(x) / k - 0.5, double(y) / k - 0.5, double(z) / k - 0.5});
  return rows;
}

Rows two_circles(std::uint64_t n) {
  const Rows rows = generate("sphere", n, 2, 7);
  Rows out;
  for (std::size_t i = 0; i < n; ++i)
    out.insert(out.end(), {rows[2 * i], rows[2 * i + 1], i % 2 == 0 ? -1.0 : 1.0});
  return out;
}

Rows cospherical_integers(std::uint64_t) {
  Rows rows;
  constexpr int square = 5 * 5 * 13 * 13 * 17 * 17 * 29;
  for (int x = 0; x * x <= square; ++x)
    for (int y = 0; x * x + y * y <= square; ++y) {
      const int rest = square - x * x - y * y;
      const int z = static_cast<int>(std::lround(std::sqrt(rest)));
      if (z * z != rest) continue;
      for (int s = 0; s < 8; ++s)
        rows.insert(rows.end(),
                    {double(s & 1 ? -x : x), double(s & 2 ? -y : y), double(s & 4 ? -z : z)});
    }
  return rows;
}

Rows duplicates(std::uint64_t n) {
  Rows rows = generate("sphere", std::max<std::uint64_t>(1, n / 8), 3);
  const std::size_t size = rows.size();
  for (unsigned k = 1; k < 8; ++k)
    for (std::size_t i = 0; i < size; ++i) rows.push_back(rows[i]);
  return rows;
}

Rows thin_plane(std::uint64_t n) {
  Rows rows = generate("cube", n, 3, 3);
  for (std::size_t i = 2; i < rows.size(); i += 3) rows[i] = 0;
  return turned(rows);
}

// ------------------------------------------------------------ of any dimension, for triangulations

/// Random numbers in [0, 1), the same on every machine.
class Units {
 public:
  double unit() { return std::ldexp(static_cast<double>(random_() >> 11), -53); }
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

 private:
  std::mt19937_64 random_{1};
};

/// Clusters whose densities range from 1 to 2^(20 d).
Rows clustered(std::uint64_t n, unsigned d) {
  Units random;
  Rows rows;
  rows.reserve(n * d);
  for (std::uint64_t i = 0; i < n; ++i) {
    const double size = std::ldexp(1.0, -random.below(20));
    for (unsigned j = 0; j < d; ++j) rows.push_back(random.unit() * size + random.below(7));
  }
  return rows;
}

Rows lattice(std::uint64_t n, unsigned d) {
  const auto width = static_cast<std::uint64_t>(
      std::max(1LL, std::llround(std::pow(static_cast<double>(n), 1.0 / d))));
  Rows rows;
  rows.reserve(n * d);
  for (std::uint64_t i = 0; i < n; ++i)
    for (std::uint64_t j = 0, rest = i; j < d; ++j, rest /= width)
      rows.push_back(static_cast<double>(j + 1 < d ? rest % width : rest));
  return rows;
}

/// Points on sixteen parallel lines.
Rows lines(std::uint64_t n, unsigned d) {
  Units random;
  Rows rows;
  rows.reserve(n * d);
  for (std::uint64_t i = 0; i < n; ++i) {
    const double along = random.unit(), line = random.below(16);
    for (unsigned j = 0; j < d; ++j) rows.push_back(j == 0 ? along : line * (j + 1) + along * j);
  }
  return rows;
}

struct SpreadFamily {
  Shape shape;
  Rows (*make)(std::uint64_t, unsigned);
};

constexpr SpreadFamily spread[] = {
    {{"uniform", "uniform in a cube"},
     [](std::uint64_t n, unsigned d) { return generate("cube", n, d); }},
    {{"clustered", "clusters within clusters: densities from 1 to 2^20 along each axis"},
     clustered},
    {{"lattice", "every point of an integer lattice: all cells are ties"}, lattice},
    {{"lines", "on sixteen parallel lines"}, lines},
};

// ----------------------------------------------------------------------------------- the list

struct Family {
  Shape shape;
  Rows (*make)(std::uint64_t);
};

constexpr Family families[] = {
    {{"lattice-surface", "a square lattice on the surface of a cube"}, lattice_surface},
    {{"turned-lattice-surface", "the same, turned in space: coplanar no more, but nearly"},
     [](std::uint64_t n) { return turned(lattice_surface(n)); }},
    {{"turned-cube-surface", "uniform on the surface of a cube, turned"},
     [](std::uint64_t n) { return turned(generate("cube-surface", n, 3)); }},
    {{"two-circles", "on two circles, one above the other: slivers"}, two_circles},
    {{"turned-two-circles", "the same, turned"},
     [](std::uint64_t n) { return turned(two_circles(n)); }},
    {{"turned-cylinder", "on the lateral surface of a cylinder, turned"},
     [](std::uint64_t n) { return turned(generate("cylinder", n, 3)); }},
    {{"squashed", "a sphere with z times 1e-9"}, squashed},
    {{"turned-squashed", "the same, turned"}, [](std::uint64_t n) { return turned(squashed(n)); }},
    {{"thin-plane", "a plane turned in space: as thick as the rounding"}, thin_plane},
    {{"cospherical", "the ninety thousand integer points of one sphere"}, cospherical_integers},
    {{"duplicates", "a sphere's surface, every point eight times"}, duplicates},
};

/// The family of that name in a table, or null.
template <class Table>
auto find(const Table& table, std::string_view name) -> decltype(std::begin(table)) {
  for (const auto& f : table)
    if (name == f.shape.name) return &f;
  return nullptr;
}

template <class Table>
std::vector<Shape> shapes_of(const Table& table) {
  std::vector<Shape> all;
  for (const auto& f : table) all.push_back(f.shape);
  return all;
}

}  // namespace

const std::vector<Shape>& hard_families() {
  static const std::vector<Shape> shapes = shapes_of(families);
  return shapes;
}

const std::vector<Shape>& spread_families() {
  static const std::vector<Shape> shapes = shapes_of(spread);
  return shapes;
}

bool is_family(std::string_view name, unsigned d) {
  if (find(spread, name) != nullptr) return true;
  if (find(families, name) != nullptr) return d == 3;
  try {
    generate(name, 1, d);
  } catch (const Error&) {
    return false;
  }
  return true;
}

std::vector<double> make_family(std::string_view name, std::uint64_t count, unsigned d) {
  if (const SpreadFamily* any = find(spread, name)) return any->make(count, d);
  const Family* family = find(families, name);
  if (family == nullptr) return generate(name, count, d);
  if (d != 3)
    throw Error(ErrorCode::invalid_argument, "points '" + std::string(name) + "' have dimension 3");
  return family->make(count);
}

}  // namespace cullhull::bench
