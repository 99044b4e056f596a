#include "delaunay/insertion_order.hpp"

#include <algorithm>

#include "geometry/curve_frame.hpp"
#include "geometry/insertion_rounds.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/xorshift.hpp"

namespace cullhull::internal {
namespace {

struct Placed {
  std::uint32_t key, id;
};

class Sorter {
 public:
  Sorter(const double* rows, unsigned d, const Run& run)
      : rows_(rows), d_(d), run_(run), frame_(d) {}

  /// Sorts items[0, n) along a Hilbert curve over their bounding box; equal points by id. A few
  /// remote points make the box so large that many items share a key: such items are sorted along a
  /// curve over their own box.
  void sort(Placed* items, Placed* scratch, std::uint32_t n) {
    if (n < 2) return;
    if (!place(items, n)) return sort_by_coordinates(items, n);
    Placed *from = items, *to = scratch;
    radix_sort(from, to, n, frame_.key_bits(), run_, [](const Placed& p) { return p.key; });
    if (from != items) std::copy(from, from + n, items);
    for (std::uint32_t begin = 0; begin < n;) {
      std::uint32_t end = begin + 1;
      while (end < n && items[end].key == items[begin].key) ++end;
      if (end - begin > few && end - begin < n) {
        run_.check();
        sort(items + begin, scratch, end - begin);
      } else if (end - begin > 1) {
        sort_by_coordinates(items + begin, end - begin);
      }
      begin = end;
    }
  }

  bool equal(std::uint32_t a, std::uint32_t b) const {
    return std::equal(row(a), row(a) + d_, row(b));
  }

 private:
  static constexpr std::uint32_t few = 48;  // so many points are sorted by coordinates; a guess

  const double* row(std::uint32_t i) const { return rows_ + std::size_t{i} * d_; }
  bool less(std::uint32_t a, std::uint32_t b) const {
    for (unsigned j = 0; j < d_; ++j)
      if (row(a)[j] != row(b)[j]) return row(a)[j] < row(b)[j];
    return a < b;
  }

  void sort_by_coordinates(Placed* items, std::uint32_t n) const {
    std::sort(items, items + n, [&](const Placed& a, const Placed& b) { return less(a.id, b.id); });
  }

  /// Computes the items' curve keys; false if the box is a point or too small for keys.
  bool place(Placed* items, std::uint32_t n) {
    const auto row_of = [&](std::uint64_t i) { return row(items[i].id); };
    if (!frame_.measure(n, row_of, run_)) return false;
    with_dimension<2, 4, 0>(d_, [&](auto d) {
      run_.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
        Placed* const own = items + begin;
        frame_.keys<d()>(
            end - begin, [&](std::uint64_t i) { return row(own[i].id); },
            [&](std::uint64_t i, std::uint32_t key) { own[i].key = key; });
      });
    });
    return true;
  }

  const double* rows_;
  unsigned d_;
  const Run& run_;
  CurveFrame frame_;
};

/// Distributes ids to rounds; within a round they keep their order. Each round is expected to hold
/// 8 times as many points as the one before. The choice is pseudorandom, the same in every run.
void sort_into_rounds(Array<std::uint32_t>& ids) {
  const InsertionRounds rounds(ids.size(), 1U << 10, 3);
  if (rounds.count == 1) return;
  Array<std::uint8_t> round(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    XorShift random((i + 1) * XorShift::golden);
    random.next();
    round[i] = static_cast<std::uint8_t>(rounds.round_of(random.next()));
  }
  Adjacency<std::uint32_t> sorted(rounds.count, [&](const auto& add) {
    for (std::size_t i = 0; i < ids.size(); ++i) add(round[i], ids[i]);
  });
  ids = std::move(sorted).take_items();
}

}  // namespace

InsertionOrder insertion_order(const double* rows, std::uint32_t n, unsigned d,
                               const double* weights, const Run& run) {
  InsertionOrder order;
  Array<Placed> items(n), scratch(n);
  for (std::uint32_t i = 0; i < n; ++i) items[i] = {0, i};
  Sorter sorter(rows, d, run);
  sorter.sort(items.data(), scratch.data(), n);
  order.ids.reserve(n);
  for (std::uint32_t begin = 0; begin < n;) {
    std::uint32_t end = begin + 1;
    while (end < n && items[begin].key == items[end].key &&
           sorter.equal(items[begin].id, items[end].id))
      ++end;
    std::uint32_t best = items[begin].id;
    for (std::uint32_t i = begin + 1; i < end; ++i) {
      const std::uint32_t id = items[i].id;
      const bool heavier = weights != nullptr && weights[id] > weights[best];
      const bool lighter = weights != nullptr && weights[id] < weights[best];
      if (heavier || (!lighter && id < best)) best = id;
    }
    for (std::uint32_t i = begin; i < end; ++i)
      if (items[i].id != best) order.duplicates.push_back({items[i].id, best});
    order.ids.push_back(best);
    begin = end;
  }
  std::sort(order.duplicates.begin(), order.duplicates.end(),
            [](const DuplicatePoint& a, const DuplicatePoint& b) { return a.id < b.id; });
  sort_into_rounds(order.ids);
  return order;
}

}  // namespace cullhull::internal
