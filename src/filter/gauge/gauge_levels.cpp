#include <algorithm>
#include <cmath>

#include "filter/gauge/gauge_build.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// The approximate number of cells along an edge of a face: their 38 KB of levels about fill the L1
/// cache.
constexpr std::uint32_t wanted_cells = 80;
/// The most cells for which the bound `overlap` is proved.
constexpr std::uint32_t most_cells = 512;
/// The cell that the levels choose and the place where the map interpolates differ by at most this
/// part of a cell (docs/exactness.md, G8).
constexpr double overlap = 0x1p-10;
/// Covers the rounding of the map's sum, of the levels and of their comparison.
constexpr double margin = 0x1p-16;

/// Replaces each value by the largest of `width` neighbours along a stride, starting `back` before
/// it, within [0, size).
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

/// Computes for each cell of a face the |y|_inf below which the map drops every point of the cell.
void find_limits(const GaugeTable& t, unsigned face, std::uint32_t parts, double* limits) {
  const std::uint32_t cells = t.cells * parts, row = cells + 1;
  // `own`: the largest value of each part; `around`: of the part and those around it.
  std::vector<double> own = values_on_face(t, face, parts), around = own;
  spread(own, row, 1, row, row, 0, 2);
  spread(own, row, row, row, 1, 0, 2);
  spread(around, row, 1, row, row, 1, 4);
  spread(around, row, row, row, 1, 1, 4);
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::size_t at = std::size_t{j} * row + i;
      const double bound = own[at] + 2 * overlap * (around[at] - own[at]);
      *limits++ = bound < 0x1p100 ? t.threshold * (1 - margin) / bound : 0;
    }
}

}  // namespace

std::vector<double> values_on_face(const GaugeTable& t, unsigned face, std::uint32_t parts) {
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

std::optional<GaugeLevels> make_levels(const GaugeTable& t, unsigned threads) {
  if (t.dimension != 3 || t.cells > most_cells) return std::nullopt;
  GaugeLevels levels;
  const std::uint32_t parts = std::max(1U, wanted_cells / t.cells), cells = t.cells * parts;
  levels.cells = cells;
  levels.middle = static_cast<float>(cells) / 2;
  levels.half_cells = levels.middle * (1 - 0x1p-20F);
  levels.face_stride = static_cast<float>(cells * cells);
  levels.last = 6 * cells * cells - 1;
  const std::size_t face_size = std::size_t{cells} * cells;
  std::vector<double> limits(6 * face_size);
  const auto each_face = [&](const auto& body) {
    for_each_chunk(6, 1, threads, [&](std::uint64_t f, std::uint64_t, std::uint64_t) { body(f); });
  };
  each_face([&](std::uint64_t f) {
    find_limits(t, static_cast<unsigned>(f), parts, &limits[f * face_size]);
  });
  const double highest = *std::max_element(limits.begin(), limits.end());
  if (!(highest > 0)) return std::nullopt;
  levels.unit = static_cast<float>(highest / 255);
  levels.of_cell.resize(limits.size());
  each_face([&](std::uint64_t f) {
    for (std::size_t k = f * face_size; k < (f + 1) * face_size; ++k)
      levels.of_cell[k] = static_cast<std::uint8_t>(
          std::clamp(std::floor(limits[k] / static_cast<double>(levels.unit)), 0.0, 255.0));
  });
  return levels;
}

}  // namespace cullhull::internal
