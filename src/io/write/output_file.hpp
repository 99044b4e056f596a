// A file that appears whole or not at all.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>

#include "cullhull/point_view.hpp"
#include "io/file_formats.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {

/// Appends the text of the items [begin, end) to `text`.
using TextOfItems = std::function<void(std::string& text, std::uint64_t begin, std::uint64_t end)>;

/// Writes beside the target and renames in commit(); the destructor removes what was not committed.
/// "-" is standard output; it, and targets that are no regular files, are written directly.
/// Every failure is Error{io} with the system's reason.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  void write(std::string_view bytes);
  /// Writes the text of the items [0, count), which all threads format: a number takes some 50 ns.
  void write_items(std::uint64_t count, const TextOfItems& text_of);
  void commit();

 private:
  void open_beside(const std::string& path);
  void send(const char* data, std::size_t size);
  void abandon() noexcept;
  [[noreturn]] void refuse(const char* doing, const std::error_code& error);

  std::string name_;       ///< for messages
  std::string target_;     ///< after following links
  std::string temporary_;  ///< empty when written directly
  std::string buffer_;
  int descriptor_ = -1;
  int slot_ = -1;
};

/// `count` numbers, little-endian.
template <class T>
void write_little_endian(OutputFile& out, const T* items, std::size_t count) {
  if constexpr (little_endian_machine) {
    out.write({reinterpret_cast<const char*>(items), count * sizeof(T)});
  } else {
    std::array<T, 512> block;
    for (std::size_t i = 0; i < count; i += block.size()) {
      const std::size_t n = std::min(block.size(), count - i);
      std::transform(items + i, items + i + n, block.begin(), little_endian<T>);
      out.write({reinterpret_cast<const char*>(block.data()), n * sizeof(T)});
    }
  }
}

/// Numbers of a scalar type, little-endian. Error{invalid_argument} for one that does not fit it.
void write_values(OutputFile& out, const double* numbers, std::uint64_t count, ScalarType type);

/// `format` if given, else the extension of `path`; `unnamed` where there is none to go by: "-", a
/// pipe or a device.
std::string output_format(const std::string& path, const std::string& format,
                          const std::string& unnamed);

/// Throws Error{invalid_argument} that lists the extensions of these kinds.
[[noreturn]] void refuse_format(const std::string& path, const std::string& format,
                                OutputKinds kinds);

}  // namespace cullhull::internal
