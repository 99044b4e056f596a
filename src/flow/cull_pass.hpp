// The pass of a GaugeMap over all points in the host's memory: on the CPU or, copied in pieces, on
// a CUDA device.
#pragma once

#include <cstdint>
#include <string>

#include "cullhull/cull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/threads/control.hpp"

namespace cullhull::internal::inline flow {

/// Decides where the pass runs, and runs it. A device that the options require was checked before;
/// one that the planner chose may turn out to be missing, which is no error.
class CullPass {
 public:
  /// Views `points` and `run`.
  CullPass(const PointView& points, const Run& run);

  /// The most nodes of a map that fit the executor's cache; 0: the CPU's default.
  std::uint32_t most_nodes() const;

  /// Sets what the map keeps and where the pass ran, and appends why to the reason. On the CPU also
  /// gathers the rows of survivors, if asked for.
  void cull(const GaugeMap& map, Survivors& result, SurvivorRows* rows = nullptr);

 private:
  void ask_planner();
  void fall_back(const Error& e);
  std::vector<std::uint64_t> survivors(const GaugeMap& map, SurvivorRows* rows);

  const PointView& points_;
  const Run& run_;
  bool insists_;
  bool device_ = false;
  std::string reason_;
};

}  // namespace cullhull::internal::inline flow
