#include "points/gather.hpp"

#include <atomic>
#include <cmath>
#include <cstring>
#include <string>

#include "cullhull/error.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t chunk_size = 1 << 16;

template <class T>
void gather_rows(const PointView& view, const std::uint64_t* ids, std::uint64_t begin,
                 std::uint64_t end, double* out) {
  const unsigned d = view.dimension;
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::byte* p = view.address(ids != nullptr ? ids[i] : i, 0);
    double* row = out + i * d;
    for (unsigned j = 0; j < d; ++j) {
      T v;
      std::memcpy(&v, p + static_cast<std::ptrdiff_t>(j) * view.coordinate_stride, sizeof v);
      row[j] = static_cast<double>(v) + 0.0;  // + 0.0 turns -0 into +0
    }
  }
}

void gather_rows(const PointView& view, const std::uint64_t* ids, std::uint64_t begin,
                 std::uint64_t end, double* out) {
  switch (view.scalar) {
    case ScalarType::f32:
      return gather_rows<float>(view, ids, begin, end, out);
    case ScalarType::f64:
      return gather_rows<double>(view, ids, begin, end, out);
    case ScalarType::i8:
      return gather_rows<std::int8_t>(view, ids, begin, end, out);
    case ScalarType::u8:
      return gather_rows<std::uint8_t>(view, ids, begin, end, out);
    case ScalarType::i16:
      return gather_rows<std::int16_t>(view, ids, begin, end, out);
    case ScalarType::u16:
      return gather_rows<std::uint16_t>(view, ids, begin, end, out);
    case ScalarType::i32:
      return gather_rows<std::int32_t>(view, ids, begin, end, out);
    case ScalarType::u32:
      return gather_rows<std::uint32_t>(view, ids, begin, end, out);
  }
}

/// Index of the first non-finite value of [begin, end), or end.
std::uint64_t first_bad(const double* values, std::uint64_t begin, std::uint64_t end) {
  double sum = 0;  // x * 0 is NaN exactly for NaN and infinities
  for (std::uint64_t i = begin; i < end; ++i) sum += values[i] * 0.0;
  if (sum == 0) return end;
  while (std::isfinite(values[begin])) ++begin;
  return begin;
}

}  // namespace

std::vector<double> gather_points(const PointView& view, const std::uint64_t* ids,
                                  std::uint64_t count, unsigned threads) {
  const unsigned d = view.dimension;
  std::vector<double> out(count * d);
  std::atomic<std::uint64_t> bad{~std::uint64_t{0}};
  for_each_chunk(count, chunk_size, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   gather_rows(view, ids, begin, end, out.data());
                   const std::uint64_t b = first_bad(out.data(), begin * d, end * d);
                   if (b == end * d) return;
                   std::uint64_t lowest = bad.load();
                   while (b < lowest && !bad.compare_exchange_weak(lowest, b)) {
                   }
                 });
  const std::uint64_t b = bad.load();
  if (b != ~std::uint64_t{0}) {
    const std::uint64_t point = ids != nullptr ? ids[b / d] : b / d;
    const char* what = std::isnan(out[b]) ? "NaN" : "infinite";
    throw Error(ErrorCode::not_finite, "point " + std::to_string(point) + ", coordinate " +
                                           std::to_string(b % d) + " is " + what +
                                           "; remove or repair such points first");
  }
  return out;
}

}  // namespace cullhull::internal
