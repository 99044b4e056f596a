// From points to the map that culls them (sample, exact hull of the sample, map), for points in any
// kind of memory, which a function fetches; and the pass of that map over all points.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "filter/gauge/gauge_map.hpp"

namespace cullhull::internal {

/// Returns the exact hull of some input points; of dimension 0 if they lie in a flat or the hull
/// would exceed the budget.
InnerPolytope inner_polytope(Array<double>&& rows, unsigned d, const Run& run);

/// Returns `size` ids spread evenly over [0, count), each at a pseudo-random place in its interval,
/// so that a period in the input's order cannot hide points from the sample; fewer if count is
/// less.
Array<std::uint64_t> sample_ids(std::uint64_t count, std::uint64_t size);

struct Filtered;

struct SampledPoints {
  std::uint64_t count = 0;
  unsigned dimension = 0;
  /// Returns packed rows of the points with these ids, which must ascend.
  std::function<Array<double>(std::span<const std::uint64_t> ids)> gather;
  /// Returns the map of the leaders of all points, which a map of some of them finds, or null.
  /// None: leaders are those of a sample.
  std::function<std::unique_ptr<GaugeMap>(const GaugeMap& before, LeaderCells cells)> lead = {};
};

struct SampledMap {
  std::unique_ptr<GaugeMap> map;  ///< null: culling is not worthwhile, or no map exists
  std::string reason;             ///< one line, with or without a map
  bool led = false;               ///< leaders made it, and may make a second one
  bool of_all = false;            ///< leaders of all points: a second one leaves hardly fewer
};

enum class Insist {
  no,    ///< build a map only if a small sample, then the map's own sample show that it is
         ///< worthwhile
  late,  ///< for points near the boundary: a small sample shows nothing, only the map's own decides
  yes,   ///< build a map whenever one exists
};

/// Returns the map of a polytope, with the resolution that suits `count` points; null if none
/// exists.
std::unique_ptr<GaugeMap> map_of_polytope(InnerPolytope polytope, std::uint64_t count,
                                          Insist insist, std::uint32_t most_nodes, const Run& run);

/// The cells of a map of leaders (leader_counts), with at most so many nodes; 0: any number.
LeaderCells cells_of_leaders(double outside, std::uint64_t tested, unsigned d,
                             std::uint32_t most_nodes);

/// `most_nodes`: as in GaugeSettings. A sample whose hull would exceed run.budget gives no map. The
/// map's sample is at most `most_probes` times as large as the first.
SampledMap map_of_sample(const SampledPoints& points, Insist insist, std::uint32_t most_nodes,
                         const Run& run, std::uint64_t most_probes = ~std::uint64_t{0});

/// The second map, of points that `before` left: of the leaders among all of them, if there is such
/// a map and points.lead; else of the hull of a sample, with at most `most_nodes`.
SampledMap map_of_left(const SampledPoints& points, const GaugeMap* before,
                       std::uint32_t most_nodes, const Run& run);

/// most_probes for the first map of a device. In 2D and 3D a pseudo-hull follows there, which needs
/// no large sample. In 3D, of 100M points of a ball, the map of a probe leaves 6 %, that of four
/// times as many points 2 %; each point left costs the surface's growth 1.2 ns, and the larger
/// sample's hull takes 0.6 ms (H200): as much at 16M points.
constexpr std::uint64_t most_probes_of_device(unsigned d) {
  return d == 3 ? 1 : d == 2 ? 4 : ~std::uint64_t{0};
}

// The filters of all points in the host's memory: on the CPU or, copied there, on a CUDA device.

/// Decides where the points are filtered, and runs the pass of a map. A device that the options
/// require has been checked before; if the planner's choice of a device fails, falls back to the
/// CPU.
class CullPass {
 public:
  /// Keeps references to `points` and `run`.
  CullPass(const PointView& points, const Run& run);

  /// The most nodes of a map that fit the executor's cache; 0: the CPU's default.
  std::uint32_t most_nodes() const;

  bool on_device() const { return device_; }

  /// On the device: both filters, of which the first is `map` (null: the surface of all points),
  /// and sets survivors without rows, and triangles. Returns false where the CPU has to do it.
  bool filter_there(const GaugeMap* map, Filtered& result);

  /// Returns the ids of the survivors, says in `result` where the pass ran, and appends the
  /// planner's reason. On the CPU also gathers the rows of survivors into `rows`, if given.
  Array<std::uint64_t> cull(const GaugeMap& map, Survivors& result, SurvivorRows* rows = nullptr);

 private:
  void ask_planner();
  template <class There>
  bool tried_there(const There& there);
  void fall_back(const Error& e);
  Array<std::uint64_t> survivors(const GaugeMap& map, SurvivorRows* rows);

  const PointView& points_;
  const Run& run_;
  bool insists_;
  bool device_ = false;
  std::string reason_;
};

}  // namespace cullhull::internal
