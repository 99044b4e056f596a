// What a set gives by its own way and by the general one, without a filter.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "agreement/canonical_hash.hpp"
#include "call_options.hpp"
#include "cullhull/error.hpp"

namespace cullhull::testing_support {

/// The message, or the hash of what is no error.
template <class Call>
std::string outcome(const Call& hull) {
  try {
    return std::to_string(canonical_hash(hull()));
  } catch (const Error& e) {
    return e.what();
  }
}
inline std::string outcome(const PointView& points, CullMethod cull) {
  return outcome([&] { return convex_hull(points, options_of(0, cull)); });
}

inline void expect_general(const PointView& points, const std::string& what) {
  EXPECT_EQ(outcome(points, CullMethod::automatic), outcome(points, CullMethod::none)) << what;
}

}  // namespace cullhull::testing_support
