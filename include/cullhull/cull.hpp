// The filter alone, for use in front of any hull code.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The filter that was used in the end. `gauge_twice`: a second, finer map over what the first
/// kept; `stream`: by HullStream, block after block.
enum class UsedFilter { none, gauge, gauge_twice, pseudo_hull, gauge_pseudo_hull, stream };

/// "none", "gauge", "gauge x2", "pseudo-hull", "gauge, pseudo-hull", "stream": as reports spell
/// them. Static storage.
const char* filter_name(UsedFilter filter) noexcept;
template <class Traits>
std::basic_ostream<char, Traits>& operator<<(std::basic_ostream<char, Traits>& out,
                                             UsedFilter value) {
  return out << filter_name(value);
}

/// The points a filter kept. `ids` are ascending. They include every extreme point of the input and
/// every duplicate of one; each discarded point is strictly inside the hull.
struct Survivors {
  std::vector<std::uint64_t> ids;
  /// True when nothing was discarded; `ids` is then empty and stands for 0 ... count - 1.
  bool all = false;
  /// The filter that ran.
  UsedFilter filter = UsedFilter::none;
  /// Where the filter ran: cpu or cuda.
  Backend backend = Backend::cpu;
  /// One line: the reason for that backend and that filter.
  std::string reason;
  double seconds = 0;

  std::uint64_t size(std::uint64_t count) const noexcept { return all ? count : ids.size(); }

  /// The id of survivor i < size(count), also if `all` is set and `ids` is empty.
  std::uint64_t id(std::uint64_t i) const noexcept {
    return all ? i : ids[static_cast<std::size_t>(i)];
  }
};

/// Discards points that are provably strictly inside the hull. Time O(n), one or two passes over
/// the input; memory O(survivors). Thread safe. Throws Error{not_finite}, which names the first bad
/// point, if a coordinate is not finite; and what convex_hull throws: out_of_budget, cancelled,
/// backend_unavailable, invalid_argument.
/// Source: docs/algorithm.md, "GaugeMap" and "PseudoHull".
Survivors cull(const PointView& points, const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
