// Documents that a program prints, held against docs/cullhull.schema.json.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "agreement/json_schema.hpp"
#include "agreement/run_app.hpp"
#include "cullhull/version.hpp"

namespace cullhull::testing {

inline nlohmann::json json_in(const std::string& path) {
  return nlohmann::json::parse(read_file(path));
}

inline const JsonSchema& schema() {
  static const JsonSchema instance(json_in(CULLHULL_SCHEMA));
  return instance;
}

/// A document of this kind, checked against the schema, and its first members.
inline nlohmann::json expect_document(const std::string& text, const std::string& kind) {
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  EXPECT_FALSE(parsed.is_discarded()) << text;
  EXPECT_EQ(schema().fault(parsed, kind), "") << text.substr(0, 2000);
  const std::string first =
      "{\n\"version\": \"" CULLHULL_VERSION "\",\n\"kind\": \"" + kind + "\",\n\"schema\": 2,\n";
  EXPECT_EQ(text.substr(0, first.size()), first);
  return parsed;
}

/// Standard output, checked.
inline nlohmann::json expect_json(const std::vector<std::string>& arguments,
                                  const std::string& name, int status = 0) {
  const Ran ran = run_app(arguments);
  EXPECT_EQ(ran.status, status) << arguments[0] << ": " << ran.err;
  return expect_document(ran.out, name);
}

}  // namespace cullhull::testing
