// Decides when the filter is worthwhile, how large its samples should be, and where the points are
// culled. Pure functions of counts and rates.
#pragma once

#include <cstdint>
#include <string>

namespace cullhull::internal {

/// Below this number of points, hulling them is faster than building a map.
std::uint64_t smallest_worth_culling(unsigned d);
/// Below this number of survivors, hulling them is faster than building a second map.
std::uint64_t smallest_worth_refining(unsigned d);

/// Returns how many of `threads` are worthwhile: one if there is too little work to share. For the
/// filter of `count` points, and for the hull of `count` survivors.
unsigned useful_cull_threads(unsigned threads, std::uint64_t count, unsigned d);
unsigned useful_threads(unsigned threads, std::uint64_t count, unsigned d);

/// Size of the first, small sample (the probe), whose hull decides whether the filter is
/// worthwhile.
std::uint64_t probe_sample_size(std::uint64_t count, unsigned d);

/// Whether culling `count` points saves time if `extreme` of `sample` random ones were vertices of
/// the sample's hull.
bool cull_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// Size of the sample that a map is built from, given the probe's outcome (as above); at least
/// `sample` if the count allows it. `leaders`: from 3D on, the sample's leaders make the map, else
/// its hull.
std::uint64_t map_sample_size(std::uint64_t count, unsigned d, std::uint64_t sample,
                              std::uint64_t extreme, bool leaders);

/// The number of leaders and of nodes of a map that tests `tested` points, from a sample of which
/// about `outside` points lie outside a rough hull; from all points if outside >= tested.
struct LeaderCounts {
  double leaders, nodes;
};
LeaderCounts leader_counts(double outside, std::uint64_t tested, unsigned d);
/// The same of a map after which no other follows, whose leaders a device finds among all points.
LeaderCounts leader_counts_of_all(double outside, unsigned d);
/// Cells along an edge of a cube that has about this many cells or nodes.
unsigned cells_for(double nodes, unsigned d);

/// The same question after the map's own sample has been hulled: only building the map and the pass
/// still cost time. `extreme` of its `sample` points are vertices.
bool map_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// Returns a sentence: "132 of 1000 sampled points are extreme".
std::string sample_finding(std::uint64_t sample, std::uint64_t extreme);

/// Bytes per second of a desktop with a PCIe 3 device: conservative estimates, not measured. Wrong
/// rates cost time, never correctness.
struct Rates {
  double host_read = 20e9;     ///< all cores read an array
  double host_copy = 10e9;     ///< all cores copy an array, bytes copied
  double link = 12e9;          ///< from pinned memory to the device
  double device_copy = 500e9;  ///< copies on the device, bytes read and written
};
/// The rates that every call assumes. Only tests assign to them, between calls.
Rates& assumed_rates() noexcept;

/// The data that decide where a pass over points is faster.
struct PlaceQuestion {
  std::uint64_t count = 0;
  unsigned dimension = 0;
  std::uint64_t point_bytes = 0;
  unsigned threads = 1;
  bool on_device = false;          ///< the points are in its memory
  bool device_started = false;     ///< the driver was used in this process
  std::uint64_t pinned_bytes = 0;  ///< pinned memory kept from earlier calls
};
struct Placement {
  bool device = false;
  std::string reason;       ///< with the estimates of both places
  std::string host_reason;  ///< with the CPU's estimate alone, used where there is no device
};
/// Whether the device would cull the points faster; does not check that there is a device.
Placement choose_place(const PlaceQuestion& question, const Rates& rates = assumed_rates());

enum class Question { sides, supports, distances };

/// Cells of directions are worth building for this many sides asked per cell.
inline constexpr std::uint64_t sides_worth_a_cell = 4;

/// Who answers questions to a hull about points on a device: the device by testing all facets or
/// vertices for each point, or, for sides, the facets in the list of its cell of directions.
enum class Answerer { cpu, device, device_by_cells };

/// The data that decide it.
struct AskedPoints {
  Question question = Question::sides;
  std::uint64_t count = 0;
  unsigned dimension = 0;
  std::uint64_t point_bytes = 0;
  unsigned threads = 1;
  std::uint64_t tests = 0;  ///< facets or vertices in all; 0: the device cannot test all of them
  std::uint64_t cells = 0;  ///< cells that the hull has or can get; 0: none
  bool cells_built = false;
  std::uint64_t asked_before = 0;  ///< points of earlier calls: building cells is shared with them
  bool cpu_allowed = true;
  bool answers_stay = false;  ///< on the device, else they go to the host
};
/// The one that answers soonest, of those that can. The CPU gets a copy of all points first.
Answerer choose_answerer(const AskedPoints& points, const Rates& rates = assumed_rates());

}  // namespace cullhull::internal
