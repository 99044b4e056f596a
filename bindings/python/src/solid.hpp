// A hull as Python holds it: the result, the coordinates of its vertices, and its queries.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arrays.hpp"
#include "call.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "cullhull/query.hpp"
#include "parallel/threads/once.hpp"

namespace binding {

/// None: as most programs read the format.
inline cullhull::Faces faces_of(std::optional<bool> polygons) {
  if (!polygons) return cullhull::Faces::by_format;
  return *polygons ? cullhull::Faces::polygons : cullhull::Faces::triangles;
}

/// Independent of the array it was computed from, which may change or be freed.
class Solid {
 public:
  /// `points`: those the hull was computed from.
  Solid(cullhull::Hull hull, const cullhull::PointView& points);
  /// `points`: those with these ids, ascending, among which all vertices are.
  Solid(cullhull::Hull hull, std::span<const std::uint64_t> ids, const cullhull::PointView& points);
  /// `vertex_rows`: the coordinates of hull.vertices, in that order.
  Solid(cullhull::Hull hull, std::vector<double> vertex_rows);
  /// Of a hull that something else keeps as well.
  Solid(std::shared_ptr<const cullhull::Hull> hull, const cullhull::PointView& points);
  Solid(std::shared_ptr<const cullhull::Hull> hull, std::vector<double> vertex_rows);
  /// With the GIL if there was a query(), which may have tables on a device.
  ~Solid();

  const cullhull::Hull& hull() const noexcept { return shared_ ? *shared_ : own_; }
  const std::vector<double>& vertex_rows() const noexcept { return vertex_rows_; }

  /// Prepared at the first query; callable from any thread, with or without the GIL.
  const cullhull::HullQuery& query() const;
  bool is_prepared() const noexcept { return is_prepared_.load(std::memory_order_relaxed); }
  /// The ids of the vertices, ascending.
  const std::vector<std::uint64_t>& ids() const;
  /// The hull over its vertices alone, numbered by their position, and their coordinates.
  cullhull::Hull by_place() const;
  std::vector<double> rows_by_place() const;
  /// For a hull computed over the vertices of `whole` by position: restores their ids. To be called
  /// before any other member, and not if it is shared.
  void renumber(const Solid& whole);

 private:
  cullhull::Hull own_;
  std::shared_ptr<const cullhull::Hull> shared_;  ///< in place of own_, if any
  std::vector<double> vertex_rows_;
  mutable cullhull::internal::Once sorted_, prepared_;
  mutable std::vector<std::uint64_t> ids_;  // sorted when first needed
  mutable std::unique_ptr<cullhull::HullQuery> query_;
  mutable std::atomic<bool> is_prepared_ = false;
};

/// The ids of `count` points that a filter kept, as a NumPy array.
inline Output<std::int64_t> kept_ids(const cullhull::Survivors& survivors, std::uint64_t count) {
  Output<std::int64_t> ids(survivors.size(count));
  for (std::uint64_t i = 0; i < survivors.size(count); ++i)
    ids.data()[i] = static_cast<std::int64_t>(survivors.all ? i : survivors.ids[i]);
  return ids;
}

/// Shows a hull's arrays to Python: they refer to its object, which keeps their memory.
using SolidHandle = nanobind::handle_t<Solid>;
inline const cullhull::Hull& hull_in(SolidHandle self) {
  return nanobind::inst_ptr<Solid>(self)->hull();
}
/// Points of a simplex: none where the hull is empty or a single point.
inline std::size_t simplex_width(const cullhull::Hull& h) {
  return static_cast<std::size_t>(h.affine_dimension > 0 ? h.affine_dimension : 0);
}

void bind_hull(nanobind::module_& m);
void bind_drop_in(nanobind::class_<Solid>& c);
void bind_state(nanobind::module_& m);
void bind_query(nanobind::class_<Solid>& c);
void bind_many(nanobind::module_& m);
void bind_halfspaces(nanobind::module_& m);
void bind_device(nanobind::module_& m);
void bind_device_batch(nanobind::module_& m);
void bind_tracker(nanobind::module_& m);
void bind_simplify(nanobind::module_& m);
void bind_stream(nanobind::module_& m);
void bind_files(nanobind::module_& m);
void bind_triangulation(nanobind::module_& m);
void bind_voronoi(nanobind::module_& m);
void bind_cells(nanobind::module_& m);
void bind_save(nanobind::module_& m);

}  // namespace binding
