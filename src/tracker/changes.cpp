#include "tracker/changes.hpp"

#include <algorithm>
#include <compare>
#include <iterator>
#include <vector>

#include "parallel/sorted.hpp"

namespace cullhull::internal {
namespace {

/// The facets of a hull in the order of their first simplices, which is lexicographic.
class FacetCursor {
 public:
  explicit FacetCursor(const Hull& hull)
      : hull_(hull), k_(static_cast<std::size_t>(std::max(hull.affine_dimension, 0))) {}

  bool done() const { return facet_ == hull_.facet_count(); }
  void advance() {
    ++facet_;
    while (simplex_ < hull_.simplex_count() && hull_.simplex_facets[simplex_] < facet_) ++simplex_;
    // Facets are numbered by their first simplices: the first simplex of facet `facet_` is the next
    // one whose facet is not lower.
  }
  std::strong_ordering compare(const FacetCursor& b) const {
    const auto row = [](const FacetCursor& c) {
      return c.hull_.simplices.data() + c.simplex_ * c.k_;
    };
    return std::lexicographical_compare_three_way(row(*this), row(*this) + k_, row(b),
                                                  row(b) + b.k_);
  }
  bool same_vertices(const FacetCursor& b) const {
    return std::ranges::equal(hull_.facets[facet_], b.hull_.facets[b.facet_]);
  }

 private:
  const Hull& hull_;
  std::size_t k_;
  std::uint64_t facet_ = 0, simplex_ = 0;
};

}  // namespace

void count_changes(const Hull& before, const Hull& after, FrameReport& report) {
  const std::vector<std::uint64_t> old = sorted(before.vertices), now = sorted(after.vertices);
  std::vector<std::uint64_t> both;
  std::ranges::set_intersection(old, now, std::back_inserter(both));
  report.vertices_came = now.size() - both.size();
  report.vertices_went = old.size() - both.size();

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
