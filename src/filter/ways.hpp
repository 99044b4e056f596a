// The ways from points to their hull, in the order in which they are tried: one table of the points
// and options that each takes. The steps of the flow ask it; none has numbers or conditions of its
// own.
//
// Example: 500 points of space with the default options. small_lattice takes them, and finds that
// they are no lattice; few_in_space takes them and finds the hull. With cull = gauge, both refuse:
// the gauge map drops 300 points, and few_in_space takes the 200 that are left.
#pragma once

#include <atomic>
#include <cstdint>
#include <iterator>
#include <string>

#include "cullhull/options.hpp"
#include "filter/planner.hpp"

namespace cullhull::internal {

enum class Way : std::uint8_t {
  columns,
  ellipse,
  few_in_plane,
  small_lattice,
  few_in_space,
  few_in_4d,
  few_in_5d,
  few_in_6d,
  few_in_7d,
  few_in_8d,
  pseudo_hull,
  outermost,
  gauge,
  lattice,
  ends_of_line,
  plane_engine,
  space_engine,
  general_engine
};

struct WayRow {
  Way way;
  const char* name;
  std::uint32_t least_dimension, most_dimension;
  std::uint64_t least, most, most_left;  ///< points of a call; those that a filter left
  bool unchosen;                         ///< only where neither a filter nor a device was asked for
  std::uint64_t bytes;  ///< the least memory budget, more than the way needs with its result
  const char* reason;
};

/// Of an engine; of a filter of all that it can count; the budgets of few points.
inline constexpr std::uint64_t most_of_engine = 0xFFFFFFFE, any_number = ~0ULL;
inline constexpr std::uint64_t few_bytes = 1 << 22, few_bytes_nd = 1 << 23;

/// Points that are tested against all facets at once, in vectors. Those of WebAssembly have 128
/// bits: of a sphere the engine is faster from 512 points on there, of a ball from 800 on.
#if defined(__EMSCRIPTEN__)
inline constexpr std::uint64_t few_most = 512;
#else
inline constexpr std::uint64_t few_most = 1024;
#endif

/// Why these limits: ellipse: plane_filter.hpp. few_in_plane: with more than 2^20 points the passes
/// of several threads over a map are faster. few_in_space: all points may be extreme, and each is
/// tested against all of up to twice as many facets; with more points the engine's search is
/// faster. few_in_4d: likewise; from 5D on larger sets, some milliseconds of work, are left to the
/// engine's threads. small_lattice: at most some ten milliseconds, in which a call is not
/// cancelled. outermost: with more points a larger sample and a finer map are faster. lattice: the
/// test takes 110 us for 1,000 points; untested below.
inline constexpr WayRow ways[] = {
    {Way::columns, "columns", 2, 2, 96, 1 << 20, most_of_engine, true, few_bytes,
     "of whole coordinates with few values, the ends of columns"},
    {Way::ellipse, "ellipse", 2, 2, 192, 1 << 20, most_of_engine, true, few_bytes,
     "discards what an ellipse in a sample's hull contains"},
    {Way::few_in_plane, "few in plane", 2, 2, 3, 1 << 20, 8192, true, few_bytes,
     "sorted chains of at most 8,192 points that are left"},
    {Way::small_lattice, "small lattice", 3, 3, 128, 1 << 22, 0, true, few_bytes,
     "of whole coordinates with few values, the ends of lines"},
    {Way::few_in_space, "few in space", 3, 3, 4, few_most, 2048, true, few_bytes,
     "tests each point against all facets at once"},
    {Way::few_in_4d, "few in 4D", 4, 4, 5, few_most, few_most, true, few_bytes_nd,
     "tests each point against all facets at once"},
    {Way::few_in_5d, "few in 5D", 5, 5, 6, 256, 256, true, few_bytes_nd,
     "tests each point against all facets at once"},
    {Way::few_in_6d, "few in 6D", 6, 6, 7, 80, 80, true, few_bytes_nd,
     "tests each point against all facets at once"},
    {Way::few_in_7d, "few in 7D", 7, 7, 8, 40, 40, true, few_bytes_nd,
     "tests each point against all facets at once"},
    {Way::few_in_8d, "few in 8D", 8, 8, 9, 24, 24, true, few_bytes_nd,
     "tests each point against all facets at once"},
    {Way::pseudo_hull, "pseudo-hull", 2, 8, 4, any_number, 0, false, 0,
     "grows a surface from extreme points, as asked"},
    {Way::outermost, "outermost", 3, 3, few_most + 1, 1 << 16, 0, true, 0,
     "a map of the outermost points, if they are few"},
    {Way::gauge, "gauge map", 2, 6, 4, any_number, 0, false, 0,
     "a map of a sample, if the sample shows a gain"},
    {Way::lattice, "lattice", 3, ~0U, 256, most_of_engine, most_of_engine, false, 0,
     "discards what lies between neighbours on a lattice"},
    {Way::ends_of_line, "ends of a line", 1, 1, 1, most_of_engine, most_of_engine, false, 0,
     "the least and the greatest coordinate"},
    {Way::plane_engine, "plane engine", 2, 2, 1, most_of_engine, most_of_engine, false, 0,
     "sorted chains, joined by all threads"},
    {Way::space_engine, "space engine", 3, 3, 1, most_of_engine, most_of_engine, false, 0,
     "insertion along a curve, in pieces for threads"},
    {Way::general_engine, "general engine", 4, ~0U, 1, most_of_engine, most_of_engine, false, 0,
     "insertion in batches, in streams for threads"},
};

constexpr const WayRow& row_of(Way way) { return ways[static_cast<unsigned>(way)]; }
static_assert([] {
  for (unsigned i = 0; i < std::size(ways); ++i)
    if (ways[i].way != static_cast<Way>(i)) return false;
  return true;
}());

/// Points to hull, and what the caller asked for.
struct WayQuestion {
  std::uint32_t dimension = 0;
  std::uint64_t count = 0;
  bool left = false;  ///< by a filter
  CullMethod cull = CullMethod::automatic;
  Backend backend = Backend::automatic;
  std::uint64_t budget = 0;  ///< bytes; 0: enough
};
/// `points`: a view, or frames of a tracker.
inline WayQuestion way_question(const auto& points, const Options& options) {
  return {points.dimension, points.count,    false,
          options.cull,     options.backend, options.memory_budget};
}

enum class Refusal : std::uint8_t { none, off, options, dimension, too_few, too_many, budget };

/// Ways that are switched off, a bit each, to measure what a way gains. Only benchmarks and tests
/// assign to it, between calls.
inline std::atomic<std::uint32_t> ways_off{0};

/// Why a way does not take the points. If it takes them but does not find their hull, the next way
/// is asked.
inline Refusal refusal(Way way, const WayQuestion& q) {
  const WayRow& r = row_of(way);
  const bool automatic = q.cull == CullMethod::automatic, pseudo = way == Way::pseudo_hull;
  if ((ways_off.load(std::memory_order_relaxed) >> static_cast<unsigned>(way) & 1) != 0)
    return Refusal::off;
  if ((r.unchosen && !(automatic && q.backend != Backend::cuda)) ||
      (pseudo && q.cull != CullMethod::pseudo_hull) ||
      (way == Way::gauge && !automatic && q.cull != CullMethod::gauge))
    return Refusal::options;
  if (q.dimension < r.least_dimension || q.dimension > r.most_dimension) return Refusal::dimension;
  // A filter takes more points than a simplex has; of its own accord, as many as the planner wants.
  if (q.count < r.least || ((pseudo || way == Way::gauge) && q.count < q.dimension + 2) ||
      (way == Way::gauge && automatic && q.count < smallest_worth_culling(q.dimension)))
    return Refusal::too_few;
  if (q.count > (q.left ? r.most_left : r.most)) return Refusal::too_many;
  if (q.budget != 0 && q.budget < r.bytes) return Refusal::budget;
  return Refusal::none;
}
inline bool takes(Way way, const WayQuestion& q) { return refusal(way, q) == Refusal::none; }
/// The last row that may take points of this dimension.
constexpr Way engine_way(std::uint32_t dimension) {
  if (dimension < 2) return Way::ends_of_line;
  return dimension == 2   ? Way::plane_engine
         : dimension == 3 ? Way::space_engine
                          : Way::general_engine;
}

/// The same in a line for people; empty if it takes them.
std::string why_not(Way way, const WayQuestion& q);
/// The same of the filter that was chosen, the gauge map by default.
inline std::string why_no_filter(const WayQuestion& q) {
  return why_not(q.cull == CullMethod::pseudo_hull ? Way::pseudo_hull : Way::gauge, q);
}

/// The way of few points in 2D to 8D.
constexpr Way few_way(std::uint32_t dimension) {
  if (dimension == 2) return Way::few_in_plane;
  return static_cast<Way>(static_cast<std::uint32_t>(Way::few_in_space) + dimension - 3);
}
inline bool takes_few(const WayQuestion& q) {
  return q.dimension >= 2 && q.dimension <= 8 && takes(few_way(q.dimension), q);
}
/// Whether it may take few points with these options, whatever their count in `q`.
inline bool permits_few(WayQuestion q) {
  if (q.dimension < 2 || q.dimension > 8) return false;
  q.count = row_of(few_way(q.dimension)).least;
  return takes_few(q);
}

}  // namespace cullhull::internal
