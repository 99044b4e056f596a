// Drops vertices in rounds. In each, vertices whose distance to the hull of their neighbours is
// proven to be small enough are candidates; an independent set of them (no two neighbours) is
// dropped, and the hull of the others is computed. A dropped vertex's neighbours then represent it,
// and all that it represented, at a distance that is summed up in `debt`. Why the sums bound the
// distance: docs/exactness.md, "Simplification".
#include "cullhull/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "parallel/adjacency.hpp"
#include "parallel/sort_few.hpp"
#include "parallel/threads/run.hpp"
#include "query/hull_arguments.hpp"
#include "query/vertex_search.hpp"

namespace cullhull::internal {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double up(double value) { return std::nextafter(value, infinity); }

/// The simplices and the other vertices around each vertex of a hull.
/// `hull`: its `count` vertices are numbered 0, 1, ...; it must outlive this object. Time and
/// memory: O(simplices).
class VertexLinks {
 public:
  VertexLinks(const Hull& hull, std::size_t count)
      : corners_(hull.simplices),
        width_(static_cast<std::size_t>(hull.affine_dimension)),
        simplices_(rows_by_id(corners_, width_, count, short_run())) {}

  std::span<const std::uint32_t> simplices(std::uint32_t v) const { return simplices_[v]; }

  /// The other vertices of the simplices around v, ascending.
  void neighbours(std::uint32_t v, std::vector<std::uint32_t>& out) const {
    out.clear();
    for (const std::uint32_t s : simplices(v))
      for (std::size_t j = 0; j < width_; ++j)
        if (corners_[s * width_ + j] != v)
          out.push_back(static_cast<std::uint32_t>(corners_[s * width_ + j]));
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }

 private:
  std::span<const std::uint64_t> corners_;
  std::size_t width_;
  Adjacency<std::uint32_t> simplices_;  ///< by vertex
};

class Simplifier {
 public:
  Simplifier(const PointView& points, const Hull& hull, double distance, const Options& options)
      : options_(options),
        run_(options),
        d_(hull.dimension),
        ids_(sorted(hull.vertices)),
        hull_(by_place(hull, ids_)),
        rows_(rows_of(points, ids_)),
        scale_(power_to_unit(rows_)),
        distance_(distance * scale_ < 0x1p-490 ? 0 : distance * scale_) {
    // Example: v is dropped within 1 mm of the middle of x1 and x2: both get the debt 1 mm. If x1
    // is dropped within 2 mm of vertices y, these get the debt 3 mm; v is then within 0.5 * 1 + 0.5
    // * 3 = 2 mm of the hull of those kept.
    debts_.assign(ids_.size(), 0);
    candidates_.resize(ids_.size());
    for (std::uint32_t v = 0; v < ids_.size(); ++v) candidates_[v] = v;
  }

  /// Runs all rounds; returns whether a vertex was dropped.
  bool run() {
    const std::size_t before = ids_.size();
    while (distance_ > 0 && !candidates_.empty()) {
      run_.report("simplify",
                  1 - static_cast<double>(candidates_.size()) / static_cast<double>(before));
      const VertexLinks links(hull_, ids_.size());
      weigh(links);
      drop(independent(links));
    }
    return ids_.size() < before;
  }

  Hull take() {
    hull_.rename([this](std::uint64_t place) { return ids_[place]; });
    return std::move(hull_);
  }
  std::uint64_t kept() const noexcept { return ids_.size(); }

  /// An upper bound of the distance of every dropped vertex, in the points' units.
  double reached() const {
    double most = 0;
    for (const double debt : debts_) most = std::max(most, debt);
    const double unscaled = most / scale_;
    return unscaled * scale_ < most ? up(unscaled) : unscaled;
  }

 private:
  /// The cost of dropping a candidate: its debt plus its distance to the hull of `support`, the
  /// vertices that represent it then.
  struct Offer {
    std::uint32_t vertex;
    double cost;
    std::vector<std::uint32_t> support;
  };

  /// Replaces candidates_ by those that may be dropped, offers_ by their costs. A vertex that may
  /// not be dropped now never may: the hull only shrinks, and debts only grow.
  void weigh(const VertexLinks& links) {
    constexpr std::uint64_t chunk_size = 256;
    std::vector<std::vector<Offer>> found(chunk_count(candidates_.size(), chunk_size));
    run_.each_chunk(candidates_.size(), chunk_size,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      Scale scale(d_);
      for (std::uint64_t i = begin; i < end; ++i)
        if (offer(links, candidates_[i], scale)) found[chunk].push_back(std::move(scale.offer));
    });
    offers_.clear();
    candidates_.clear();
    for (std::vector<Offer>& part : found)
      for (Offer& o : part) {
        candidates_.push_back(o.vertex);
        offers_.push_back(std::move(o));
      }
  }

  /// Scratch memory for weighing one vertex.
  struct Scale {
    explicit Scale(unsigned d) : nearest(d) {}
    NearestInHull nearest;
    std::vector<std::uint32_t> link;
    std::vector<double> rows;
    Offer offer;
  };

  bool offer(const VertexLinks& links, std::uint32_t v, Scale& scale) const {
    const double left = distance_ - debts_[v];
    if (!(left > 0)) return false;
    links.neighbours(v, scale.link);
    const double* at = rows_.data() + std::size_t{v} * d_;
    scale.rows.clear();
    for (const std::uint32_t u : scale.link)
      for (unsigned j = 0; j < d_; ++j)
        scale.rows.push_back(rows_[std::size_t{u} * d_ + j] * scale_ - at[j] * scale_);
    if (juts_out(links, v, scale, left)) return false;
    if (!scale.nearest.search(scale.rows.data(), scale.link.size(), left)) return false;
    const double cost = up(debts_[v] + scale.nearest.bound(scale.rows.data()));
    if (!(cost <= distance_)) return false;
    scale.offer = {v, cost, {}};
    for (const std::uint32_t place : scale.nearest.found().places)
      scale.offer.support.push_back(scale.link[place]);
    return true;
  }

  /// Whether the mean of the planes around a vertex, moved inward by twice the remaining distance,
  /// still has all its neighbours beneath: then they are too far. A cheap test that rejects most.
  bool juts_out(const VertexLinks& links, std::uint32_t v, const Scale& scale, double left) const {
    double normal[8] = {};
    if (d_ > 8) return false;
    for (const std::uint32_t s : links.simplices(v)) {
      const double* plane =
          hull_.facet_planes.data() + std::size_t{hull_.simplex_facets[s]} * (d_ + 1);
      for (unsigned j = 0; j < d_; ++j) normal[j] += plane[j];
    }
    double square = 0;
    for (unsigned j = 0; j < d_; ++j) square += normal[j] * normal[j];
    const double enough = 2 * left * std::sqrt(square);
    for (std::size_t i = 0; i < scale.link.size(); ++i) {
      double beneath = 0;
      for (unsigned j = 0; j < d_; ++j) beneath -= normal[j] * scale.rows[i * d_ + j];
      if (!(beneath > enough)) return false;
    }
    return true;
  }

  /// The cheapest offers, no two of them of neighbouring vertices.
  std::vector<const Offer*> independent(const VertexLinks& links) const {
    std::vector<const Offer*> order;
    for (const Offer& o : offers_) order.push_back(&o);
    std::stable_sort(order.begin(), order.end(),
                     [](const Offer* a, const Offer* b) { return a->cost < b->cost; });
    std::vector<bool> blocked(ids_.size(), false);
    std::vector<std::uint32_t> link;
    std::size_t chosen = 0;
    for (const Offer* o : order) {
      if (blocked[o->vertex]) continue;
      order[chosen++] = o;
      links.neighbours(o->vertex, link);
      for (const std::uint32_t u : link) blocked[u] = true;
    }
    order.resize(chosen);
    return order;
  }

  /// Drops the chosen vertices, or half of them, and so on, where the others would span a smaller
  /// flat. A single vertex that reduces the dimension is kept for good.
  void drop(std::vector<const Offer*> chosen) {
    while (!chosen.empty()) {
      std::vector<bool> gone(ids_.size(), false);
      for (const Offer* o : chosen) gone[o->vertex] = true;
      std::vector<std::uint64_t> ids;
      std::vector<double> rows;
      for (std::size_t v = 0; v < ids_.size(); ++v) {
        if (gone[v]) continue;
        ids.push_back(ids_[v]);
        rows.insert(rows.end(), rows_.begin() + static_cast<std::ptrdiff_t>(v * d_),
                    rows_.begin() + static_cast<std::ptrdiff_t>((v + 1) * d_));
      }
      Hull next = convex_hull(PointView::row_major(rows.data(), ids.size(), d_), quiet());
      if (next.affine_dimension == hull_.affine_dimension) {
        hull_ = std::move(next);
        ids_ = std::move(ids);
        rows_ = std::move(rows);
        settle(chosen, gone);
        return;
      }
      if (chosen.size() == 1) {
        std::erase(candidates_, chosen.front()->vertex);
        return;
      }
      chosen.resize(chosen.size() / 2);
    }
  }

  Options quiet() const {
    Options options = options_;
    options.progress = {};
    return options;
  }

  /// Transfers the debts of dropped vertices to those that represent them; renumbers.
  void settle(const std::vector<const Offer*>& chosen, const std::vector<bool>& gone) {
    for (const Offer* o : chosen)
      for (const std::uint32_t u : o->support) debts_[u] = std::max(debts_[u], o->cost);
    std::vector<std::uint32_t> place(gone.size());
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < gone.size(); ++v) {
      place[v] = count;
      if (gone[v]) continue;
      debts_[count++] = debts_[v];
    }
    debts_.resize(count);
    std::erase_if(candidates_, [&](std::uint32_t v) { return gone[v]; });
    for (std::uint32_t& v : candidates_) v = place[v];
  }

  const Options& options_;
  const Run run_;
  const unsigned d_;
  std::vector<std::uint64_t> ids_;  // of the vertices, ascending
  Hull hull_;                       // of rows_, its vertices numbered by position
  std::vector<double> rows_;
  const double scale_, distance_;  // distances are scaled, rows_ are not
  std::vector<double> debts_;      // one a vertex
  std::vector<std::uint32_t> candidates_;
  std::vector<Offer> offers_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

Simplification simplify(const PointView& points, const Hull& hull, double distance,
                        const Options& options) {
  internal::check_hull_arguments(points, hull, distance);
  Simplification result;
  if (distance == 0 || hull.affine_dimension < 2) {
    result.hull = hull;
    return result;
  }
  internal::Simplifier simplifier(points, hull, distance, options);
  if (!simplifier.run()) {
    result.hull = hull;
    return result;
  }
  result.dropped = hull.vertices.size() - simplifier.kept();
  result.distance = simplifier.reached();
  result.hull = simplifier.take();
  result.hull.point_count = hull.point_count;
  result.hull.scalar = hull.scalar;
  result.hull.statistics = hull.statistics;
  return result;
}

double rounding_distance(const PointView& points, const Hull& hull) {
  internal::check_hull_arguments(points, hull, 0);
  double largest = 0;
  for (const std::uint64_t id : hull.vertices)
    for (std::uint32_t j = 0; j < hull.dimension; ++j)
      largest = std::max(largest, std::fabs(points.at(id, j)));
  const double d = hull.dimension;
  return 64 * d * std::sqrt(d) * 0x1p-53 * largest;
}

}  // namespace cullhull
