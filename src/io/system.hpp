// The system calls for files: POSIX, or their counterparts on Windows. No other source of io uses
// the system's own functions for files, memory maps and pipes. Paths are UTF-8.
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <process.h>
#else
#include <unistd.h>
#endif

namespace cullhull::internal::system {

inline constexpr int standard_input = 0, standard_output = 1;
inline constexpr std::size_t longest_path = 4096;

#if defined(_WIN32)
using FileStatus = struct _stat64;
int status_of(const char* path, FileStatus& status);
inline int status_of(int fd, FileStatus& status) { return _fstat64(fd, &status); }
inline bool is_folder(const FileStatus& s) { return (s.st_mode & _S_IFMT) == _S_IFDIR; }
inline bool is_regular(const FileStatus& s) { return (s.st_mode & _S_IFMT) == _S_IFREG; }
bool may_write(const char* path);
inline int close_file(int fd) { return _close(fd); }
int remove_file(const char* path);
inline int process_number() { return _getpid(); }
#else
using FileStatus = struct stat;
inline int status_of(const char* path, FileStatus& status) { return ::stat(path, &status); }
inline int status_of(int fd, FileStatus& status) { return ::fstat(fd, &status); }
inline bool is_folder(const FileStatus& s) { return S_ISDIR(s.st_mode); }
inline bool is_regular(const FileStatus& s) { return S_ISREG(s.st_mode); }
inline bool may_write(const char* path) { return ::access(path, W_OK) == 0; }
inline int close_file(int fd) { return ::close(fd); }
inline int remove_file(const char* path) { return ::unlink(path); }
inline int process_number() { return ::getpid(); }
#endif

/// Descriptors; -1 and errno where they cannot be had. Bytes are not translated, and child
/// processes do not inherit them.
int open_to_read(const char* path);
int open_to_write(const char* path);
int create_file(const char* path);  ///< fails where there is one
int duplicate(int fd);

/// A shared library by the name the system knows it under, its symbols for nobody else; nullptr
/// where it cannot be loaded. It stays loaded.
void* open_library(const char* name);
void* find_symbol(void* library, const char* name);

/// As many bytes as are available, 0 at the end, negative and errno for an error.
std::ptrdiff_t read_some(int fd, void* out, std::size_t size);
std::ptrdiff_t read_some_at(int fd, void* out, std::size_t size, std::uint64_t offset);
std::ptrdiff_t write_some(int fd, const void* data, std::size_t size);
/// Whether there are bytes to read, or the end, within 100 ms.
bool readable_soon(int fd);

/// Maps a file from `offset` on, a multiple of map_granularity(), read-only; nullptr and errno.
/// `at_once`: reads the pages immediately, if the system can.
const void* map_file(int fd, std::uint64_t offset, std::size_t size, bool at_once);
void unmap_file(const void* address, std::size_t size) noexcept;
std::size_t map_granularity();

/// Files whose names match, in no order. Windows: wildcards in the last part of the path alone.
std::vector<std::string> files_matching(const std::string& pattern);

/// Hints, which affect time only.
void expect_in_order(const void* mapped, std::size_t size);
void expect_in_order(int fd);
void expect_soon(int fd, std::uint64_t offset, std::size_t size);
void enlarge_pipe(int fd);
/// Reads a piece of a map into memory; does nothing on systems that cannot.
void fetch_pages(const void* mapped, std::size_t size);

/// Gives a new file the permissions of the one that it replaces.
void set_permissions(int fd, const FileStatus& like);

}  // namespace cullhull::internal::system
