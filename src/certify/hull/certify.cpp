#include "cullhull/certify.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "certify/certificate.hpp"
#include "certify/hull/cones.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal::certify {

void check_chunks(const Run& run, std::uint64_t count, std::uint64_t chunk_size,
                  const std::function<void(std::uint64_t begin, std::uint64_t end)>& body,
                  CodePlace where) {
  std::vector<std::string> faults(chunk_count(count, chunk_size));
  run.each_chunk(
      count, chunk_size,
      [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    try {
      body(begin, end);
    } catch (const Fault& f) {
      faults[chunk] = f.reason;
    }
      },
      where);
  for (std::string& f : faults)
    if (!f.empty()) throw Fault{std::move(f)};
}

Sign Subject::side(std::uint32_t f, const double* x, const double** scratch) const {
  for (unsigned j = 0; j < k; ++j) scratch[j] = row(simplex(f)[j]);
  scratch[k] = x;
  // If the facet is orthogonal to an axis, equality shows that x is in its plane, a frequent case
  // on grids.
  for (unsigned c = 0; c < k; ++c) {
    bool level = true;
    for (unsigned j = 0; j < k && level; ++j) level = scratch[j][c] == x[c];
    if (level) return Sign::zero;
  }
  if (k > 8) run.check();  // a sign can take milliseconds
  Rung rung = Rung::filter;
  const Sign sign = orientation(k, scratch, &rung);
  if (rung == Rung::exact) exact_decisions.fetch_add(1, std::memory_order_relaxed);
  return sign;
}

Sign Subject::seen(const double** r) const {
  if (k > 8) run.check();
  if (!centre.empty()) {
    r[k] = centre.data();
    Rung rung = Rung::filter;
    const Sign sign = orientation(k, r, &rung);
    if (rung == Rung::exact) exact_decisions.fetch_add(1, std::memory_order_relaxed);
    return sign;
  }
  // No double is strictly inside: uses the centroid of the basis, as an exact rational.
  exact_decisions.fetch_add(1, std::memory_order_relaxed);
  std::vector<const double*> corners;
  for (const std::uint32_t v : basis) corners.push_back(row(v));
  // det [p1 - p0; ...; o - p0] = (-1)^k det [p0 - o; ...; p(k-1) - o]
  const Sign sign = orientation_from_centroid_exact(k, r, corners.data());
  return k % 2 == 0 ? sign : -sign;
}

bool Subject::in_cone(std::uint32_t f, const double* x, const double** scratch) const {
  for (unsigned j = 0; j < k; ++j) {
    for (unsigned i = 0; i < k; ++i) scratch[i] = i == j ? x : row(simplex(f)[i]);
    if (seen(scratch) == Sign::positive) return false;
  }
  return true;
}

std::uint32_t Subject::locate(const double* x, std::uint32_t start, const double** scratch) const {
  // A visibility walk on a regular subdivision of the sphere terminates. Inside a triangulated
  // facet it could cycle; therefore the first slot tested rotates and steps are counted. The limit
  // is far above the length of walks and stops only walks on surfaces that are not closed.
  std::uint32_t f = start;
  const std::uint64_t limit = 1000 + std::uint64_t{4} * simplex_count();
  for (std::uint64_t step = 0; step < limit; ++step) {
    bool moved = false;
    for (unsigned i = 0; i < k && !moved; ++i) {
      const auto j = static_cast<unsigned>((i + step * 7) % k);
      for (unsigned c = 0; c < k; ++c) scratch[c] = c == j ? x : row(simplex(f)[c]);
      if (seen(scratch) != Sign::positive) continue;
      f = neighbour(f, j);
      moved = true;
    }
    if (!moved) return f;
    if (step % 4096 == 4095) run.check();
  }
  for (f = 0; f < simplex_count(); ++f)
    if (in_cone(f, x, scratch)) return f;
  fault("no facet meets the ray towards a point: the surface is not closed");
}

namespace {

void check_empty(const Hull& h, std::uint64_t n) {
  if (n == 0 && (!h.vertices.empty() || !h.centroid.empty()))
    fault("there are no points, but vertices or a centroid");
  if (!h.simplices.empty() || !h.simplex_facets.empty() || !h.simplex_neighbours.empty() ||
      h.facets.offsets.size() > 1 || !h.facets.items.empty() ||
      h.facet_neighbours.offsets.size() > 1 || !h.facet_neighbours.items.empty() ||
      !h.facet_planes.empty())
    fault("a hull of affine dimension ", h.affine_dimension, " has no facets");
  if (h.volume != 0 || h.area != 0) fault("a hull without facets has no volume and no area");
}

/// k = 0: all points are equal to the first.
void check_single(Subject& s) {
  const Hull& h = s.hull;
  check_empty(h, s.points.count);
  // In blocks, check_equal() finds a lower id: point 0 may be one that is left out.
  if (h.vertices.size() != 1 || (s.claimed == nullptr && h.vertices[0] != 0))
    fault("the only vertex should be point 0");
  s.full.resize(s.points.dimension);
  for (unsigned j = 0; j < s.points.dimension; ++j)
    s.full[j] = s.claimed != nullptr ? (*s.claimed)[j] : s.points.at(0, j);
  if (!std::ranges::equal(h.centroid, s.full)) fault("the centroid is not the only point");
}

/// k = 0: checks that each point of the block equals the only vertex.
void check_equal(const Subject& s, const PointView& block, std::uint64_t first_id) {
  check_chunks(s.run, block.count, std::uint64_t{1} << 16,
               [&](std::uint64_t begin, std::uint64_t end) {
    const std::uint64_t vertex = s.hull.vertices[0];
    if (begin < end && begin + first_id < vertex)
      fault("the only vertex should be point ", begin + first_id);
    for (std::uint64_t i = begin; i < end; ++i)
      for (unsigned j = 0; j < block.dimension; ++j) {
        const double v = block.at(i, j);
        if (!std::isfinite(v)) fault("point ", first_id + i, " is not finite");
        if (v != s.full[j]) fault("point ", first_id + i, " differs from point ", vertex);
      }
    if (begin + first_id <= vertex && vertex < end + first_id) ++s.vertices_met;
  });
}

/// Checks all properties that can be checked without the non-vertices.
void check_hull(Subject& s, std::optional<Cones>& cones, Certificate& out) {
  const Hull& h = s.hull;
  const std::uint64_t n = s.points.count;
  if (h.dimension != s.points.dimension) fault("the hull's dimension is not that of the points");
  if (h.point_count != n) fault("the hull is that of ", h.point_count, " points, not of ", n);
  if (h.scalar != s.points.scalar) fault("the hull's scalar type is not that of the points");
  if (h.affine_dimension < -1 || h.affine_dimension > static_cast<std::int64_t>(h.dimension))
    fault("affine dimension ", h.affine_dimension, " is impossible");
  if ((n == 0) != (h.affine_dimension == -1))
    fault("affine dimension ", h.affine_dimension, " is impossible for ", n, " points");
  if (s.claimed != nullptr && s.claimed->size() != h.vertices.size() * h.dimension)
    fault("the vertices are ", h.vertices.size(), ", but their coordinates ", s.claimed->size());
  if (n == 0) return check_empty(h, 0);
  if (h.affine_dimension == 0) return check_single(s);
  s.k = static_cast<unsigned>(h.affine_dimension);
  s.run.report("certify", 0);
  check_shape(s);
  check_flat(s);
  s.run.report("certify", 0.05);
  cones.emplace(s);
  const std::size_t corners = s.k + std::size_t{1};
  if (s.k > 1 && n == corners && s.ids.size() == corners && s.simplex_count() == corners) {
    out.ridges_checked = check_single_simplex(s);
  } else {
    check_interior(s, *cones);
    s.run.report("certify", 0.2);
    out.ridges_checked = check_ridges(s, *cones);
    check_covering(s, *cones);
  }
  s.run.report("certify", 0.4);
  check_facets(s);
  s.run.report("certify", 0.5);
}

void check_all(Subject& s, Certificate& out) {
  const std::uint64_t n = s.points.count;
  require_points(s.points);
  std::optional<Cones> cones;
  check_hull(s, cones, out);
  if (s.k > 0)
    PointCheck(s, *cones).check(s.points, 0);
  else
    check_equal(s, s.points, 0);
  out.points_checked = n;
  if (s.k == 0) return;
  s.run.report("certify", 0.8);
  check_numbers(s);
  s.run.report("certify", 1);
}

}  // namespace
}  // namespace cullhull::internal::certify

namespace cullhull {

Certificate certify(const PointView& points, const Hull& hull, const Options& options) {
  using namespace internal::certify;
  const internal::Call call(options);
  Certificate out;
  Subject subject(points, hull, call.run);
  try {
    check_all(subject, out);
    out.valid = true;
  } catch (const Fault& f) {
    out.reason = f.reason;
  }
  out.exact_decisions = subject.exact_decisions;
  return out;
}

// ------------------------------------------------------------------------------- in pieces

struct CertifyStream::Impl {
  Options options;
  internal::Run run{options};
  const Hull& hull;
  std::vector<double> claimed;
  PointView none;
  internal::certify::Subject subject{none, hull, run};
  std::optional<internal::certify::Cones> cones;
  std::unique_ptr<internal::certify::PointCheck> points;
  Certificate out;
  mutable std::mutex mutex;  ///< guards the members below
  std::uint64_t at = 0;      ///< lowest first id of a block with a fault
  std::uint64_t checked = 0, left_out = 0;

  Impl(const Hull& h, std::vector<double>&& rows, const Options& o)
      : options(o), hull(h), claimed(std::move(rows)) {
    sort_claimed();
  }

  /// Sorts the claimed rows from the hull's order (cyclic for a polygon) to ascending ids.
  void sort_claimed() {
    const std::size_t n = hull.vertices.size(), d = hull.dimension;
    if (claimed.size() != n * d || std::is_sorted(hull.vertices.begin(), hull.vertices.end()))
      return;
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return hull.vertices[a] < hull.vertices[b]; });
    std::vector<double> sorted;
    for (const std::size_t i : order)
      sorted.insert(sorted.end(), claimed.begin() + static_cast<std::ptrdiff_t>(i * d),
                    claimed.begin() + static_cast<std::ptrdiff_t>((i + 1) * d));
    claimed = std::move(sorted);
  }

  /// Keeps the fault of the block with the lowest id, so that the order of pushes does not matter.
  void note(const internal::certify::Fault& f, std::uint64_t first_id) {
    const std::lock_guard lock(mutex);
    if (!out.reason.empty() && at <= first_id) return;
    out.reason = f.reason;
    at = first_id;
  }
};

CertifyStream::CertifyStream(const Hull& hull, std::vector<double> vertex_coordinates,
                             const Options& options)
    : impl_(std::make_unique<Impl>(hull, std::move(vertex_coordinates), options)) {
  Impl& m = *impl_;
  m.none = {nullptr, hull.scalar, hull.dimension, hull.point_count, 0, 0};
  m.subject.claimed = &m.claimed;
  try {
    internal::certify::check_hull(m.subject, m.cones, m.out);
    if (m.subject.k > 0)
      m.points = std::make_unique<internal::certify::PointCheck>(m.subject, *m.cones);
  } catch (const internal::certify::Fault& f) {
    m.note(f, 0);
  }
}
CertifyStream::CertifyStream(CertifyStream&&) noexcept = default;
CertifyStream& CertifyStream::operator=(CertifyStream&&) noexcept = default;
CertifyStream::~CertifyStream() = default;

void CertifyStream::push(const PointView& block, std::uint64_t first_id) {
  Impl& m = *impl_;
  internal::require_points(block);
  {
    const std::lock_guard lock(m.mutex);
    m.checked += block.count;
    if (!m.out.reason.empty() && m.at <= first_id) return;
  }
  try {
    if (block.dimension != m.hull.dimension)
      internal::certify::fault("the hull's dimension is not that of the points");
    if (m.hull.affine_dimension < 0) {
      if (block.count > 0) internal::certify::fault("the hull is that of no points");
    } else if (m.points != nullptr) {
      m.points->check(block, first_id);
    } else {
      internal::certify::check_equal(m.subject, block, first_id);
    }
  } catch (const internal::certify::Fault& f) {
    m.note(f, first_id);
  }
}

void CertifyStream::skip(std::uint64_t count) {
  const std::lock_guard lock(impl_->mutex);
  impl_->left_out += count;
}

internal::CertifiedPart CertifyStream::part() const {
  const Impl& m = *impl_;
  const std::lock_guard lock(m.mutex);
  return {m.checked, m.subject.vertices_met, m.subject.exact_decisions, m.out.reason, m.at};
}

void CertifyStream::add(const internal::CertifiedPart& part) {
  Impl& m = *impl_;
  if (!part.reason.empty()) m.note({part.reason}, part.at);
  const std::lock_guard lock(m.mutex);
  m.checked += part.points;
  m.subject.vertices_met += part.vertices;
  m.subject.exact_decisions += part.exact_decisions;
}

Certificate CertifyStream::finish() {
  Impl& m = *impl_;
  try {
    // A hull of no points does not count those that were left out.
    const std::uint64_t counted = m.checked + (m.hull.affine_dimension < 0 ? 0 : m.left_out);
    if (m.out.reason.empty() && counted != m.hull.point_count)
      internal::certify::fault("the hull is that of ", m.hull.point_count, " points, not of ",
                               counted);
    if (m.out.reason.empty() && m.subject.vertices_met != m.hull.vertices.size())
      internal::certify::fault("of ", m.hull.vertices.size(), " vertices, ",
                               m.subject.vertices_met.load(), " are among the points");
    if (m.out.reason.empty() && m.subject.k > 0) internal::certify::check_numbers(m.subject);
  } catch (const internal::certify::Fault& f) {
    m.note(f, ~std::uint64_t{0});
  }
  m.out.valid = m.out.reason.empty();
  m.out.points_checked = m.checked;
  m.out.exact_decisions = m.subject.exact_decisions;
  return m.out;
}

}  // namespace cullhull
