// System calls other than files': POSIX, or their counterparts on Windows. Signals are in
// signals.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace app::system {

inline constexpr int standard_input = 0, standard_output = 1, standard_error = 2;

/// As many bytes as can be written at once; negative and errno.
std::ptrdiff_t write_some(int fd, const char* data, std::size_t size);
bool is_terminal(int fd);
/// The width of the terminal's window; 0 if unknown.
std::size_t terminal_columns(int fd);
/// Opens a null device for a standard stream that was closed.
void open_if_closed(int fd);
/// To be called first. Where the addresses of the process are limited: one heap for all threads, as
/// a heap for each takes 128 MB of addresses for a moment and 64 MB for good. On Windows: standard
/// streams pass bytes as they are, and the console takes UTF-8.
void prepare_process();
/// The words of the command line behind the program's name, in UTF-8.
std::vector<std::string> arguments(int argc, char** argv);
void wait_10_ms();                  ///< callable from a signal handler
[[noreturn]] void end(int status);  ///< at once: no destructors, no handlers

/// Asks the desktop to show a file, where there is one; does not wait for it, and says nothing.
void open_in_browser(const std::string& path);

std::size_t page_bytes();
std::uint64_t memory_bytes();  ///< of the machine
std::uint64_t peak_bytes();    ///< that this process has held in memory at once

/// The identity of a file, whatever name it was opened by.
struct FileIdentity {
  bool exists = false, regular = false, folder = false;
  std::uint64_t device = 0, number = 0, bytes = 0;
  std::string changed;  ///< its modification time, only to be compared
};
FileIdentity identify(const std::string& path);
FileIdentity identify(int fd);

}  // namespace app::system
