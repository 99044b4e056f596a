// The canonical hull of few points in four to eight dimensions, from their coordinates.
#include <bit>

#include "few/few_in_space.hpp"
#include "few/small_nd.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {

bool hull_of_few_nd(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                    Hull& hull) {
  const Array<double> rows = gather_points(view, ids, count, short_run());
  const auto n = static_cast<unsigned>(count);
  return with_dimension<4, 7, 8>(view.dimension, [&](auto k) {
    // The keys of write_few_simplices fit.
    static_assert(std::bit_width(SmallSurfaceNd<k>::most_facets - 1) +
                      k * std::bit_width(row_of(few_way(k)).most_left - 1) <=
                  64);
    auto& surface = thread_memory<SmallSurfaceNd<k>>();
    const bool done = surface.build(rows.data(), n) &&
                      write_few_simplices(view, ids, n, surface.simplices(), hull);
    // Free large surfaces: small sets rarely need them.
    if (!done && surface.simplices().slots > 1024) surface = {};
    return done;
  });
}

}  // namespace cullhull::internal
