// Checks of merged facets: lists, neighbours, extreme vertices, canonical triangulation.
#include <algorithm>

#include "certify/certificate.hpp"

namespace cullhull::internal::certify {
namespace {

using Set = std::vector<std::uint32_t>;

/// Checks that facets are numbered by their first simplex.
FacetSimplices group_simplices(const Subject& s) {
  const Hull& h = s.hull;
  if (s.all_simple()) {
    check_chunks(s.run, s.simplex_count(), std::uint64_t{1} << 14,
                 [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i)
        if (h.simplex_facets[i] != i) fault("simplex ", i, " is not facet ", i);
    });
    return {};
  }
  const auto facets = static_cast<std::uint32_t>(h.facets.size());
  std::uint32_t seen = 0;
  for (std::uint32_t i = 0; i < s.simplex_count(); ++i) {
    const std::uint32_t f = h.simplex_facets[i];
    if (f > seen) fault("facet ", f, " appears before facet ", seen);
    seen += f == seen;
  }
  if (seen != facets) fault("facet ", seen, " has no simplex");
  return {facets, [&](const auto& add) {
            for (std::uint32_t i = 0; i < s.simplex_count(); ++i) add(h.simplex_facets[i], i);
          }};
}

class FacetCheck {
 public:
  FacetCheck(const Subject& s) : s_(s), h_(s.hull), k_(s.k), members_(s.members) {}

  void run() {
    if (k_ > 1 && !s_.all_simple()) check_connected();
    check_chunks(s_.run, h_.facets.size(), std::uint64_t{1} << 12,
                 [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f) check_lists(static_cast<std::uint32_t>(f));
    });
    if (k_ == 2) check_winding();
    // All corners of a facet that is one simplex are extreme, and it needs no triangulation.
    if (k_ > 1 && s_.all_simple()) return;
    index_incidence();
    check_extreme();
    if (k_ > 3) check_pulled();
  }

 private:
  using Simplices = std::span<const std::uint32_t>;

  std::uint64_t id(std::uint32_t v) const { return s_.ids[v]; }

  void check_connected() {
    std::vector<std::uint8_t> reached(s_.simplex_count(), 0);
    std::vector<std::uint32_t> stack;
    for (std::uint32_t f = 0; f < h_.facets.size(); ++f) {
      if (members_[f].size() == 1) continue;
      stack.push_back(members_[f][0]);
      reached[stack.back()] = 1;
      std::uint32_t count = 0;
      while (!stack.empty()) {
        const std::uint32_t i = stack.back();
        stack.pop_back();
        ++count;
        for (unsigned j = 0; j < k_; ++j) {
          const std::uint32_t g = s_.neighbour(i, j);
          if (h_.simplex_facets[g] != f || reached[g]) continue;
          reached[g] = 1;
          stack.push_back(g);
        }
      }
      if (count != members_[f].size()) fault("the simplices of facet ", f, " are not connected");
    }
  }

  void check_lists(std::uint32_t f) const {
    const auto own = s_.all_simple() ? Simplices(&f, 1) : members_[f];
    if (k_ > 2 && own.size() == 1) return check_simplex(f, own[0]);
    Set corners;
    for (const std::uint32_t i : own)
      corners.insert(corners.end(), s_.simplex(i), s_.simplex(i) + k_);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    const std::size_t listed = h_.facets[f].size();
    if (listed != corners.size())
      fault("facet ", f, " lists ", listed, " vertices, its simplices have ", corners.size());
    for (const std::uint32_t i : own)
      if (k_ > 1 && std::find(s_.simplex(i), s_.simplex(i) + k_, corners[0]) == s_.simplex(i) + k_)
        fault("simplex ", i, " is not pulled from vertex ", id(corners[0]), " of facet ", f);
    if (k_ == 2)
      check_edge(f, own[0], static_cast<std::uint32_t>(own.size()));
    else if (k_ == 3)
      check_polygon(f, own, corners[0]);
    else
      check_sets(f, own, corners);
  }

  /// Checks a facet that is simplex i: the usual case, without the sets that other facets need.
  void check_simplex(std::uint32_t f, std::uint32_t i) const {
    const auto listed = h_.facets[f];
    const std::uint64_t* v = h_.simplices.data() + std::size_t{i} * k_;
    // Its ids ascend; for k > 3 the simplex's last two may be swapped.
    const bool swap = k_ > 3 && v[k_ - 2] > v[k_ - 1];
    bool same = listed.size() == k_;
    for (unsigned j = 0; j < k_ && same; ++j)
      same = listed[j] == v[swap && j + 2 >= k_ ? 2 * k_ - 3 - j : j];
    if (!same) fault("facet ", f, " is not its simplex");
    const auto across = h_.facet_neighbours[f];
    bool right = across.size() <= k_;
    if (k_ == 3) {
      right = across.size() == 3;
      for (unsigned j = 0; j < 3 && right; ++j)
        right = across[j] == h_.simplex_facets[s_.neighbour(i, (j + 2) % 3)];
    } else if (right) {
      // A strictly ascending list of the right length that contains every neighbour.
      for (std::size_t n = 0; n < across.size() && right; ++n) {
        bool met = false;
        for (unsigned j = 0; j < k_; ++j) met |= h_.simplex_facets[s_.neighbour(i, j)] == across[n];
        right = met && (n == 0 || across[n - 1] < across[n]);
      }
      for (unsigned j = 0; j < k_ && right; ++j)
        right = std::count(across.begin(), across.end(), h_.simplex_facets[s_.neighbour(i, j)]) > 0;
    }
    if (!right) fault("the neighbours of facet ", f, " are wrong");
  }

  void check_edge(std::uint32_t f, std::uint32_t i, std::uint32_t simplices) const {
    const auto v = h_.facets[f];
    const auto across = h_.facet_neighbours[f];
    const std::uint64_t* w = h_.simplices.data() + std::size_t{i} * 2;
    if (simplices != 1 || v[0] != w[1] || v[1] != w[0]) fault("facet ", f, " is not its simplex");
    if (across.size() != 2 || across[0] != h_.simplex_facets[s_.neighbour(i, 1)] ||
        across[1] != h_.simplex_facets[s_.neighbour(i, 0)])
      fault("the neighbours of facet ", f, " are wrong");
  }

  void check_polygon(std::uint32_t f, Simplices own, std::uint32_t lowest) const {
    const auto first = h_.facets[f];
    const auto beside = h_.facet_neighbours[f];
    const std::size_t n = first.size();
    if (beside.size() != n) fault("facet ", f, " has a wrong neighbour list");
    if (first[0] != id(lowest)) fault("facet ", f, " does not begin with its lowest id");
    struct Edge {
      std::uint64_t from, to;
      std::uint32_t across;
    };
    std::vector<Edge> edges;
    for (const std::uint32_t i : own)
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t across = h_.simplex_facets[s_.neighbour(i, j)];
        if (across == f) continue;
        const std::uint32_t* v = s_.simplex(i);
        edges.push_back({id(v[(j + 1) % 3]), id(v[(j + 2) % 3]), across});
      }
    if (edges.size() != n)
      fault("the border of facet ", f, " has ", edges.size(), " edges, not ", n);
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.from < b.from; });
    for (std::size_t j = 0; j < n; ++j) {
      const auto it = std::lower_bound(edges.begin(), edges.end(), first[j],
                                       [](const Edge& e, std::uint64_t v) { return e.from < v; });
      if (it == edges.end() || it->from != first[j] || it->to != first[(j + 1) % n])
        fault("facet ", f, " is not in cyclic order at vertex ", first[j]);
      if (it->across != beside[j]) fault("the neighbours of facet ", f, " are wrong");
    }
  }

  void check_sets(std::uint32_t f, Simplices own, const Set& corners) const {
    const auto v = h_.facets[f];
    for (std::size_t j = 0; j < corners.size(); ++j)
      if (v[j] != id(corners[j])) fault("facet ", f, " does not list its vertices in order");
    Set across;
    for (const std::uint32_t i : own)
      for (unsigned j = 0; j < k_; ++j) {
        const std::uint32_t g = h_.simplex_facets[s_.neighbour(i, j)];
        if (g != f) across.push_back(g);
      }
    std::sort(across.begin(), across.end());
    across.erase(std::unique(across.begin(), across.end()), across.end());
    const auto n = h_.facet_neighbours[f];
    if (!std::equal(across.begin(), across.end(), n.begin(), n.end()))
      fault("the neighbours of facet ", f, " are wrong");
  }

  /// k = 2: the vertices are in the order of the facets.
  void check_winding() const {
    if (h_.facets.size() != h_.vertices.size()) fault("a polygon has as many facets as vertices");
    std::uint32_t f = 0;
    while (f < h_.facets.size() && h_.facets[f][0] != h_.vertices[0]) ++f;
    for (const std::uint64_t v : h_.vertices) {
      if (f >= h_.facets.size() || h_.facets[f][0] != v)
        fault("vertices are not in counter-clockwise order at vertex ", v);
      f = h_.facet_neighbours[f][0];
    }
  }

  void index_incidence() {
    listed_.resize(h_.facets.items.size());
    check_chunks(s_.run, listed_.size(), std::uint64_t{1} << 14,
                 [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) listed_[i] = s_.position(h_.facets.items[i]);
    });
    on_ = Adjacency<std::uint32_t>(s_.ids.size(), [&](const auto& add) {
      for (std::uint32_t f = 0; f < h_.facets.size(); ++f)
        for (std::uint64_t i = h_.facets.offsets[f]; i < h_.facets.offsets[f + 1]; ++i)
          add(listed_[i], f);
    });
  }
  std::size_t size(std::uint32_t f) const { return h_.facets[f].size(); }
  Set facets_of(std::uint32_t v) const { return {on_[v].begin(), on_[v].end()}; }
  bool on_all(std::uint32_t w, const Set& facets) const {
    return std::includes(on_[w].begin(), on_[w].end(), facets.begin(), facets.end());
  }
  /// The lowest vertex other than `self` that is on all `facets` (not empty), or ids.size().
  std::uint32_t lowest_common(const Set& facets, std::uint32_t self) const {
    const std::uint32_t f = *std::min_element(facets.begin(), facets.end(),
                                              [&](auto a, auto b) { return size(a) < size(b); });
    for (std::uint64_t i = h_.facets.offsets[f]; i < h_.facets.offsets[f + 1]; ++i)
      if (listed_[i] != self && on_all(listed_[i], facets)) return listed_[i];
    return static_cast<std::uint32_t>(s_.ids.size());
  }

  /// A vertex is extreme if and only if no other vertex is on all of its facets.
  void check_extreme() const {
    check_chunks(s_.run, s_.ids.size(), std::uint64_t{1} << 12,
                 [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto v = static_cast<std::uint32_t>(i);
        const Set facets = facets_of(v);
        bool extreme = facets.size() >= k_;
        // A corner of a simplex facet is extreme; for k <= 3 so is a vertex of k facets.
        const bool corner =
            std::any_of(facets.begin(), facets.end(), [&](auto f) { return size(f) == k_; });
        if (k_ > 3 && extreme && !corner) extreme = lowest_common(facets, v) == s_.ids.size();
        if (k_ > 1 && !extreme) fault("vertex ", id(v), " is not an extreme point");
      }
    });
  }

  /// Checks the triangulation by pulling: the first vertex of every tail of a simplex is the lowest
  /// one of the smallest face that contains the tail.
  void check_pulled() const {
    check_chunks(s_.run, s_.simplex_count(), std::uint64_t{1} << 10,
                 [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        if (size(h_.simplex_facets[i]) == k_) continue;
        Set v(s_.simplex(static_cast<std::uint32_t>(i)),
              s_.simplex(static_cast<std::uint32_t>(i)) + k_);
        std::sort(v.begin(), v.end());
        Set facets = facets_of(v.back());
        for (unsigned j = k_ - 1; j-- > 0;) {
          const Set own = facets_of(v[j]);
          Set both;
          std::set_intersection(facets.begin(), facets.end(), own.begin(), own.end(),
                                std::back_inserter(both));
          facets = std::move(both);
          if (facets.empty() || lowest_common(facets, v[j]) < v[j])
            fault("simplex ", i, " is not part of the pulled triangulation of its facet");
        }
      }
    });
  }

  const Subject& s_;
  const Hull& h_;
  const unsigned k_;
  const FacetSimplices& members_;
  Adjacency<std::uint32_t> on_;        // the facets of each vertex
  std::vector<std::uint32_t> listed_;  // the vertices of the facets, facet by facet
};

}  // namespace

void check_facets(Subject& s) {
  s.members = group_simplices(s);
  FacetCheck(s).run();
}

}  // namespace cullhull::internal::certify
