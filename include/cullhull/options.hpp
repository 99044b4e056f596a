// Options of a call. No option changes the result, only how it is reached.
#pragma once

#include <cstdint>
#include <functional>

#include "cullhull/machine.hpp"
#include "cullhull/stop_token.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

enum class Backend { automatic, cpu, cuda };
/// The filters: docs/algorithm.md. `automatic` estimates on a sample whether the gauge map pays.
enum class CullMethod { automatic, gauge, pseudo_hull, none };
enum class Engine { native, qhull };

/// "automatic", "cpu", "cuda"; "native", "qhull": as reports and the command line spell them.
/// Static storage.
const char* backend_name(Backend backend) noexcept;
const char* engine_name(Engine engine) noexcept;

/// Called from the calling thread now and then: a short phase name and the share done in [0, 1]. It
/// may throw; the exception passes through and no output is left partly written.
using Progress = std::function<void(const char* phase, double share)>;

/// Called from the calling thread alone, each time a call checks `stop` there: often, so it must be
/// quick. It may request the stop, and must not throw.
using Poll = std::function<void()>;

/// How a call runs, whatever it computes.
struct RunOptions {
  /// Threads to use; 0 means all the machine offers.
  unsigned threads = 0;
  /// Bytes it may allocate beyond the input; 0: half of the memory that this process may use.
  std::uint64_t memory_budget = 0;
  Progress progress;
  stop_token stop;
  /// For callers that must look for signals themselves. Not called while the calling thread waits
  /// for other threads: it does not bound the latency of calls that take seconds on several.
  Poll poll;
};

struct Options : RunOptions {
  Options() = default;
  explicit Options(const RunOptions& run) : RunOptions(run) {}

  Backend backend = Backend::automatic;
  CullMethod cull = CullMethod::automatic;
  Engine engine = Engine::native;
  /// The CUDA device for points of the host; -1: the calling thread's current one. Points in a
  /// device's memory are worked on by that device.
  int device = -1;
  /// Whether the hull keeps the coordinates of its vertices (Hull::vertex_coordinates), so that
  /// certify, HullQuery, HullState and write_hull need no points beside it. Used by convex_hull,
  /// HullTracker, HullStream and HullState::hull.
  bool with_coordinates = false;
  /// The rates by which `Backend::automatic` chooses.
  MachineConstants machine;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
