#include "cullhull/generate.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "cullhull/error.hpp"
#include "generate/point_generator.hpp"
#include "generate/rotation.hpp"
#include "parallel/int128.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"

// Not in a namespace without a name: GCC 13.2 ends with an internal error at a class that has them
// as members, where sources are compiled as one.
namespace cullhull::internal {

/// A smooth hill or dent of the bumpy surface, around the direction `centre`.
struct Bump {
  std::vector<double> centre;
  double height, width;
};

/// Data that all points of one generator share.
struct GeneratorJob {
  std::uint32_t dimension;
  std::uint64_t count;
  std::uint64_t seed;
  std::uint64_t grid_size = 128;
  std::uint64_t step = 1, shift = 0;  // cyclic: point i has number (step i + shift) mod count
  std::vector<Bump> bumps = {};
};

using PointFunction = void (*)(const GeneratorJob&, RandomStream&, std::uint64_t index,
                               double* row);

}  // namespace cullhull::internal

namespace cullhull {

namespace {

using internal::Bump;
using internal::GeneratorJob;
using internal::PointFunction;
using internal::RandomStream;

double squared_norm(std::uint32_t d, const double* row) {
  double sum = 0;
  for (std::uint32_t j = 0; j < d; ++j) sum += row[j] * row[j];
  return sum;
}

/// A uniformly distributed unit vector of d coordinates.
void random_direction(std::uint32_t d, RandomStream& random, double* row) {
  double norm = 0;
  do {
    for (std::uint32_t j = 0; j < d; ++j) row[j] = random.normal();
    norm = std::sqrt(squared_norm(d, row));
  } while (norm == 0);
  for (std::uint32_t j = 0; j < d; ++j) row[j] /= norm;
}

// A uniform point of the p-ball without rejection: d variables x of density proportional to
// exp(-|x|^p), divided by (the sum of all |x|^p plus an exponential variable)^(1/p). Source:
// Barthe, Guedon, Mendelson, Naor, "A probabilistic approach to the geometry of the l_p^n-ball",
// 2005. p is 2 in ball_point and 1 in octahedron_point.
void ball_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] = random.normal();
  const double length = std::sqrt(squared_norm(job.dimension, row) + 2 * random.exponential());
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] /= length;
}

void octahedron_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  double sum = random.exponential();
  for (std::uint32_t j = 0; j < job.dimension; ++j) {
    const double e = random.exponential();
    sum += e;
    row[j] = (random.bits() >> 63) != 0 ? -e : e;
  }
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] /= sum;
}

// d + 1 exponential spacings, scaled to sum 1, are uniform barycentric coordinates.
void simplex_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  double sum = random.exponential();
  for (std::uint32_t j = 0; j < job.dimension; ++j) sum += row[j] = random.exponential();
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] /= sum;
}

void sphere_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  random_direction(job.dimension, random, row);
}

void cube_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] = random.symmetric();
}

void cube_surface_point(const GeneratorJob& job, RandomStream& random, std::uint64_t index,
                        double* row) {
  cube_point(job, random, index, row);
  const std::uint64_t face = random.below(2 * std::uint64_t{job.dimension});
  row[face / 2] = face % 2 == 0 ? -1 : 1;
}

void gauss_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] = random.normal();
}

void grid_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  for (std::uint32_t j = 0; j < job.dimension; ++j)
    row[j] = static_cast<double>(random.below(job.grid_size));
}

void shell_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  random_direction(job.dimension, random, row);
  const double radius = 0.9 + 0.1 * random.unit();
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] *= radius;
}

void cylinder_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  random_direction(job.dimension - 1, random, row);
  row[job.dimension - 1] = random.symmetric();
}

// The lateral area at distance t from the apex is proportional to t^(d-2), which is the density of
// the largest of d - 1 uniform numbers.
void cone_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  const std::uint32_t base = job.dimension - 1;
  random_direction(base, random, row);
  double t = 0;
  for (std::uint32_t j = 0; j < base; ++j) t = std::max(t, random.unit());
  for (std::uint32_t j = 0; j < base; ++j) row[j] *= t;
  row[base] = 1 - t;
}

// The parameters t are multiples of a power of two, so that t^k is exact as long as it has at most
// 53 bits: k log2(2 count) <= 53.
void cyclic_point(const GeneratorJob& job, RandomStream&, std::uint64_t index, double* row) {
  const std::uint64_t number = internal::multiply_add_modulo(job.step, index, job.shift, job.count);
  double scale = 1;
  while (scale < static_cast<double>(job.count)) scale *= 2;
  const double t = (2 * static_cast<double>(number) - static_cast<double>(job.count - 1)) / scale;
  double power = 1;
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] = power *= t;
}

// A star-shaped surface. Every bump multiplies the radius by 1 + height q^3, where q decreases from
// 1 at the bump's centre to 0 at its rim. This keeps the radius positive and the surface twice
// differentiable.
void bumpy_point(const GeneratorJob& job, RandomStream& random, std::uint64_t, double* row) {
  random_direction(job.dimension, random, row);
  double radius = 1;
  for (const Bump& bump : job.bumps) {
    double s = 0;
    for (std::uint32_t j = 0; j < job.dimension; ++j) s += row[j] * bump.centre[j];
    const double q = 1 - (1 - s) / bump.width;
    if (q > 0) radius *= 1 + bump.height * q * q * q;
  }
  // Fine relief, like scales or a fleece. Without it a seventh of the points would be extreme, more
  // than in any scan of a real body.
  double relief = 1;
  for (std::uint32_t j = 0; j < std::min(job.dimension, 3U); ++j)
    relief *= internal::rotation_by(10 * row[j] + 0.1 * j).sine;
  radius *= 1 + 0.008 * relief;
  for (std::uint32_t j = 0; j < job.dimension; ++j) row[j] *= radius * (1 - 0.2 * (j % 3));
}

void prepare_bumps(GeneratorJob& job) {
  RandomStream random(job.seed, ~std::uint64_t{0});
  job.bumps.resize(48);
  for (Bump& bump : job.bumps) {
    bump.centre.resize(job.dimension);
    random_direction(job.dimension, random, bump.centre.data());
    bump.height = -0.2 + 0.5 * random.unit();
    bump.width = 0.05 + 0.45 * random.unit();
  }
}

// Derives the order of a cyclic polytope's points from the seed: a step coprime to their number,
// and a shift.
void prepare_order(GeneratorJob& job) {
  if (job.count < 2) return;
  RandomStream random(job.seed, ~std::uint64_t{0});
  do {
    job.step = random.bits() % job.count;
  } while (std::gcd(job.step, job.count) != 1);
  job.shift = random.bits() % job.count;
}

constexpr std::uint32_t any = std::numeric_limits<std::uint32_t>::max();

struct ShapeEntry {
  Shape shape;
  PointFunction point;
  void (*prepare)(GeneratorJob&) = nullptr;
  std::uint32_t min_dimension = 1, max_dimension = any;
};

const std::vector<ShapeEntry>& entries() {
  static const std::vector<ShapeEntry> table = {
      {{"ball", "uniform in the unit ball"}, ball_point},
      {{"sphere", "uniform on the unit sphere: every point is extreme"}, sphere_point},
      {{"cube", "uniform in [-1, 1)^d"}, cube_point},
      {{"cube-surface", "uniform on the surface of [-1, 1]^d"}, cube_surface_point},
      {{"octahedron", "uniform in the cross-polytope |x1| + ... + |xd| <= 1"}, octahedron_point},
      {{"polyhedron", "the same as octahedron"}, octahedron_point},
      {{"gauss", "normal: mean 0, variance 1 along every axis"}, gauss_point},
      {{"grid", "integers drawn from [0, 128)^d; grid:K for [0, K)^d, K up to 2^32"}, grid_point},
      {{"shell", "random directions, radius uniform in [0.9, 1)"}, shell_point},
      {{"cylinder", "on the lateral surface: unit (d-1)-sphere times [-1, 1)"},
       cylinder_point,
       nullptr,
       2},
      {{"cone", "on the lateral surface: apex at height 1, unit (d-1)-sphere at height 0"},
       cone_point,
       nullptr,
       2},
      {{"simplex", "uniform in the simplex x >= 0, x1 + ... + xd <= 1"}, simplex_point},
      {{"cyclic", "on the moment curve (t, t^2, ..., t^d), |t| < 1; the seed orders the points"},
       cyclic_point,
       prepare_order},
      {{"disk", "ball with d = 2"}, ball_point, nullptr, 2, 2},
      {{"circle", "sphere with d = 2"}, sphere_point, nullptr, 2, 2},
      {{"bumpy", "a closed star-shaped surface with bumps and fine relief, like a scanned body"},
       bumpy_point,
       prepare_bumps,
       2},
  };
  return table;
}

const ShapeEntry& find_shape(std::string_view name) {
  for (const ShapeEntry& entry : entries())
    if (name == entry.shape.name) return entry;
  std::string known;
  for (const ShapeEntry& entry : entries()) known += std::string(" ") + entry.shape.name;
  throw Error(ErrorCode::invalid_argument, "unknown shape '", name, "'; known:", known);
}

std::uint64_t parse_grid_size(std::string_view text) {
  std::uint64_t size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error != std::errc() || end != text.data() + text.size() || size == 0 ||
      size > (std::uint64_t{1} << 32))
    throw Error(ErrorCode::invalid_argument,
                "grid:K needs a whole number K from 1 to 4294967296, not '", text, "'");
  return size;
}

void check_dimension(const ShapeEntry& entry, std::uint32_t dimension) {
  if (dimension >= entry.min_dimension && dimension <= entry.max_dimension) return;
  throw Error(ErrorCode::invalid_argument, "shape '", entry.shape.name, "' needs dimension ",
              entry.min_dimension, (entry.max_dimension == any ? " or more" : ""), ", not ",
              dimension);
}

void check(const stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
}

/// Resizes to `size` zeros in steps and checks for a request to stop between them: the system
/// clears pages at only some gigabytes a second, so a large array takes a noticeable time.
void resize_in_steps(std::vector<double>& values, std::size_t size, const stop_token& stop) {
  constexpr std::size_t step = std::size_t{1} << 22;
  values.reserve(size);
  while (values.size() < size) {
    check(stop);
    values.resize(std::min(size, values.size() + step));
  }
}

}  // namespace

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> list = [] {
    std::vector<Shape> result;
    for (const ShapeEntry& entry : entries()) result.push_back(entry.shape);
    return result;
  }();
  return list;
}

}  // namespace cullhull

namespace cullhull::internal {

struct PointGenerator::Impl {
  GeneratorJob job;
  PointFunction point;
};

PointGenerator::PointGenerator(std::string_view shape, std::uint64_t count, std::uint32_t dimension,
                               std::uint64_t seed) {
  const auto colon = shape.find(':');
  const ShapeEntry& entry = find_shape(shape.substr(0, colon));
  GeneratorJob job{.dimension = dimension, .count = count, .seed = seed};
  if (colon != std::string_view::npos) {
    if (entry.point != grid_point)
      throw Error(ErrorCode::invalid_argument, "only grid takes a parameter, not '", shape, "'");
    job.grid_size = parse_grid_size(shape.substr(colon + 1));
  }
  check_dimension(entry, dimension);
  constexpr std::uint64_t most_coordinates = (std::uint64_t{1} << 60) - 1;
  if (count > most_coordinates / dimension)
    throw Error(ErrorCode::invalid_argument, count, " points of dimension ", dimension,
                " have 2^60 coordinates or more");
  if (entry.prepare != nullptr) entry.prepare(job);
  impl_.reset(new Impl{std::move(job), entry.point});
}

PointGenerator::PointGenerator(PointGenerator&&) noexcept = default;
PointGenerator& PointGenerator::operator=(PointGenerator&&) noexcept = default;
PointGenerator::~PointGenerator() = default;

// Each run of points has a random stream of its own, so the length of a run is part of the
// contract: another length would give other points.
void PointGenerator::rows(std::uint64_t first, std::uint64_t count, double* out,
                          const stop_token& stop) const {
  const GeneratorJob& job = impl_->job;
  if (first % run_length != 0 || first > job.count || count > job.count - first)
    throw Error(ErrorCode::invalid_argument, count, " points from point ", first, " on, of ",
                job.count);
  for_each_chunk(count, run_length, resolve_threads(0),
                 [&](std::uint64_t run, std::uint64_t begin, std::uint64_t end) {
    check(stop);
    RandomStream random(job.seed, first / run_length + run);
    for (std::uint64_t i = begin; i < end; ++i)
      impl_->point(job, random, first + i, out + i * job.dimension);
  });
}

}  // namespace cullhull::internal

namespace cullhull {

std::vector<double> generate(std::string_view shape, std::uint64_t count, std::uint32_t dimension,
                             std::uint64_t seed, const stop_token& stop) {
  const internal::PointGenerator generator(shape, count, dimension, seed);
  std::vector<double> points;
  resize_in_steps(points, count * dimension, stop);
  generator.rows(0, count, points.data(), stop);
  return points;
}

}  // namespace cullhull
