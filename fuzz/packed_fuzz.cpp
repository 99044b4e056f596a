// .gz, .zst and .npz, whatever is in them; the first byte chooses.
#include "fuzz/read_points.hpp"
#include "io/packed/unwrap.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cullhull;
  if (size == 0) return 0;
  static const char* const names[] = {"a.gz", "a.zst", "a.npz", "a.csv.gz", "a.npy.zst", "a"};
  const std::string name = names[data[0] % 6];
  const std::vector<char> bytes(data + 1, data + size);
  ReadOptions options;
  options.threads = 1;
  options.memory_budget = std::uint64_t{1} << 24;
  internal::Source source{name, bytes.data(), bytes.size()};
  internal::Buffer memory;
  try {
    internal::unwrap({name, data[0] % 5 == 4 ? "b" : ""}, source, options, memory);
    const internal::PointData points = internal::read_points(source, options);
    volatile double sink = 0;
    for (std::uint64_t i = 0; i < points.view.count; ++i)
      for (std::uint32_t j = 0; j < points.view.dimension; ++j) sink = points.view.at(i, j);
    (void)sink;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::out_of_budget) return 0;  // a bomb
    fuzz::check_refusal(error, true);
  }
  return 0;
}
