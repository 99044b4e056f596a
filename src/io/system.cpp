#include "io/system.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <new>

#include "parallel/paths.hpp"
#include "parallel/windows.hpp"
#if !defined(_WIN32)
#include <dlfcn.h>
#include <fcntl.h>
#include <glob.h>
#include <poll.h>
#include <sys/mman.h>
#if defined(__linux__) && !defined(MADV_POPULATE_READ)
#define MADV_POPULATE_READ 22  // Linux 5.14; missing in older C headers
#endif
#endif

namespace cullhull::internal::system {

#if defined(_WIN32)

namespace {

/// errno of the last error of Windows.
int failed() {
  switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
      return errno = ENOENT, -1;
    case ERROR_FILE_EXISTS:
      return errno = EEXIST, -1;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
      return errno = EACCES, -1;
    case ERROR_HANDLE_DISK_FULL:
    case ERROR_DISK_FULL:
      return errno = ENOSPC, -1;
    case ERROR_BROKEN_PIPE:
    case ERROR_NO_DATA:
      return errno = EPIPE, -1;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
      return errno = ENOMEM, -1;
    default:
      return errno = EIO, -1;
  }
}

HANDLE handle_of(int fd) { return reinterpret_cast<HANDLE>(_get_osfhandle(fd)); }
unsigned at_most(std::size_t size) {
  return static_cast<unsigned>(std::min<std::size_t>(size, INT_MAX));
}

}  // namespace

int status_of(const char* path, FileStatus& status) {
  const std::filesystem::path name = native_path(path);  // "folder/" is not there, "folder" is
  return _wstat64((name.has_filename() ? name : name.parent_path()).c_str(), &status);
}
bool may_write(const char* path) { return _waccess(native_path(path).c_str(), 2) == 0; }
int remove_file(const char* path) { return _wunlink(native_path(path).c_str()); }
int open_to_read(const char* path) {
  const int fd = _wopen(native_path(path).c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT);
  const int error = errno;
  FileStatus status{};
  const bool folder = fd < 0 && status_of(path, status) == 0 && is_folder(status);
  errno = folder ? EISDIR : error;
  return fd;
}
int open_to_write(const char* path) {
  return _wopen(native_path(path).c_str(), _O_WRONLY | _O_BINARY | _O_NOINHERIT);
}
// An interrupt removes what is unfinished while it is open: it must be shared for that.
int create_file(const char* path) {
  const HANDLE file = CreateFileW(native_path(path).c_str(), GENERIC_WRITE,
                                  FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                                  CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) return static_cast<int>(failed());
  return _open_osfhandle(reinterpret_cast<std::intptr_t>(file), _O_BINARY);
}
int duplicate(int fd) { return _dup(fd); }

void* open_library(const char* name) { return LoadLibraryA(name); }
void* find_symbol(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}

// By handles: descriptors of standard streams translate line ends.
std::ptrdiff_t read_some(int fd, void* out, std::size_t size) {
  DWORD got = 0;
  if (ReadFile(handle_of(fd), out, at_most(size), &got, nullptr)) return got;
  return GetLastError() == ERROR_BROKEN_PIPE ? 0 : failed();  // its writer has ended
}
// By a handle of its own: a reading at an offset moves the place where the next one of the same
// handle begins.
std::ptrdiff_t read_some_at(int fd, void* out, std::size_t size, std::uint64_t offset) {
  const HANDLE file = ReOpenFile(handle_of(fd), GENERIC_READ,
                                 FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, 0);
  if (file == INVALID_HANDLE_VALUE) return failed();
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(offset);
  place.OffsetHigh = static_cast<DWORD>(offset >> 32);
  DWORD got = 0;
  const bool read = ReadFile(file, out, at_most(size), &got, &place) != 0;
  const std::ptrdiff_t result = read ? got : GetLastError() == ERROR_HANDLE_EOF ? 0 : failed();
  CloseHandle(file);
  return result;
}
std::ptrdiff_t write_some(int fd, const void* data, std::size_t size) {
  DWORD sent = 0;
  return WriteFile(handle_of(fd), data, at_most(size), &sent, nullptr) ? sent : failed();
}
bool readable_soon(int fd) {
  DWORD waiting = 0;  // of pipes; anything else has bytes or is at its end
  if (!PeekNamedPipe(handle_of(fd), nullptr, 0, nullptr, &waiting, nullptr) || waiting > 0)
    return true;
  Sleep(100);
  return false;
}

const void* map_file(int fd, std::uint64_t offset, std::size_t size, bool) {
  const HANDLE mapping = CreateFileMappingW(handle_of(fd), nullptr, PAGE_READONLY, 0, 0, nullptr);
  if (mapping == nullptr) return failed(), nullptr;
  const void* const address = MapViewOfFile(
      mapping, FILE_MAP_READ, static_cast<DWORD>(offset >> 32), static_cast<DWORD>(offset), size);
  if (address == nullptr) failed();
  CloseHandle(mapping);  // the view keeps it
  return address;
}
void unmap_file(const void* address, std::size_t) noexcept { UnmapViewOfFile(address); }
std::size_t map_granularity() {
  SYSTEM_INFO info{};
  GetSystemInfo(&info);
  return info.dwAllocationGranularity;
}

std::vector<std::string> files_matching(const std::string& pattern) {
  const std::size_t slash = pattern.find_last_of(separators);
  const std::string folder = slash == std::string::npos ? "" : pattern.substr(0, slash + 1);
  std::vector<std::string> found;
  WIN32_FIND_DATAW entry{};
  const HANDLE search = FindFirstFileW(native_path(pattern).c_str(), &entry);
  if (search == INVALID_HANDLE_VALUE) return found;
  do {
    if ((entry.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) == 0)
      found.push_back(folder + utf8_name(entry.cFileName));
  } while (FindNextFileW(search, &entry));
  FindClose(search);
  return found;
}

void expect_in_order(const void*, std::size_t) {}
void expect_in_order(int) {}
void expect_soon(int, std::uint64_t, std::size_t) {}
void enlarge_pipe(int) {}
void fetch_pages(const void*, std::size_t) {}
void set_permissions(int, const FileStatus&) {}

#else

int open_to_read(const char* path) { return ::open(path, O_RDONLY | O_CLOEXEC); }
int open_to_write(const char* path) { return ::open(path, O_WRONLY | O_CLOEXEC); }
int create_file(const char* path) {
  return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}
int duplicate(int fd) { return ::dup(fd); }

#if CULLHULL_HAVE_HDF5  // else no library is loaded, nor dlopen's own linked (glibc before 2.34)
void* open_library(const char* name) { return ::dlopen(name, RTLD_NOW | RTLD_LOCAL); }
void* find_symbol(void* library, const char* name) { return ::dlsym(library, name); }
#endif

std::ptrdiff_t read_some(int fd, void* out, std::size_t size) { return ::read(fd, out, size); }
std::ptrdiff_t read_some_at(int fd, void* out, std::size_t size, std::uint64_t offset) {
  return ::pread(fd, out, size, static_cast<off_t>(offset));
}
std::ptrdiff_t write_some(int fd, const void* data, std::size_t size) {
  return ::write(fd, data, size);
}
bool readable_soon(int fd) {
  pollfd asked{fd, POLLIN, 0};
  return ::poll(&asked, 1, 100) != 0;
}

const void* map_file(int fd, std::uint64_t offset, std::size_t size, bool at_once) {
  int flags = MAP_PRIVATE;
#if defined(MAP_POPULATE)
  if (at_once) flags |= MAP_POPULATE;
#else
  (void)at_once;
#endif
  void* const address = ::mmap(nullptr, size, PROT_READ, flags, fd, static_cast<off_t>(offset));
  return address == MAP_FAILED ? nullptr : address;
}
void unmap_file(const void* address, std::size_t size) noexcept {
  ::munmap(const_cast<void*>(address), size);
}
std::size_t map_granularity() { return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)); }

std::vector<std::string> files_matching(const std::string& pattern) {
  glob_t matches = {};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches);
  std::vector<std::string> found(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  ::globfree(&matches);
  if (code == GLOB_NOSPACE) throw std::bad_alloc();
  return found;
}

void expect_in_order(const void* mapped, std::size_t size) {
  (void)::madvise(const_cast<void*>(mapped), size, MADV_SEQUENTIAL);
}
void expect_in_order(int fd) {
#if defined(POSIX_FADV_SEQUENTIAL)
  (void)::posix_fadvise(fd, 0, 0, POSIX_FADV_SEQUENTIAL);
#else
  (void)fd;
#endif
}
void expect_soon(int fd, std::uint64_t offset, std::size_t size) {
#if defined(POSIX_FADV_WILLNEED)
  (void)::posix_fadvise(fd, static_cast<off_t>(offset), static_cast<off_t>(size),
                        POSIX_FADV_WILLNEED);
#else
  (void)fd, (void)offset, (void)size;
#endif
}
void enlarge_pipe(int fd) {
#if defined(F_SETPIPE_SZ)
  (void)::fcntl(fd, F_SETPIPE_SZ, 1 << 20);
#else
  (void)fd;
#endif
}
void fetch_pages(const void* mapped, std::size_t size) {
#if defined(MADV_POPULATE_READ)
  (void)::madvise(const_cast<void*>(mapped), size, MADV_POPULATE_READ);
#else
  (void)mapped, (void)size;
#endif
}
void set_permissions(int fd, const FileStatus& like) { (void)::fchmod(fd, like.st_mode & 07777); }

#endif

}  // namespace cullhull::internal::system
