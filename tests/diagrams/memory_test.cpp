// The memory budget of triangulations and of what is made of them: refused before the work. And
// serial loops that check for cancellation.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "generate/point_generator.hpp"
#include "parallel/threads/checked_steps.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace memory_test {

constexpr std::uint64_t mib = std::uint64_t{1} << 20;

struct Made {
  std::vector<double> rows;
  std::uint32_t dimension;

  Made(const char* shape, std::uint64_t n, std::uint32_t d) : rows(n * d), dimension(d) {
    internal::PointGenerator(shape, n, d, 1).rows(0, n, rows.data());
  }
  PointView view() const {
    return PointView::row_major(rows.data(), rows.size() / dimension, dimension);
  }
};

std::string refusal(const std::function<void()>& work) {
  return testing_support::error_of(ErrorCode::out_of_budget, work);
}

TEST(DiagramMemory, TriangulationsAreRefusedByAnEstimateBeforeTheWork) {
  for (const unsigned threads : {1U, 2U})
    for (const auto& [points, budget] : {std::pair{Made("disk", 100000, 2), 10 * mib},
                                         std::pair{Made("ball", 100000, 3), 40 * mib},
                                         std::pair{Made("ball", 20000, 4), 30 * mib}}) {
      TriangulationOptions o;
      o.threads = threads;
      o.memory_budget = budget;
      double done = 0;
      o.progress = [&](const char* phase, double share) {
        if (std::string_view(phase) == "triangulate") done = std::max(done, share);
      };
      const std::string why = refusal([&, &made = points] { (void)delaunay(made.view(), o); });
      EXPECT_NE(why.find("cells of the triangulation need about"), std::string::npos) << why;
      EXPECT_LT(done, 0.1) << "the points were inserted before the refusal";
    }
}

TEST(DiagramMemory, FewerCellsThanUsualFit) {
  // Three cells for each point of a sphere and two at the hull, for a point of a ball nearly seven.
  const Made sphere("sphere", 30000, 3);
  TriangulationOptions o;
  o.threads = 1;
  o.memory_budget = 19'500'000;
  EXPECT_EQ(delaunay(sphere.view(), o).vertex_count(), 30000U);
  const Made ball("ball", 30000, 3);
  refusal([&] { (void)delaunay(ball.view(), o); });
  // Equal points have no cells.
  Made equal("disk", 100000, 2);
  for (std::size_t i = 2000; i < equal.rows.size(); ++i) equal.rows[i] = equal.rows[i % 2000];
  o.memory_budget = 8 * mib;
  EXPECT_EQ(delaunay(equal.view(), o).vertex_count(), 1000U);
}

TEST(DiagramMemory, TheBudgetBoundsCellsWhateverTheEstimateWas) {
  // Points on two lines that do not meet: as many cells as pairs of neighbours on each.
  std::vector<double> rows;
  for (int i = 0; i < 2000; ++i)
    for (const double x :
         {i % 2 == 0 ? 1.0 * i : 0.0, i % 2 == 0 ? 0.0 : 1.0 * i, i % 2 == 0 ? 0.0 : 9.0})
      rows.push_back(x);
  TriangulationOptions o;
  o.memory_budget = 20 * mib;
  const std::string why =
      refusal([&] { (void)delaunay(PointView::row_major(rows.data(), 2000, 3), o); });
  EXPECT_NE(why.find("cells of the triangulation"), std::string::npos) << why;
}

TEST(DiagramMemory, DiagramsAndShapesAreRefusedBeforeTheirWork) {
  const Made points("disk", 20000, 2);
  const PointView view = points.view();
  const Triangulation t = delaunay(view);
  const Voronoi diagram = voronoi(view, t);
  const double low[] = {-1, -1}, high[] = {1, 1};
  RunOptions o;
  o.memory_budget = mib / 2;
  o.progress = [](const char* phase, double) { ADD_FAILURE() << "began: " << phase; };
  refusal([&] { (void)voronoi(view, t, {}, o); });
  auto clipping = options_as<ClipOptions>(o);
  refusal([&] { (void)clip_voronoi(view, t, low, high, {}, clipping); });
  clipping.diagram = &diagram;
  refusal([&] { (void)clip_voronoi(view, t, low, high, {}, clipping); });
  refusal([&] { (void)alpha_shape(view, t, 0.1, o); });
  refusal([&] { (void)alpha_radii(view, t, o); });
  refusal([&] { (void)critical_alpha(view, t, true, o); });
  refusal([&] { (void)concave_hull(view, t, 0.1, o); });
  refusal([&] { (void)concave_length(view, t, 0.1, o); });
  refusal([&] { (void)constrained_delaunay(view, {}, options_as<ConstrainedOptions>(o)); });
  o.progress = nullptr;
  o.memory_budget = 20 * mib;
  EXPECT_EQ(voronoi(view, t, {}, o).vertex_count(), diagram.vertex_count());
  clipping = options_as<ClipOptions>(o);
  clipping.diagram = &diagram;
  EXPECT_EQ(clip_voronoi(view, t, low, high, {}, clipping).measures.size(), 20000U);
}

// ------------------------------------------------------------------- cancellation in serial loops

TEST(CheckedSteps, CheckOnceInSoManySteps) {
  std::uint64_t checks = 0;
  Options options;
  options.threads = 1;
  options.poll = [&] { ++checks; };
  const internal::Run run(options);
  internal::CheckedSteps steps(run);
  const std::uint64_t between = internal::CheckedSteps::between_checks;
  for (std::uint64_t i = 0; i < 10 * between; ++i) steps.next();
  EXPECT_EQ(checks, 10U);
  for (std::uint64_t i = 0; i < 10; ++i) steps.next(internal::CheckedSteps::between_checks);
  EXPECT_EQ(checks, 20U);
}

TEST(CheckedSteps, ASpanningTreeChecksWhileItSorts) {
  const Made points("disk", 100000, 2);
  const Triangulation t = delaunay(points.view());
  std::stop_source stop;
  Options o;
  o.threads = 1;
  o.stop = stop.get_token();
  std::uint64_t checks = 0;
  bool sorting = false;
  o.progress = [&](const char* phase, double) { sorting = std::string_view(phase) == "sort"; };
  o.poll = [&] { checks += sorting ? 1 : 0; };
  (void)minimum_spanning_tree(points.view(), t, o);
  // 300,000 edges, each compared some 18 times.
  const std::uint64_t comparisons = 300000 * 10;
  EXPECT_GT(checks, comparisons / internal::CheckedSteps::between_checks);
  // A stop within the sort ends the call at the next check.
  checks = 0;
  o.poll = [&] {
    checks += sorting ? 1 : 0;
    if (checks == 3) stop.request_stop();
  };
  testing_support::error_of(ErrorCode::cancelled,
                            [&] { (void)minimum_spanning_tree(points.view(), t, o); });
  EXPECT_LE(checks, 4U);
}

}  // namespace memory_test
}  // namespace cullhull
