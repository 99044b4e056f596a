// Points in a CUDA device's memory, and whether there is a device. Needs no CUDA header: builds
// without the CUDA backend have the same functions, which then report that it is not available.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Non-owning view of points that a device can read (device or managed memory), like PointView:
/// coordinate j of point i is at `data + i * point_stride + j * coordinate_stride` (bytes, any
/// sign), aligned to the scalar. The memory must not change during a call. A call's work starts
/// after all work already queued on `stream` (a cudaStream_t; null: the default stream), so a
/// kernel queued there may still be writing the points; the call returns when its own work is done.
/// Refused with Error{backend_unavailable}: a stream that is being captured into a CUDA graph, and
/// a call of a thread that has an unread CUDA error (cudaGetLastError), which stays unread.
struct DevicePointView {
  const void* data = nullptr;
  ScalarType scalar = ScalarType::f32;  ///< f32 or f64
  std::uint32_t dimension = 0;
  std::uint64_t count = 0;
  std::ptrdiff_t point_stride = 0;
  std::ptrdiff_t coordinate_stride = 0;
  void* stream = nullptr;

  /// Point by point: x0 y0 z0 x1 y1 z1 ...
  template <class T>
  static DevicePointView row_major(const T* p, std::uint64_t n, std::uint32_t d,
                                   void* stream = nullptr) noexcept {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>);
    return {p,
            scalar_type_of<T>(),
            d,
            n,
            static_cast<std::ptrdiff_t>(d * sizeof(T)),
            static_cast<std::ptrdiff_t>(sizeof(T)),
            stream};
  }
  /// Coordinate by coordinate: x0 x1 ... y0 y1 ...
  template <class T>
  static DevicePointView column_major(const T* p, std::uint64_t n, std::uint32_t d,
                                      void* stream = nullptr) noexcept {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>);
    return {p,
            scalar_type_of<T>(),
            d,
            n,
            static_cast<std::ptrdiff_t>(sizeof(T)),
            static_cast<std::ptrdiff_t>(n * sizeof(T)),
            stream};
  }

  /// True where points are packed rows of scalars without gaps.
  bool packed_rows() const noexcept {
    const auto s = static_cast<std::ptrdiff_t>(scalar_size(scalar));
    return coordinate_stride == s && point_stride == s * static_cast<std::ptrdiff_t>(dimension);
  }
};

/// State of the CUDA backend in this process.
struct CudaStatus {
  bool compiled = false;       ///< the library was built with the CUDA backend
  bool available = false;      ///< `Backend::cuda` will work
  std::string reason;          ///< one line: why it is not available; empty if it is
  std::string device;          ///< name of the current device
  int compute_capability = 0;  ///< 90 for 9.0
  int driver_version = 0;      ///< newest CUDA the driver knows, 12040 for 12.4; 0: no driver
  int runtime_version = 0;     ///< CUDA version this library was built with
  std::uint64_t memory_bytes = 0;
};

/// Queries driver and device; the first call may take some tenths of a second. Reports a missing
/// device in the status and does not throw.
CudaStatus cuda_status();

/// The calling thread's current CUDA device; -1: no usable device, or no CUDA backend.
int current_cuda_device() noexcept;

/// The device that the calling thread has made current; -1: the process has not used CUDA so far,
/// or the thread has chosen no device. Unlike current_cuda_device(), never starts the driver, which
/// takes a quarter of a second and makes CUDA unusable in processes that are forked later.
int chosen_cuda_device() noexcept;

/// Waits for all work queued on `stream` (a cudaStream_t). Needed if another thread than the one
/// that names the stream makes the call: each thread has its own per-thread default stream. Throws
/// Error{backend_unavailable}.
void wait_for_cuda_stream(void* stream);

/// A stream of the library's on this device, which no other one waits for, for a DevicePointView
/// whose producer orders its work before it (DLPack). With its last copy it is the library's again.
/// Throws Error{backend_unavailable}.
std::shared_ptr<void> device_stream(int device);

/// Waits for all work of the device that holds this memory, for arrays whose producer does not name
/// its stream. Throws Error{backend_unavailable}, and Error{invalid_argument} for memory of no
/// device.
void wait_for_cuda_device_of(const void* memory);

/// Coordinates of the points with these ids, in this order, one row each; bit for bit, not checked
/// for finiteness. Throws Error{backend_unavailable}; Error{invalid_argument} for an id out of
/// range and for unsupported memory or scalar types.
Array<double> fetch_points(const DevicePointView& points, std::span<const std::uint64_t> ids);

/// Memory in a device. Copies share it; it is freed with the last copy, after all work queued on
/// the device by then.
struct DeviceMemory {
  std::shared_ptr<void> data;
  int device = -1;
};
/// At least `bytes` bytes on the device that holds these points (the current device if there are
/// none), aligned to 256 bytes and not initialised: for answers of HullQuery. Throws
/// Error{backend_unavailable}, Error{invalid_argument} for memory of no device,
/// Error{out_of_budget}.
DeviceMemory device_memory(const DevicePointView& points, std::uint64_t bytes);

/// cull(PointView) for points in device memory: discards points that are provably strictly inside
/// the hull. The device tests them; only samples and survivors are transferred. `Backend::cpu`
/// copies all points to the host. Extra device memory: one bit per point and the survivors, or half
/// a megabyte if that is not available. Throws what cull(PointView) throws,
/// Error{backend_unavailable} without a device, Error{invalid_argument} for unsupported memory or
/// scalar types, and Error{out_of_budget} if the device's memory is full.
Survivors cull(const DevicePointView& points, const Options& options = {});

/// The exact convex hull: the same, bit for bit, as convex_hull(PointView) of the same points.
/// `vertex_coordinates`, if given, receives those of Hull::vertices, one row each, in that order.
Hull convex_hull(const DevicePointView& points, const Options& options = {},
                 std::vector<double>* vertex_coordinates = nullptr);

}  // namespace cullhull
#pragma GCC visibility pop
