// Checks JSON against a schema, as far as docs/cullhull.schema.json uses the language (JSON Schema,
// draft 2020-12), and more strictly: a member that the schema does not name is a fault, so that
// nothing goes undocumented. A word of the language that is not known here is a fault too.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cullhull::testing {

class JsonSchema {
 public:
  using Json = nlohmann::json;
  explicit JsonSchema(Json schema) : root_(std::move(schema)) {}

  /// What is wrong with `value` as a `name` of $defs; empty if nothing is.
  std::string fault(const Json& value, const std::string& name) const {
    return check(value, root_.at("$defs").at(name), name);
  }

 private:
  static bool has_type(const Json& value, const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
           (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
           (type == "null" && value.is_null()) || (type == "number" && value.is_number()) ||
           (type == "integer" && value.is_number_integer());
  }

  std::string check(const Json& value, const Json& schema, const std::string& at) const {
    for (const auto& [word, rule] : schema.items()) {
      const std::string found = check_word(value, schema, word, rule, at);
      if (!found.empty()) return found;
    }
    return "";
  }

  std::string check_word(const Json& value, const Json& schema, const std::string& word,
                         const Json& rule, const std::string& at) const {
    if (word == "description") return "";
    if (word == "$ref")
      return check(value, root_.at(Json::json_pointer(rule.get<std::string>().substr(1))), at);
    if (word == "const") return value == rule ? "" : at + " is not " + rule.dump();
    if (word == "enum")
      return std::find(rule.begin(), rule.end(), value) != rule.end()
                 ? ""
                 : at + " is none of " + rule.dump();
    if (word == "type") {
      const std::vector<std::string> types =
          rule.is_array() ? rule.get<std::vector<std::string>>()
                          : std::vector<std::string>{rule.get<std::string>()};
      return std::any_of(types.begin(), types.end(),
                         [&](const auto& t) { return has_type(value, t); })
                 ? ""
                 : at + " is no " + rule.dump();
    }
    if (word == "minimum")
      return !value.is_number() || value.get<double>() >= rule.get<double>()
                 ? ""
                 : at + " is below " + rule.dump();
    if (word == "anyOf") return check_any(value, rule, at);
    if (word == "items") {
      for (std::size_t i = 0; value.is_array() && i < value.size(); ++i)
        if (auto found = check(value[i], rule, at + "[" + std::to_string(i) + "]"); !found.empty())
          return found;
      return "";
    }
    if (word == "required") {
      for (const auto& key : rule)
        if (value.is_object() && !value.contains(key.get<std::string>()))
          return at + " has no " + key.dump();
      return "";
    }
    if (word == "properties" || word == "additionalProperties")
      return check_members(value, schema, at);
    return "unknown word of the schema's language: " + word;
  }

  std::string check_any(const Json& value, const Json& choices, const std::string& at) const {
    std::string why;
    for (const Json& choice : choices) {
      const std::string found = check(value, choice, at);
      if (found.empty()) return "";
      why += (why.empty() ? "" : "; or ") + found;
    }
    return why;
  }

  std::string check_members(const Json& value, const Json& schema, const std::string& at) const {
    if (!value.is_object()) return "";
    for (const auto& [key, member] : value.items()) {
      const Json* rule = nullptr;
      if (schema.contains("properties") && schema["properties"].contains(key))
        rule = &schema["properties"][key];
      else if (schema.contains("additionalProperties"))
        rule = &schema["additionalProperties"];
      if (rule == nullptr) return at + "." + key + " is not in the schema";
      if (auto found = check(member, *rule, at + "." + key); !found.empty()) return found;
    }
    return "";
  }

  Json root_;
};

}  // namespace cullhull::testing
