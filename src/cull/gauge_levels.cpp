#include "cull/gauge_levels.hpp"

#include <algorithm>
#include <cmath>

namespace cullhull::internal {
namespace {

/// About so many parts along an edge of a face fill the L1 cache, or a little more.
constexpr std::uint32_t wanted_cells = 80;
/// `overlap` is proved up to here.
constexpr std::uint32_t most_cells = 512;
/// Within this part of a cell the cell that the levels choose and the place the map interpolates at
/// agree.
constexpr double overlap = 0x1p-10;
/// And this covers the rounding of the map's sum, of the levels and of their comparison.
constexpr double margin = 0x1p-16;

/// The map's values at the corners of the parts of one face: (cells + 1)^2 of them.
std::vector<double> corner_values(const GaugeTable& t, unsigned face, std::uint32_t parts) {
  const std::uint32_t cells = t.cells * parts, row = t.cells + 1;
  const float* nodes = t.nodes.data() + std::size_t{face} * row * row;
  std::vector<double> values(std::size_t{cells + 1} * (cells + 1));
  std::size_t at = 0;
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const std::uint32_t ci = std::min(i / parts, t.cells - 1),
                          cj = std::min(j / parts, t.cells - 1);
      const float* g = nodes + std::size_t{cj} * row + ci;
      const double u = static_cast<double>(i - ci * parts) / parts;
      const double v = static_cast<double>(j - cj * parts) / parts;
      const double low = std::min(u, v), high = std::max(u, v);
      const double between = u > v ? g[1] : g[row];
      values[at++] = (1 - high) * g[0] + (high - low) * between + low * g[row + 1];
    }
  return values;
}

/// The largest of `width` neighbours along a stride, from `back` before each on, within [0, size).
void spread(std::vector<double>& v, std::uint32_t size, std::size_t step, std::size_t lines,
            std::size_t line_step, std::uint32_t back, std::uint32_t width) {
  std::vector<double> line(size);
  for (std::size_t l = 0; l < lines; ++l) {
    double* p = v.data() + l * line_step;
    for (std::uint32_t i = 0; i < size; ++i) line[i] = p[i * step];
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t begin = i < back ? 0 : i - back, end = std::min(size, i - back + width);
      double most = line[i];
      for (std::uint32_t k = begin; k < end; ++k) most = std::max(most, line[k]);
      p[i * step] = most;
    }
  }
}

}  // namespace

std::optional<GaugeLevels> make_levels(const GaugeTable& t) {
  if (t.dimension != 3 || t.cells > most_cells) return std::nullopt;
  GaugeLevels levels;
  const std::uint32_t parts = std::max(1U, wanted_cells / t.cells), cells = t.cells * parts;
  levels.cells = cells;
  levels.middle = static_cast<float>(cells) / 2;
  levels.half_cells = levels.middle * (1 - 0x1p-20F);
  levels.face_stride = static_cast<float>(cells * cells);
  levels.last = 6 * cells * cells - 1;
  std::vector<double> limits;
  const std::uint32_t row = cells + 1;
  for (unsigned face = 0; face < 6; ++face) {
    // The largest value of each part, and of those around it as well.
    std::vector<double> own = corner_values(t, face, parts), around = own;
    spread(own, row, 1, row, row, 0, 2);
    spread(own, row, row, row, 1, 0, 2);
    spread(around, row, 1, row, row, 1, 4);
    spread(around, row, row, row, 1, 1, 4);
    for (std::uint32_t j = 0; j < cells; ++j)
      for (std::uint32_t i = 0; i < cells; ++i) {
        const std::size_t at = std::size_t{j} * row + i;
        const double bound = own[at] + 2 * overlap * (around[at] - own[at]);
        limits.push_back(bound < 0x1p100 ? t.threshold * (1 - margin) / bound : 0);
      }
  }
  const double highest = *std::max_element(limits.begin(), limits.end());
  if (!(highest > 0)) return std::nullopt;
  levels.unit = static_cast<float>(highest / 255);
  levels.packed.assign(limits.size() / 4 + 1, 0);
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const auto level = static_cast<std::uint32_t>(
        std::clamp(std::floor(limits[k] / static_cast<double>(levels.unit)), 0.0, 255.0));
    levels.packed[k / 4] |= level << (8 * (k % 4));
  }
  return levels;
}

}  // namespace cullhull::internal
