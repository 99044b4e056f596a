// What a call throws, as text.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "cullhull/error.hpp"

namespace cullhull::testing_support {

/// The message of the Error that `body` throws, whose code is expected to be `code`.
template <class Body>
std::string message_of(const Body& body, ErrorCode code) {
  try {
    body();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  return "nothing was thrown";
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

}  // namespace cullhull::testing_support
