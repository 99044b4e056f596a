#include "cuda/gauge.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <type_traits>

#include "cuda/kernels/gauge_kernel.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

// ---------------------------------------------------------------- points of the host

/// Copies points [begin, end) of the view to packed rows. Every T is exactly an Out.
template <class T, class Out>
void pack(const PointView& v, std::uint64_t begin, std::uint64_t end, Out* out) {
  const std::size_t d = v.dimension;
  if constexpr (std::is_same_v<T, Out>) {
    if (v.packed_rows()) {
      std::memcpy(out, v.address(begin, 0), (end - begin) * d * sizeof(T));
      return;
    }
  }
  for (std::uint64_t i = begin; i < end; ++i) {
    for (std::uint32_t j = 0; j < d; ++j) {
      T value;
      std::memcpy(&value, v.address(i, j), sizeof value);  // any alignment
      *out++ = static_cast<Out>(value);
    }
  }
}

void pack(const PointView& v, std::uint64_t begin, std::uint64_t end, std::byte* out) {
  with_scalar(v.scalar, [&](auto scalar) {
    using T = decltype(scalar);
    using Out = std::conditional_t<std::is_same_v<T, float>, float, double>;
    pack<T>(v, begin, end, reinterpret_cast<Out*>(out));
  });
}

/// Appends the survivors of a piece that begins with point `first` of all.
void append_survivors(const GaugeTable& table, const DevicePointView& part, std::uint64_t first,
                      Array<std::uint64_t>& ids) {
  const DeviceIds left = survivors_of_device_points(table, part);
  const std::size_t before = ids.size();
  ids.resize(before + left.count);
  download(ids.data() + before, left.ids.data(), left.count, cuda_stream_of(part));
  for (std::size_t i = before; i < ids.size(); ++i) ids[i] += first;
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

Array<std::uint64_t> survivors_of_host_points(const GaugeTable& table, const PointView& points,
                                              const Run& run) {
  Array<std::uint64_t> ids;
  in_pieces(points.count, points.count, run.control, [&](std::uint64_t first, std::uint64_t n) {
    const CudaStream stream;
    DevicePointView part;
    const DeviceArray<std::byte> rows = uploaded_points(points, first, n, stream.get(), run, part);
    append_survivors(table, part, first, ids);
  });
  return ids;
}

// -------------------------------------------------------------- points of the device

void sum_in_place(std::uint64_t* numbers, std::uint64_t count, cudaStream_t stream) {
  std::size_t bytes = 0;
  check(sum_counts(nullptr, bytes, numbers, numbers, count, stream), "counting");
  const DeviceArray<std::byte> scratch(std::max<std::size_t>(bytes, 1), stream);
  check(sum_counts(scratch.data(), bytes, numbers, numbers, count, stream), "counting");
}

DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points) {
  const cudaStream_t stream = cuda_stream_of(points);
  const DeviceArray<float> nodes = uploaded(table.nodes, stream);
  const std::uint64_t words = mask_words(points.count);
  const DeviceArray<std::uint32_t> mask(mask_room(points.count), stream);
  check(gauge_mask(table, nodes.data(), points, mask.data(), this_device(), stream), "culling");

  // One offset more than there are tiles: the last offset is the total.
  const std::uint64_t tiles = (words + tile_words - 1) / tile_words;
  const DeviceArray<std::uint64_t> offsets(tiles + 1, stream);
  check(cudaMemsetAsync(offsets.data() + tiles, 0, sizeof(std::uint64_t), stream), "counting");
  check(count_bits(mask.data(), words, offsets.data(), stream), "counting");
  sum_in_place(offsets.data(), tiles + 1, stream);
  DeviceIds result;
  download(&result.count, offsets.data() + tiles, 1, stream);
  result.ids = DeviceArray<std::uint64_t>(result.count, stream);
  if (result.count > 0)
    check(list_bits(mask.data(), words, offsets.data(), result.ids.data(), stream), "listing");
  return result;
}

Array<std::uint64_t> survivors_by_pieces(const GaugeTable& table, const DevicePointView& points,
                                         const Control& control) {
  constexpr std::uint64_t piece = 1 << 22;  // points; their mask takes half a megabyte
  Array<std::uint64_t> ids;
  in_pieces(points.count, piece, control, [&](std::uint64_t first, std::uint64_t n) {
    append_survivors(table, part_of(points, first, n), first, ids);
  });
  return ids;
}

namespace {

const std::byte* point_address(const DevicePointView& points, std::uint64_t i) {
  return static_cast<const std::byte*>(part_of(points, i, 1).data);
}

/// Copies the rows of a view, or of some of its points, to the host. Packed rows are copied
/// directly. Others are first gathered on the device or, if it lacks memory for that, copied by
/// runs of consecutive points, some of which take a call for each point.
template <class T>
class Rows {
 public:
  /// `ids`: the points to copy; null: all. `most`: the most points of one call of copy().
  Rows(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t most)
      : points_(points), ids_(ids), gathers_(ids != nullptr || !points.packed_rows()) {
    if (!gathers_) return;
    try {
      packed_ = DeviceArray<T>(most * points.dimension, cuda_stream_of(points));
      if (ids != nullptr) piece_ids_ = DeviceArray<std::uint64_t>(most, cuda_stream_of(points));
    } catch (const OutOfMemory&) {
      packed_ = {};
      gathers_ = false;
    }
  }

  /// Starts copying rows [first, first + n) of the selected ones to `to`, on the points' stream.
  void copy(std::uint64_t first, std::uint64_t n, T* to) const {
    if (!gathers_) return copy_records(first, n, to);
    const cudaStream_t stream = cuda_stream_of(points_);
    const DevicePointView part = ids_ == nullptr ? part_of(points_, first, n) : points_;
    if (ids_ != nullptr) upload(piece_ids_.data(), ids_ + first, n, stream);
    check(gather_rows(part, piece_ids_.data(), n, packed_.data(), stream), "gathering points");
    copy_packed(packed_.data(), n * points_.dimension, to);
  }

 private:
  void copy_packed(const void* from, std::uint64_t values, T* to) const {
    check(cudaMemcpyAsync(to, from, values * sizeof(T), cudaMemcpyDeviceToHost,
                          cuda_stream_of(points_)),
          "copying points from the device");
  }

  /// Copies the selected rows without gathering them: each run of consecutive ids by copy_run().
  void copy_records(std::uint64_t first, std::uint64_t n, T* to) const {
    const unsigned d = points_.dimension;
    if (ids_ == nullptr) return copy_run(point_address(points_, first), n, to);
    for (std::uint64_t begin = 0, end = 1; begin < n; begin = end++) {
      while (end < n && ids_[first + end] == ids_[first + end - 1] + 1) ++end;
      copy_run(point_address(points_, ids_[first + begin]), end - begin, to + begin * d);
    }
  }

  /// Copies `n` consecutive points with any strides.
  void copy_run(const std::byte* from, std::uint64_t n, T* to) const {
    const unsigned d = points_.dimension;
    if (points_.packed_rows()) return copy_packed(from, n * d, to);
    if (points_.coordinate_stride == std::ptrdiff_t{sizeof(T)}) return copy_strided(from, d, n, to);
    for (unsigned j = 0; j < d; ++j)
      copy_strided(from + static_cast<std::ptrdiff_t>(j) * points_.coordinate_stride, 1, n, to + j);
  }

  /// Copies `width` consecutive values of each of `n` points into rows of as many values as the
  /// dimension.
  void copy_strided(const std::byte* from, unsigned width, std::uint64_t n, T* to) const {
    constexpr std::ptrdiff_t longest_pitch = 0x7FFFFFFF;
    const std::ptrdiff_t pitch = points_.point_stride;
    const std::size_t row = points_.dimension * sizeof(T), bytes = width * sizeof(T);
    if (pitch >= static_cast<std::ptrdiff_t>(bytes) && pitch <= longest_pitch) {
      check(cudaMemcpy2DAsync(to, row, from, static_cast<std::size_t>(pitch), bytes, n,
                              cudaMemcpyDeviceToHost, cuda_stream_of(points_)),
            "copying points from the device");
      return;
    }
    for (std::uint64_t i = 0; i < n; ++i)
      copy_packed(from + static_cast<std::ptrdiff_t>(i) * pitch, width, to + i * points_.dimension);
  }

  const DevicePointView& points_;
  const std::uint64_t* ids_;
  bool gathers_;
  DeviceArray<T> packed_;
  DeviceArray<std::uint64_t> piece_ids_;
};

template <class T>
Array<double> download_as(const DevicePointView& points, const std::uint64_t* ids,
                          std::uint64_t count, const Run& run) {
  const unsigned d = points.dimension;
  const std::uint64_t piece = std::max<std::uint64_t>(1, (std::uint64_t{1} << 20) / d);
  const cudaStream_t stream = cuda_stream_of(points);
  const std::shared_ptr<T> here = landing<T>(std::min(piece, count) * d);
  Rows<T> source(points, ids, std::min(piece, count));
  Array<double> rows(count * d);
  for (std::uint64_t first = 0; first < count; first += piece) {
    run.check();
    const std::uint64_t n = std::min(piece, count - first);
    Settled settled(stream);  // where a copy is refused, others may be on their way to `here`
    source.copy(first, n, here.get());
    settled.wait("copying points from the device");
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
