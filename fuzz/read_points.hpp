// What every reader must keep to, whatever the bytes.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "io/source.hpp"

namespace cullhull::fuzz {

/// Refusals are Error{bad_file} with one printable line, or, where columns or a decimal mark are
/// asked for that the file does not have, Error{invalid_argument}; anything else ends the fuzzer.
inline void check_refusal(const Error& error, bool asked = false) {
  if (error.code() != ErrorCode::bad_file &&
      !(asked && error.code() == ErrorCode::invalid_argument))
    std::abort();
  if (internal::printable_text(error.what()) != error.what()) std::abort();
}

/// Up to four columns by name, number or range, perhaps a key, and world or stored numbers: which,
/// the bytes themselves decide, so that an input that fails does so again.
inline ReadOptions choose_columns(const std::uint8_t* data, std::size_t size) {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 0x100000001B3U;
  hash ^= hash >> 29;
  const auto below = [&](std::uint64_t limit) {
    const std::uint64_t chosen = hash % limit;
    hash /= limit;
    return chosen;
  };
  static constexpr const char* columns[] = {"x", "y",  "z", "x",       "y",         "z",
                                            "Z", "w",  "a", "\"a,b\"", "intensity", "gps_time",
                                            "0", "1:", "2", "3:1"};
  ReadOptions options;
  const std::uint64_t count = 1 + below(4);
  for (std::uint64_t i = 0; i < count; ++i)
    options.columns += (i > 0 ? "," : "") + std::string(columns[below(std::size(columns))]);
  if (below(3) == 0) options.key = columns[below(std::size(columns))];
  if (options.key != "" && below(2) == 0) options.columns = "";
  const Numbers numbers[] = {Numbers::world, Numbers::grid, Numbers::file, Numbers::raw};
  options.numbers = numbers[below(4)];
  return options;
}

/// Reads every coordinate, so that the sanitizer sees each step beyond the memory of a view.
inline void touch_all(const PointView& view) {
  volatile double sink = 0;
  for (std::uint64_t i = 0; i < view.count; ++i)
    for (std::uint32_t j = 0; j < view.dimension; ++j) sink = view.at(i, j);
  (void)sink;
}

/// Reads `data` and then every coordinate. The bytes are copied, so that the sanitizer sees the
/// smallest step beyond their end.
inline void read_once(const std::uint8_t* data, std::size_t size, ReadOptions options) {
  const std::vector<char> bytes(data, data + size);
  options.threads = 1;
  unsigned remarks = 0;
  options.remark = [&](const std::string& line) {  // a few of a table, printable
    if (++remarks > 4 || internal::printable_text(line) != line) std::abort();
  };
  try {
    const internal::PointData points =
        internal::read_points({"input", bytes.data(), bytes.size()}, options);
    const PointView& view = points.view;
    if (view.dimension == 0) std::abort();
    // No reader may conjure points: each coordinate takes a bit of the file at least.
    if (view.count > 0 && view.dimension > size) std::abort();
    touch_all(view);
    if (!options.key.empty() && points.keys.size() != view.count) std::abort();
  } catch (const Error& error) {
    if (options.memory_budget != 0 && error.code() == ErrorCode::out_of_budget) return;
    check_refusal(error, !options.columns.empty() || !options.key.empty() || options.decimal != 0);
  }
}

/// The same as the options say, and once more with columns that the bytes choose.
inline void read_all(const std::uint8_t* data, std::size_t size, const ReadOptions& options) {
  read_once(data, size, options);
  ReadOptions chosen = choose_columns(data, size);
  chosen.format = options.format;
  chosen.decimal = options.decimal;
  chosen.memory_budget = options.memory_budget;
  chosen.raw_dimension = options.raw_dimension;
  chosen.raw_scalar = options.raw_scalar;
  read_once(data, size, chosen);
}

/// A file for readers that open files by name: in memory where the system has such a folder.
class NamedFile {
 public:
  NamedFile(const std::uint8_t* data, std::size_t size) {
    file_ = ::mkstemp(name_.data());
    if (file_ < 0 || ::write(file_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;
  ~NamedFile() {
    ::close(file_);
    ::unlink(name_.c_str());
  }
  const std::string& name() const { return name_; }

 private:
  std::string name_ =
      (std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") + std::string("/input.XXXXXX");
  int file_ = -1;
};

}  // namespace cullhull::fuzz
