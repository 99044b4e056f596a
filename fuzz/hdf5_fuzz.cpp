// What an HDF5 file may say of its datasets; libhdf5 itself is not instrumented. Version 1.10
// crashes on some damaged files, whoever calls it: that ends a process but no run of several
// (-fork=1).
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iterator>

#include "fuzz/read_points.hpp"
#include "io/hdf5/hdf5_points.hpp"

namespace {

constexpr int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGABRT};
struct sigaction effects[std::size(faults)];

void end_if_libhdf5(int signal, siginfo_t*, void*) {
  if (cullhull::describe_library_fault() != nullptr) ::_exit(0);
  const auto which = std::find(std::begin(faults), std::end(faults), signal) - std::begin(faults);
  sigaction(signal, effects + which, nullptr);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  struct sigaction action = {};
  action.sa_sigaction = end_if_libhdf5;
  action.sa_flags = SA_SIGINFO;
  for (std::size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &action, effects + i);
  return 0;
}

// Libhdf5 allocates half a megabyte for every file it opens, and frees it: AddressSanitizer would
// keep 256 MB of such before it reuses any. What a damaged file makes it ask for is refused.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "quarantine_size_mb=16:allocator_may_return_null=1";
}

// What libhdf5 itself reads beyond a buffer of its own, or forgets of a damaged file, is its own to
// mend.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }
extern "C" const char* __asan_default_suppressions();
extern "C" const char* __asan_default_suppressions() { return "interceptor_via_lib:libhdf5"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cullhull;
  if (size == 0) return 0;
  static const char* const datasets[] = {"", "/p", "/x,/y", "/g/p"};
  const fuzz::NamedFile file(data + 1, size - 1);
  ReadOptions options;
  if (data[0] / 4 % 2 == 1) options = fuzz::choose_columns(data, size);
  options.threads = 1;
  options.memory_budget = std::uint64_t{1} << 24;
  try {
    const internal::PointData points =
        internal::read_hdf5(file.name(), datasets[data[0] % 4], options);
    if (points.view.dimension == 0) std::abort();
    fuzz::touch_all(points.view);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::out_of_budget || error.code() == ErrorCode::io) return 0;
    fuzz::check_refusal(error, true);
  }
  return 0;
}
