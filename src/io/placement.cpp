#include "cullhull/placement.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "cullhull/hull.hpp"
#include "io/coordinates.hpp"
#include "io/grid_axes.hpp"
#include "io/source.hpp"
#include "io/text/lines.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

constexpr int most_decimals = 15, most_places = 100;
/// So that the nearest double of a coordinate identifies the number: its error is below a quarter.
constexpr std::uint64_t most_number = std::uint64_t{1} << 50;

/// digits * 10^exponent.
struct Decimal {
  bool negative = false;
  std::uint64_t digits = 0;
  int exponent = 0;
};

/// The shortest decimal that reads back as `value`.
Decimal shortest_decimal(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific);
  Decimal d;
  const char* at = text;
  if (*at == '-') {
    d.negative = true;
    ++at;
  }
  int behind_point = 0;
  for (bool behind = false; *at != 'e'; ++at)
    if (*at == '.') {
      behind = true;
    } else {
      d.digits = 10 * d.digits + static_cast<std::uint64_t>(*at - '0');
      behind_point += behind ? 1 : 0;
    }
  ++at;
  if (*at == '+') ++at;
  std::from_chars(at, end.ptr, d.exponent);
  d.exponent -= behind_point;
  while (d.digits != 0 && d.digits % 10 == 0) {
    d.digits /= 10;
    ++d.exponent;
  }
  if (d.digits == 0) d.exponent = 0;
  return d;
}

/// On a grid with this many decimals; empty beyond what doubles hold exactly.
std::optional<double> multiple(const Decimal& d, int decimals) {
  std::uint64_t number = d.digits;
  if (d.exponent + decimals < 0) return std::nullopt;
  for (int i = 0; number != 0 && i < d.exponent + decimals; ++i)
    if (!multiply(number, 10, number) || number > most_number) return std::nullopt;
  if (number > most_number) return std::nullopt;
  return d.negative ? -static_cast<double>(number) : static_cast<double>(number);
}

bool is_multiple(double v, double unit) { return std::rint(v / unit) == v / unit; }

/// The same for a binary grid, where numbers are unchanged.
std::optional<double> binary_multiple(double v, double unit) {
  return is_multiple(v, unit) ? std::optional(v) : std::nullopt;
}

/// Binary places that scales and offsets need together; nothing where they have very many.
std::optional<int> binary_places(const std::vector<Placement>& placements) {
  int places = 0;
  for (const Placement& p : placements)
    for (const std::vector<double>* numbers : {&p.scale, &p.offset})
      for (const double v : *numbers)
        while (!is_multiple(v, std::ldexp(1.0, -places)))
          if (++places > most_places) return std::nullopt;
  return places;
}

/// The bits of numbers up to `most`.
int bits_of(double most) { return most <= 1 ? 1 : static_cast<int>(std::ceil(std::log2(most))); }

/// The bits of a state's numbers on a grid that contains it; 0: unknown.
int bits_on(const GridOfState& s, const Grid& grid) {
  if (s.bits == 0) return 0;
  const double own = s.decimals >= 0 ? Grid(s.decimals).unit() : std::ldexp(1.0, -s.places);
  return bits_of(std::ldexp(own / grid.unit(), s.bits));
}

/// Whether all numbers have at most 50 bits there. Sets the grid's bits.
bool all_lie_on(const std::vector<Placement>& placements, const std::vector<GridOfState>& states,
                Grid& grid) {
  double most = 1;
  for (const Placement& p : placements) {
    const std::optional<Multiples> m = multiples_of(p, grid);
    if (!m) return false;
    for (std::size_t j = 0; j < m->step.size(); ++j)
      most = std::max(most, (m->step[j] * 0x1p31 + std::abs(m->origin[j])) /
                                (grid.decimals() < 0 ? grid.unit() : 1));
  }
  int bits = bits_of(most);
  for (const GridOfState& s : states) {
    const int own = bits_on(s, grid);
    if (own > 50) return false;
    bits = own == 0 || bits == 0 ? 0 : std::max(bits, own);
  }
  grid.set_bits(bits);
  return true;
}

}  // namespace

Grid grid_of_all(const std::vector<Placement>& placements, const std::vector<GridOfState>& states) {
  int decimals = 0;
  for (const Placement& p : placements) {
    if (p.empty()) return {};
    for (const std::vector<double>* numbers : {&p.scale, &p.offset})
      for (const double v : *numbers) decimals = std::max(decimals, -shortest_decimal(v).exponent);
  }
  std::optional<int> places = binary_places(placements);
  for (const GridOfState& s : states) {
    if (s.decimals < 0 && s.places < 0) return {};
    // A binary fraction has as many decimals as places.
    decimals = std::max(decimals, std::max(s.decimals, s.places));
    if (s.decimals > 0)
      places.reset();
    else if (places)
      places = std::max(*places, s.places);
  }
  if (placements.empty() && states.empty()) return {};
  if (decimals > 0 && places)
    if (Grid grid = Grid::binary(*places); all_lie_on(placements, states, grid)) return grid;
  if (decimals > most_decimals) return {};
  Grid grid(decimals);
  return all_lie_on(placements, states, grid) ? grid : Grid();
}

std::optional<Multiples> multiples_of(const Placement& placement, const Grid& grid) {
  Multiples m;
  const bool decimal = grid.decimals() >= 0;
  const double most = static_cast<double>(most_number) * (decimal ? 1 : grid.unit());
  const auto on_grid = [&](double v) {
    return decimal ? multiple(shortest_decimal(v), grid.decimals())
                   : binary_multiple(v, grid.unit());
  };
  for (std::size_t j = 0; j < placement.scale.size(); ++j) {
    const auto step = on_grid(placement.scale[j]), origin = on_grid(placement.offset[j]);
    // Numbers of a file have 32 bits: the farthest is 2^31 steps away.
    if (!step || !origin || *step * 0x1p31 + std::abs(*origin) > most) return std::nullopt;
    m.step.push_back(*step);
    m.origin.push_back(*origin);
  }
  return m;
}

Grid grid_of(const Placement& placement, const ReadOptions& options) {
  if (placement.empty() || options.numbers != Numbers::grid) return {};
  return options.grid ? *options.grid : common_grid({placement});
}

void place(PointData& data, const ReadOptions& options) {
  if (data.placement.empty() || stays(options.numbers)) return;
  const Placement& placement = data.placement;
  data.grid = grid_of(placement, options);
  const bool on_grid = !data.grid.empty();
  const Grid grid = on_grid ? data.grid : common_grid({placement});
  const auto multiples = grid.empty() ? std::nullopt : multiples_of(placement, grid);
  const PointView from = data.view;
  const std::uint32_t d = from.dimension;
  std::uint64_t bytes = 0;
  if (!multiply(from.count, d * sizeof(double), bytes)) throw std::bad_alloc();
  Buffer room(std::max<std::uint64_t>(bytes, 1));
  auto* const out = room.as<double>();
  constexpr std::uint64_t chunk = std::uint64_t{1} << 16;  // points
  for_each_chunk(from.count, chunk, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    for (std::uint32_t j = 0; j < d; ++j)
      for (std::uint64_t i = begin; i < end; ++i) {
        const double x = from.at(i, j);
        double& to = out[i * d + j];
        if (!multiples)
          to = placement.at(j, x);
        else if (const double n = x * multiples->step[j] + multiples->origin[j]; on_grid)
          to = n;
        else
          to = grid.to_world(n);
      }
  });
  data.storage = std::move(room);
  data.in_place = false;
  data.view = PointView::row_major(data.storage.as<const double>(), from.count, d);
}

}  // namespace cullhull::internal

namespace cullhull {

using internal::multiples_of;

Grid::Grid(int decimals) : decimals_(decimals) {
  for (int i = 0; i < decimals; ++i) power_ *= 10;  // exact up to 10^22
  unit_ = 1 / power_;
}

Grid Grid::binary(int places) {
  Grid grid;
  grid.unit_ = std::ldexp(1.0, -places);
  return grid;
}

double Grid::measure_to_world(double measure, int dimension) const noexcept {
  double power = 1;
  for (int i = 0; i < dimension; ++i) power *= power_;
  return measure / power;
}

double Grid::measure_to_grid(double measure, int dimension) const noexcept {
  double power = 1;
  for (int i = 0; i < dimension; ++i) power *= power_;
  return measure * power;
}

double Grid::number_of(double coordinate) const noexcept {
  if (empty()) return coordinate;
  const double number =
      decimals_ < 0 ? std::round(coordinate / unit_) * unit_ : std::round(to_grid(coordinate));
  return to_world(number) == coordinate ? number : std::numeric_limits<double>::quiet_NaN();
}

Grid common_grid(const std::vector<Placement>& placements) {
  return internal::grid_of_all(placements, {});
}

internal::GridAxes::GridAxes(const Placement& placement, const Grid& grid) {
  std::optional<internal::Multiples> multiples;
  if (!grid.empty()) multiples = multiples_of(placement, grid);
  if (!multiples) throw Error(ErrorCode::invalid_argument, "the numbers do not lie on the grid");
  step_ = std::move(multiples->step);
  origin_ = std::move(multiples->origin);
}

namespace {

/// Converts each number of a hull: offsets and the centroid are lengths.
template <class Length, class Measure>
void convert(Hull& hull, const Length& length, const Measure& measure) {
  const std::size_t width = std::size_t{hull.dimension} + 1;
  for (std::size_t i = width - 1; i < hull.facet_planes.size(); i += width)
    hull.facet_planes[i] = length(hull.facet_planes[i]);
  for (double& x : hull.centroid) x = length(x);
  const int k = std::max(hull.affine_dimension, 0);
  hull.volume = measure(hull.volume, k);
  hull.area = measure(hull.area, std::max(k - 1, 0));
}

}  // namespace

void to_world(Hull& hull, const Grid& grid) {
  if (grid.empty()) return;
  convert(
      hull, [&](double x) { return grid.to_world(x); },
      [&](double m, int d) { return grid.measure_to_world(m, d); });
}

void to_grid(Hull& hull, const Grid& grid) {
  if (grid.empty()) return;
  convert(
      hull, [&](double x) { return grid.to_grid(x); },
      [&](double m, int d) { return grid.measure_to_grid(m, d); });
}

void to_grid(Hull& hull, std::vector<double>& vertex_coordinates, const Grid& grid) {
  if (grid.empty()) return;
  const std::size_t d = hull.dimension;
  const std::vector<double> centroid = hull.centroid;
  to_grid(hull, grid);
  for (double& x : vertex_coordinates) x = grid.number_of(x);
  for (std::size_t j = 0; j < hull.centroid.size(); ++j) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = j; i < vertex_coordinates.size(); i += d) {
      low = std::min(low, vertex_coordinates[i]);
      high = std::max(high, vertex_coordinates[i]);
    }
    // Rounding may have moved it out of the box, of which a point or a flat has no thickness.
    if (grid.to_world(low) <= centroid[j] && centroid[j] <= grid.to_world(high))
      hull.centroid[j] = std::clamp(hull.centroid[j], low, high);
  }
}

void to_world(Voronoi& diagram, const Grid& grid) {
  if (grid.empty()) return;
  for (double& x : diagram.vertices) x = grid.to_world(x);
}

void to_world(ClippedCells& cells, const Grid& grid) {
  if (grid.empty()) return;
  for (double& x : cells.vertices) x = grid.to_world(x);
  for (double& m : cells.measures) m = grid.measure_to_world(m, static_cast<int>(cells.dimension));
}

void to_world(HullState& state, const Grid& grid) {
  if (grid.decimals() >= 0)
    state.to_world(grid.decimals(), grid.bits());
  else if (!grid.empty())  // the coordinates are there
    state.set_binary_grid(-std::ilogb(grid.unit()), grid.bits());
}

void to_world(std::vector<double>& numbers, const Grid& grid) {
  if (grid.empty()) return;
  for (double& x : numbers) x = grid.to_world(x);
}

}  // namespace cullhull
