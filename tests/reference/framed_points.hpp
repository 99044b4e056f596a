// Points in their frame, for tests of what writes an engine's surface as a hull.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "parallel/threads/run.hpp"
#include "result/boundary.hpp"
#include "result/measures/measure.hpp"
#include "result/write/write_simplices.hpp"
#include "tests/agreement/canonical_hash.hpp"

namespace cullhull::internal {

struct FramedPoints {
  FramedPoints(const std::vector<double>& rows, unsigned d)
      : view(PointView::row_major(rows.data(), rows.size() / d, d)),
        run(options),
        frame(gather_points(view, nullptr, view.count, run.with_threads(1)),
              static_cast<std::uint32_t>(view.count), d, run.with_threads(1)) {}

  ResultInput input() const { return {&view, &frame.points(), nullptr, frame.axes().data()}; }
  Hull empty_hull() const {
    Hull hull;
    hull.dimension = view.dimension;
    hull.point_count = view.count;
    hull.affine_dimension = static_cast<int>(view.dimension);
    return hull;
  }
  /// As for any hull: coplanar simplices are looked for, merged, triangulated, sorted, measured.
  std::uint64_t the_general_way(Boundary&& surface) const {
    const Run& one = run.with_threads(1);
    Hull hull = empty_hull();
    const CoplanarPairs pairs =
        coplanar_pairs(surface, frame.points(), one, hull.statistics.rung_counts);
    const OrderedFacets assembled = order_facets(
        input(), merge_coplanar(std::move(surface), pairs, frame.points(), one), one, hull);
    measure(view, assembled.vertices, assembled.index, frame.axes().data(), one, hull);
    hull.vertices = assembled.vertices;
    return testing_support::canonical_hash(hull);
  }

  PointView view;
  Options options;
  Run run;
  LocalFrame frame;
};

}  // namespace cullhull::internal
