// Expands words to the files that they name.
#include <algorithm>
#include <fstream>

#include "cullhull/error.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/blocks/block_source.hpp"
#include "io/blocks/read_ahead.hpp"
#include "io/packed/archive.hpp"
#include "io/packed/unpack.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/paths.hpp"
namespace cullhull {

namespace {

/// A file, folder or pattern a line; blank lines and lines that begin with # are left out.
std::vector<std::string> listed(const std::string& path) {
  internal::system::FileStatus status{};
  if (internal::system::status_of(path.c_str(), status) == 0 && internal::system::is_folder(status))
    throw Error(ErrorCode::io, internal::display_name(path),
                ": a folder, where a list of files is wanted; without the @ its "
                "files are the input");
  std::ifstream list(internal::native_path(path));
  if (!list) throw Error(ErrorCode::io, internal::display_name(path), ": cannot open the list");
  std::vector<std::string> words;
  for (std::string line; std::getline(list, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty() && line[0] != '#') words.push_back(line);
  }
  return words;
}

}  // namespace

std::vector<std::string> input_files(const std::vector<std::string>& words,
                                     const ReadOptions& options) {
  std::vector<std::string> spelled_out;
  for (const std::string& word : words) {
    internal::system::FileStatus status{};
    if (word.size() > 1 && word[0] == '@' && internal::system::status_of(word.c_str(), status) != 0)
      for (std::string& line : listed(word.substr(1))) spelled_out.push_back(std::move(line));
    else
      spelled_out.push_back(word);
  }
  if (spelled_out.empty()) throw Error(ErrorCode::invalid_argument, "no input is named");
  std::vector<std::string> files = sequence_files(spelled_out, options);
  std::size_t streams = 0;
  for (const std::string& file : files) streams += file == "-";
  if (streams > 1) throw Error(ErrorCode::invalid_argument, "standard input can be read only once");
  return files;
}

std::string file_of_input(const std::string& word) { return internal::split_input(word).file; }

std::uint64_t input_bytes(const std::vector<std::string>& files) {
  std::uint64_t total = 0;
  for (const std::string& file : files) {
    internal::system::FileStatus status{};
    if (file == "-" || internal::system::status_of(file_of_input(file).c_str(), status) != 0 ||
        !internal::system::is_regular(status))
      return 0;
    total += static_cast<std::uint64_t>(status.st_size);
  }
  return total;
}

bool worth_streaming(const std::vector<std::string>& files, const Options& options) {
  if (std::any_of(files.begin(), files.end(), internal::named_as_packed)) return true;
  const std::uint64_t half = internal::resolve_budget(options.memory_budget) / 2;
  const std::uint64_t block = std::min(BlockOptions().block_bytes, half + 1);
  for (const std::string& file : files) {
    const std::string path = file_of_input(file);
    if (!internal::is_pipe(path)) continue;
    const bool beyond = internal::read_ahead(path, block, options.stop);
    const std::string_view seen = internal::seen_ahead(path);
    // What is read whole has more room without blocks; what is compressed has an unknown size.
    const bool packed = internal::packing_of(seen, "", {}) != internal::Packing::none;
    if (packed || (beyond && internal::comes_in_blocks({path, seen.data(), seen.size()}, {}, true)))
      return true;
  }
  std::uint64_t unpacked = input_bytes(files);
  constexpr std::uint64_t most = 8;  // bytes of records in a byte of LAZ, but for what is constant
  for (const std::string& file : files)
    if (const std::string ending = internal::extension_of(file);
        ending == "laz" || ending == "copc")
      unpacked += (most - 1) * input_bytes({file});
  return unpacked > half;
}

}  // namespace cullhull
