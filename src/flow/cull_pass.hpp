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
class FirstPass {
 public:
  /// Decides. Views the points, which must outlive it.
  FirstPass(const PointView& points, const Options& options, unsigned threads);

  /// Nodes of a map the pass can hold close by; 0: the CPU's choice.
  std::uint32_t most_nodes() const;

  /// Sets what the map keeps, where that was found, and adds why there to the reason. On the CPU
  /// their rows as well, if asked for.
  void cull(const GaugeMap& map, const Control& control, Survivors& result,
            SurvivorRows* rows = nullptr);

 private:
  void ask_planner(const Options& options);
  void fall_back(const Error& e);
  std::vector<std::uint64_t> survivors(const GaugeMap& map, const Control& control,
                                       SurvivorRows* rows);

  const PointView& points_;
  unsigned threads_;
  int ordinal_;  ///< the device that options name; -1: the current one
  bool insists_;
  bool device_ = false;
  std::string reason_;
};

}  // namespace cullhull::internal
