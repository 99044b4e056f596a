#include "batch/batch_maker.hpp"

#include <algorithm>
#include <utility>

#include "cullhull/hull.hpp"
#include "few/few_in_space.hpp"
#include "filter/ways.hpp"
#include "result/write/hull_lists.hpp"

namespace cullhull::internal {
namespace {

/// Empties a batch but keeps its memory.
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
  /// `still`: the number of all sets divided by the number joined after this call. Lists that grow
  /// reserve memory for this multiple of their size.
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
    run_.each_item(parts_.size(), [&](std::uint64_t p) {
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
      for (std::size_t i = 1; i < offsets.size(); ++i) out[at[p] + i - 1] = base[p] + offsets[i];
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
  std::vector<std::function<void(std::uint64_t)>> copies_;  // each copies part p into a list
};

}  // namespace

SetHuller::SetHuller(const Run& run) : options_(run.options), polygon_(run.control) {
  options_.threads = 1;
  options_.progress = nullptr;
  options_.poll = nullptr;  // only for the calling thread; this may run on another
}

void SetHuller::append(const PointView& set, HullBatch& to) {
  // Small sets are not filtered, whatever filter was chosen.
  const bool at_once = permits_few(
      {.dimension = set.dimension, .backend = options_.backend, .budget = options_.memory_budget});
  if (at_once && ((polygon_.find(set) && polygon_.write(set, to)) || append_small_3d(set, to)))
    return;
  internal::append(to, convex_hull(set, options_));
}

void SetHuller::append(const FoundHull& found, HullBatch& to) {
  const std::size_t vertices = to.vertices.items.size(), facets = to.facets.items.size(),
                    simplices = to.simplices.items.size();
  if (found.simplices == nullptr ||
      !append_simplices_3d(found.rows, found.simplices, found.simplex_count, to))
    append(found.rows, to);
  const auto rename = [&](Array<std::uint64_t>& items, std::size_t begin) {
    for (std::size_t i = begin; i < items.size(); ++i) items[i] = found.ids[items[i]];
  };
  rename(to.vertices.items, vertices);
  rename(to.facets.items, facets);
  rename(to.simplices.items, simplices);
  to.point_counts.back() = found.point_count;
}

namespace {

/// The mean number of a set's points, rounded up.
std::uint64_t mean_of(std::uint64_t sets, std::uint64_t points) {
  return sets > 0 ? points / sets + 1 : 1;
}

/// Sets per task: an even division among threads against the cost of starting a task (about a
/// microsecond). Half as many cost sets of 10 points 3 %, and of 4 points 8 %; sets of 64 nothing.
std::uint64_t chunk_of(std::uint64_t mean) { return mean < 32 ? 32 : 16; }

/// The number of sets in a block. A block's parts are joined while they are in the cache, and the
/// next block reuses their memory. A block has about 65,000 points, and 16,000 for one thread in
/// space, whose larger hulls then fit its own L2 cache.
std::uint64_t block_of(std::uint32_t dimension, std::uint64_t mean, unsigned threads) {
  const bool few = threads == 1 && dimension > 2;
  const std::uint64_t chunk = chunk_of(mean);
  const std::uint64_t together = (few ? 1U << 14 : 1U << 16) / (mean * chunk);
  const std::uint64_t fewest = few ? 4 : std::max(32U, 4 * threads);
  return chunk * std::clamp<std::uint64_t>(together, fewest, fewest + 128);
}

}  // namespace

BatchMaker::BatchMaker(std::uint32_t dimension, ScalarType scalar, std::uint64_t sets,
                       std::uint64_t points, const Run& run)
    : run_(run),
      sets_(sets),
      chunk_(chunk_of(mean_of(sets, points))),
      block_(block_of(dimension, mean_of(sets, points), run.threads)) {
  all_.dimension = dimension;
  all_.scalar = scalar;
}

void BatchMaker::add(std::uint64_t count, const Append& append, const Number& number) {
  parts_.resize(std::min(block_ / chunk_, chunk_count(count, chunk_)));
  errors_.assign(parts_.size(), std::nullopt);
  for (std::uint64_t first = 0; first < count; first += block_) {
    run_.report("hulls", static_cast<double>(done_) / static_cast<double>(sets_));
    const std::uint64_t sets = std::min(block_, count - first);
    parts_.resize(chunk_count(sets, chunk_));
    run_.each_chunk(sets, chunk_, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      add_chunk(c, first + begin, first + end, append, number);
    });
    for (const std::optional<Error>& e : errors_)
      if (e) throw *e;
    done_ += sets;
    const double still = static_cast<double>(sets_) / static_cast<double>(done_);
    Joiner(parts_, run_, still).run(all_);
  }
}

void BatchMaker::add_chunk(std::uint64_t c, std::uint64_t begin, std::uint64_t end,
                           const Append& append, const Number& number) {
  HullBatch& part = parts_[c];
  clear(part);
  part.dimension = all_.dimension;
  SetHuller huller(run_);
  std::uint64_t i = begin;
  try {
    for (; i < end; ++i) append(huller, i, part);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled) throw;
    const std::uint64_t set = number ? number(i) : i;
    errors_[c] = Error(e.code(), "set ", set, ": ", e.what());
  }
}

HullBatch BatchMaker::finish() && {
  run_.report("done", 1);
  return std::move(all_);
}

}  // namespace cullhull::internal
