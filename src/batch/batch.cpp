// Many small hulls: the pipeline once a set, sets spread over the cores, results end to end.
#include "cullhull/batch.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batch/planar_sets.hpp"
#include "batch/small_sets.hpp"
#include "cullhull/error.hpp"
#include "parallel/run.hpp"

namespace cullhull {
namespace {

using namespace internal;

template <class To, class Items>
requires requires(To& to, const Items& items) { to.insert(to.end(), items.begin(), items.end()); }
void append(To& to, const Items& items) { to.insert(to.end(), items.begin(), items.end()); }

/// Appends a list.
template <class T, class Items>
void append_list(Lists<T>& to, const Items& items) {
  append(to.items, items);
  to.offsets.push_back(to.items.size());
}

/// Appends offsets that begin at 0, increased by the last offset of `to`.
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

/// Empties it, keeping its memory.
void clear(HullBatch& b) {
  const auto clear_lists = [](auto& lists) {
    lists.offsets = {0};
    lists.items.clear();
  };
  b.point_counts.clear();
  b.affine_dimensions.clear();
  b.volumes.clear();
  b.areas.clear();
  b.centroids.clear();
  clear_lists(b.vertices);
  b.facet_starts.assign(1, 0);
  clear_lists(b.facets);
  clear_lists(b.facet_neighbours);
  b.facet_planes.clear();
  clear_lists(b.simplices);
  clear_lists(b.simplex_neighbours);
  clear_lists(b.simplex_facets);
}

/// Appends parts to a batch, end to end. First all lists are resized, then all parts are copied in
/// one parallel loop.
class Joiner {
 public:
  /// `still`: the number of all sets over the number joined after this call, by which memory is
  /// reserved.
  Joiner(const std::vector<HullBatch>& parts, const Run& run, double still)
      : parts_(parts), run_(run), still_(still) {}

  void run(HullBatch& out) {
    join(out, &HullBatch::point_counts);
    join(out, &HullBatch::affine_dimensions);
    join(out, &HullBatch::volumes);
    join(out, &HullBatch::areas);
    join(out, &HullBatch::centroids);
    join_lists(out, &HullBatch::vertices);
    join_starts(
        out.facet_starts, [](const HullBatch& b) -> const auto& { return b.facet_starts; });
    join_lists(out, &HullBatch::facets);
    join_lists(out, &HullBatch::facet_neighbours);
    join(out, &HullBatch::facet_planes);
    join_lists(out, &HullBatch::simplices);
    join_lists(out, &HullBatch::simplex_neighbours);
    join_lists(out, &HullBatch::simplex_facets);
    // One parallel loop for all lists: small sets are done in the time that ten loops would take to
    // start.
    run_.each(parts_.size(), 4, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t p = begin; p < end; ++p)
        for (const auto& copy : copies_) copy(p);
    });
  }

 private:
  /// Computes where each part begins in the whole; returns the whole's size.
  template <class Size>
  std::vector<std::uint64_t> places(std::uint64_t begin, Size&& size) const {
    std::vector<std::uint64_t> at(parts_.size() + 1, begin);
    for (std::size_t p = 0; p < parts_.size(); ++p) at[p + 1] = at[p] + size(parts_[p]);
    return at;
  }
  template <class Vector>
  void grow(Vector& out, std::size_t size) const {
    if (size > out.capacity())
      out.reserve(static_cast<std::size_t>(1.02 * still_ * static_cast<double>(size)));
    out.resize(size);
  }
  template <class Vector>
  void join_items(Vector& out, const auto& of) {
    auto at = places(out.size(), [&](const HullBatch& b) { return of(b).size(); });
    grow(out, at.back());
    copies_.push_back([this, &out, of, at = std::move(at)](std::uint64_t p) {
      const Vector& items = of(parts_[p]);
      std::copy(items.begin(), items.end(), out.begin() + static_cast<std::ptrdiff_t>(at[p]));
    });
  }
  template <class Vector>
  void join(HullBatch& out, Vector HullBatch::*member) {
    join_items(
        out.*member, [member](const HullBatch& b) -> const auto& { return b.*member; });
  }
  /// Joins offsets that begin at 0 in every part.
  template <class Vector>
  void join_starts(Vector& out, const auto& of) {
    auto at = places(out.size(), [&](const HullBatch& b) { return of(b).size() - 1; });
    auto base = places(out.back(), [&](const HullBatch& b) { return of(b).back(); });
    grow(out, at.back());
    copies_.push_back(
        [this, &out, of, at = std::move(at), base = std::move(base)](std::uint64_t p) {
          const auto& offsets = of(parts_[p]);
          for (std::size_t i = 1; i < offsets.size(); ++i)
            out[at[p] + i - 1] = base[p] + offsets[i];
        });
  }
  template <class T>
  void join_lists(HullBatch& out, Lists<T> HullBatch::*member) {
    EvenArray<std::uint64_t>& offsets = (out.*member).offsets;
    const std::uint64_t step = common_step(member, offsets);
    if (step != 0)
      offsets = EvenArray<std::uint64_t>::of_step(
          places(offsets.size(), [&](const HullBatch& b) { return (b.*member).size(); }).back(),
          step);
    else
      join_starts(
          offsets.edit(), [member](const HullBatch& b) -> const auto& {
            return (b.*member).offsets;
          });
    join_items((out.*member).items, [member](const HullBatch& b) -> const auto& {
      return (b.*member).items;
    });
  }
  /// The length that all lists have in common, or 0.
  template <class T>
  std::uint64_t common_step(Lists<T> HullBatch::*member,
                            const EvenArray<std::uint64_t>& offsets) const {
    std::uint64_t step = 0;
    const auto agrees = [&](const EvenArray<std::uint64_t>& o) {
      if (o.size() < 2) return true;
      if (o.step() == nullptr || *o.step() == 0 || (step != 0 && *o.step() != step)) return false;
      step = *o.step();
      return true;
    };
    const bool even = agrees(offsets) && std::all_of(parts_.begin(), parts_.end(), [&](auto& p) {
                        return agrees((p.*member).offsets);
                      });
    return even ? step : 0;
  }

  const std::vector<HullBatch>& parts_;
  const Run& run_;
  const double still_;
  std::vector<std::function<void(std::uint64_t)>> copies_;  // of part p into a list
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

/// Copies lists [begin, end), with offsets from 0.
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
  const Run run(options);
  // With other options the fast paths' errors would differ.
  const bool plain = options.engine == Engine::native && options.backend != Backend::cuda &&
                     (options.memory_budget == 0 || options.memory_budget >= 1 << 22);
  // Chunks of 32 sets: large enough to be worth a task, small enough to be shared evenly (a guess).
  // The parts of a block of chunks are joined while they are in the cache, and their memory is
  // reused by the next block: about 65,000 points, and 16,000 for one thread in space, whose larger
  // hulls then fit its own L2 cache.
  constexpr std::uint64_t chunk = 32;
  const bool few = run.threads == 1 && points.dimension > 2;
  const std::uint64_t mean = set_count > 0 ? (offsets[set_count] - offsets[0]) / set_count + 1 : 1;
  const std::uint64_t together = (few ? 1U << 14 : 1U << 16) / (mean * chunk);
  const std::uint64_t fewest = few ? 4 : std::max(32U, 4 * run.threads);
  const std::uint64_t block = chunk * std::clamp<std::uint64_t>(together, fewest, fewest + 128);
  std::vector<HullBatch> parts(std::min(block / chunk, chunk_count(set_count, chunk)));
  std::vector<std::optional<Error>> errors(parts.size());
  const auto hulls_of_chunk = [&](HullBatch& part, std::uint64_t begin, std::uint64_t end) {
    Options one = options;
    one.threads = 1;
    one.progress = nullptr;
    one.poll = nullptr;  // this may run on another thread
    part.dimension = points.dimension;
    PlanarSets planar(run.control);
    for (std::uint64_t i = begin; i < end; ++i) {
      PointView set = points;
      set.count = offsets[i + 1] - offsets[i];
      set.data += static_cast<std::ptrdiff_t>(offsets[i]) * points.point_stride;
      if (plain && planar.append(set, part)) continue;
      try {
        if (!plain || !append_small_3d(set, part)) append(part, convex_hull(set, one));
      } catch (const Error& e) {
        if (e.code() == ErrorCode::cancelled) throw;
        throw Error(e.code(), "set " + std::to_string(i) + ": " + e.what());
      }
    }
  };
  HullBatch all;
  all.dimension = points.dimension;
  all.scalar = points.scalar;
  for (std::uint64_t first = 0; first < set_count; first += block) {
    run.report("hulls", static_cast<double>(first) / static_cast<double>(set_count));
    const std::uint64_t count = std::min(block, set_count - first);
    parts.resize(chunk_count(count, chunk));
    run.each_chunk(count, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      clear(parts[c]);
      try {
        hulls_of_chunk(parts[c], first + begin, first + end);
      } catch (const Error& e) {
        if (e.code() == ErrorCode::cancelled) throw;
        errors[c] = e;
      }
    });
    for (const std::optional<Error>& e : errors)
      if (e) throw *e;
    const double still = static_cast<double>(set_count) / static_cast<double>(first + count);
    Joiner(parts, run, still).run(all);
  }
  run.report("done", 1);
  return all;
}

}  // namespace cullhull
