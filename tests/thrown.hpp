// What a call throws, as text; what a text has.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "cullhull/error.hpp"

namespace cullhull::testing_support {

/// The message of the Error that `call` throws, which must have code `code` and be one line.
template <class Call>
std::string error_of(ErrorCode code, const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
    const std::string what = e.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  ADD_FAILURE() << "no error";
  return "";
}

/// Code and message of the Error that `call` throws; empty if it throws none.
template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    return std::to_string(static_cast<int>(e.code())) + " " + e.what();
  }
  return "";
}

/// Whether `text` has every one of `parts`.
template <class... Parts>
::testing::AssertionResult has(std::string_view text, const Parts&... parts) {
  for (const std::string_view part : {std::string_view(parts)...})
    if (text.find(part) == std::string_view::npos)
      return ::testing::AssertionFailure() << "no [" << part << "] in [" << text << "]";
  return ::testing::AssertionSuccess() << "there is [" << text << "]";
}

}  // namespace cullhull::testing_support
