// A triangulation as Python holds it: the result beside the array it was computed from.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <memory>
#include <vector>

#include "call.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"
#include "parallel/threads/once.hpp"
#include "points.hpp"

namespace binding {

/// None, or a list of doubles.
std::vector<double> weights_of(nanobind::handle array);

/// Keeps the array alive, which its questions read; nobody may change that meanwhile.
class Cells {
 public:
  Cells(cullhull::Triangulation triangulation, nanobind::object points, nanobind::object weights);

  const cullhull::Triangulation& triangulation() const noexcept { return triangulation_; }
  const nanobind::object& points_array() const noexcept { return points_array_; }
  /// None without weights.
  const nanobind::object& weights_array() const noexcept { return weights_array_; }

  const Points& points() const noexcept { return points_; }
  /// Empty without weights.
  const std::vector<double>& weights() const noexcept { return weights_; }

  /// Prepared at the first question; any thread may ask, with or without the GIL. A preparation
  /// that was stopped is made anew by the next question.
  const cullhull::TriangulationQuery& query(const cullhull::Options& options) const;
  bool is_prepared() const noexcept { return is_prepared_.load(std::memory_order_relaxed); }
  /// For the nearest points, likewise, which takes less to prepare; null where the query must be
  /// asked: for power distances, the furthest site, no points and many dimensions.
  const cullhull::NearestPoint* tree(const cullhull::Options& options) const;
  bool has_tree() const noexcept { return has_tree_.load(std::memory_order_relaxed); }

 private:
  cullhull::Triangulation triangulation_;
  nanobind::object points_array_, weights_array_;
  Points points_;
  std::vector<double> weights_;
  mutable cullhull::internal::Once prepared_;
  mutable std::unique_ptr<cullhull::TriangulationQuery> query_;
  mutable std::atomic<bool> is_prepared_ = false;
  mutable cullhull::internal::Once planted_;
  mutable std::unique_ptr<const cullhull::NearestPoint> tree_;
  mutable std::atomic<bool> has_tree_ = false;
};

/// How Python sees a triangulation whose arrays it shows: by its object, which keeps their memory.
using CellsHandle = nanobind::handle_t<Cells>;
inline const Cells& cells_in(CellsHandle self) { return *nanobind::inst_ptr<Cells>(self); }

/// For some microseconds a cell.
Length length_of_cells(const Cells& cells) noexcept;

/// Questions to a triangulation.
void bind_cells_query(nanobind::module_& m, nanobind::class_<Cells>& c);
/// What SciPy's Delaunay has beside cells and neighbours.
void bind_lifted(nanobind::module_& m, nanobind::class_<Cells>& c);

}  // namespace binding
