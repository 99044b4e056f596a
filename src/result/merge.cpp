#include <algorithm>
#include <numeric>

#include "exact/orientation/orientation.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/index.hpp"
#include "parallel/threads/run.hpp"
#include "result/boundary.hpp"

namespace cullhull::internal {
namespace {

/// A ridge on the border of a merged facet: the ridge of `simplex` opposite to its vertex `slot`.
struct Border {
  std::uint32_t simplex;
  unsigned slot;
};

/// Merges coplanar simplices for any k other than 3. Serial.
class Merger {
 public:
  Merger(Boundary&& surface, const LocalPoints& points, const Control& control)
      : old_(std::move(surface)), points_(points), control_(control), k_(old_.dimension) {}

  Facets run(const CoplanarPairs& pairs) {
    number_facets(pairs);
    keep_singles();
    drop_flat_vertices();
    for (std::uint32_t m = 0; m < merged_count(); ++m) {
      if (m % 1024 == 0) control_.check();
      triangulate(m);
    }
    match_new_ridges();
    return std::move(out_);
  }

 private:
  std::uint32_t merged_count() const { return static_cast<std::uint32_t>(members_.size()); }

  /// Numbers the facets in facet_: first the unmerged simplices in their order, then the merged
  /// facets in the order of their first simplex.
  void number_facets(const CoplanarPairs& pairs) {
    const std::size_t n = old_.facet_count();
    facet_.resize(n);
    DisjointSets sets(n);
    sets.clear(0, n);
    std::vector<std::uint8_t> merged(n, 0);
    for (const auto& [a, b] : pairs) {
      merged[a] = merged[b] = 1;
      sets.join(a, b);
    }
    for (std::uint32_t f = 0; f < n; ++f) facet_[f] = sets.root(f);
    singles_ = static_cast<std::uint32_t>(std::count(merged.begin(), merged.end(), 0));
    std::uint32_t single = 0;
    std::uint32_t next = singles_;
    for (std::uint32_t f = 0; f < n; ++f)
      facet_[f] = !merged[f] ? single++ : facet_[f] == f ? next++ : facet_[facet_[f]];
    members_ = Adjacency<std::uint32_t, std::uint32_t>(next - singles_, [&](const auto& add) {
      for (std::uint32_t f = 0; f < n; ++f)
        if (merged[f]) add(facet_[f] - singles_, f);
    });
  }

  /// Copies the unmerged simplices to the new surface. Neighbours in merged facets remain no_index
  /// until match_new_ridges().
  void keep_singles() {
    Boundary& s = out_.surface;
    s.dimension = k_;
    out_.singles = singles_;
    for (std::uint32_t f = 0; f < old_.facet_count(); ++f) {
      if (facet_[f] >= singles_) continue;
      s.odd.push_back(old_.odd[f]);
      for (unsigned i = 0; i < k_; ++i) {
        s.vertices.push_back(old_.simplex(f)[i]);
        const std::uint32_t g = facet_[old_.neighbours[std::size_t{f} * k_ + i]];
        s.neighbours.push_back(g < singles_ ? g : no_index);  // facet g < singles_ is simplex g
      }
    }
    out_.facet.resize(singles_);
    std::iota(out_.facet.begin(), out_.facet.end(), 0U);
  }

  /// Finds the vertices that are not extreme (flat_) and removes them from the merged facets. A
  /// vertex is extreme if and only if no other vertex lies on all of its facets. A vertex on an
  /// unmerged facet is a corner of a simplex and therefore extreme.
  void drop_flat_vertices() {
    std::vector<std::uint8_t> candidate(points_.count, 0);
    for (const std::uint32_t f : members_.items())
      for (unsigned i = 0; i < k_; ++i) candidate[old_.simplex(f)[i]] = 1;
    for (std::uint32_t f = 0; f < old_.facet_count(); ++f)
      for (unsigned i = 0; i < k_; ++i)
        if (candidate[old_.simplex(f)[i]]) incidence_.emplace_back(old_.simplex(f)[i], facet_[f]);
    std::sort(incidence_.begin(), incidence_.end());
    incidence_.erase(std::unique(incidence_.begin(), incidence_.end()), incidence_.end());

    first_.assign(points_.count, 0);
    on_facet_.assign(merged_count(), {});
    flat_.assign(points_.count, 0);
    for (std::size_t i = 0; i < incidence_.size(); ++i) {
      const auto [v, facet] = incidence_[i];
      if (i == 0 || incidence_[i - 1].first != v) first_[v] = i;
      if (facet >= singles_) on_facet_[facet - singles_].push_back(v);
    }
    for (std::size_t i = 0; i < incidence_.size();) {
      const std::uint32_t v = incidence_[i].first;
      std::size_t end = i;
      while (end < incidence_.size() && incidence_[end].first == v) ++end;
      flat_[v] = !extreme(i, end);
      i = end;
    }
    for (VertexSet& set : on_facet_)
      set.erase(std::remove_if(set.begin(), set.end(), [&](auto v) { return flat_[v] != 0; }),
                set.end());
  }

  /// Whether the vertex of the incidences [begin, end) is extreme.
  bool extreme(std::size_t begin, std::size_t end) const {
    if (end - begin < k_) return false;
    if (k_ == 2) return true;
    std::uint32_t smallest = no_index;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t facet = incidence_[i].second;
      if (facet < singles_) return true;
      if (smallest == no_index ||
          on_facet_[facet - singles_].size() < on_facet_[smallest - singles_].size())
        smallest = facet;
    }
    const auto& others = on_facet_[smallest - singles_];
    return std::none_of(others.begin(), others.end(), [&](std::uint32_t w) {
      return w != incidence_[begin].first && on_all(w, begin, end);
    });
  }

  /// Whether vertex w lies on all facets of the incidences [begin, end).
  bool on_all(std::uint32_t w, std::size_t begin, std::size_t end) const {
    std::size_t j = first_[w];
    for (std::size_t i = begin; i < end; ++i) {
      while (j < incidence_.size() && incidence_[j].first == w &&
             incidence_[j].second < incidence_[i].second)
        ++j;
      if (j == incidence_.size() || incidence_[j] != std::pair{w, incidence_[i].second})
        return false;
    }
    return true;
  }

  /// Collects the borders of merged facet m and writes the facet and its simplices.
  void triangulate(std::uint32_t m) {
    borders_.clear();
    for (const std::uint32_t f : members_[m])
      for (unsigned j = 0; j < k_; ++j)
        if (neighbour_facet({f, j}) != singles_ + m) borders_.push_back({f, j});
    if (on_facet_[m].size() < k_ || borders_.empty()) fail_not_exact("a facet has too few corners");
    if (k_ == 2)
      segment(m);
    else
      pull_facet(m);
    out_.vertices.offsets.push_back(out_.vertices.items.size());
    out_.neighbours.offsets.push_back(out_.neighbours.items.size());
  }

  std::uint32_t neighbour_facet(const Border& b) const {
    return facet_[old_.neighbours[std::size_t{b.simplex} * k_ + b.slot]];
  }

  /// Appends the remaining data of a simplex of merged facet m, whose ids have been appended.
  void add_simplex(std::uint32_t m, bool odd) {
    out_.surface.odd.push_back(odd);
    out_.surface.neighbours.insert(out_.surface.neighbours.end(), k_, no_index);
    out_.facet.push_back(singles_ + m);
  }

  /// k = 2: replaces a chain of collinear edges by one edge. Engines orient edges clockwise
  /// (docs/algorithm.md).
  void segment(std::uint32_t m) {
    if (borders_.size() != 2) fail_not_exact("an edge has not two ends");
    std::uint32_t end[2], across[2];
    for (const Border& b : borders_) {
      const unsigned head = old_.stored_slot(b.simplex, b.slot) == 0;  // the tail is off the ridge
      end[head] = old_.simplex(b.simplex)[1 - b.slot];
      across[head] = neighbour_facet(b);
    }
    out_.surface.vertices.push_back(std::min(end[0], end[1]));
    out_.surface.vertices.push_back(std::max(end[0], end[1]));
    add_simplex(m, end[0] > end[1]);
    out_.vertices.items.insert(out_.vertices.items.end(), {end[1], end[0]});
    out_.neighbours.items.insert(out_.neighbours.items.end(), {across[0], across[1]});
  }

  /// k >= 4: writes the facet's ridges and triangulates it by pulling.
  void pull_facet(std::uint32_t m) {
    // The corners of the ridge to a neighbour are those of the old simplices on their common
    // border.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> corners;  // (neighbour, corner)
    for (const Border& b : borders_)
      for (unsigned i = 0; i < k_; ++i) {
        const std::uint32_t v = old_.simplex(b.simplex)[i];
        if (i != b.slot && !flat_[v]) corners.emplace_back(neighbour_facet(b), v);
      }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<VertexSet> ridges;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (i == 0 || corners[i - 1].first != corners[i].first) {
        ridges.emplace_back();
        out_.neighbours.items.push_back(corners[i].first);
      }
      ridges.back().push_back(corners[i].second);
    }
    const VertexSet& vertices = on_facet_[m];
    out_.vertices.items.insert(out_.vertices.items.end(), vertices.begin(), vertices.end());
    std::vector<std::uint32_t> pulled;
    pull(vertices, k_ - 1, ridges, pulled);
    Array<std::uint32_t>& ids = out_.surface.vertices;
    const std::size_t first = ids.size();
    ids.insert(ids.end(), pulled.begin(), pulled.end());
    const std::uint32_t beneath = vertex_beneath(borders_[0]);
    std::vector<const double*> rows(k_ + 1);
    rows[k_] = points_.exact_row(beneath);
    for (std::size_t i = first; i < ids.size(); i += k_) {
      for (unsigned j = 0; j < k_; ++j) rows[j] = points_.exact_row(ids[i + j]);
      if (k_ > 8) control_.check();  // a sign can take milliseconds
      const Sign sign = orientation(k_, rows.data());
      if (sign == Sign::zero) fail_not_exact("a facet's corners are degenerate");
      add_simplex(m, sign == Sign::positive);
    }
  }

  /// A vertex of the neighbour across a border that is off the border. It lies strictly beneath the
  /// facet and so defines the facet's orientation.
  std::uint32_t vertex_beneath(const Border& b) const {
    const std::uint32_t g = old_.neighbours[std::size_t{b.simplex} * k_ + b.slot];
    const std::uint32_t* v = old_.simplex(b.simplex);
    for (unsigned i = 0; i < k_; ++i) {
      const std::uint32_t w = old_.simplex(g)[i];
      if (std::find(v, v + k_, w) == v + k_) return w;
    }
    fail_not_exact("two facets have the same corners");
  }

  /// Links neighbours across the ridges that have no neighbour yet: two simplices with the same ids
  /// on a ridge are neighbours. Throws Error{not_exact} if a ridge has no partner.
  void match_new_ridges() {
    Boundary& s = out_.surface;
    struct Slot {
      std::uint32_t simplex, slot;
    };
    std::vector<Slot> open;
    for (std::uint32_t f = 0; f < s.facet_count(); ++f)
      for (unsigned j = 0; j < k_; ++j)
        if (s.neighbours[std::size_t{f} * k_ + j] == no_index) open.push_back({f, j});
    const auto compare = [&](const Slot& a, const Slot& b) {
      const std::uint32_t* x = s.simplex(a.simplex);
      const std::uint32_t* y = s.simplex(b.simplex);
      for (unsigned c = 0; c + 1 < k_; ++c) {
        const std::uint32_t p = x[c + (c >= a.slot)], q = y[c + (c >= b.slot)];
        if (p != q) return p < q ? -1 : 1;
      }
      return 0;
    };
    std::sort(open.begin(), open.end(),
              [&](const Slot& a, const Slot& b) { return compare(a, b) < 0; });
    for (std::size_t i = 0; i < open.size(); i += 2) {
      if (i + 1 == open.size() || compare(open[i], open[i + 1]) != 0)
        fail_not_exact("facets do not fit together");
      s.neighbours[std::size_t{open[i].simplex} * k_ + open[i].slot] = open[i + 1].simplex;
      s.neighbours[std::size_t{open[i + 1].simplex} * k_ + open[i + 1].slot] = open[i].simplex;
    }
  }

  Boundary old_;
  const LocalPoints& points_;
  const Control& control_;
  const unsigned k_;
  Facets out_;
  std::uint32_t singles_ = 0;
  std::vector<std::uint32_t> facet_;                 // facet of each old simplex
  Adjacency<std::uint32_t, std::uint32_t> members_;  // old simplices of each merged facet
  std::vector<std::pair<std::uint32_t, std::uint32_t>> incidence_;  // (vertex, facet), sorted
  std::vector<std::size_t> first_;                                  // first incidence of a vertex
  std::vector<VertexSet> on_facet_;                                 // vertices of each merged facet
  std::vector<std::uint8_t> flat_;                                  // vertices that are not extreme
  std::vector<Border> borders_;
};

}  // namespace

Facets merge_coplanar(Boundary&& surface, const CoplanarPairs& pairs, const LocalPoints& points,
                      const Run& run) {
  if (plane_only || pairs.empty()) {
    Facets out;
    out.singles = surface.facet_count();
    out.surface = std::move(surface);
    return out;
  }
  if (surface.dimension == 3) return merge_polygons(std::move(surface), pairs, run);
  return Merger(std::move(surface), points, run.control).run(pairs);
}

}  // namespace cullhull::internal
