// Many small hulls: the pipeline once a set, sets spread over the cores, results end to end.
#include "cullhull/batch.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "control.hpp"
#include "cullhull/error.hpp"
#include "parallel/big_array.hpp"
#include "parallel/parallel.hpp"
#include "planar_sets.hpp"

namespace cullhull {
namespace {

using namespace internal;

template <class To, class Items>
requires requires(To& to, const Items& items) { to.insert(to.end(), items.begin(), items.end()); }
void append(To& to, const Items& items) { to.insert(to.end(), items.begin(), items.end()); }

/// One more list.
template <class T, class Items>
void append_list(Lists<T>& to, const Items& items) {
  append(to.items, items);
  to.offsets.push_back(to.items.size());
}

/// Offsets that begin at 0, moved on by what is there.
template <class To, class Offsets>
void append_offsets(To& to, const Offsets& offsets) {
  const std::uint64_t base = to.back();
  for (std::size_t i = 1; i < offsets.size(); ++i) to.push_back(base + offsets[i]);
}

template <class T, class Items>
void append_lists(Lists<T>& to, const Lists<T, Items>& more) {
  append_offsets(to.offsets, more.offsets);
  append(to.items, more.items);
}

void append(HullBatch& b, const Hull& h) {
  b.point_counts.push_back(h.point_count);
  b.affine_dimensions.push_back(h.affine_dimension);
  b.volumes.push_back(h.volume);
  b.areas.push_back(h.area);
  append(b.centroids, h.centroid);
  b.centroids.resize(b.size() * b.dimension, 0);
  append_list(b.vertices, h.vertices);
  b.facet_starts.push_back(b.facet_starts.back() + h.facet_count());
  append_lists(b.facets, h.facets);
  append_lists(b.facet_neighbours, h.facet_neighbours);
  append(b.facet_planes, h.facet_planes);
  append_list(b.simplices, h.simplices);
  append_list(b.simplex_neighbours, h.simplex_neighbours);
  append_list(b.simplex_facets, h.simplex_facets);
}

/// Parts end to end. Every list is sized first, then all parts are copied at once.
class Joiner {
 public:
  Joiner(std::vector<HullBatch>& parts, unsigned threads) : parts_(parts), threads_(threads) {}

  void run(HullBatch& out) {
    join(out, &HullBatch::point_counts);
    join(out, &HullBatch::affine_dimensions);
    join(out, &HullBatch::volumes);
    join(out, &HullBatch::areas);
    join(out, &HullBatch::centroids);
    join_lists(out, &HullBatch::vertices);
    join_starts(
        out.facet_starts, [](HullBatch & b) -> auto& { return b.facet_starts; });
    join_lists(out, &HullBatch::facets);
    join_lists(out, &HullBatch::facet_neighbours);
    join(out, &HullBatch::facet_planes);
    join_lists(out, &HullBatch::simplices);
    join_lists(out, &HullBatch::simplex_neighbours);
    join_lists(out, &HullBatch::simplex_facets);
  }

 private:
  /// Where each part begins in the whole, and the whole's size.
  template <class Size>
  std::vector<std::uint64_t> places(Size&& size) const {
    std::vector<std::uint64_t> at(parts_.size() + 1, 0);
    for (std::size_t p = 0; p < parts_.size(); ++p) at[p + 1] = at[p] + size(parts_[p]);
    return at;
  }
  template <class Copy>
  void each(Copy&& copy) const {
    for_each_chunk(parts_.size(), 8, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     for (std::uint64_t p = begin; p < end; ++p) copy(p);
                   });
  }
  template <class Vector>
  void join_items(Vector& out, const auto& of) const {
    const auto at = places([&](HullBatch& b) { return of(b).size(); });
    resize_big(out, at.back());
    each([&](std::uint64_t p) {
      Vector& items = of(parts_[p]);
      std::copy(items.begin(), items.end(), out.begin() + static_cast<std::ptrdiff_t>(at[p]));
      items = {};
    });
  }
  template <class T>
  void join(HullBatch& out, std::vector<T> HullBatch::*member) const {
    join_items(
        out.*member, [member](HullBatch & b) -> auto& { return b.*member; });
  }
  /// Offsets that begin at 0 in every part.
  void join_starts(auto& out, const auto& of) const {
    const auto at = places([&](HullBatch& b) { return of(b).size() - 1; });
    const auto base = places([&](HullBatch& b) { return of(b).back(); });
    resize_big(out, at.back() + 1);
    each([&](std::uint64_t p) {
      const auto& offsets = of(parts_[p]);
      for (std::size_t i = 1; i < offsets.size(); ++i) out[at[p] + i] = base[p] + offsets[i];
    });
  }
  template <class T>
  void join_lists(HullBatch& out, Lists<T> HullBatch::*member) const {
    join_starts((out.*member).offsets.edit(), [member](HullBatch & b) -> auto& {
      return (b.*member).offsets;
    });
    join_items((out.*member).items, [member](HullBatch & b) -> auto& { return (b.*member).items; });
  }

  std::vector<HullBatch>& parts_;
  unsigned threads_;
};

void check_offsets(const PointView& points, const std::uint64_t* offsets, std::uint64_t sets) {
  if (offsets == nullptr) throw Error(ErrorCode::invalid_argument, "offsets is null");
  for (std::uint64_t i = 0; i <= sets; ++i)
    if (offsets[i] > points.count || (i > 0 && offsets[i] < offsets[i - 1]))
      throw Error(ErrorCode::invalid_argument, "offset " + std::to_string(i) + " is " +
                                                   std::to_string(offsets[i]) +
                                                   "; offsets must ascend and not exceed the " +
                                                   std::to_string(points.count) + " points");
}

template <class T, class To>
void copy_list(const Lists<T>& lists, std::size_t i, To& to) {
  to.assign(lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i]),
            lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i + 1]));
}

/// Lists [begin, end), their offsets from 0.
template <class T, class Items>
void copy_run(const Lists<T>& lists, std::uint64_t begin, std::uint64_t end, Lists<T, Items>& out) {
  const std::uint64_t base = lists.offsets[begin];
  for (std::uint64_t i = begin + 1; i <= end; ++i) out.offsets.push_back(lists.offsets[i] - base);
  out.items = Array<T>(lists.items.begin() + static_cast<std::ptrdiff_t>(base),
                       lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[end]));
}

}  // namespace

Hull HullBatch::hull(std::size_t i) const {
  if (i >= size()) throw std::out_of_range("HullBatch::hull: no such set");
  Hull h;
  h.dimension = dimension;
  h.scalar = scalar;
  h.point_count = point_counts[i];
  h.affine_dimension = affine_dimensions[i];
  h.volume = volumes[i];
  h.area = areas[i];
  if (h.affine_dimension >= 0) {
    const auto c = centroids.begin() + static_cast<std::ptrdiff_t>(i * dimension);
    h.centroid.assign(c, c + dimension);
  }
  copy_list(vertices, i, h.vertices);
  const std::uint64_t begin = facet_starts[i], end = facet_starts[i + 1];
  copy_run(facets, begin, end, h.facets);
  copy_run(facet_neighbours, begin, end, h.facet_neighbours);
  const std::uint64_t width = dimension + std::uint64_t{1};
  h.facet_planes.assign(facet_planes.begin() + static_cast<std::ptrdiff_t>(begin * width),
                        facet_planes.begin() + static_cast<std::ptrdiff_t>(end * width));
  copy_list(simplices, i, h.simplices.edit());
  copy_list(simplex_neighbours, i, h.simplex_neighbours);
  copy_list(simplex_facets, i, h.simplex_facets.edit());
  return h;
}

HullBatch convex_hulls(const PointView& points, const std::uint64_t* offsets,
                       std::uint64_t set_count, const Options& options) {
  check_offsets(points, offsets, set_count);
  const Control control(options);
  const unsigned threads = resolve_threads(options.threads);
  // Chunks of sets: large enough to be worth a task, many enough to be shared evenly.
  constexpr std::uint64_t chunk = 128;
  const std::uint64_t chunks = chunk_count(set_count, chunk);
  std::vector<HullBatch> parts(chunks);
  std::vector<std::optional<Error>> errors(chunks);
  const auto hulls_of_chunk = [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    control.check();
    Options one = options;
    one.threads = 1;
    one.progress = nullptr;
    parts[c].dimension = points.dimension;
    PlanarSets planar(options, control);
    for (std::uint64_t i = begin; i < end; ++i) {
      PointView set = points;
      set.count = offsets[i + 1] - offsets[i];
      set.data += static_cast<std::ptrdiff_t>(offsets[i]) * points.point_stride;
      if (planar.append(set, parts[c])) continue;
      try {
        append(parts[c], convex_hull(set, one));
      } catch (const Error& e) {
        if (e.code() == ErrorCode::cancelled) throw;
        errors[c].emplace(e.code(), "set " + std::to_string(i) + ": " + e.what());
        return;
      }
    }
  };
  constexpr std::uint64_t block = 64 * chunk;  // between two reports
  for (std::uint64_t first = 0; first < set_count; first += block) {
    control.report("hulls", static_cast<double>(first) / static_cast<double>(set_count));
    for_each_chunk(std::min(block, set_count - first), chunk, threads,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     hulls_of_chunk(first / chunk + c, first + begin, first + end);
                   });
  }
  for (const std::optional<Error>& e : errors)
    if (e) throw *e;
  HullBatch all;
  all.dimension = points.dimension;
  all.scalar = points.scalar;
  Joiner(parts, threads).run(all);
  control.report("done", 1);
  return all;
}

}  // namespace cullhull
