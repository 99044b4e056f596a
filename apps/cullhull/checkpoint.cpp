#include "checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "parallel/paths.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;

constexpr std::string_view kind = "cullhull checkpoint ", version = "2";
constexpr std::size_t sum_digits = 16;

[[noreturn]] void broken(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_file, path, ": ", why, "; remove it to begin anew");
}

/// FNV-1a, as hexadecimal digits.
std::string checksum(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return fmt::format("{:0{}x}", sum, sum_digits);
}

/// What follows the line with the check sum, once that is found right.
std::string_view checked(const std::string& path, std::string_view text) {
  if (!text.starts_with(kind)) broken(path, "is not a checkpoint");
  const std::size_t line = text.find('\n');
  const std::string_view found = text.substr(kind.size(), line - kind.size());
  if (found != version) broken(path, "is a checkpoint that another version of the program wrote");
  std::string_view rest = text.substr(line + 1);
  if (rest.size() <= sum_digits || rest[sum_digits] != '\n') broken(path, "is a broken checkpoint");
  const std::string_view sum = rest.substr(0, sum_digits);
  rest.remove_prefix(sum_digits + 1);
  if (sum != checksum(rest)) broken(path, "is a broken checkpoint: its check sum is wrong");
  return rest;
}

}  // namespace

// A line with the version, a line with the check sum of all that follows: a line of JSON, and a
// hull state.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  const cullhull::BlockPosition& at = checkpoint.position;
  const nlohmann::json head = {{"file", at.file},
                               {"points", at.points},
                               {"file_points", at.file_points},
                               {"file_bytes", at.file_bytes},
                               {"file_lines", at.file_lines},
                               {"bytes", at.bytes},
                               {"input_bytes", at.input_bytes},
                               {"skipped", at.skipped},
                               {"inputs", checkpoint.inputs}};
  std::string text = head.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + '\n';
  const std::vector<std::byte> state = checkpoint.state.to_bytes();
  text.append(reinterpret_cast<const char*>(state.data()), state.size());
  cullhull::write_text(path, fmt::format("{}{}\n{}\n{}", kind, version, checksum(text), text));
}

std::optional<Checkpoint> read_checkpoint(const std::string& path) {
  const std::filesystem::path place = cullhull::internal::native_path(path);
  std::error_code unknown;
  if (!std::filesystem::exists(place, unknown)) return std::nullopt;
  if (std::filesystem::is_directory(place, unknown))
    throw Error(ErrorCode::io, path, ": a folder, where a checkpoint is a file");
  std::ifstream file(place, std::ios::binary);
  if (!file) throw Error(ErrorCode::io, path, ": cannot open the checkpoint");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string_view rest = checked(path, text);
  const std::size_t line = std::min(rest.find('\n'), rest.size() - 1);
  Checkpoint read;
  try {
    const auto head = nlohmann::json::parse(rest.substr(0, line));
    head.at("file").get_to(read.position.file);
    head.at("points").get_to(read.position.points);
    head.at("file_points").get_to(read.position.file_points);
    head.at("file_bytes").get_to(read.position.file_bytes);
    head.at("file_lines").get_to(read.position.file_lines);
    head.at("bytes").get_to(read.position.bytes);
    head.at("input_bytes").get_to(read.position.input_bytes);
    read.position.skipped = head.value("skipped", std::uint64_t{0});  // others before --skip-nan
    head.at("inputs").get_to(read.inputs);
    read.state = cullhull::HullState::from_bytes(std::as_bytes(std::span(rest).subspan(line + 1)));
  } catch (const nlohmann::json::exception&) {
    broken(path, "is a broken checkpoint");
  } catch (const Error& e) {
    broken(path, e.what());
  }
  return read;
}

}  // namespace app
