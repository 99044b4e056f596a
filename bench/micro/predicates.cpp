// One orientation test by each stage. Argument: the dimension.
#include <cmath>

#include "exact/orientation/orientation.hpp"
#include "sets.hpp"

namespace cullhull::micro {
namespace {

using internal::orientation;
using internal::Rung;
using internal::Sign;

/// Many orientation tests of d + 1 points each, so that branch predictors cannot learn them.
struct Questions {
  static constexpr std::size_t count = 512;
  unsigned dimension;
  std::vector<double> rows;
  std::vector<const double*> points;

  Questions(unsigned d, std::vector<double> made) : dimension(d), rows(std::move(made)) {
    for (std::size_t i = 0; i < count * (d + 1); ++i) points.push_back(rows.data() + i * d);
  }
  const double* const* operator[](std::size_t i) const {
    return points.data() + i * (dimension + 1);
  }
  double* last(std::size_t i) { return rows.data() + ((i + 1) * (dimension + 1) - 1) * dimension; }
};

Questions random_questions(unsigned d) {
  return {d, generate("cube", Questions::count * (d + 1), d)};
}

/// The last point is on the hyperplane of the others, up to rounding.
Questions nearly_flat(unsigned d) {
  Questions q = random_questions(d);
  for (std::size_t i = 0; i < Questions::count; ++i)
    for (unsigned j = 0; j < d; ++j) q.last(i)[j] = 0.5 * (q[i][0][j] + q[i][1][j]);
  return q;
}

/// The same with 16-bit integers, where the last point is exactly on the hyperplane.
Questions flat_integers(unsigned d) {
  Questions q = random_questions(d);
  for (double& x : q.rows) x = 2 * std::nearbyint(x * 0x1p14);
  for (std::size_t i = 0; i < Questions::count; ++i)
    for (unsigned j = 0; j < d; ++j) q.last(i)[j] = (q[i][0][j] + q[i][1][j]) / 2;
  return q;
}

/// Evaluates all tests repeatedly; stage `wanted` must decide most of them.
void ask(benchmark::State& state, const Questions& q, Rung wanted) {
  std::size_t there = 0;
  for (std::size_t i = 0; i < Questions::count; ++i) {
    Rung rung = Rung::plane;
    orientation(q.dimension, q[i], &rung);
    there += rung == wanted ? 1 : 0;
  }
  if (there < Questions::count * 9 / 10) state.SkipWithError("another rung decides");
  for (auto _ : state)
    for (std::size_t i = 0; i < Questions::count; ++i)
      benchmark::DoNotOptimize(orientation(q.dimension, q[i]));
  count_items(state, Questions::count);
}

void orientation_filter(benchmark::State& state) {
  ask(state, random_questions(static_cast<unsigned>(state.range(0))), Rung::filter);
}
void orientation_doubles_exact(benchmark::State& state) {
  ask(state, nearly_flat(static_cast<unsigned>(state.range(0))), Rung::exact);
}
/// By any stage: a filter may prove a zero for integers.
void orientation_integers(benchmark::State& state) {
  const Questions q = flat_integers(static_cast<unsigned>(state.range(0)));
  for (std::size_t i = 0; i < Questions::count; ++i)
    if (orientation(q.dimension, q[i]) != Sign::zero) state.SkipWithError("these are flat");
  for (auto _ : state)
    for (std::size_t i = 0; i < Questions::count; ++i)
      benchmark::DoNotOptimize(orientation(q.dimension, q[i]));
  count_items(state, Questions::count);
}

BENCHMARK(orientation_filter)->DenseRange(2, 8);
BENCHMARK(orientation_doubles_exact)->DenseRange(2, 8);
BENCHMARK(orientation_integers)->DenseRange(2, 8);

}  // namespace
}  // namespace cullhull::micro
