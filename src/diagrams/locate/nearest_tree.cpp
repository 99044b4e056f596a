#include "diagrams/locate/nearest_tree.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"
#include "diagrams/locate/power_sign.hpp"
#include "diagrams/locate/queries.hpp"
#include "exact/determinants/minors.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {

namespace {

/// Points in a leaf, whose distances are computed together.
constexpr unsigned width = 8;
/// Subtrees that threads build, unless they have few points.
constexpr std::size_t most_parts = 64;
constexpr std::ptrdiff_t points_of_a_part = std::ptrdiff_t{1} << 13;
// A squared distance in doubles passes D + 2 roundings at most: one of the difference, which counts
// twice, one of the square, D - 1 of the sum; so it is within (D + 3) u of exact, relatively, and
// within 8 * 2^-1075 more for squares that underflow. With c the least one found, a point above c
// (1 + 4 (D + 8) u) + 2^-1000 is farther than the point of c: both errors together are 2 (D + 3) u,
// and the roundings of the bound itself fit into what is left. A subtree is left out by the same
// bound: the distance from its halfspaces is computed by the same operations in the same order from
// differences that are nowhere larger, and rounding is monotonous. All other candidates are
// compared exactly, on the coordinates as given, by compare_lengths(); of equal ones the lowest id
// stays. An overflow makes a square infinite, that is above every finite bound, as the distance is;
// where the bound overflows as well, all infinite squares stay candidates. So the answer is exact
// for all finite doubles. So that not all points stay candidates, a set whose largest coordinate is
// above 2^400 or below 2^-400 is searched multiplied by 2^-600 or 2^900. This rounds, if at all, by
// 2^-1075 in a coordinate: a difference above 2^-1000 changes by 2^-74 of itself, the square of a
// smaller one by less than 2^-1000.

/// Coordinates whose squares are far from overflow and underflow.
constexpr double least_unscaled = 0x1p-400, most_unscaled = 0x1p400;
/// More than all underflows together add to a squared distance.
constexpr double tiny = 0x1p-1000;

template <unsigned D>
class Tree final : public NearestTree {
 public:
  Tree(const double* rows, const std::uint32_t* names, std::uint32_t count, const Run& run) {
    std::size_t leaves = 1;
    while (leaves * width < count) leaves *= 2;
    measure(rows, count);
    const std::size_t slots = leaves * width;
    require_budget(run.budget,
                   count * sizeof(Item) + leaves * sizeof(Split) +
                       slots * (sizeof(std::uint32_t) + (scale_ != 1 ? 2 : 1) * D * sizeof(double)),
                   "the tree's points");
    splits_.assign(leaves - 1, Split{nan, 0});
    ids_.assign(slots, no_index);
    blocks_.assign(slots * D, nan);
    if (scale_ != 1) given_.resize(slots * D);
    Array<Item> items(count);
    run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        scale(rows + i * D, items[i].at);
        items[i].place = static_cast<std::uint32_t>(i);
      }
    });
    build({rows, names}, {0, items.data(), items.data() + count}, run);
  }

  unsigned dimension() const noexcept override { return D; }

  std::uint32_t nearest(const double* query, FarQueries far) const override {
    return is_left_out(query, far) ? no_index : Search(*this).nearest(query);
  }

  bool nearest(const PointView& queries, FarQueries far, std::uint32_t* out,
               const Run& run) const override {
    std::atomic<bool> any_left = false;
    const auto set_leaves = [&](const double* rows, std::uint64_t count, const auto& put) {
      for (std::uint64_t i = 0; i < count; ++i) put(i, leaf_of(rows + i * D));
    };
    each_query(queries, static_cast<unsigned>(std::bit_width(splits_.size())), run, set_leaves,
               [&] {
      return
          [&, search = Search(*this)](std::uint64_t i, const double* query, std::uint32_t) mutable {
        const bool left = is_left_out(query, far);
        if (left) any_left = true;
        out[i] = left ? no_index : search.nearest(query);
          };
    });
    return any_left;
  }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::size_t no_slot = ~std::size_t{0};

  struct Item {
    double at[D];
    std::uint32_t place;
  };
  /// Points of the first child are not above `at` on the axis, those of the second not below it.
  /// NaN where the second child has none.
  struct Split {
    double at;
    unsigned axis;
  };
  struct Source {
    const double* rows;
    const std::uint32_t* names;

    const double* row(const Item& item) const { return rows + std::size_t{item.place} * D; }
    std::uint32_t id(const Item& item) const {
      return names != nullptr ? names[item.place] : item.place;
    }
  };
  /// A node and its points.
  struct Part {
    std::size_t node;
    Item *begin, *end;
  };

  /// Sets what depends on the box of the points.
  void measure(const double* rows, std::uint32_t count) {
    std::array<double, D> low, high;
    std::copy_n(rows, D, low.begin());
    std::copy_n(rows, D, high.begin());
    for (std::uint32_t i = 1; i < count; ++i)
      for (unsigned j = 0; j < D; ++j) {
        const double x = rows[std::size_t{i} * D + j];
        low[j] = std::min(low[j], x);
        high[j] = std::max(high[j], x);
      }
    double most = 0;
    for (unsigned j = 0; j < D; ++j) most = std::max({most, std::abs(low[j]), std::abs(high[j])});
    scale_ = most > most_unscaled ? 0x1p-600 : most != 0 && most < least_unscaled ? 0x1p900 : 1;
    scale(low.data(), low.data());
    scale(high.data(), high.data());
    double extent = 0;
    for (unsigned j = 0; j < D; ++j) {
      middle_[j] = low[j] / 2 + high[j] / 2;
      extent = std::max(extent, high[j] - low[j]);
    }
    reach_ = 0x1p30 * extent;
  }
  void scale(const double* from, double* to) const {
    for (unsigned j = 0; j < D; ++j) to[j] = from[j] * scale_;
  }
  bool is_left_out(const double* query, FarQueries far) const {
    if (far == FarQueries::answered) return false;
    bool is_far = false;
    for (unsigned j = 0; j < D; ++j) is_far |= std::abs(query[j] * scale_ - middle_[j]) > reach_;
    return is_far;
  }

  /// The tree is a heap: the children of node i are 2 i + 1 and 2 i + 2, the leaves come last. All
  /// leaves have the same depth and at most `width` points.
  void build(const Source& source, const Part& all, const Run& run) {
    std::vector<Part> parts{all};
    while (parts.size() < most_parts && parts[0].node < splits_.size() &&
           all.end - all.begin > static_cast<std::ptrdiff_t>(parts.size()) * points_of_a_part) {
      std::vector<Part> halves(2 * parts.size());
      run.each_item(parts.size(), [&](std::uint64_t i) {
        std::tie(halves[2 * i], halves[2 * i + 1]) = split(source, parts[i]);
      });
      parts = std::move(halves);
    }
    run.each_item(parts.size(), [&](std::uint64_t i) { build_below(source, parts[i]); });
  }
  void build_below(const Source& source, const Part& part) {
    if (part.begin == part.end) return;
    if (part.node >= splits_.size()) {
      fill(source, part);
      return;
    }
    const auto [first, second] = split(source, part);
    build_below(source, first);
    build_below(source, second);
  }

  /// Halves a part along the longest side of its box. Of equal points the one of lowest id stays.
  std::pair<Part, Part> split(const Source& source, const Part& part) {
    const auto [node, begin, end] = part;
    Item* middle = end;
    if (begin != end) {
      double low[D], high[D];
      std::copy_n(begin->at, D, low);
      std::copy_n(begin->at, D, high);
      for (const Item* item = begin; item != end; ++item)
        for (unsigned j = 0; j < D; ++j) {
          low[j] = std::min(low[j], item->at[j]);
          high[j] = std::max(high[j], item->at[j]);
        }
      unsigned axis = 0;
      for (unsigned j = 1; j < D; ++j)
        if (high[j] - low[j] > high[axis] - low[axis]) axis = j;
      if (high[axis] == low[axis] && are_equal(source, begin, end)) {
        std::swap(*begin, *std::min_element(begin, end, [&](const Item& a, const Item& b) {
          return source.id(a) < source.id(b);
        }));
        return {{2 * node + 1, begin, begin + 1}, {2 * node + 2, end, end}};
      }
      middle = begin + (end - begin) / 2;
      std::nth_element(begin, middle, end,
                       [axis](const Item& a, const Item& b) { return a.at[axis] < b.at[axis]; });
      splits_[node] = {middle->at[axis], axis};
    }
    return {{2 * node + 1, begin, middle}, {2 * node + 2, middle, end}};
  }
  /// As given, as scaling may have rounded.
  static bool are_equal(const Source& source, const Item* begin, const Item* end) {
    const double* const first = source.row(*begin);
    return std::all_of(begin, end, [&](const Item& item) {
      return std::equal(first, first + D, source.row(item));
    });
  }

  void fill(const Source& source, const Part& part) {
    const std::size_t leaf = part.node - splits_.size();
    std::size_t slot = leaf * width;
    for (const Item* item = part.begin; item != part.end; ++item, ++slot) {
      ids_[slot] = source.id(*item);
      for (unsigned j = 0; j < D; ++j) blocks_[(leaf * D + j) * width + slot % width] = item->at[j];
      if (scale_ != 1) std::copy_n(source.row(*item), D, given_.data() + slot * D);
    }
  }

  std::uint32_t leaf_of(const double* query) const {
    std::size_t node = 0;
    while (node < splits_.size()) {
      const Split& split = splits_[node];
      node = 2 * node + 1 + (query[split.axis] * scale_ >= split.at ? 1 : 0);
    }
    return static_cast<std::uint32_t>(node - splits_.size());
  }

  /// Searches of one thread.
  class Search {
   public:
    explicit Search(const Tree& tree) : tree_(tree) {}

    std::uint32_t nearest(const double* query) {
      given_ = query;
      tree_.scale(query, q_);
      found_.clear();
      set_best(last_ == no_slot ? std::numeric_limits<double>::infinity() : distance(last_));
      visit(0, {});
      if (found_.size() > 1)
        std::erase_if(found_, [&](const Candidate& c) { return c.distance > ceiling_; });
      last_ = found_[0].slot;
      if (found_.size() > 1) decide();
      return tree_.ids_[last_];
    }

   private:
    struct Candidate {
      double distance;
      std::size_t slot;
    };

    /// Computed squares of distances are within (D + 3) roundings and `tiny` of exact ones, so a
    /// point whose square is above the ceiling is farther than the best; with one below the floor,
    /// all others found so far are. docs/exactness.md, "Points in cells". An overflow makes an
    /// infinity, which is above a finite ceiling rightly, and not above an infinite one.
    void set_best(double square) {
      constexpr double share = 4 * (D + 8) * unit_roundoff;
      best_ = square;
      ceiling_ = square * (1 + share) + tiny;
      floor_ = square * (1 - share) - tiny;
    }
    double coordinate(std::size_t slot, unsigned j) const {
      return tree_.blocks_[(slot / width * D + j) * width + slot % width];
    }
    double distance(std::size_t slot) const {
      double square = 0;
      for (unsigned j = 0; j < D; ++j) {
        const double away = coordinate(slot, j) - q_[j];
        square += away * away;
      }
      return square;
    }

    /// `away`: how far the query is from the node along each axis, at least. Rounding is monotone,
    /// so the computed distance from a node is not above any computed in it.
    void visit(std::size_t node, const std::array<double, D>& away) {
      if (node >= tree_.splits_.size()) {
        look(node - tree_.splits_.size());
        return;
      }
      const Split& split = tree_.splits_[node];
      const double beyond = q_[split.axis] - split.at;
      const std::size_t near = 2 * node + 1 + (beyond >= 0 ? 1 : 0);
      visit(near, away);
      std::array<double, D> across = away;
      across[split.axis] = beyond;
      double square = 0;
      for (unsigned j = 0; j < D; ++j) square += across[j] * across[j];
      if (square <= ceiling_) visit(4 * node + 3 - near, across);
    }

    void look(std::size_t leaf) {
      const double* const block = tree_.blocks_.data() + leaf * D * width;
      double square[width] = {};
      for (unsigned j = 0; j < D; ++j)
        for (unsigned i = 0; i < width; ++i) {
          const double away = block[j * width + i] - q_[j];
          square[i] += away * away;
        }
      for (unsigned i = 0; i < width; ++i)
        if (square[i] <= ceiling_) take(square[i], leaf * width + i);
    }

    void take(double square, std::size_t slot) {
      if (square < floor_) found_.clear();
      if (square < best_) set_best(square);
      found_.push_back({square, slot});
    }

    /// The coordinates of a slot as given; `room` for D.
    const double* row(std::size_t slot, double* room) const {
      if (tree_.scale_ != 1) return tree_.given_.data() + slot * D;
      for (unsigned j = 0; j < D; ++j) room[j] = coordinate(slot, j);
      return room;
    }
    /// Sets last_ to the nearest of the candidates, of several that of the lowest id.
    void decide() {
      double rooms[2][D];
      unsigned free = 1;
      const double* best = row(last_, rooms[0]);
      for (const Candidate& c : found_) {
        if (c.slot == last_) continue;
        const double* const other = row(c.slot, rooms[free]);
        const Sign sign = power_sign(D, false, given_, other, best);
        if (sign == Sign::positive ||
            (sign == Sign::zero && tree_.ids_[c.slot] > tree_.ids_[last_]))
          continue;
        last_ = c.slot;
        best = other;
        free = 1 - free;
      }
    }

    const Tree& tree_;
    const double* given_ = nullptr;  ///< the query, and as it is compared with the tree
    double q_[D] = {};
    double best_ = 0, ceiling_ = 0, floor_ = 0;
    std::vector<Candidate> found_;
    std::size_t last_ = no_slot;  ///< the slot of the last answer
  };

  /// All coordinates are multiplied by this power of two where squares could overflow or vanish.
  double scale_ = 1;
  std::array<double, D> middle_{};
  double reach_ = 0;
  Array<Split> splits_;
  Array<double> blocks_;  ///< for each leaf, axis after axis, `width` coordinates; NaN: no point
  Array<std::uint32_t> ids_;
  Array<double> given_;  ///< unless scale_ is 1: the coordinates as given, for each slot
};

}  // namespace

std::unique_ptr<const NearestTree> NearestTree::of(unsigned dimension, const double* rows,
                                                   const std::uint32_t* names, std::uint32_t count,
                                                   const Run& run) {
  return with_dimension<1, most_dimensions, most_dimensions>(
      dimension, [&](auto known) -> std::unique_ptr<const NearestTree> {
        return std::make_unique<const Tree<known()>>(rows, names, count, run);
      });
}

}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

struct NearestPoint::State {
  std::unique_ptr<const NearestTree> tree;
};

NearestPoint::NearestPoint(const PointView& points, const RunOptions& options) {
  const Call call(options);
  const Run& run = call.run;
  require_points(points);
  if (points.dimension > NearestTree::most_dimensions)
    refuse("nearest points are found in up to ", NearestTree::most_dimensions,
           " dimensions, not in ", points.dimension);
  if (points.count == 0) refuse("there are no points of which one could be the nearest");
  if (points.count >= no_index) refuse("there are more than 2^32 - 2 points: ", points.count);
  require_budget(run.budget, points.count * points.dimension * sizeof(double), "the coordinates");
  const Array<double> rows = gather_points(points, nullptr, points.count, run);
  state_.reset(new State{NearestTree::of(points.dimension, rows.data(), nullptr,
                                         static_cast<std::uint32_t>(points.count), run)});
}
NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;
NearestPoint& NearestPoint::operator=(NearestPoint&&) noexcept = default;

std::uint32_t NearestPoint::dimension() const noexcept { return state_->tree->dimension(); }

std::uint32_t NearestPoint::nearest(const double* query) const {
  for (unsigned j = 0; j < state_->tree->dimension(); ++j) require_finite(query[j], j);
  return state_->tree->nearest(query, NearestTree::FarQueries::answered);
}

void NearestPoint::nearest(const PointView& queries, std::uint32_t* out,
                           const RunOptions& options) const {
  const Call call(options);
  const Run& run = call.run;
  require_points(queries);
  if (queries.dimension != state_->tree->dimension())
    refuse("points of dimension ", queries.dimension, " asked of points in dimension ",
           state_->tree->dimension());
  check_finite(queries, nullptr, run);
  state_->tree->nearest(queries, NearestTree::FarQueries::answered, out, run);
}

}  // namespace cullhull
