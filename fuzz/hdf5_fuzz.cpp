// What an HDF5 file may say of its datasets; libhdf5 itself is not instrumented.
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz/read_points.hpp"
#include "io/hdf5/hdf5_points.hpp"

namespace {

/// A file in memory, as libhdf5 opens files by name.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : file_(::memfd_create("input.h5", 0)) {
    if (file_ < 0 || ::write(file_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(file_); }
  std::string name() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cullhull;
  if (size == 0) return 0;
  static const char* const datasets[] = {"", "/p", "/x,/y", "/g/p"};
  const MemoryFile file(data + 1, size - 1);
  ReadOptions options;
  options.threads = 1;
  options.memory_budget = std::uint64_t{1} << 24;
  try {
    internal::Slice slice;
    const internal::PointData points =
        internal::read_hdf5(file.name(), datasets[data[0] % 4], options, slice);
    if (points.view.dimension == 0) std::abort();
    volatile double sink = 0;
    for (std::uint64_t i = 0; i < points.view.count; ++i)
      for (std::uint32_t j = 0; j < points.view.dimension; ++j) sink = points.view.at(i, j);
    (void)sink;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::out_of_budget || error.code() == ErrorCode::io) return 0;
    fuzz::check_refusal(error, true);
  }
  return 0;
}
