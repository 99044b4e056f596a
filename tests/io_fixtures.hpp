// Files and bytes for the tests of src/io.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/source.hpp"
#include "parallel/byte_order.hpp"
#include "thrown.hpp"

namespace cullhull::testing {

using testing_support::error_of;
using testing_support::has;

/// A folder that is gone when the test is over.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() /
            ("cullhull-io-" + std::to_string(getpid()) + "-" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_),
                                                  std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Whether a reader may give little-endian numbers where they lie.
inline constexpr bool lies_ready = internal::little_endian_machine;

/// Little-endian, as most files are.
template <class... T>
std::string bytes_of(T... values) {
  std::string out;
  ((values = internal::little_endian(values)), ...);
  (out.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return out;
}

template <class T>
std::string bytes_of_big_endian(T value) {
  std::string out = bytes_of(value);
  std::reverse(out.begin(), out.end());
  return out;
}

inline std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  std::string out("\x93NUMPY");
  out += static_cast<char>(version);
  out += '\0';
  out += bytes_of(static_cast<std::uint16_t>(dictionary.size()));
  if (version > 1) out += std::string(2, '\0');
  return out + dictionary + data;
}

inline internal::PointData parse(std::string_view bytes, const std::string& format,
                                 ReadOptions options = {}) {
  options.format = format;
  return internal::read_points({"F", bytes.data(), bytes.size()}, options);
}

using Rows = std::vector<std::vector<double>>;

inline Rows rows_of(const PointView& view) {
  Rows rows(view.count);
  for (std::uint64_t i = 0; i < view.count; ++i)
    for (std::uint32_t j = 0; j < view.dimension; ++j) rows[i].push_back(view.at(i, j));
  return rows;
}

/// Takes points in blocks and drops them.
inline BlockVisitor no_visitor() {
  BlockVisitor visitor;
  visitor.points = [](const PointView&, std::uint64_t) {};
  return visitor;
}

/// Options by which what is remarked goes to `said`.
inline ReadOptions remarks_to(std::vector<std::string>& said) {
  ReadOptions options;
  options.remark = [&](const std::string& line) { said.push_back(line); };
  return options;
}

/// The one line that reading these bytes, whose points are `want`, says to the user.
inline std::string remark_on(std::string_view bytes, const std::string& format, const Rows& want) {
  std::vector<std::string> said;
  EXPECT_EQ(rows_of(parse(bytes, format, remarks_to(said)).view), want) << bytes;
  EXPECT_LE(said.size(), 1U) << bytes;
  return said.empty() ? "" : said[0];
}

/// All points by id, read in blocks of about `block_bytes`, so small that rows are cut everywhere.
inline Rows rows_in_blocks(const std::string& path, const ReadOptions& read = {},
                           std::uint64_t block_bytes = 4096) {
  std::mutex mutex;
  std::map<std::uint64_t, Rows> found;
  BlockVisitor visitor;
  visitor.points = [&](const PointView& block, std::uint64_t first) {
    const std::lock_guard lock(mutex);
    found[first] = rows_of(block);
  };
  BlockOptions options;
  options.read = read;
  options.block_bytes = block_bytes;
  options.readers = 3;
  visit_blocks({path}, visitor, options);
  Rows all;
  for (const auto& [first, part] : found) {
    EXPECT_EQ(first, all.size());
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// The message for bytes that must be refused.
inline std::string refusal(std::string_view bytes, const std::string& format,
                           const ReadOptions& options = {}) {
  return error_of(ErrorCode::bad_file, [&] { parse(bytes, format, options); });
}

/// What reading the file says against it, "" if nothing: the same whole and in blocks.
inline std::string error_whole_and_in_blocks(const std::string& path) {
  const std::string whole = error_of([&] { open_points(path); });
  EXPECT_EQ(error_of([&] { visit_blocks({path}, no_visitor(), {}); }), whole);
  return whole.substr(whole.find(' ') + 1);  // without the code
}

}  // namespace cullhull::testing
