// The statistics of results, member by member: as Python shows them, and as they are pickled.
#pragma once

#include <nanobind/nanobind.h>

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "cullhull/hull.hpp"
#include "cullhull/triangulation.hpp"

namespace binding {

namespace nb = nanobind;

/// Calls each(name, member) for each member of a hull's or a triangulation's statistics.
template <class S, class Each>
requires std::same_as<std::remove_const_t<S>, cullhull::Statistics>
void each_statistic(S& s, const Each& each) {
  each("survivors", s.survivors);
  each("cull_method", s.filter);
  each("cull_reason", s.cull_reason);
  each("backend", s.backend);
  each("threads", s.threads);
  each("cull_seconds", s.cull_seconds);
  each("hull_seconds", s.hull_seconds);
  each("compute_seconds", s.compute_seconds);
  each("rung_counts", s.rung_counts);
}
template <class S, class Each>
requires std::same_as<std::remove_const_t<S>, cullhull::TriangulationStatistics>
void each_statistic(S& s, const Each& each) {
  each("rung_counts", s.rung_counts);
  each("ties", s.ties);
  each("cells_created", s.cells_created);
  each("threads", s.threads);
  each("order_seconds", s.order_seconds);
  each("insert_seconds", s.insert_seconds);
  each("write_seconds", s.write_seconds);
  each("compute_seconds", s.compute_seconds);
}

// A member as Python has it.
template <class T>
const T& plain(const T& value) {
  return value;
}
inline const char* plain(cullhull::UsedFilter filter) { return cullhull::filter_name(filter); }
inline const char* plain(cullhull::Backend backend) { return cullhull::backend_name(backend); }
inline nb::tuple plain(const std::uint64_t (&counts)[3]) {
  return nb::make_tuple(counts[0], counts[1], counts[2]);
}

template <class Statistics>
nb::typed<nb::dict, nb::str, nb::any> dict_of(const Statistics& statistics) {
  nb::typed<nb::dict, nb::str, nb::any> all;
  each_statistic(statistics,
                 [&](const char* name, const auto& member) { all[name] = plain(member); });
  return all;
}

}  // namespace binding
