#include "cuda/gauge.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

#include "cuda/kernels/gauge_kernel.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

// ---------------------------------------------------------------- points of the host

/// Copies points [begin, end) of the view to packed rows: floats, and all else as doubles.
void pack(const PointView& v, std::uint64_t begin, std::uint64_t end, std::byte* out) {
  const bool is_float = v.scalar == ScalarType::f32;
  if ((is_float || v.scalar == ScalarType::f64) && v.packed_rows())
    std::memcpy(out, v.address(begin, 0), (end - begin) * v.dimension * scalar_size(v.scalar));
  else if (!is_float)
    load_rows_as_given(v, begin, end, reinterpret_cast<double*>(out));
  else
    for (std::uint64_t i = begin; i < end; ++i)
      for (std::uint32_t j = 0; j < v.dimension; ++j, out += sizeof(float))
        std::memcpy(out, v.address(i, j), sizeof(float));
}

}  // namespace

DeviceArray<std::byte> uploaded_points(const PointView& points, std::uint64_t first,
                                       std::uint64_t count, cudaStream_t stream, const Run& run,
                                       DevicePointView& view) {
  // 8 MiB take 0.15 ms over a link of 55 GB/s, and starting a copy takes 10 us. Packing the first
  // piece and copying the last one overlap with nothing: 0.6 ms with 16 threads, 2.5 ms if pieces
  // had 32 MiB.
  constexpr std::uint64_t piece_bytes = std::uint64_t{8} << 20;
  const ScalarType scalar = points.scalar == ScalarType::f32 ? ScalarType::f32 : ScalarType::f64;
  const std::size_t row_bytes = points.dimension * scalar_size(scalar);
  const std::uint64_t piece = std::min(std::max<std::uint64_t>(piece_bytes / row_bytes, 1), count);
  DeviceArray<std::byte> rows(count * row_bytes, stream);
  view = {rows.data(),
          scalar,
          points.dimension,
          count,
          static_cast<std::ptrdiff_t>(row_bytes),
          static_cast<std::ptrdiff_t>(scalar_size(scalar)),
          stream};
  const std::shared_ptr<std::byte> here[] = {landing<std::byte>(piece * row_bytes),
                                             landing<std::byte>(piece * row_bytes)};
  const Settled settled(stream);
  unsigned turn = 0;
  for (std::uint64_t at = 0; at < count; at += piece, turn ^= 1) {
    run.check();
    const std::uint64_t n = std::min(piece, count - at);
    std::byte* const packed = here[turn].get();
    run.each(n, 1 << 14, [&](std::uint64_t begin, std::uint64_t end) {
      pack(points, first + at + begin, first + at + end, packed + begin * row_bytes);
    });
    // Waits for the copy of the piece before, whose buffer is packed next.
    synchronise(stream, "copying points to the device");
    check(cudaMemcpyAsync(rows.data() + at * row_bytes, packed, n * row_bytes,
                          cudaMemcpyHostToDevice, stream),
          "copying points to the device");
  }
  return rows;
}

Array<std::uint64_t> survivors_there(const GaugeTable& table, const PointView& points,
                                     const Run& run) {
  const DeviceScope scope(device_or_current(run.options.device).ordinal, run.options);
  Array<std::uint64_t> ids;
  in_pieces(points.count, points.count, run.control, [&](std::uint64_t first, std::uint64_t n) {
    const CudaStream stream;
    const Settled settled(stream.get());  // as filter_there()
    DevicePointView part;
    const DeviceArray<std::byte> rows = uploaded_points(points, first, n, stream.get(), run, part);
    survivors_of_device_points(table, part).append_to(ids, first, stream.get());
  });
  return ids;
}

// -------------------------------------------------------------- points of the device

DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points) {
  const cudaStream_t stream = cuda_stream_of(points);
  const DeviceArray<float> nodes = uploaded(table.nodes, stream);
  const DeviceArray<std::uint32_t> mask(mask_room(points.count), stream);
  check(gauge_mask(table, nodes.data(), points, mask.data(), this_device(), stream), "culling");
  return list_bits(mask.data(), mask_words(points.count), stream);
}

Array<std::uint64_t> survivors_by_pieces(const GaugeTable& table, const DevicePointView& points,
                                         const Control& control) {
  Array<std::uint64_t> ids;
  in_pieces(points.count, points.count, control, [&](std::uint64_t first, std::uint64_t n) {
    survivors_of_device_points(table, part_of(points, first, n))
        .append_to(ids, first, cuda_stream_of(points));
  });
  return ids;
}

namespace {

/// Packed rows in the device's memory are copied. Others a kernel writes into pinned memory, where
/// it reads the ids, too: a full device has no other. Where there is none, it packs them there.
template <class T>
Array<double> download_as(const DevicePointView& points, const std::uint64_t* ids,
                          std::uint64_t count, const Run& run) {
  const unsigned d = points.dimension;
  const std::uint64_t piece =
      std::min(count, std::max<std::uint64_t>(1, (std::uint64_t{1} << 20) / d));
  const cudaStream_t stream = cuda_stream_of(points);
  const bool gathers = ids != nullptr || !points.packed_rows();
  const std::uint64_t listed = ids != nullptr ? piece : 0;
  std::shared_ptr<T> here;
  std::shared_ptr<std::uint64_t> ids_here;
  DeviceArray<T> packed;
  DeviceArray<std::uint64_t> ids_there;
  try {
    here = pinned<T>(piece * d);
    ids_here = pinned<std::uint64_t>(listed);
  } catch (const OutOfMemory&) {
    here = landing<T>(piece * d);
    if (gathers) packed = DeviceArray<T>(piece * d, stream);
    ids_there = DeviceArray<std::uint64_t>(listed, stream);
  }
  Array<double> rows(count * d);
  for (std::uint64_t first = 0; first < count; first += piece) {
    run.check();
    const std::uint64_t n = std::min(piece, count - first);
    const DevicePointView part = ids == nullptr ? part_of(points, first, n) : points;
    if (packed.data() != nullptr) {
      if (ids != nullptr) upload(ids_there.data(), ids + first, n, stream);
      check(gather_rows(part, ids_there.data(), n, packed.data(), stream), "packing points");
      begin_download(here.get(), packed.data(), n * d, stream);
    } else if (gathers) {
      if (ids != nullptr) std::copy_n(ids + first, n, ids_here.get());
      check(gather_rows(part, ids_here.get(), n, here.get(), stream), "gathering points");
    } else {
      begin_download(here.get(), static_cast<const T*>(part.data), n * d, stream);
    }
    synchronise(stream, "copying points from the device");
    run.each(n * d, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      std::copy(here.get() + begin, here.get() + end, rows.data() + first * d + begin);
    });
  }
  return rows;
}

}  // namespace

Array<double> download_points(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const Run& run) {
  if (count == 0) return {};
  return points.scalar == ScalarType::f64 ? download_as<double>(points, ids, count, run)
                                          : download_as<float>(points, ids, count, run);
}

}  // namespace cullhull::internal
