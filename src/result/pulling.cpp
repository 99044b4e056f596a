#include <algorithm>

#include "result/boundary.hpp"

namespace cullhull::internal {
namespace {

/// The recursion of pull(): prefix_ holds the apexes of the cones so far.
class Puller {
 public:
  explicit Puller(std::vector<std::uint32_t>& out) : out_(out) {}

  void run(const VertexSet& vertices, unsigned m, const std::vector<VertexSet>& facets) {
    if (vertices.size() == m + std::size_t{1}) {
      out_.insert(out_.end(), prefix_.begin(), prefix_.end());
      out_.insert(out_.end(), vertices.begin(), vertices.end());
      return;
    }
    const auto incidence = incidences(facets);
    prefix_.push_back(vertices[0]);
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
      if (facets[i][0] == vertices[0]) continue;
      if (facets[i].size() == m)
        run(facets[i], m - 1, {});
      else
        run(facets[i], m - 1, facets_of(i, m, facets, incidence));
    }
    prefix_.pop_back();
  }

 private:
  using Incidences = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // (vertex, facet)

  /// All pairs of a vertex and a facet that contains it, sorted.
  static Incidences incidences(const std::vector<VertexSet>& facets) {
    Incidences all;
    for (std::uint32_t i = 0; i < facets.size(); ++i)
      for (const std::uint32_t v : facets[i]) all.emplace_back(v, i);
    std::sort(all.begin(), all.end());
    return all;
  }

  /// The facets of facet g of an m-dimensional polytope, as vertex sets: the inclusion-maximal
  /// intersections of g with the other facets.
  static std::vector<VertexSet> facets_of(std::uint32_t g, unsigned m,
                                          const std::vector<VertexSet>& facets,
                                          const Incidences& incidence) {
    Incidences shared;  // (facet, vertex), each vertex of g on that facet
    for (const std::uint32_t v : facets[g]) {
      auto it = std::lower_bound(incidence.begin(), incidence.end(), std::pair{v, 0U});
      for (; it != incidence.end() && it->first == v; ++it)
        if (it->second != g) shared.emplace_back(it->second, v);
    }
    std::sort(shared.begin(), shared.end());
    std::vector<VertexSet> sets;
    for (std::size_t i = 0; i < shared.size();) {
      std::size_t end = i;
      while (end < shared.size() && shared[end].first == shared[i].first) ++end;
      if (end - i >= m - 1) {
        VertexSet& s = sets.emplace_back();
        for (; i < end; ++i) s.push_back(shared[i].second);
      }
      i = end;
    }
    // Some sets may be faces of dimension m - 3 or less, which are not maximal. Such a face can
    // have m - 1 vertices only if its dimension is at least 2, so for m >= 5.
    if (m >= 5) keep_maximal(sets);
    return sets;
  }

  /// Removes the sets that are subsets of others.
  static void keep_maximal(std::vector<VertexSet>& sets) {
    std::stable_sort(sets.begin(), sets.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    std::vector<VertexSet> kept;
    for (VertexSet& s : sets) {
      const bool inside = std::any_of(kept.begin(), kept.end(), [&](const VertexSet& t) {
        return std::includes(t.begin(), t.end(), s.begin(), s.end());
      });
      if (!inside) kept.push_back(std::move(s));
    }
    sets = std::move(kept);
  }

  std::vector<std::uint32_t>& out_;
  VertexSet prefix_;
};

}  // namespace

void pull(const VertexSet& vertices, unsigned m, const std::vector<VertexSet>& facets,
          std::vector<std::uint32_t>& out) {
  Puller(out).run(vertices, m, facets);
}

}  // namespace cullhull::internal
