#include "system.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstdio>

#include "parallel/paths.hpp"
#include "parallel/windows.hpp"
#if defined(_WIN32)
// After <windows.h>.
#include <fcntl.h>
#include <io.h>
#include <psapi.h>
#include <shellapi.h>

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <filesystem>
#else
#include <fcntl.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <poll.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>

extern char** environ;  // NOLINT: not every system declares it
#endif

namespace app::system {

#if defined(_WIN32)

std::ptrdiff_t write_some(int fd, const char* data, std::size_t size) {
  return _write(fd, data, static_cast<unsigned>(std::min<std::size_t>(size, INT_MAX)));
}
void prepare_process() {
  for (const int fd : {standard_input, standard_output, standard_error})
    (void)_setmode(fd, _O_BINARY);
  SetConsoleOutputCP(CP_UTF8);
}
std::vector<std::string> arguments(int, char**) {
  int count = 0;
  wchar_t** const words = CommandLineToArgvW(GetCommandLineW(), &count);
  std::vector<std::string> all;
  for (int i = 1; i < count; ++i) all.push_back(cullhull::internal::utf8_name(words[i]));
  LocalFree(words);
  return all;
}
bool is_terminal(int fd) {
  DWORD mode = 0;
  return GetConsoleMode(reinterpret_cast<HANDLE>(_get_osfhandle(fd)), &mode) != 0;
}
std::size_t terminal_columns(int fd) {
  CONSOLE_SCREEN_BUFFER_INFO screen;
  const auto console = reinterpret_cast<HANDLE>(_get_osfhandle(fd));
  if (!GetConsoleScreenBufferInfo(console, &screen)) return 0;
  return static_cast<std::size_t>(screen.srWindow.Right - screen.srWindow.Left + 1);
}
void open_if_closed(int fd) {
  if (_get_osfhandle(fd) == -1) (void)_open("NUL", fd == 0 ? _O_WRONLY : _O_RDONLY);
}
void open_in_browser(const std::string& path) {
  const std::wstring wide =
      std::filesystem::absolute(cullhull::internal::native_path(path)).wstring();
  (void)ShellExecuteW(nullptr, L"open", wide.c_str(), nullptr, nullptr, SW_SHOWNORMAL);
}
void wait_10_ms() { Sleep(10); }
void end(int status) { std::_Exit(status); }

std::size_t page_bytes() {
  SYSTEM_INFO info{};
  GetSystemInfo(&info);
  return info.dwPageSize;
}
std::uint64_t memory_bytes() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}
std::uint64_t peak_bytes() {
  PROCESS_MEMORY_COUNTERS counters{};
  return GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters)
             ? counters.PeakWorkingSetSize
             : 0;
}

namespace {

FileIdentity identity_of(HANDLE file) {
  FileIdentity identity;
  BY_HANDLE_FILE_INFORMATION i{};
  if (file == INVALID_HANDLE_VALUE) return identity;
  identity.exists = true;
  if (!GetFileInformationByHandle(file, &i)) return identity;  // a pipe, the console
  identity.folder = (i.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  identity.regular = !identity.folder;
  identity.device = i.dwVolumeSerialNumber;
  identity.number = std::uint64_t{i.nFileIndexHigh} << 32 | i.nFileIndexLow;
  identity.bytes = std::uint64_t{i.nFileSizeHigh} << 32 | i.nFileSizeLow;
  identity.changed = std::to_string(std::uint64_t{i.ftLastWriteTime.dwHighDateTime} << 32 |
                                    i.ftLastWriteTime.dwLowDateTime);
  return identity;
}

}  // namespace

FileIdentity identify(const std::string& path) {
  const HANDLE file = CreateFileW(cullhull::internal::native_path(path).c_str(), 0,
                                  FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                                  OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  FileIdentity identity = identity_of(file);
  if (file != INVALID_HANDLE_VALUE) CloseHandle(file);
  return identity;
}
FileIdentity identify(int fd) { return identity_of(reinterpret_cast<HANDLE>(_get_osfhandle(fd))); }

#else

std::ptrdiff_t write_some(int fd, const char* data, std::size_t size) {
  return ::write(fd, data, size);
}
void prepare_process() {
#if defined(__GLIBC__)
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY)
    ::mallopt(M_ARENA_MAX, 1);
#endif
}
std::vector<std::string> arguments(int argc, char** argv) { return {argv + 1, argv + argc}; }
bool is_terminal(int fd) { return ::isatty(fd) == 1; }
std::size_t terminal_columns(int fd) {
  winsize window{};
  return ::ioctl(fd, TIOCGWINSZ, &window) == 0 ? window.ws_col : 0;
}
void open_if_closed(int fd) {
  if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF)
    // The lowest free descriptor is `fd`. Opened in the wrong direction, so that reads and writes
    // fail.
    (void)!::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}
#if defined(__EMSCRIPTEN__)
void open_in_browser(const std::string&) {}  // a module starts no other program
#else
void open_in_browser(const std::string& path) {
#if defined(__APPLE__)
  const char* const opener = "open";
#else
  const char* const opener = "xdg-open";
  const auto set = [](const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr && *value != 0;
  };
  if (!set("DISPLAY") && !set("WAYLAND_DISPLAY")) return;
#endif
  posix_spawn_file_actions_t actions;
  if (::posix_spawn_file_actions_init(&actions) != 0) return;
  for (const int fd : {standard_input, standard_output, standard_error})
    ::posix_spawn_file_actions_addopen(&actions, fd, "/dev/null", fd == 0 ? O_RDONLY : O_WRONLY, 0);
  const std::string file = path.starts_with('-') ? "./" + path : path;
  char* const words[] = {const_cast<char*>(opener), const_cast<char*>(file.c_str()), nullptr};
  pid_t child = 0;
  (void)::posix_spawnp(&child, opener, &actions, nullptr, words, environ);  // none: no browser
  ::posix_spawn_file_actions_destroy(&actions);
}
#endif
void wait_10_ms() { ::poll(nullptr, 0, 10); }
void end(int status) { ::_exit(status); }

std::size_t page_bytes() { return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)); }
std::uint64_t memory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  return pages > 0 ? static_cast<std::uint64_t>(pages) * page_bytes() : 0;
}
std::uint64_t peak_bytes() {
  // getrusage would include the peak of the parent before exec.
  if (std::FILE* file = std::fopen("/proc/self/status", "re")) {
    char line[256];
    unsigned long long kilobytes = 0;
    bool found = false;
    while (!found && std::fgets(line, sizeof line, file) != nullptr)
      found = std::sscanf(line, "VmHWM: %llu kB", &kilobytes) == 1;
    std::fclose(file);
    if (found) return kilobytes * 1024;
  }
  rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
#if defined(__APPLE__)
  return static_cast<std::uint64_t>(usage.ru_maxrss);  // bytes there
#else
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
#endif
}

namespace {

FileIdentity identity_of(int failed, const struct stat& status) {
  FileIdentity identity;
  if (failed != 0) return identity;
  identity.exists = true;
  identity.regular = S_ISREG(status.st_mode);
  identity.folder = S_ISDIR(status.st_mode);
  identity.device = static_cast<std::uint64_t>(status.st_dev);
  identity.number = static_cast<std::uint64_t>(status.st_ino);
  identity.bytes = static_cast<std::uint64_t>(status.st_size);
#if defined(__APPLE__)
  const timespec& changed = status.st_mtimespec;
#else
  const timespec& changed = status.st_mtim;
#endif
  identity.changed = std::to_string(changed.tv_sec) + "." + std::to_string(changed.tv_nsec);
  return identity;
}

}  // namespace

FileIdentity identify(const std::string& path) {
  struct stat status {};
  const int failed = ::stat(path.c_str(), &status);
  return identity_of(failed, status);
}
FileIdentity identify(int fd) {
  struct stat status {};
  const int failed = ::fstat(fd, &status);
  return identity_of(failed, status);
}

#endif

}  // namespace app::system
