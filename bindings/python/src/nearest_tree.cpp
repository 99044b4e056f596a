#include "nearest_tree.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <numeric>
#include <thread>
#include <utility>

#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"

namespace binding {

using cullhull::PointView;
using cullhull::ScalarType;

namespace {

template <class T>
void load(const PointView& view, double* to) {
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const std::byte* at = view.data + static_cast<std::ptrdiff_t>(i) * view.point_stride;
    for (unsigned j = 0; j < view.dimension; ++j, at += view.coordinate_stride) {
      T value;
      std::memcpy(&value, at, sizeof value);
      *to++ = static_cast<double>(value);
    }
  }
}

constexpr double roundoff = 0x1p-53;
/// Coordinates up to here have differences, squares and sums of them that do not overflow.
constexpr double largest = 0x1p400;
/// More than all underflows together add to a squared distance.
constexpr double tiny = 0x1p-1000;

// ------------------------------------------------------------------- which of two is nearer

/// The sign of a sum of doubles, exactly, if neither an overflow nor an underflow happens: the
/// partial sums are kept as expansions, doubles that do not overlap (Shewchuk 1997,
/// GROW-EXPANSION).
class ExactSum {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = x + parts_[i], other = sum - x;
      const double error = (x - (sum - other)) + (parts_[i] - other);
      x = sum;
      if (error != 0) parts_[kept++] = error;
    }
    size_ = kept;
    if (x != 0) parts_[size_++] = x;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 8 * NearestTree::most_dimensions> parts_;
  std::size_t size_ = 0;
};

/// By the library, whatever the magnitudes are.
int compare_by_triangulation(unsigned d, const double* q, const double* a, const double* b) {
  std::array<double, 2 * NearestTree::most_dimensions> both;
  std::copy_n(a, d, both.data());
  std::copy_n(b, d, both.data() + d);
  const auto nearest = [&] {
    PointView view;
    view.data = reinterpret_cast<const std::byte*>(both.data());
    view.scalar = ScalarType::f64;
    view.count = 2;
    view.dimension = d;
    view.point_stride = static_cast<std::ptrdiff_t>(d * sizeof(double));
    view.coordinate_stride = sizeof(double);
    cullhull::TriangulationOptions options;
    options.threads = 1;
    return cullhull::TriangulationQuery(view, cullhull::delaunay(view, options), {}, options)
        .nearest(q);
  };
  if (nearest() == 1) return 1;  // the second one is nearer, as ties go to the first
  std::swap_ranges(both.data(), both.data() + d, both.data() + d);
  return nearest() == 1 ? -1 : 0;
}

/// The sign of |q - a|^2 - |q - b|^2. In doubles first: each product has at most 5 roundings,
/// relative to the product of its factors' magnitudes; d sums follow. The bound has as many again.
int compare(unsigned d, const double* q, const double* a, const double* b) {
  if (std::equal(a, a + d, b)) return 0;
  double sum = 0, size = 0;
  for (unsigned j = 0; j < d; ++j) {
    const double across = a[j] - b[j], from_a = a[j] - q[j], from_b = b[j] - q[j];
    sum += across * (from_a + from_b);
    size += std::abs(across) * (std::abs(from_a) + std::abs(from_b));
  }
  const double bound = (2.0 * d + 16) * roundoff * size + tiny;
  if (std::abs(sum) > bound) return sum > 0 ? 1 : -1;
  // From here on the errors of products are doubles too.
  const auto small = [](double x) { return x != 0 && std::abs(x) < 1 / largest; };
  ExactSum exact;
  for (unsigned j = 0; j < d; ++j) {
    if (small(q[j]) || small(a[j]) || small(b[j])) return compare_by_triangulation(d, q, a, b);
    exact.add_product(a[j], a[j]);
    exact.add_product(-b[j], b[j]);
    exact.add_product(-2 * q[j], a[j]);
    exact.add_product(2 * q[j], b[j]);
  }
  return exact.sign();
}

}  // namespace

// ------------------------------------------------------------------------------ the tree

class NearestTree::Base {
 public:
  virtual ~Base() = default;
  virtual void nearest(const double* rows, std::uint64_t count, std::uint32_t* out,
                       unsigned threads, const std::function<void(double)>& check) const = 0;
};

namespace {

/// Points in a leaf, whose distances are computed together.
constexpr unsigned width = 8;
/// Queries in a chunk.
constexpr std::uint64_t grain = 1024;
/// Below this many queries a second thread does not pay where the machine is busy: it may have to
/// wait for a time slice, milliseconds, and a query takes about 0.3 us.
constexpr std::uint64_t worth_a_thread = 32 * grain;

template <unsigned D>
class Tree final : public NearestTree::Base {
 public:
  Tree(const double* rows, std::uint32_t count) {
    std::size_t leaves = 1;
    while (leaves * width < count) leaves *= 2;
    splits_.resize(leaves - 1);
    ids_.assign(leaves * width, no_id);
    blocks_.assign(leaves * width * D, std::numeric_limits<double>::infinity());
    std::vector<Item> items(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      std::copy_n(rows + std::size_t{i} * D, D, items[i].at);
      items[i].id = i;
    }
    build(0, items.data(), items.data() + count);
  }

  void nearest(const double* rows, std::uint64_t count, std::uint32_t* out, unsigned threads,
               const std::function<void(double)>& check) const override {
    const std::vector<std::uint32_t> order = along_the_leaves(rows, count);
    std::atomic<std::uint64_t> next = 0;
    const auto work = [&](const auto& before_each) {
      Search search(*this);
      for (std::uint64_t begin; (begin = next.fetch_add(grain)) < count;) {
        before_each(static_cast<double>(begin) / static_cast<double>(count));
        const std::uint64_t end = std::min(begin + grain, count);
        for (std::uint64_t i = begin; i < end; ++i) {
          const std::uint64_t at = order.empty() ? i : order[i];
          out[at] = search.nearest(rows + at * D);
        }
      }
    };
    const std::uint64_t most = std::min<std::uint64_t>(threads, count / worth_a_thread + 1);
    std::exception_ptr failure;
    {
      std::vector<std::jthread> helpers;
      std::atomic<bool> failed = false;
      try {
        for (std::uint64_t i = 1; i < most; ++i)
          helpers.emplace_back([&] {
            try {
              work([](double) {});
            } catch (...) {  // std::bad_alloc
              failed = true;
            }
          });
        work(check);
      } catch (...) {
        next = count;
        failure = std::current_exception();
      }
      helpers.clear();  // joins
      if (failed && !failure) failure = std::make_exception_ptr(std::bad_alloc());
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  static constexpr std::uint32_t no_id = 0xffffffff;

  struct Item {
    double at[D];
    std::uint32_t id;
  };
  /// Points of the first child are not above `at` on the axis, those of the second not below it.
  struct Split {
    double at;
    unsigned axis;
  };

  /// The tree is a heap: the children of node i are 2 i + 1 and 2 i + 2, the leaves come last. All
  /// leaves have the same depth and at most `width` points.
  void build(std::size_t node, Item* begin, Item* end) {
    const auto count = static_cast<std::size_t>(end - begin);
    if (node >= splits_.size()) {
      const std::size_t leaf = node - splits_.size();
      // Ascending, so that equal points do not depend on the order in which they were parted.
      std::sort(begin, end, [](const Item& a, const Item& b) { return a.id < b.id; });
      for (std::size_t i = 0; i < count; ++i) {
        ids_[leaf * width + i] = begin[i].id;
        for (unsigned j = 0; j < D; ++j) blocks_[(leaf * D + j) * width + i] = begin[i].at[j];
      }
      return;
    }
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
    Item* const middle = begin + count / 2;
    std::nth_element(begin, middle, end,
                     [axis](const Item& a, const Item& b) { return a.at[axis] < b.at[axis]; });
    splits_[node] = {middle->at[axis], axis};
    build(2 * node + 1, begin, middle);
    build(2 * node + 2, middle, end);
  }

  std::uint32_t leaf_of(const double* q) const {
    std::size_t node = 0;
    while (node < splits_.size())
      node = 2 * node + 1 + (q[splits_[node].axis] >= splits_[node].at ? 1 : 0);
    return static_cast<std::uint32_t>(node - splits_.size());
  }

  /// The queries by their leaves, so that each begins with what the last one read; empty for as
  /// they come.
  std::vector<std::uint32_t> along_the_leaves(const double* rows, std::uint64_t count) const {
    const std::size_t leaves = splits_.size() + 1;
    if (leaves == 1 || count < 32 || count > no_id) return {};
    std::vector<std::uint32_t> leaf(count), order(count);
    for (std::uint64_t i = 0; i < count; ++i) leaf[i] = leaf_of(rows + i * D);
    if (leaves > 4 * count) {
      std::iota(order.begin(), order.end(), 0U);
      std::sort(order.begin(), order.end(),
                [&](std::uint32_t a, std::uint32_t b) { return leaf[a] < leaf[b]; });
      return order;
    }
    std::vector<std::uint32_t> place(leaves + 1);
    for (const std::uint32_t l : leaf) ++place[l + 1];
    for (std::size_t l = 0; l < leaves; ++l) place[l + 1] += place[l];
    for (std::uint64_t i = 0; i < count; ++i)
      order[place[leaf[i]]++] = static_cast<std::uint32_t>(i);
    return order;
  }

  /// Searches of one thread.
  class Search {
   public:
    explicit Search(const Tree& tree) : tree_(tree) {}

    std::uint32_t nearest(const double* q) {
      q_ = q;
      found_.clear();
      set_best(last_ == no_id ? 0x1p900 : distance(last_));
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
      std::uint32_t slot;
    };

    /// Squared distances have at most d + 3 roundings, so a point whose computed one is beyond the
    /// ceiling is farther than the best.
    void set_best(double distance) {
      constexpr double share = 4 * (D + 8) * roundoff;
      best_ = distance;
      ceiling_ = distance * (1 + share) + tiny;
      floor_ = distance * (1 - share) - tiny;
    }
    double coordinate(std::uint32_t slot, unsigned j) const {
      return tree_.blocks_[(std::size_t{slot / width} * D + j) * width + slot % width];
    }
    double distance(std::uint32_t slot) const {
      double square = 0;
      for (unsigned j = 0; j < D; ++j) {
        const double away = coordinate(slot, j) - q_[j];
        square += away * away;
      }
      return square;
    }

    /// `away`: how far q is from the node along each axis, at least. Rounding is monotone, so the
    /// computed distance from a node is not above any computed in it.
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
        if (square[i] <= ceiling_) take(square[i], static_cast<std::uint32_t>(leaf * width + i));
    }

    void take(double distance, std::uint32_t slot) {
      if (distance < floor_) found_.clear();
      if (distance < best_) set_best(distance);
      found_.push_back({distance, slot});
    }

    /// Sets last_ to the nearest of the candidates, of several that of the lowest id.
    void decide() {
      double best[D], other[D];
      for (unsigned j = 0; j < D; ++j) best[j] = coordinate(last_, j);
      for (const Candidate& c : found_) {
        for (unsigned j = 0; j < D; ++j) other[j] = coordinate(c.slot, j);
        const int sign = compare(D, q_, other, best);
        if (sign > 0 || (sign == 0 && tree_.ids_[c.slot] >= tree_.ids_[last_])) continue;
        last_ = c.slot;
        std::copy_n(other, D, best);
      }
    }

    const Tree& tree_;
    const double* q_ = nullptr;
    double best_ = 0, ceiling_ = 0, floor_ = 0;
    std::vector<Candidate> found_;
    std::uint32_t last_ = no_id;  ///< the slot of the last answer
  };

  std::vector<Split> splits_;
  std::vector<double> blocks_;  ///< for each leaf, axis after axis, `width` coordinates
  std::vector<std::uint32_t> ids_;
};

template <unsigned D = 1>
std::unique_ptr<const NearestTree::Base> tree_of(unsigned d, const double* rows,
                                                 std::uint32_t count) {
  if constexpr (D < NearestTree::most_dimensions)
    if (d > D) return tree_of<D + 1>(d, rows, count);
  return std::make_unique<const Tree<D>>(rows, count);
}

}  // namespace

std::vector<double> rows_of_view(const PointView& view) {
  std::vector<double> rows(view.count * view.dimension);
  switch (view.scalar) {
    case ScalarType::f32:
      load<float>(view, rows.data());
      break;
    case ScalarType::f64:
      load<double>(view, rows.data());
      break;
    case ScalarType::i8:
      load<std::int8_t>(view, rows.data());
      break;
    case ScalarType::u8:
      load<std::uint8_t>(view, rows.data());
      break;
    case ScalarType::i16:
      load<std::int16_t>(view, rows.data());
      break;
    case ScalarType::u16:
      load<std::uint16_t>(view, rows.data());
      break;
    case ScalarType::i32:
      load<std::int32_t>(view, rows.data());
      break;
    case ScalarType::u32:
      load<std::uint32_t>(view, rows.data());
      break;
  }
  return rows;
}

bool NearestTree::takes(const PointView& points, const std::vector<double>& rows) {
  if (points.dimension < 1 || points.dimension > most_dimensions) return false;
  bool within = true;
  for (const double x : rows) within &= std::abs(x) <= largest;  // false for NaN
  return within;
}

bool NearestTree::holds(const PointView& points, const std::vector<double>& rows) {
  if (!takes(points, rows)) return false;
  double most = 0;
  for (const double x : rows) most = std::max(most, std::abs(x));
  return most == 0 || most >= 1 / largest;
}

NearestTree::NearestTree(const PointView& points, const std::vector<double>& rows)
    : dimension_(points.dimension),
      tree_(tree_of(dimension_, rows.data(), static_cast<std::uint32_t>(points.count))) {}
NearestTree::~NearestTree() = default;

void NearestTree::nearest(const double* rows, std::uint64_t count, std::uint32_t* out,
                          unsigned threads, const std::function<void(double)>& check) const {
  tree_->nearest(rows, count, out, threads, check);
}

}  // namespace binding
