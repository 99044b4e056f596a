// Every format in blocks, with and without columns: the first byte chooses the format, or that the
// content tells it, and the size of a block.
#include "cullhull/point_blocks.hpp"
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cullhull;
  if (size == 0) return 0;
  static const std::vector<std::string> formats = [] {
    std::vector<std::string> all = input_formats();
    all.insert(all.begin(), "");
    return all;
  }();
  const fuzz::NamedFile file(data + 1, size - 1);
  BlockOptions options;
  if (data[0] & 0x40) options.read = fuzz::choose_columns(data, size);
  options.read.format = formats[data[0] % formats.size()];
  options.read.threads = 1;
  options.read.remark = [](const std::string&) {};
  options.read.memory_budget = std::uint64_t{1} << 24;
  if (options.read.format == "raw") {
    options.read.raw_dimension = static_cast<std::uint32_t>(1 + size % 5);
    options.read.raw_scalar = static_cast<ScalarType>(size % 8);
  }
  options.readers = 1;
  options.block_bytes = data[0] & 0x80 ? 64 : 4096;
  std::uint64_t points = 0;
  BlockVisitor visitor;
  const auto visit = [&](const PointView& block, std::uint64_t first) {
    if (first != points) std::abort();
    points += block.count;
    fuzz::touch_all(block);
  };
  visitor.points = visit;
  visitor.keyed = [&](const PointView& block, std::uint64_t first, const PointKeys& keys) {
    if (keys.size() != block.count) std::abort();
    visit(block, first);
  };
  visitor.state = [](const HullState&, std::uint64_t) {};
  try {
    visit_blocks({file.name()}, visitor, options);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_budget) fuzz::check_refusal(error, true);
  }
  return 0;
}
