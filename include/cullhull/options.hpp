// Options of a call. They change how the result is computed, never the result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>

#include "cullhull/stop_token.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

enum class Backend { automatic, cpu, cuda };
/// The filters: docs/algorithm.md. automatic: decide from a sample whether the gauge map is
/// worthwhile.
enum class CullMethod { automatic, gauge, pseudo_hull, none };

/// "automatic", "cpu", "cuda": as reports and the command line spell them. Static storage.
const char* backend_name(Backend backend) noexcept;
template <class Traits>
std::basic_ostream<char, Traits>& operator<<(std::basic_ostream<char, Traits>& out, Backend value) {
  return out << backend_name(value);
}

/// Called occasionally, from the calling thread: a short phase name and the completed fraction in
/// [0, 1]. It may throw; the exception reaches the caller, and no output is left partly written.
using Progress = std::function<void(const char* phase, double share)>;

/// Called only from the calling thread, each time that thread checks `stop`: often, so it must be
/// quick. It may request a stop, and must not throw.
using Poll = std::function<void()>;

/// How a call runs, whatever it computes. Functions of this library may be called from any number
/// of threads at the same time, and so may the const members of an object.
///
/// - threads: to use, at most 1024; 0: std::thread::hardware_concurrency().
/// - memory_budget: limit in bytes for memory beyond the input; 0: half of the memory that this
///   process may use.
/// - progress, stop: see Progress and std::stop_token.
/// - poll: for callers that must poll for signals themselves. Not called while the calling thread
///   waits for other threads, so it does not bound the latency of long multi-threaded calls.
///
/// Every struct of options begins with these members, so that {.threads = 2} makes any of them, and
/// converts to RunOptions. options_as() converts to the others.
struct RunOptions {
#define CULLHULL_RUN_MEMBERS       \
  unsigned threads = 0;            \
  std::uint64_t memory_budget = 0; \
  Progress progress{};             \
  stop_token stop{};               \
  Poll poll{};
  CULLHULL_RUN_MEMBERS
};

#define CULLHULL_RUN_OPTIONS \
  CULLHULL_RUN_MEMBERS       \
  operator ::cullhull::RunOptions() const { return {threads, memory_budget, progress, stop, poll}; }

/// Allocates memory of the current device in the place of the library's own pool: by RMM, say, or
/// by PyTorch's caching allocator. `stream` is a cudaStream_t, the points' or one of the library's
/// own. Any thread may call deallocate: a result frees its memory where it is destroyed.
struct DeviceAllocator {
  /// Memory aligned to 256 bytes that work submitted to the stream from now on may use. Null and
  /// std::bad_alloc mean that there is none; other exceptions reach the caller.
  std::function<void*(std::size_t bytes, void* stream)> allocate;
  /// Takes memory back that work submitted to the stream before may still use. Must not throw.
  std::function<void(void* memory, std::size_t bytes, void* stream)> deallocate;
};

struct Options {
  CULLHULL_RUN_OPTIONS
  Backend backend = Backend::automatic;
  CullMethod cull = CullMethod::automatic;
  /// The CUDA device for points in host memory; -1: the calling thread's current one; every_device:
  /// all of them, for a part each. Points in a device's memory are processed by that device.
  int device = -1;
  static constexpr int every_device = -2;
  /// Whether the hull carries the coordinates of its vertices (Hull::vertex_coordinates), so that
  /// certify, HullQuery, HullState and write_hull need no points beside it. Used by convex_hull,
  /// HullTracker, HullStream, HullState::hull and hull_from_json.
  bool with_coordinates = false;
  /// For all device memory of the call and of its results; null: the library's own pool.
  std::shared_ptr<const DeviceAllocator> device_allocator{};
};

/// Other options for a call that runs like one with `from`: options_as<TriangulationOptions>(o).
template <class To, class From>
To options_as(const From& from) {
  To to;
  to.threads = from.threads;
  to.memory_budget = from.memory_budget;
  to.progress = from.progress;
  to.stop = from.stop;
  to.poll = from.poll;
  return to;
}

}  // namespace cullhull
#pragma GCC visibility pop
