// .gz, .zst and .npz, whatever is in them; the first byte chooses.
#include "fuzz/read_points.hpp"
#include "io/packed/unpack.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cullhull;
  if (size == 0) return 0;
  static const char* const names[] = {"a.gz", "a.zst", "a.npz", "a.csv.gz", "a.npy.zst", "a"};
  const std::string name = names[data[0] % 6];
  const std::vector<char> bytes(data + 1, data + size);
  ReadOptions options;
  if (data[0] / 6 % 2 == 1) options = fuzz::choose_columns(data, size);
  options.threads = 1;
  options.memory_budget = std::uint64_t{1} << 24;
  internal::Source source{name, bytes.data(), bytes.size()};
  internal::RawArray<char> memory;
  try {
    internal::unwrap({name, data[0] % 5 == 4 ? "b" : ""}, source, options, memory);
    const internal::PointData points = internal::read_points(source, options);
    fuzz::touch_all(points.view);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::out_of_budget) return 0;  // a bomb
    fuzz::check_refusal(error, true);
  }
  return 0;
}
