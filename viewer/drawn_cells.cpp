#include "viewer/drawn_cells.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "cullhull/alpha_shape.hpp"
#include "viewer/hull_shape.hpp"

namespace cullhull::viewer {
namespace {

/// A page's points in the order of ids; triangulates a uniform sample of them.
class Sampled {
 public:
  Sampled(const std::vector<double>& ids, const std::vector<double>& coordinates,
          std::uint32_t dimension, const TriangulationOptions& options, bool outline)
      : order_(ids.size()),
        coordinates_(coordinates),
        dimension_(dimension),
        options_(options),
        outline_(outline) {
    std::iota(order_.begin(), order_.end(), 0U);
    std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return ids[a] < ids[b]; });
  }
  std::uint64_t size() const { return order_.size(); }

  DrawnCells cells(std::uint64_t count) const {
    const std::vector<std::uint64_t> chosen = fair_sample(order_.size(), count);
    std::vector<double> rows;
    rows.reserve(chosen.size() * dimension_);
    for (const std::uint64_t i : chosen)
      for (std::uint32_t j = 0; j < dimension_; ++j)
        rows.push_back(coordinates_[std::uint64_t{order_[i]} * dimension_ + j]);
    const PointView points = PointView::row_major(rows.data(), chosen.size(), dimension_);
    const Triangulation t = delaunay(points, options_);
    DrawnCells cells{t.corners(), chosen.size(), {}};
    const auto add = [&](const auto& corners) {
      for (const std::uint32_t v : corners) cells.rows.push_back(order_[chosen[v]]);
    };
    if (outline_) {
      const double alpha = critical_alpha(points, t, true, options_);
      for (const std::uint32_t c : alpha_shape(points, t, alpha, options_).cells) add(t.cell(c));
    } else {
      add(t.cells);
    }
    return cells;
  }

 private:
  std::vector<std::uint32_t> order_;
  const std::vector<double>& coordinates_;
  std::uint32_t dimension_;
  const TriangulationOptions& options_;
  bool outline_;
};

}  // namespace

DrawnCells drawn_cells(const std::vector<double>& ids, const std::vector<double>& coordinates,
                       std::uint32_t dimension, std::uint64_t most_corners,
                       const TriangulationOptions& options, bool outline) {
  const Sampled points(ids, coordinates, dimension, options, outline);
  // The number of cells may grow as the square of the number of points. Therefore starts with few
  // points and adds more as long as the cells fit.
  std::uint64_t count = std::min<std::uint64_t>(points.size(), 256);
  DrawnCells cells = points.cells(count);
  while (count < points.size()) {
    const double a_point = static_cast<double>(std::max<std::size_t>(1, cells.rows.size())) /
                           static_cast<double>(count);
    const double room = 0.95 * static_cast<double>(most_corners) / a_point;
    const std::uint64_t next =
        std::min({points.size(), 4 * count, static_cast<std::uint64_t>(room)});
    if (next <= count + count / 16) break;
    DrawnCells more = points.cells(next);
    if (more.rows.size() > most_corners) break;
    cells = std::move(more);
    count = next;
  }
  return cells;
}

}  // namespace cullhull::viewer
