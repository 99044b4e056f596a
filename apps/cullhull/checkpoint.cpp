#include "checkpoint.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;

constexpr std::string_view magic = "cullhull checkpoint 1\n";

[[noreturn]] void broken(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_file, path + ": " + why + "; remove it to begin anew");
}

}  // namespace

// A line that identifies the format, a line of JSON, and a hull state, which has a check sum.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  const cullhull::BlockPosition& at = checkpoint.position;
  const nlohmann::json head = {{"file", at.file},
                               {"points", at.points},
                               {"file_points", at.file_points},
                               {"file_bytes", at.file_bytes},
                               {"file_lines", at.file_lines},
                               {"bytes", at.bytes},
                               {"input_bytes", at.input_bytes},
                               {"inputs", checkpoint.inputs}};
  std::string text(magic);
  text += head.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + '\n';
  const std::vector<std::byte> state = checkpoint.state.to_bytes();
  text.append(reinterpret_cast<const char*>(state.data()), state.size());
  cullhull::write_text(path, text);
}

std::optional<Checkpoint> read_checkpoint(const std::string& path) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return std::nullopt;
  if (std::filesystem::is_directory(path, unknown))
    throw Error(ErrorCode::io, path + ": a folder, where a checkpoint is a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::io, path + ": cannot open the checkpoint");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t line = text.find('\n', magic.size());
  if (!text.starts_with(magic) || line == std::string::npos) broken(path, "is no checkpoint");
  Checkpoint read;
  try {
    const auto head = nlohmann::json::parse(text.begin() + magic.size(),
                                            text.begin() + static_cast<std::ptrdiff_t>(line));
    head.at("file").get_to(read.position.file);
    head.at("points").get_to(read.position.points);
    head.at("file_points").get_to(read.position.file_points);
    head.at("file_bytes").get_to(read.position.file_bytes);
    head.at("file_lines").get_to(read.position.file_lines);
    head.at("bytes").get_to(read.position.bytes);
    head.at("input_bytes").get_to(read.position.input_bytes);
    head.at("inputs").get_to(read.inputs);
    read.state = cullhull::HullState::from_bytes(std::as_bytes(std::span(text).subspan(line + 1)));
  } catch (const nlohmann::json::exception&) {
    broken(path, "is a broken checkpoint");
  } catch (const Error& e) {
    broken(path, e.what());
  }
  return read;
}

}  // namespace app
