#include "cuda/gauge.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <type_traits>

#include "cuda/kernels/gauge_kernel.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// Appends first + i for every set bit i of the mask.
void list_words(const std::uint32_t* mask, std::uint64_t words, std::uint64_t first,
                Array<std::uint64_t>& ids) {
  for (std::uint64_t w = 0; w < words; ++w)
    for (std::uint32_t word = mask[w]; word != 0; word &= word - 1)
      ids.push_back(first + w * 32 + static_cast<unsigned>(std::countr_zero(word)));
}

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

/// The buffers and the stream of one of the two pieces in flight: packed points for the device, and
/// the mask that it returns. All work of a slot is on its own stream, so its buffers may be reused
/// when that stream is idle.
class Slot {
 public:
  Slot(std::uint64_t points, std::size_t row_bytes)
      : rows_(points * row_bytes),
        device_rows_(points * row_bytes, stream_.get()),
        mask_(mask_room(points)),
        device_mask_(mask_room(points), stream_.get()) {}
  ~Slot() { (void)cudaStreamSynchronize(stream_.get()); }  // after an error copies may be in flight
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  std::byte* rows() const { return rows_.data(); }

  /// Starts filtering a piece. `points` describes the slot's rows, which are the input's points
  /// from `first` on.
  void start(const GaugeTable& table, const float* nodes, DevicePointView points,
             std::uint64_t first) {
    first_ = first;
    count_ = points.count;
    points.data = device_rows_.data();
    points.stream = stream_.get();
    const std::size_t bytes = points.count * static_cast<std::size_t>(points.point_stride);
    check(cudaMemcpyAsync(device_rows_.data(), rows_.data(), bytes, cudaMemcpyHostToDevice,
                          stream_.get()),
          "copying points to the device");
    check(gauge_mask(table, nodes, points, device_mask_.data(), this_device(), stream_.get()),
          "culling");
    check(cudaMemcpyAsync(mask_.data(), device_mask_.data(),
                          mask_words(count_) * sizeof(std::uint32_t), cudaMemcpyDeviceToHost,
                          stream_.get()),
          "copying survivors from the device");
  }

  /// Waits for the piece in flight, if any, and appends its survivors.
  void finish(Array<std::uint64_t>& ids) {
    if (count_ == 0) return;
    synchronise(stream_.get(), "culling");
    list_words(mask_.data(), mask_words(count_), first_, ids);
    count_ = 0;
  }

 private:
  CudaStream stream_;
  PinnedArray<std::byte> rows_;
  DeviceArray<std::byte> device_rows_;
  PinnedArray<std::uint32_t> mask_;
  DeviceArray<std::uint32_t> device_mask_;
  std::uint64_t first_ = 0;
  std::uint64_t count_ = 0;
};

Array<std::uint64_t> cull_pieces(const GaugeTable& table, const PointView& points,
                                 std::uint64_t piece, const Run& run) {
  DevicePointView rows;
  rows.scalar = points.scalar == ScalarType::f32 ? ScalarType::f32 : ScalarType::f64;
  rows.dimension = points.dimension;
  rows.coordinate_stride = static_cast<std::ptrdiff_t>(scalar_size(rows.scalar));
  rows.point_stride = rows.coordinate_stride * static_cast<std::ptrdiff_t>(points.dimension);
  const auto row_bytes = static_cast<std::size_t>(rows.point_stride);

  const CudaStream stream;
  const DeviceArray<float> nodes = uploaded(table.nodes, stream.get());
  Array<std::uint64_t> ids;
  {
    Slot slots[2] = {{piece, row_bytes}, {piece, row_bytes}};
    unsigned turn = 0;
    for (std::uint64_t first = 0; first < points.count; first += piece, turn ^= 1) {
      run.check();
      Slot& slot = slots[turn];
      slot.finish(ids);  // pieces finish in order, so ids ascend
      rows.count = std::min(piece, points.count - first);
      run.each(rows.count, 1 << 16, [&](std::uint64_t begin, std::uint64_t end) {
        pack(points, first + begin, first + end, slot.rows() + begin * row_bytes);
      });
      slot.start(table, nodes.data(), rows, first);
    }
    slots[turn].finish(ids);
    slots[turn ^ 1].finish(ids);
  }
  return ids;
}

/// The smallest piece, in points. Copying fewer takes less time than starting the copy.
constexpr std::uint64_t least_piece = 1 << 16;

}  // namespace

Array<std::uint64_t> survivors_of_host_points(const GaugeTable& table, const PointView& points,
                                              const Run& run) {
  // 32 MiB: so long that the time of starting a copy is negligible, and so short that the first and
  // the last piece, whose work does not overlap that of others, are a small part of the whole.
  constexpr std::uint64_t piece_bytes = 32 << 20;
  const std::uint64_t wanted = piece_bytes / (points.dimension * sizeof(double));
  std::uint64_t piece = std::min((points.count + 127) / 128 * 128, wanted / 128 * 128);
  piece = std::max(piece, std::uint64_t{128});
  for (;;) {
    try {
      return cull_pieces(table, points, piece, run);
    } catch (const OutOfMemory&) {
      if (piece <= least_piece) throw;
      piece = std::max(least_piece, piece / 2 / 128 * 128);
    }
  }
}

// -------------------------------------------------------------- points of the device

DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points) {
  const cudaStream_t stream = cuda_stream_of(points);
  const DeviceArray<float> nodes = uploaded(table.nodes, stream);
  const std::uint64_t words = mask_words(points.count);
  const DeviceArray<std::uint32_t> mask(mask_room(points.count), stream);
  check(gauge_mask(table, nodes.data(), points, mask.data(), this_device(), stream), "culling");

  // One offset more than there are tiles: the last offset is the total.
  const std::uint64_t tiles = (words + tile_words - 1) / tile_words;
  const DeviceArray<std::uint64_t> counts(tiles + 1, stream);
  const DeviceArray<std::uint64_t> offsets(tiles + 1, stream);
  check(cudaMemsetAsync(counts.data() + tiles, 0, sizeof(std::uint64_t), stream), "counting");
  check(count_bits(mask.data(), words, counts.data(), stream), "counting");
  std::size_t scratch_bytes = 0;
  check(sum_counts(nullptr, scratch_bytes, counts.data(), offsets.data(), tiles + 1, stream),
        "counting");
  const DeviceArray<std::byte> scratch(std::max<std::size_t>(scratch_bytes, 1), stream);
  check(sum_counts(scratch.data(), scratch_bytes, counts.data(), offsets.data(), tiles + 1, stream),
        "counting");
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
  const cudaStream_t stream = cuda_stream_of(points);
  const DeviceArray<float> nodes = uploaded(table.nodes, stream);
  const DeviceArray<std::uint32_t> device_mask(mask_room(piece), stream);
  std::vector<std::uint32_t> mask(mask_words(piece));
  Array<std::uint64_t> ids;
  for (std::uint64_t first = 0; first < points.count; first += piece) {
    control.check();
    const DevicePointView part = part_of(points, first, std::min(piece, points.count - first));
    check(gauge_mask(table, nodes.data(), part, device_mask.data(), this_device(), stream),
          "culling");
    download(mask.data(), device_mask.data(), mask_words(part.count), stream);
    list_words(mask.data(), mask_words(part.count), first, ids);
  }
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
  // Where a copy is refused, others may be on their way to `here`.
  const Settled settled(stream);
  Array<double> rows(count * d);
  for (std::uint64_t first = 0; first < count; first += piece) {
    run.check();
    const std::uint64_t n = std::min(piece, count - first);
    source.copy(first, n, here.get());
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
