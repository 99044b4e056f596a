// What the program asks of the system beside files: POSIX, or what Windows has in its place.
// Signals are in signals.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace app::system {

inline constexpr int standard_input = 0, standard_output = 1, standard_error = 2;

/// As many bytes as can be written at once; negative and errno.
std::ptrdiff_t write_some(int fd, const char* data, std::size_t size);
bool is_terminal(int fd);
/// Gives a closed standard stream a descriptor that reads or writes nothing.
void open_if_closed(int fd);
/// From now on what is written there is gone.
void silence(int fd);
void wait_10_ms();                  ///< also in a signal handler
[[noreturn]] void end(int status);  ///< at once: no destructors, no handlers

std::size_t page_bytes();
std::uint64_t memory_bytes();  ///< of the machine
std::uint64_t peak_bytes();    ///< that this process has held in memory at once

/// A file as the system knows it, whatever its names are.
struct FileIdentity {
  bool exists = false, regular = false, folder = false;
  std::uint64_t device = 0, number = 0, bytes = 0;
  std::string changed;  ///< the time of its last change, only to be compared
};
FileIdentity identify(const std::string& path);
FileIdentity identify(int fd);

}  // namespace app::system
