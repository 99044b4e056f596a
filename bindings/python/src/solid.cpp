#include "solid.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace binding {

using cullhull::Hull;
using cullhull::HullQuery;
using cullhull::PointView;

namespace {

std::vector<double> gather(const PointView& points, const std::vector<std::uint64_t>& ids) {
  std::vector<double> rows(ids.size() * points.dimension);
  double* out = rows.data();
  for (const std::uint64_t id : ids)
    for (std::uint32_t j = 0; j < points.dimension; ++j, ++out)
      if (points.scalar == cullhull::ScalarType::f64)
        std::memcpy(out, points.address(id, j), sizeof *out);
      else
        *out = points.at(id, j);
  return rows;
}

std::uint64_t place_of(std::span<const std::uint64_t> ids, std::uint64_t id) {
  return static_cast<std::uint64_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}
std::vector<std::uint64_t> places_of(std::vector<std::uint64_t> vertices,
                                     std::span<const std::uint64_t> ids) {
  for (std::uint64_t& id : vertices) id = place_of(ids, id);
  return vertices;
}

}  // namespace

Solid::Solid(Hull hull, const PointView& points)
    : own_(std::move(hull)), vertex_rows_(gather(points, own_.vertices)) {}

Solid::Solid(Hull hull, std::span<const std::uint64_t> ids, const PointView& points)
    : own_(std::move(hull)), vertex_rows_(gather(points, places_of(own_.vertices, ids))) {}

Solid::Solid(Hull hull, std::vector<double> vertex_rows)
    : own_(std::move(hull)), vertex_rows_(std::move(vertex_rows)) {}

Solid::Solid(std::shared_ptr<const Hull> hull, const PointView& points)
    : shared_(std::move(hull)), vertex_rows_(gather(points, shared_->vertices)) {}

Solid::Solid(std::shared_ptr<const Hull> hull, std::vector<double> vertex_rows)
    : shared_(std::move(hull)), vertex_rows_(std::move(vertex_rows)) {}

const std::vector<std::uint64_t>& Solid::ids() const {
  sorted_.call([this] {
    ids_ = hull().vertices;
    std::sort(ids_.begin(), ids_.end());  // a polygon's are in cyclic order
  });
  return ids_;
}

Solid::~Solid() {
  if (query_ == nullptr) return;
  const nanobind::gil_scoped_release release;  // freeing waits for all work of the device
  query_.reset();
}

const HullQuery& Solid::query() const {
  prepared_.call([this] {
    Hull own = hull();
    own.vertex_coordinates.assign(vertex_rows_.begin(), vertex_rows_.end());
    query_ = std::make_unique<HullQuery>(own);
    is_prepared_ = true;
  });
  return *query_;
}

Hull Solid::by_place() const {
  Hull local = hull();
  local.rename([this](std::uint64_t id) { return place_of(ids(), id); });
  local.point_count = ids().size();
  return local;
}

void Solid::renumber(const Solid& whole) {
  own_.rename([&](std::uint64_t place) { return whole.ids()[place]; });
  own_.point_count = whole.hull().point_count;
  own_.scalar = whole.hull().scalar;
}

std::vector<double> Solid::rows_by_place() const {
  const std::size_t d = hull().dimension;
  std::vector<double> rows(vertex_rows_.size());
  for (std::size_t i = 0; i < hull().vertices.size(); ++i)
    std::copy_n(vertex_rows_.data() + i * d, d,
                rows.data() + place_of(ids(), hull().vertices[i]) * d);
  return rows;
}

}  // namespace binding
