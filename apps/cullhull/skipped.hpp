// --skip-nan: points without a return are left out, and every id stays the one of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/cull.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

namespace app {

/// The points of a set that are left out.
class Skipped {
 public:
  Skipped() = default;
  /// Leaves out the points with a NaN coordinate.
  explicit Skipped(const cullhull::PointView& points);

  bool any() const { return !rows_.empty(); }
  std::uint64_t count() const { return rows_.size(); }
  bool contains(std::uint64_t id) const;

  // A set without these points, whose ids are then numbers in `kept`.

  /// A copy of the other points, in `memory`.
  cullhull::PointView others(const cullhull::PointView& points,
                             std::vector<std::byte>& memory) const;
  /// The id in the file of such a number.
  std::uint64_t id_of(std::uint64_t number) const { return any() ? kept_[number] : number; }
  /// Numbers become ids.
  void restore(cullhull::Hull& hull) const;
  void restore(std::vector<std::uint64_t>& ids) const;
  void restore(cullhull::Survivors& survivors) const;
  /// "point 7, coordinate 0 is infinite" with the point's id.
  std::string restored(const std::string& message) const;

  // A set of as many points, where those left out are copies of the first other point: for results
  // that list something for each point. Of equal points the lowest id counts, which may be that of
  // a copy before it; restore_copies() names the point instead. The order of ids stays as it is.

  /// Such a set, in `memory`. There is another point.
  cullhull::PointView with_copies(const cullhull::PointView& points,
                                  std::vector<std::byte>& memory) const;
  /// Numbers of the points, where copies have the first other point's.
  void copy_numbers(std::vector<double>& numbers) const;
  void restore_copies(cullhull::Hull& hull) const;
  /// Points left out are hidden then.
  void restore_copies(cullhull::Triangulation& triangulation) const;

 private:
  template <class Id>
  Id original(Id id) const {
    return contains(id) ? static_cast<Id>(kept_[0]) : id;
  }
  std::vector<std::uint64_t> rows_, kept_;
};

}  // namespace app
