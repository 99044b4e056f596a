// A batch of hulls as Python holds it.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/point_view.hpp"
#include "solid.hpp"

namespace binding {

/// The batch and the coordinates of all its vertices.
struct Batch {
  cullhull::HullBatch hulls;
  cullhull::Array<double> vertex_rows;

  std::unique_ptr<Solid> at(std::size_t i) const {
    const auto row = [&](std::size_t set) {
      return vertex_rows.begin() +
             static_cast<std::ptrdiff_t>(hulls.vertices.offsets[set] * hulls.dimension);
    };
    return std::make_unique<Solid>(hulls.hull(i), std::vector<double>(row(i), row(i + 1)));
  }

  void gather_vertices(const cullhull::PointView& points, const std::uint64_t* sets) {
    const auto& ids = hulls.vertices;
    vertex_rows.resize(ids.items.size() * points.dimension);
    double* out = vertex_rows.data();
    for (std::size_t set = 0; set < hulls.size(); ++set)
      for (std::uint64_t i = ids.offsets[set]; i < ids.offsets[set + 1]; ++i)
        for (std::uint32_t j = 0; j < points.dimension; ++j, ++out) {
          const std::uint64_t point = sets[set] + ids.items[i];
          if (points.scalar == cullhull::ScalarType::f64)
            std::memcpy(out, points.address(point, j), sizeof *out);
          else
            *out = points.at(point, j);
        }
  }
};

}  // namespace binding
