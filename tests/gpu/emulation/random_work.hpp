// Random calls on the emulated device, in either precision.
#pragma once

#include <cstdint>
#include <random>

#include "agreement/random_seeds.hpp"
#include "emulation.hpp"

namespace cullhull::testing {

/// `Work` has run_as<Real>().
template <class Work>
class RandomWork {
 public:
  explicit RandomWork(std::uint64_t seed) : random_(seed), seed_(seed) {}

  void run() {
    emulation::settings() = {};
    emulation::restart(seed_);
    auto& work = static_cast<Work&>(*this);
    if (one_in(2))
      work.template run_as<float>();
    else
      work.template run_as<double>();
    emulation::settings() = {};
  }

 protected:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }

  std::mt19937_64 random_;
  std::uint64_t seed_;
};

}  // namespace cullhull::testing
