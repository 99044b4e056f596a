// Facets = vertices x facets per vertex, each extrapolated separately.
//
// Facets per vertex: for V random points on a sphere in R^d this number tends to a limit as their
// squared spacing, V^(-2 / (d - 1)), tends to 0. For other bodies the sphere's numbers are scaled
// to fit the hull of a sample. Beyond 8D only hulls of few vertices fit in memory; their facets are
// estimated as a part of the most that this number of vertices can have. Vertices: linear programs
// decide for a few points whether each is extreme among all.
#include "hull/general/facet_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "extreme/hull_membership.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Facets per vertex of random points on a sphere: the limit, and for V = 20, 40, ... 640 points
/// the relative distance from it (limit / value - 1). Measured.
constexpr unsigned table_size = 6;
struct Sphere {
  double limit;
  double distance[table_size];
};
constexpr Sphere spheres[] = {
    {6.8, {0.66, 0.45, 0.24, 0.125, 0.074, 0.049}},  // 4D
    {32, {2.7, 1.34, 0.74, 0.48, 0.31, 0.197}},      // 5D
    {187, {9.2, 3.9, 2.1, 1.28, 0.82, 0.556}},       // 6D
    {1296, {39, 11.9, 5.25, 3.04, 1.87, 1.23}},      // 7D
    {10262, {177, 37.2, 15, 7.4, 4.08, 2.59}},       // 8D
};

/// Facets per vertex of random points on a sphere: a power law between the measured sizes, and
/// beyond them one of exponent -2.4 / (d - 1), a little steeper than the theory's -2 / (d - 1). For
/// each dimension beyond 8D the limit grows by the factor d - 0.1, the distance by 2.5.
double facets_per_vertex(double vertices, unsigned d) {
  const Sphere& s = spheres[std::clamp(d, 4U, 8U) - 4];
  const double at = std::clamp(std::log2(std::max(vertices, 20.0) / 20), 0.0, table_size - 1.0);
  const auto k = std::min(static_cast<unsigned>(at), table_size - 2);
  double limit = s.limit;
  double distance =
      s.distance[k] * std::pow(s.distance[k + 1] / s.distance[k], at - static_cast<double>(k));
  constexpr double last = 20 << (table_size - 1);
  if (vertices > last) distance *= std::pow(vertices / last, -2.4 / (d - 1));
  for (unsigned e = 9; e <= d; ++e) {
    limit *= e - 0.1;
    distance *= 2.5;
  }
  return limit / (1 + distance);
}

/// The ids of `size` distinct points, in pseudo-random order.
std::vector<std::uint32_t> random_points(std::uint32_t count, std::uint32_t size) {
  std::vector<std::uint32_t> ids(count);
  for (std::uint32_t i = 0; i < count; ++i) ids[i] = i;
  XorShift random;
  for (std::uint32_t i = 0; i < size; ++i) std::swap(ids[i], ids[i + random.next() % (count - i)]);
  ids.resize(size);
  return ids;
}

struct SampleHull {
  double vertices = 0, facets = 0;
};

SampleHull hull_of(const LocalPoints& points, const std::uint32_t* ids, std::uint32_t size,
                   const Run& run) {
  const unsigned d = points.dimension;
  Array<double> rows(std::size_t{size} * d);
  for (std::uint32_t i = 0; i < size; ++i)
    std::copy_n(points.row(ids[i]), d, rows.data() + std::size_t{i} * d);
  const LocalFrame frame(std::move(rows), size, d, run);
  SampleHull result;
  if (frame.affine_dimension() != static_cast<int>(d)) return result;
  const Boundary hull = hull_nd(frame.points(), frame.simplex().data(),
                                run.with_budget(std::uint64_t{1} << 40), true);
  std::vector<std::uint8_t> used(size, 0);
  for (const std::uint32_t v : hull.vertices) used[v] = 1;
  result.facets = static_cast<double>(hull.facet_count());
  result.vertices = static_cast<double>(std::count(used.begin(), used.end(), 1));
  return result;
}

/// Expected number of extreme points among `size` random points, estimated by testing a few of
/// them.
double extreme_among(const LocalPoints& points, const std::vector<std::uint32_t>& ids,
                     std::uint32_t size, const Run& run) {
  // With 24 extreme points found, the estimate's relative standard deviation is 20 % (1 /
  // sqrt(24)).
  constexpr std::uint32_t block = 64, most_tests = 1024, enough = 24;
  const PointColumns others(points, {ids.begin(), ids.begin() + size}, run.control);
  PointColumns working(
      points, {ids.begin(), ids.begin() + std::min<std::uint32_t>(size, 32 * points.dimension)},
      run.control);
  std::uint32_t tested = 0, found = 0;
  // Where few points are extreme, more are tested; points that are not extreme are tested fast.
  while (tested < std::min(most_tests, size) && found < enough) {
    const std::uint32_t count = std::min(block, size - tested);
    std::vector<std::uint8_t> extreme(count, 0);
    std::vector<std::vector<std::uint32_t>> useful(chunk_count(count, 4));
    run.each_chunk(count, 4, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      HullMembership membership(points, run.control);
      for (std::uint64_t i = begin; i < end; ++i)
        extreme[i] = !membership.inside(ids[size - 1 - tested - i], others, working, useful[c]);
    });
    found += static_cast<std::uint32_t>(std::count(extreme.begin(), extreme.end(), 1));
    tested += count;
    for (const auto& list : useful)
      for (const std::uint32_t i : list)
        if (!working.contains(i)) working.add(i);
  }
  return static_cast<double>(size) * std::max(found, 1U) / tested;
}

/// Facets beyond 8D, by a model: facets / most_facets(V, d) = (1 + m / b)^(1 - floor(d/2)) with m =
/// V - d - 1. The ratio is 1 for a simplex and makes facets linear in V for large V, as on a
/// sphere. Measured for random points in balls, on spheres and in cubes, from 9D to 16D: b is 50 to
/// 160 and falls slowly with m, so b of a small sample predicts ten times its points within a
/// factor of 2.
double extrapolate(const SampleHull& sample, double vertices, unsigned d) {
  const double power = d / 2 - 1.0;
  const double most = most_facets(static_cast<std::uint64_t>(sample.vertices), d);
  const double rise = std::pow(most / sample.facets, 1 / power) - 1;  // m / b
  const double m = sample.vertices - d - 1;
  if (!(rise > 0 && m > 0)) return most_facets(static_cast<std::uint64_t>(vertices), d);
  return most_facets(static_cast<std::uint64_t>(vertices), d) *
         std::pow(1 + rise * (vertices - d - 1) / m, -power);
}

/// For dimensions beyond 8: the size of the largest sample whose hull takes at most some hundredths
/// of a second even with the most facets possible (a facet takes O(d^3)).
std::uint32_t affordable_sample(std::uint32_t count, unsigned d) {
  const double most = std::max(1000.0, 2e7 / std::pow(d, 3));
  std::uint32_t size = std::min(count, d + 3);
  while (size < count && most_facets(size + 1, d) <= most) ++size;
  return size;
}

/// Facets of a set with `vertices` extreme points, of at most n points, extrapolated from the
/// sample.
double extrapolated_facets(const SampleHull& sample, double vertices, std::uint64_t n, unsigned d) {
  const double facets = d > 8 ? extrapolate(sample, vertices, d)
                              : vertices * facets_per_vertex(vertices, d) * sample.facets /
                                    sample.vertices / facets_per_vertex(sample.vertices, d);
  return std::min(facets, most_facets(n, d));
}

}  // namespace

double most_facets(std::uint64_t n, unsigned d) {
  if (n <= d) return 0;
  const auto choose = [](double a, unsigned b) {
    double c = 1;
    for (unsigned i = 0; i < b; ++i) c *= (a - i) / (i + 1.0);
    return c;
  };
  const auto m = static_cast<double>(n);
  const unsigned low = d / 2, high = (d + 1) / 2;
  return choose(m - high, low) + choose(m - low - 1, high - 1);
}

double smooth_facets(double vertices, unsigned d) {
  return vertices * facets_per_vertex(std::max(vertices, 1e12), d);
}

FacetEstimate estimate_facets(const LocalPoints& points, const Run& run) {
  const unsigned d = points.dimension;
  constexpr std::uint32_t largest_set = 20000;
  constexpr double enough_facets = 40000;  // the last sample: up to 3 times as many, 0.1 s
  const std::uint32_t n = points.count, set = std::min(n, largest_set);
  const std::vector<std::uint32_t> ids = random_points(n, set);

  FacetEstimate estimate;
  SampleHull sample;
  for (std::uint32_t size = d > 8 ? affordable_sample(set, d) : std::min(set, 3 * d);;) {
    sample = hull_of(points, ids.data(), size, run);
    if (size == n) return {sample.vertices, sample.facets};
    if (size == set || d > 8 || sample.facets > enough_facets) break;
    size = std::min(set, size + size / 2);
  }
  double vertices = extreme_among(points, ids, set, run);
  if (set < n) {  // a power law through a quarter of the set and all of it
    const double quarter = extreme_among(points, ids, set / 4, run);
    const double exponent = std::clamp(std::log(vertices / quarter) / std::log(4.0), 0.0, 1.0);
    vertices *= std::pow(static_cast<double>(n) / set, exponent);
  }
  estimate.vertices = std::max(vertices, sample.vertices);
  if (sample.vertices == 0) return estimate;
  estimate.facets = extrapolated_facets(sample, estimate.vertices, n, d);
  return estimate;
}

void check_facets(const LocalPoints& points, std::uint64_t bytes_per_facet, const Run& run) {
  const unsigned d = points.dimension;
  const double affordable = static_cast<double>(run.budget) / static_cast<double>(bytes_per_facet);
  if (std::min(smooth_facets(points.count, d), most_facets(points.count, d)) <= affordable) return;
  const FacetEstimate e = estimate_facets(points, run);
  if (e.facets <= affordable) return;
  const auto rounded = [](double v) {  // two digits suffice for an estimate
    const double unit = std::pow(10.0, std::max(0.0, std::floor(std::log10(std::max(v, 1.0))) - 1));
    std::string digits =
        std::to_string(static_cast<std::uint64_t>(std::min(std::round(v / unit) * unit, 1e18)));
    for (std::size_t i = digits.size(); i > 3; i -= 3)
      digits.insert(digits.begin() + static_cast<std::ptrdiff_t>(i - 3), ',');
    return digits;
  };
  throw Error(ErrorCode::out_of_budget, "a hull of about ", rounded(e.facets),
              " facets is expected (", rounded(e.vertices), " extreme points in dimension ", d,
              "), which needs about ",
              rounded(e.facets * static_cast<double>(bytes_per_facet) / 0x1p20),
              " MiB; the memory budget is ", run.budget >> 20,
              " MiB; raise the budget, or ask for the extreme points only (extreme_points, --only "
              "vertices)");
}

}  // namespace cullhull::internal
