// The pass of a GaugeMap over all points, where they are in the host's memory: on the CPU or,
// copied there in pieces, on a CUDA device.
#pragma once

#include <cstdint>
#include <string>

#include "cull/gauge_map.hpp"
#include "cullhull/cull.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// Where the first pass runs. A device that was asked for has been required before; one that the
/// planner chose may turn out not to be there, which is no error.
class CullPass {
 public:
  /// Decides. Views points and run.
  CullPass(const PointView& points, const Run& run);

  /// Nodes of a map the pass can hold close by; 0: the CPU's choice.
  std::uint32_t most_nodes() const;

  /// Sets what the map keeps, where that was found, and adds why there to the reason. On the CPU
  /// their rows as well, if asked for.
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

}  // namespace cullhull::internal
