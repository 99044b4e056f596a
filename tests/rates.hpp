// Rates of another machine for the planner.
#pragma once

#include "filter/planner.hpp"

namespace cullhull::testing_support {

/// Every call assumes these rates until the object is destroyed.
class WithRates {
 public:
  explicit WithRates(const internal::Rates& rates) : before_(internal::assumed_rates()) {
    internal::assumed_rates() = rates;
  }
  ~WithRates() { internal::assumed_rates() = before_; }
  WithRates(const WithRates&) = delete;
  WithRates& operator=(const WithRates&) = delete;

 private:
  internal::Rates before_;
};

}  // namespace cullhull::testing_support
