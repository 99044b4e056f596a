#include "cullhull/generate.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <future>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "generate/point_generator.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/helpers.hpp"
#include "thrown.hpp"

namespace cullhull::generate_test {

using namespace testing_support;

constexpr std::uint64_t seed = 20240611;

double norm(const double* p, unsigned d) {
  double s = 0;
  for (unsigned j = 0; j < d; ++j) s += p[j] * p[j];
  return std::sqrt(s);
}

std::uint64_t hash(const std::vector<double>& values) {
  std::uint64_t h = 14695981039346656037ULL;  // FNV-1a over the bits
  for (const double v : values) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    for (int k = 0; k < 8; ++k) h = (h ^ ((bits >> (8 * k)) & 255)) * 1099511628211ULL;
  }
  return h;
}

/// One that the shape has.
unsigned a_dimension_of(const std::string& shape) {
  return shape == "disk" || shape == "circle" ? 2 : 3;
}

/// As many calls of other threads as the machine has processors.
class OtherCalls {
 public:
  OtherCalls() {
    // Not by latches, which lose wake-ups on Windows (GCC 12).
    const std::shared_future<void> over = over_.get_future();
    while (threads_.size() < internal::machine_threads())
      threads_.emplace_back([this, over] {
        const internal::CallScope call;
        ++begun_;
        over.wait();
      });
    while (begun_ < threads_.size()) std::this_thread::yield();
  }
  ~OtherCalls() {
    over_.set_value();
    for (std::thread& t : threads_) t.join();
  }

 private:
  std::atomic<std::size_t> begun_{0};
  std::promise<void> over_;
  std::vector<std::thread> threads_;
};

TEST(Generate, SameBitsForEveryThreadCount) {
  for (const Shape& shape : shapes()) {
    const unsigned d = a_dimension_of(shape.name);
    const auto many = generate(shape.name, 20000, d, seed);
    const OtherCalls busy;  // then nobody helps
    EXPECT_EQ(hash(many), hash(generate(shape.name, 20000, d, seed))) << shape.name;
    EXPECT_NE(hash(many), hash(generate(shape.name, 20000, d, seed + 1))) << shape.name;
    for (const double v : many) ASSERT_TRUE(std::isfinite(v)) << shape.name;
  }
}

TEST(Generate, APrefixIsTheSameSet) {
  const auto few = generate("ball", 5000, 3, seed);
  const auto many = generate("ball", 9000, 3, seed);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
}

TEST(Generate, PiecesInAnyOrderAreTheWhole) {
  constexpr std::uint64_t run = internal::PointGenerator::run_length, count = 5 * run + 17;
  for (const Shape& shape : shapes()) {
    const unsigned d = a_dimension_of(shape.name);
    const std::vector<double> whole = generate(shape.name, count, d, seed);
    const internal::PointGenerator generator(shape.name, count, d, seed);
    std::vector<double> pieces(whole.size());
    const std::pair<std::uint64_t, std::uint64_t> order[] = {
        {4 * run, run + 17}, {0, 1}, {0, 3 * run}, {3 * run, run}, {5 * run, 0}, {5 * run, 17}};
    for (const auto& [first, length] : order)
      generator.rows(first, length, pieces.data() + first * d);
    EXPECT_EQ(hash(pieces), hash(whole)) << shape.name;
  }
}

TEST(Generate, NoPiecesThatAreNot) {
  constexpr std::uint64_t run = internal::PointGenerator::run_length, most = ~std::uint64_t{0};
  const internal::PointGenerator generator("ball", 2 * run + 5, 3, seed);
  std::vector<double> rows(3 * 3 * run);
  for (const auto& [first, count] : std::vector<std::pair<std::uint64_t, std::uint64_t>>{
           {1, 1}, {2 * run, 6}, {3 * run, 0}, {0, most}, {most - run + 1, 1}}) {
    error_of(ErrorCode::invalid_argument,
             [&, f = first, n = count] { generator.rows(f, n, rows.data()); });
  }
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(generator.rows(0, 1, rows.data(), stop.get_token()), Error);
  EXPECT_THROW(internal::PointGenerator("ball", most / 16 + 1, 1), Error);
  EXPECT_THROW(internal::PointGenerator("ball", std::uint64_t{1} << 50, 1U << 10), Error);
  EXPECT_THROW(internal::PointGenerator("cone", 5, 1), Error);
}

TEST(Generate, PointsLieWhereTheShapeSays) {
  for (unsigned d = 1; d <= 7; ++d) {
    const std::uint64_t n = 3000;
    const auto ball = generate("ball", n, d, seed);
    const auto sphere = generate("sphere", n, d, seed);
    const auto octahedron = generate("octahedron", n, d, seed);
    const auto simplex = generate("simplex", n, d, seed);
    const auto surface = generate("cube-surface", n, d, seed);
    const auto shell = generate("shell", n, d, seed);
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::size_t r = i * d;
      EXPECT_LT(norm(&ball[r], d), 1.0);
      EXPECT_NEAR(norm(&sphere[r], d), 1.0, 1e-15 * d);
      EXPECT_GT(norm(&shell[r], d), 0.9 - 1e-12);
      EXPECT_LT(norm(&shell[r], d), 1.0);
      double l1 = 0, sum = 0, largest = 0;
      for (unsigned j = 0; j < d; ++j) {
        l1 += std::abs(octahedron[r + j]);
        sum += simplex[r + j];
        EXPECT_GE(simplex[r + j], 0.0);
        largest = std::max(largest, std::abs(surface[r + j]));
      }
      EXPECT_LE(l1, 1.0);
      EXPECT_LE(sum, 1.0);
      EXPECT_EQ(largest, 1.0);
    }
  }
}

// The share of a d-ball of radius 1/2^(1/d), and of the like for the others, is one half: with n
// points the count is binomial, and six standard deviations would fail once in 5e8 seeds.
TEST(Generate, VolumesAreUniform) {
  const std::uint64_t n = 40000;
  const double slack = 6 * std::sqrt(n * 0.25);
  for (unsigned d = 2; d <= 6; ++d) {
    const double half = std::pow(0.5, 1.0 / d);
    const auto ball = generate("ball", n, d, seed);
    const auto octahedron = generate("octahedron", n, d, seed);
    const auto simplex = generate("simplex", n, d, seed);
    double in_ball = 0, in_octahedron = 0, in_simplex = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
      double l1 = 0, sum = 0;
      for (unsigned j = 0; j < d; ++j) {
        l1 += std::abs(octahedron[i * d + j]);
        sum += simplex[i * d + j];
      }
      in_ball += norm(&ball[i * d], d) < half;
      in_octahedron += l1 < half;
      in_simplex += sum < half;
    }
    EXPECT_NEAR(in_ball, n * 0.5, slack) << "d = " << d << ", seed " << seed;
    EXPECT_NEAR(in_octahedron, n * 0.5, slack) << "d = " << d << ", seed " << seed;
    EXPECT_NEAR(in_simplex, n * 0.5, slack) << "d = " << d << ", seed " << seed;
  }
}

TEST(Generate, NormalMoments) {
  const std::uint64_t n = 100000;
  const auto values = generate("gauss", n, 1, seed);
  double mean = 0, square = 0, fourth = 0;
  for (const double v : values) {
    mean += v;
    square += v * v;
    fourth += v * v * v * v;
  }
  // Standard deviations of the three means: 1, sqrt 2, sqrt 96, each over sqrt n.
  const double s = 6 / std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(mean / n, 0.0, s);
  EXPECT_NEAR(square / n, 1.0, s * std::sqrt(2.0));
  EXPECT_NEAR(fourth / n, 3.0, s * std::sqrt(96.0));
}

TEST(Generate, PortableLogIsALogarithm) {
  for (double x = 1e-300; x < 1e300; x *= 1.7)
    EXPECT_NEAR(internal::portable_log(x), std::log(x),
                4e-16 * std::max(1.0, std::abs(std::log(x))));
  EXPECT_EQ(internal::portable_log(1.0), 0.0);
}

TEST(Generate, GridTakesItsSize) {
  std::set<double> seen;
  for (const double v : generate("grid:3", 1000, 2, seed)) seen.insert(v);
  EXPECT_EQ(seen, (std::set<double>{0, 1, 2}));
  double largest = 0;
  for (const double v : generate("grid", 5000, 3, seed)) {
    EXPECT_EQ(v, std::floor(v));
    largest = std::max(largest, v);
  }
  EXPECT_EQ(largest, 127.0);
  EXPECT_EQ(generate("grid:1", 2, 2, seed), std::vector<double>(4, 0.0));
}

TEST(Generate, CyclicPointsAreExactPowersOfDistinctParameters) {
  const std::uint64_t n = 100;
  const auto points = generate("cyclic", n, 6, seed);
  std::set<double> parameters;
  for (std::uint64_t i = 0; i < n; ++i) {
    const double t = points[i * 6];
    parameters.insert(t);
    EXPECT_LT(std::abs(t), 1.0);
    EXPECT_EQ(t * 128, std::floor(t * 128));
    for (unsigned j = 1; j < 6; ++j) EXPECT_EQ(points[i * 6 + j], std::pow(t, j + 1));
  }
  EXPECT_EQ(parameters.size(), n);
}

TEST(Generate, CylinderAndConeLieOnTheirMantle) {
  for (unsigned d = 2; d <= 5; ++d) {
    const auto cylinder = generate("cylinder", 2000, d, seed);
    const auto cone = generate("cone", 2000, d, seed);
    for (std::size_t r = 0; r < cone.size(); r += d) {
      EXPECT_NEAR(norm(&cylinder[r], d - 1), 1.0, 1e-15 * d);
      EXPECT_NEAR(norm(&cone[r], d - 1) + cone[r + d - 1], 1.0, 1e-15 * d);
    }
  }
}

TEST(Generate, RefusesWhatItDoesNotKnow) {
  const std::tuple<const char*, std::uint64_t, std::uint32_t> cases[] = {
      {"potato", 10, 3},
      {"", 10, 3},
      {"ball", 10, 0},
      {"disk", 10, 3},
      {"cone", 10, 1},
      {"ball:3", 10, 3},
      {"grid:0", 10, 3},
      {"grid:", 10, 3},
      {"grid:4294967297", 10, 3},
      {"ball", ~std::uint64_t{0} / 2, 3}};
  for (const auto& [shape, n, d] : cases) {
    const std::string name = shape;
    const std::uint64_t count = n;
    const std::uint32_t dimension = d;
    SCOPED_TRACE(name);
    error_of(ErrorCode::invalid_argument, [&] { generate(name, count, dimension, seed); });
  }
  EXPECT_TRUE(generate("ball", 0, 3, seed).empty());
}

}  // namespace cullhull::generate_test
