// A hull as Python holds it: the result, the coordinates of its vertices, and its questions.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <mutex>
#include <vector>

#include "arrays.hpp"
#include "call.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"

namespace binding {

/// Independent of the array it was computed from: that may change or go away.
class Solid {
 public:
  /// `points`: those the hull was computed from.
  Solid(cullhull::Hull hull, const cullhull::PointView& points);
  /// `vertex_rows`: the coordinates of hull.vertices, in that order.
  Solid(cullhull::Hull hull, std::vector<double> vertex_rows);

  const cullhull::Hull& hull() const noexcept { return hull_; }
  const std::vector<double>& vertex_rows() const noexcept { return vertex_rows_; }

  /// Prepared at the first question; any thread may ask, with or without the GIL.
  const cullhull::HullQuery& query() const;
  /// The id of a vertex by its place among the sorted ids, as query() counts them.
  std::uint64_t id_of(std::uint64_t place) const { return ids_[place]; }
  /// The hull over its vertices alone, numbered by their place, and their coordinates.
  cullhull::Hull by_place() const;
  std::vector<double> rows_by_place() const;
  /// This hull was computed over the vertices of `whole` by place: gives it back their ids.
  void renumber(const Solid& whole);

 private:
  void sort_ids();

  cullhull::Hull hull_;
  std::vector<double> vertex_rows_;
  std::vector<std::uint64_t> ids_;  // hull_.vertices, ascending
  mutable std::once_flag once_;
  mutable std::unique_ptr<cullhull::HullQuery> query_;
};

/// The ids of `count` points that a filter kept, as NumPy has them.
inline Output<std::int64_t> kept_ids(const cullhull::Survivors& survivors, std::uint64_t count) {
  Output<std::int64_t> ids(survivors.size(count));
  for (std::uint64_t i = 0; i < survivors.size(count); ++i)
    ids.data()[i] = static_cast<std::int64_t>(survivors.all ? i : survivors.ids[i]);
  return ids;
}

void bind_hull(nanobind::module_& m);
void bind_query(nanobind::class_<Solid>& c);
void bind_many(nanobind::module_& m);
void bind_halfspaces(nanobind::module_& m);
void bind_device(nanobind::module_& m);
void bind_tracker(nanobind::module_& m);
void bind_simplify(nanobind::module_& m);

}  // namespace binding
