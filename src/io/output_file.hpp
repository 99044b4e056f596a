// A file that appears whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace cullhull::internal {

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
  void commit();

 private:
  void open_beside(const std::string& path);
  void send(const char* data, std::size_t size);
  void abandon() noexcept;
  [[noreturn]] void refuse(const char* doing, int error);

  std::string name_;       ///< for messages
  std::string target_;     ///< after following links
  std::string temporary_;  ///< empty when written directly
  std::string buffer_;
  int descriptor_ = -1;
  int slot_ = -1;
};

/// `format` if given, else the extension of `path`; `unnamed` where the name tells nothing: "-", a
/// pipe or a device.
std::string output_format(const std::string& path, const std::string& format,
                          const std::string& unnamed);

/// Throws Error{invalid_argument}.
[[noreturn]] void refuse_format(const std::string& path, const std::string& format,
                                const char* known);

}  // namespace cullhull::internal
