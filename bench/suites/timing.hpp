// The clock and the median for all measurements.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>
#include <vector>

namespace cullhull::bench {

template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  std::forward<Work>(work)();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The median; of an even number of values the mean of the middle two; 0 for no values.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

template <class Work>
double median_seconds(unsigned repeat, Work&& work) {
  std::vector<double> times;
  for (unsigned k = 0; k < repeat; ++k) times.push_back(seconds_of(work));
  return median(std::move(times));
}

/// The median of consecutive calls, each after prepare(), during 20 ms (at least one call). Single
/// calls would mislead for small inputs: for any library, a program's first call takes several
/// times as long. (The suite `calls` measures first calls.)
template <class Prepare, class Work>
double settled_seconds(Prepare&& prepare, Work&& work) {
  constexpr double enough = 0.02;
  std::vector<double> times;
  double spent = 0;
  while (times.empty() || spent < enough) {
    prepare();
    times.push_back(seconds_of(work));
    spent += times.back();
  }
  return median(std::move(times));
}

}  // namespace cullhull::bench
