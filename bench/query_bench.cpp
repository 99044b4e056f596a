// Rates of batched queries to a hull, compared with testing every facet.
#include <cstdio>
#include <string>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "timing.hpp"

namespace {

using namespace cullhull;

using bench::median_seconds;

void report(const char* what, std::uint64_t n, double seconds) {
  std::printf("  %-40s %8.1f M/s\n", what, static_cast<double>(n) / seconds * 1e-6);
}

void run(const std::string& hull_of, std::uint64_t n, std::uint64_t asked) {
  const std::vector<double> points = generate(hull_of, n, 3, 1);
  const PointView view = PointView::row_major(points.data(), n, 3);
  const Hull hull = convex_hull(view);
  const double build = median_seconds(3, [&] { HullQuery(view, hull); });
  std::printf("hull of %s %llu: %zu vertices, %zu facets; prepared in %.1f ms\n", hull_of.c_str(),
              static_cast<unsigned long long>(n), hull.vertices.size(),
              static_cast<std::size_t>(hull.facet_count()), build * 1e3);
  const HullQuery query(view, hull);
  std::vector<std::uint8_t> in(asked);
  for (const char* where : {"ball", "cube", "sphere"}) {
    const std::vector<double> q = generate(where, asked, 3, 2);
    const PointView at = PointView::row_major(q.data(), asked, 3);
    report((std::string("contains, uniform in the ") + where).c_str(), asked,
           median_seconds(5, [&] { query.contains(at, in.data()); }));
    const std::uint64_t few = asked / 64;
    const PointView some = PointView::row_major(q.data(), few, 3);
    std::vector<double> distance(few);
    report("  signed distance", few,
           median_seconds(3, [&] { query.signed_distances(some, distance.data()); }));
    std::vector<std::uint64_t> ids(few);
    report("  support", few, median_seconds(3, [&] { query.supports(some, ids.data()); }));
    std::vector<RayHit> hits(few);
    report("  rays, towards the next point", few, median_seconds(3, [&] {
             const PointView next = PointView::row_major(q.data() + 3, few, 3);
             query.rays(some, next, hits.data());
           }));
    std::uint64_t inside = 0;
    const std::uint64_t slow = 2000;
    report("  every facet in turn, one core", slow, median_seconds(3, [&] {
             for (std::uint64_t i = 0; i < slow; ++i) {
               bool out = false;
               for (std::size_t f = 0; f < hull.facet_count() && !out; ++f) {
                 const double* p = hull.facet_planes.data() + f * 4;
                 out = p[0] * q[3 * i] + p[1] * q[3 * i + 1] + p[2] * q[3 * i + 2] + p[3] > 0;
               }
               inside += !out;
             }
           }));
    if (inside > 3 * slow) std::puts("");  // keeps the loop from being removed
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t asked = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  run("ball", 8'000'000, asked);
  run("ball", 3'000, asked);
}
