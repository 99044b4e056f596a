// Qhull (libqhull_r) as a second engine behind the same interface.
//
// Qhull merges facets within its own tolerance, so its answer is not the exact hull where points
// are nearly coplanar. Exact orientations therefore check that its result is a closed surface of
// non-degenerate simplices that is convex at every ridge.
#include "hull/engine.hpp"

#if defined(CULLHULL_HAVE_QHULL)

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <climits>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {
namespace {

[[noreturn]] void not_exact(const std::string& what) {
  throw Error(ErrorCode::not_exact, "qhull ", what, "; use the native engine");
}

/// A run of Qhull: its state and its output, both released by the destructor.
///
/// Qhull has no cancellation, but writes progress reports to a stream. This class supplies the
/// stream: every write calls `hear`, which makes Qhull add no further point once the caller asks to
/// stop.
class QhullRun {
 public:
  explicit QhullRun(const Control& control) : control_(control), state_(std::make_unique<qhT>()) {
    log_ = fopencookie(this, "w", {nullptr, &QhullRun::hear, nullptr, nullptr});
    if (!log_) throw std::bad_alloc();
    std::setvbuf(log_, nullptr, _IONBF, 0);
    qh_zero(state_.get(), log_);
  }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;
  ~QhullRun() {
    qh_freeqhull(state_.get(), !qh_ALL);
    int long_blocks = 0, long_bytes = 0;
    qh_memfreeshort(state_.get(), &long_blocks, &long_bytes);
    std::fclose(log_);
  }

  /// Errors inside Qhull are returned as an exit code (Qhull uses longjmp within the call).
  void build(const LocalPoints& points) {
    // Qhull takes a pointer to non-const, but changes points only where options ask it to.
    auto* coordinates = const_cast<coordT*>(points.coordinates);
    // The options that SciPy uses; TF: the interval of progress reports, in new facets.
    const std::string dimension_options = points.dimension < 5 ? "qhull Qt" : "qhull Qt Qx";
    std::string command = dimension_options + " TF" + std::to_string(facets_a_report);
    const int code = qh_new_qhull(state_.get(), static_cast<int>(points.dimension),
                                  static_cast<int>(points.count), coordinates, False,
                                  command.data(), log_, log_);
    control_.check();
    if (code != 0) not_exact("failed: " + (error_.empty() ? "no message" : error_));
  }

  qhT* get() { return state_.get(); }

 private:
  static constexpr int facets_a_report = 200;  // latency of a stop against reporting; untested

  /// Called by the C library inside Qhull: must not throw.
  static ssize_t hear(void* self, const char* text, std::size_t size) noexcept {
    auto& run = *static_cast<QhullRun*>(self);
    try {
      run.control_.check();
    } catch (const Error&) {
      run.state_->STOPadd = 1;
    }
    run.keep_error({text, size});
    return static_cast<ssize_t>(size);
  }

  /// The first line of the first message that is an error: "QH6154 Qhull precision error: ...".
  void keep_error(std::string_view text) noexcept {
    const std::size_t begin = text.find("QH6");
    if (!error_.empty() || begin == std::string_view::npos) return;
    try {
      error_ = text.substr(begin, text.find('\n', begin) - begin);
    } catch (const std::bad_alloc&) {  // reported without a message
    }
  }

  const Control& control_;
  std::unique_ptr<qhT> state_;
  std::string error_;
  FILE* log_ = nullptr;
};

std::vector<std::uint32_t> simplices(QhullRun& run, unsigned d) {
  qhT* qh = run.get();
  std::vector<std::uint32_t> out;
  out.reserve(std::size_t{d} * static_cast<std::size_t>(std::max(0, qh->num_facets)));
  for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next) {
    unsigned n = 0;
    for (void* const* v = &facet->vertices->e[0].p; *v; ++v, ++n) {
      const int id = qh_pointid(qh, static_cast<vertexT*>(*v)->point);
      if (id < 0) not_exact("returned a vertex that is no input point");
      out.push_back(static_cast<std::uint32_t>(id));
    }
    if (n != d) not_exact("returned a facet that is no simplex");
  }
  return out;
}

/// Fills the neighbours by sorting all ridges; every ridge must occur exactly twice.
void match_ridges(Boundary& hull) {
  const unsigned d = hull.dimension, r = d - 1;
  const std::size_t count = hull.vertices.size();  // one ridge for each corner of each facet
  if (count > UINT32_MAX) throw Error(ErrorCode::out_of_budget, "more than 2^32 ridges");
  std::vector<std::uint32_t> ridges(count * r), order(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t* v = &hull.vertices[i / d * d];
    std::uint32_t* ridge = &ridges[i * r];
    for (unsigned j = 0; j < d; ++j)
      if (j != i % d) *ridge++ = v[j];
    std::sort(&ridges[i * r], ridge);
    order[i] = static_cast<std::uint32_t>(i);
  }
  const auto key = [&](std::uint32_t i) { return ridges.begin() + std::ptrdiff_t{i} * r; };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(key(a), key(a) + r, key(b), key(b) + r);
  });
  hull.neighbours.resize(count);
  const auto same = [&](std::size_t a, std::size_t b) {
    return std::equal(key(order[a]), key(order[a]) + r, key(order[b]));
  };
  for (std::size_t i = 0; i < count; i += 2) {
    if (i + 1 == count || !same(i, i + 1) || (i + 2 < count && same(i, i + 2)))
      not_exact("returned facets that are no closed surface");
    hull.neighbours[order[i]] = order[i + 1] / d;
    hull.neighbours[order[i + 1]] = order[i] / d;
  }
}

/// Orients every facet outward and checks that the surface is convex at every ridge.
class Orienter {
 public:
  Orienter(const LocalPoints& points, Boundary& hull)
      : points_(points), hull_(hull), corners_(hull.dimension + 1) {
    vertices_.assign(hull.vertices.begin(), hull.vertices.end());
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  }

  void operator()(std::size_t facet) {
    const unsigned d = hull_.dimension;
    std::uint32_t* v = &hull_.vertices[facet * d];
    std::uint32_t* n = &hull_.neighbours[facet * d];
    for (unsigned j = 0; j < d; ++j) corners_[j] = points_.exact_row(v[j]);
    Sign side = Sign::zero;
    for (unsigned j = 0; j < d; ++j) {
      const Sign s = of(opposite(n[j], facet));
      if (s == Sign::zero) continue;
      if (side != Sign::zero && s != side) not_exact("returned a surface that is not convex");
      side = s;
    }
    // All neighbours are coplanar: use any vertex off the plane.
    for (std::size_t i = 0; side == Sign::zero && i < vertices_.size(); ++i)
      side = of(vertices_[i]);
    if (side == Sign::zero) not_exact("returned a degenerate facet");
    if (side == Sign::positive) {
      std::swap(v[d - 2], v[d - 1]);
      std::swap(n[d - 2], n[d - 1]);
    }
  }

  /// All vertices of the hull, ascending.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }

 private:
  Sign of(std::uint32_t x) {
    corners_[hull_.dimension] = points_.exact_row(x);
    Rung rung = Rung::filter;
    const Sign s = orientation(hull_.dimension, corners_.data(), &rung);
    hull_.rung_counts.count(rung);
    return s;
  }
  /// The vertex of `other` that is not on its ridge with `facet`. Where both facets have the same
  /// vertices, returns a vertex of the facet itself, which is coplanar, too.
  std::uint32_t opposite(std::uint32_t other, std::size_t facet) const {
    const unsigned d = hull_.dimension;
    const std::uint32_t* a = &hull_.vertices[facet * d];
    const std::uint32_t* b = &hull_.vertices[std::size_t{other} * d];
    for (unsigned j = 0; j < d; ++j)
      if (std::find(a, a + d, b[j]) == a + d) return b[j];
    return a[0];
  }

  const LocalPoints& points_;
  Boundary& hull_;
  std::vector<const double*> corners_;
  std::vector<std::uint32_t> vertices_;
};

/// Lists pairs (point, vertex) for all points equal to a vertex: of equal points Qhull keeps an
/// arbitrary one.
void find_duplicates(const LocalPoints& points, const std::vector<std::uint32_t>& vertices,
                     const Control& control, Boundary& hull) {
  const unsigned d = points.dimension;
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    const double *p = points.exact_row(a), *q = points.exact_row(b);
    return std::lexicographical_compare(p, p + d, q, q + d);
  };
  std::vector<std::uint32_t> order = vertices;
  std::sort(order.begin(), order.end(), compare);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (i % 65536 == 0) control.check();
    const auto at = std::lower_bound(order.begin(), order.end(), i, compare);
    if (at != order.end() && *at != i && !compare(i, *at)) hull.duplicates.emplace_back(i, *at);
  }
}

}  // namespace

bool qhull_available() { return true; }

Boundary hull_qhull(const LocalPoints& points, const Control& control) {
  if (points.count > static_cast<std::uint32_t>(INT_MAX))
    throw Error(ErrorCode::out_of_budget, "qhull takes no more than 2^31 - 1 points");
  control.check();
  Boundary hull;
  hull.dimension = points.dimension;
  {
    QhullRun run(control);
    run.build(points);
    const std::vector<std::uint32_t> ids = simplices(run, points.dimension);
    hull.vertices.assign(ids.begin(), ids.end());
  }
  match_ridges(hull);
  Orienter orient(points, hull);
  for (std::size_t i = 0; i < hull.facet_count(); ++i) {
    if (i % 4096 == 0) control.check();
    orient(i);
  }
  find_duplicates(points, orient.vertices(), control, hull);
  return hull;
}

}  // namespace cullhull::internal

#else

namespace cullhull::internal {

bool qhull_available() { return false; }

Boundary hull_qhull(const LocalPoints&, const Control&) {
  throw Error(ErrorCode::backend_unavailable,
              "built without Qhull: install libqhull-dev and configure again, or use the native "
              "engine");
}

}  // namespace cullhull::internal

#endif
