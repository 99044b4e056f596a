#include <algorithm>
#include <compare>
#include <vector>

#include "cullhull/hull.hpp"
#include "parallel/sort_few.hpp"
#include "tracker/simplex_memory.hpp"

namespace cullhull::internal {
namespace {

/// Iterates over the facets of a hull in lexicographic order of their first simplices.
class FacetCursor {
 public:
  explicit FacetCursor(const Hull& hull)
      : hull_(hull),
        row_(hull.simplices.data()),
        k_(static_cast<std::size_t>(std::max(hull.affine_dimension, 0))),
        facets_(hull.facet_count()),
        simplicial_(facets_ == hull.simplex_count()) {}

  bool done() const { return facet_ == facets_; }
  void advance() {
    ++facet_;
    if (simplicial_) {
      row_ += k_;
      return;
    }
    // Facets are numbered by their first simplices: the first simplex of facet `facet_` is the next
    // one whose facet number is not lower.
    while (simplex_ < hull_.simplex_count() && hull_.simplex_facets[simplex_] < facet_) ++simplex_;
    row_ = hull_.simplices.data() + simplex_ * k_;
  }
  std::strong_ordering compare(const FacetCursor& b) const {
    for (std::size_t j = 0; j < k_; ++j)
      if (row_[j] != b.row_[j]) return row_[j] <=> b.row_[j];
    return std::strong_ordering::equal;
  }
  /// Whether both facets have the same vertices. Requires equal first simplices.
  bool same_vertices(const FacetCursor& b) const {
    return (simplicial_ && b.simplicial_) ||
           std::ranges::equal(hull_.facets[facet_], b.hull_.facets[b.facet_]);
  }

 private:
  const Hull& hull_;
  const std::uint64_t* row_;
  std::size_t k_;
  std::uint64_t facet_ = 0, simplex_ = 0, facets_;
  bool simplicial_;
};

std::uint64_t count_common(const std::vector<std::uint64_t>& a,
                           const std::vector<std::uint64_t>& b) {
  std::uint64_t common = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    common += a[i] == b[j];
    const bool first = a[i] <= b[j], second = b[j] <= a[i];
    i += first;
    j += second;
  }
  return common;
}

}  // namespace

void count_changes(const Hull& before, const Hull& after, FrameReport& report) {
  const std::uint64_t both = count_common(sorted(before.vertices), sorted(after.vertices));
  report.vertices_came = after.vertices.size() - both;
  report.vertices_went = before.vertices.size() - both;

  std::uint64_t stayed = 0;
  if (before.affine_dimension == after.affine_dimension) {
    FacetCursor a(before), b(after);
    while (!a.done() && !b.done()) {
      const auto order = a.compare(b);
      if (order == 0 && a.same_vertices(b)) ++stayed;
      if (order <= 0) a.advance();
      if (order >= 0) b.advance();
    }
  }
  report.facets_came = after.facet_count() - stayed;
  report.facets_went = before.facet_count() - stayed;
}

}  // namespace cullhull::internal
