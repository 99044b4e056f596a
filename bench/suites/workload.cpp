#include "workload.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <utility>

#include "cullhull/error.hpp"
#include "numbers.hpp"

namespace cullhull::bench {

std::string Workload::name() const {
  const std::string size = count >= 1'000'000 && count % 10'000 == 0 ? short_count(count)
                           : count >= 1'000 && count < 1'000'000 && count % 10 == 0
                               ? short_count(count)
                               : std::to_string(count);
  return fmt::format("{}-{}d-{}{}", family, dimension, size,
                     scalar == ScalarType::f64 ? "" : fmt::format("-{}", scalar_name(scalar)));
}

std::string Workload::title() const {
  std::string what = family;
  if (family == "sphere") what = dimension == 2 ? "circle" : "sphere surface";
  if (family == "ball" && dimension == 2) what = "disk";
  if (family == "cylinder" || family == "cone") what += " mantle";
  if (family == "grid") what = fmt::format("integer grid 128^{},", dimension);
  std::replace(what.begin(), what.end(), '-', ' ');
  return fmt::format("{}D {} {}{}", dimension, what, short_count(count),
                     scalar == ScalarType::f64 ? "" : fmt::format(", {}", scalar_name(scalar)));
}

Workload workload_named(const std::string& name) {
  static const std::regex form(R"((.+)-(\d{1,2})d-(\d{1,9}(?:\.\d+)?)([kM]?)(?:-(f32|f64|i32))?)");
  std::smatch part;
  if (!std::regex_match(name, part, form))
    throw Error(ErrorCode::invalid_argument,
                "bench: '" + name + "' is no workload; write, say, ball-3d-8M or grid-3d-2M-i32");
  Workload w;
  w.family = part[1];
  w.dimension = static_cast<unsigned>(std::stoul(part[2]));
  const double unit = part[4] == "M" ? 1e6 : part[4] == "k" ? 1e3 : 1;
  w.count = static_cast<std::uint64_t>(std::llround(std::stod(part[3]) * unit));
  if (part[5] == "f32") w.scalar = ScalarType::f32;
  if (part[5] == "i32") w.scalar = ScalarType::i32;
  return w;
}

Points points_of(const Workload& w, std::vector<double> rows) {
  Points p;
  p.rows = std::move(rows);
  const std::uint64_t n = p.rows.size() / w.dimension;
  p.doubles = p.view = PointView::row_major(p.rows.data(), n, w.dimension);
  if (w.scalar == ScalarType::f32) {
    p.floats.assign(p.rows.begin(), p.rows.end());
    std::copy(p.floats.begin(), p.floats.end(), p.rows.begin());
    p.view = PointView::row_major(p.floats.data(), n, w.dimension);
  }
  if (w.scalar == ScalarType::i32) {
    // Integers do not change; other values are rounded to a lattice fine enough to keep the shape.
    const bool whole =
        std::all_of(p.rows.begin(), p.rows.end(), [](double x) { return x == std::floor(x); });
    for (double& x : p.rows) {
      x = whole ? x : std::nearbyint(x * 0x1p20);
      if (!(std::abs(x) < 0x1p31))
        throw Error(ErrorCode::invalid_argument, w.name() + ": beyond 32-bit integers");
      p.integers.push_back(static_cast<std::int32_t>(x));
    }
    p.view = PointView::row_major(p.integers.data(), n, w.dimension);
  }
  return p;
}

}  // namespace cullhull::bench
