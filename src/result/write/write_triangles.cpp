// Writes the result in 3D in three sweeps. The first visits the facets in the engine's order, in
// which neighbours are near in memory. It checks all ridges and writes a record of each facet, with
// all data that the result needs; each range of facets sorts its records into buckets by the lowest
// vertex. The second sweep takes a bucket's records from all ranges, sorts them in the cache and
// writes the facets in canonical order. The third renumbers the neighbours. The sums follow the
// canonical order and do not depend on ranges and buckets.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <functional>
#include <numeric>

#include "exact/orientation/orientation_3d.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure.hpp"
#include "result/write/bucket_sort.hpp"
#include "result/write/few_triangle_measures.hpp"
#include "result/write/hull_lists.hpp"
#include "result/write/triangle_lists.hpp"
#include "result/write/triangle_sweep.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;

/// Items in a chunk of the loops that read in random order: 5 to 20 microseconds of work.
constexpr std::uint64_t grain = std::uint64_t{1} << 12;

// -------------------------------------------------------------------------------- the vertices

/// The hull's vertices, and the position among them of each vertex number of the engine.
class Vertices3D {
 public:
  Vertices3D(const TriangleMesh& surface, const LocalPoints& points, const Id* order,
             const std::uint64_t* ids, const Run& run)
      : place_(order) {
    // By Euler's formula, F triangles of a hull have F / 2 + 2 vertices, so F = 2 V - 4.
    all_points_ = surface.live == 2 * std::uint64_t{points.count} - 4;
    resize_big(ids_, surface.live / 2 + 2);
    if (!all_points_) {
      number(surface, points.count, order, ids, run);
      return;
    }
    run.each(points.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t p = begin; p < end; ++p) ids_[p] = ids != nullptr ? ids[p] : p;
    });
  }

  std::vector<std::uint64_t>& ids() { return ids_; }
  /// The position of each vertex number of the engine.
  const Id* place() const { return place_; }
  /// The local id of the vertex at each position; null if every local point is a vertex.
  const Id* locals() const { return all_points_ ? nullptr : locals_.get(); }
  /// False if the number of vertices contradicts Euler's formula: the surface is not that of a
  /// hull.
  bool good() const { return good_; }

 private:
  /// Numbers the vertices when some points are not vertices.
  void number(const TriangleMesh& surface, Id points, const Id* order, const std::uint64_t* ids,
              const Run& run) {
    BigArray<std::uint8_t> used(surface.count), extreme(points);
    std::memset(used.get(), 0, surface.count);
    std::memset(extreme.get(), 0, points);
    const auto runs = surface.runs(grain);
    run.each_item(runs.size(), [&](std::uint64_t c) {
      for (Id f = runs[c].first; f < runs[c].second; ++f) {
        const Facet3D& facet = surface.facets[f];
        if (!facet.live()) continue;
        for (const Id v : facet.vertices)  // threads may set the same flag, to the same value
          std::atomic_ref<std::uint8_t>(used[v]).store(1, std::memory_order_relaxed);
      }
    });
    run.each(surface.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t v = begin; v < end; ++v)
        if (used[v] != 0)
          std::atomic_ref<std::uint8_t>(extreme[order[v]]).store(1, std::memory_order_relaxed);
    });
    BigArray<Id> position(points);
    const auto prepare = [&](std::uint64_t vertices) {
      good_ = vertices == ids_.size();
      if (good_) locals_ = BigArray<Id>(vertices);
      return good_;
    };
    pack(
        points, grain, run, [&](std::uint64_t p) { return extreme[p] != 0; }, prepare,
        [&](std::uint64_t p, std::uint64_t rank) {
      position[p] = static_cast<Id>(rank);
      locals_[rank] = static_cast<Id>(p);
      ids_[rank] = ids != nullptr ? ids[p] : p;
        });
    if (!good_) return;
    own_place_ = BigArray<Id>(surface.count);
    run.each(surface.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t v = begin; v < end; ++v)
        own_place_[v] = used[v] != 0 ? position[order[v]] : 0;
    });
    place_ = own_place_.get();
  }

  std::vector<std::uint64_t> ids_;
  BigArray<Id> locals_, own_place_;
  const Id* place_;
  bool all_points_ = false, good_ = true;
};

/// The local id of each vertex number of the engine, replaced by the lowest id of an equal point.
BigArray<Id> with_lowest_ids(const TriangleMesh& surface, Id points, const Run& run) {
  BigArray<Id> order(surface.count), lowest(points);
  run.each(points, grain, [&](std::uint64_t begin, std::uint64_t end) {
    std::iota(lowest.get() + begin, lowest.get() + end, static_cast<Id>(begin));
  });
  for (const auto& [duplicate, vertex] : surface.duplicates)
    lowest[vertex] = std::min(lowest[vertex], duplicate);
  run.each(surface.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) order[v] = lowest[surface.order[v]];
  });
  return order;
}

// ---------------------------------------------------------------------------------- the sweeps

/// The three sweeps.
class TriangleWriter {
 public:
  TriangleWriter(const ResultInput& input, TriangleMesh& surface, Vertices3D& vertices,
                 const Id* order, const Frame& frame, const Run& run, Hull& hull)
      : input_(input),
        surface_(surface),
        vertices_(vertices),
        order_(order),
        frame_(frame),
        plane_(frame),
        run_(run),
        hull_(hull),
        count_(surface.live),
        plain_(input.ids == nullptr && vertices.locals() == nullptr) {}

  bool run() {
    run_.report("ridges", 0);
    place_rows();
    divide();
    if (!sweep()) return false;
    const auto slots = surface_.used.back().second;
    surface_ = {};
    own_rows_ = {};
    run_.report("facets", 0);
    resize(slots);
    write_facets();
    records_ = {};
    run_.report("neighbours", 0);
    write_neighbours();
    run_.report("measures", 0);
    finish_simplicial<3>(input_, vertices_.ids(), frame_, runs_.get(), run_, hull_);
    return true;
  }

 private:
  // ---------------------------------------------------------------- first sweep

  /// Chooses the coordinates that the first sweep reads. If the engine's rows are the frame's times
  /// powers of two (no axis was translated), the sweep uses the engine's rows. Otherwise the
  /// frame's rows are copied into the engine's order.
  void place_rows() {
    source_.facets = surface_.facets.data();
    source_.place = vertices_.place();
    source_.exact_doubles = input_.local->small_lattice;
    std::copy_n(frame_.at(0), 3, source_.origin);
    if (find_factors()) {
      source_.rows = surface_.rows.get();
      return;
    }
    std::fill_n(source_.factor, 3, 1.0);
    own_rows_ = BigArray<double>(std::size_t{surface_.count} * Shared3D::row_stride);
    const auto vertices = static_cast<Id>(vertices_.ids().size());
    run_.each(surface_.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t v = begin; v < end; ++v) {
        const Id place = std::min(vertices - 1, source_.place[v]);
        double* row = own_rows_.get() + v * Shared3D::row_stride;
        std::memcpy(row, frame_.at(place), 3 * sizeof(double));
        row[3] = 0;
      }
    });
    source_.rows = own_rows_.get();
  }

  /// Derives the factors from one vertex with a nonzero coordinate for each axis. Returns whether
  /// they map the rows of all vertices to the frame's, bit for bit.
  bool find_factors() {
    const auto local_row = [&](std::uint64_t v) {
      const Id* locals = vertices_.locals();
      return input_.local->row(locals != nullptr ? locals[v] : static_cast<Id>(v));
    };
    const std::uint64_t count = vertices_.ids().size();
    for (unsigned c = 0; c < 3; ++c) {
      std::uint64_t v = 0;
      while (v < count && local_row(v)[c] == 0) ++v;
      source_.factor[c] = v < count ? frame_.at(static_cast<Id>(v))[c] / local_row(v)[c] : 1;
    }
    std::atomic<bool> same{true};
    run_.each(count, grain, [&](std::uint64_t begin, std::uint64_t end) {
      if (!same.load(std::memory_order_relaxed)) return;
      std::uint64_t different = 0;
      for (std::uint64_t v = begin; v < end; ++v) {
        const double* given = frame_.at(static_cast<Id>(v));
        const double* ours = local_row(v);
        for (unsigned c = 0; c < 3; ++c)
          different |= std::bit_cast<std::uint64_t>(given[c]) ^
                       std::bit_cast<std::uint64_t>(ours[c] * source_.factor[c]);
      }
      if (different != 0) same = false;
    });
    return same;
  }

  /// Divides the lowest vertices into buckets of about 4096 facets, and the facets into ranges of
  /// 4096, so that each fits the L2 cache (2048 and 8192 were no faster); of fewer, where there
  /// would be too few for the threads.
  void divide() {
    constexpr std::uint64_t usual = 4096, least = 256;
    const std::uint64_t share = count_ / (4 * std::uint64_t{run_.threads});
    const auto stretch =
        static_cast<Id>(run_.threads == 1 ? usual : std::clamp(share, least, usual));
    const auto vertex_count = static_cast<Id>(vertices_.ids().size());
    shift_ = bucket_shift(count_, vertex_count, stretch);
    buckets_ = ((vertex_count - 1U) >> shift_) + 1;
    stretches_ = surface_.runs(stretch);
    region_.assign(stretches_.size() + 1, 0);
    for (std::size_t s = 0; s < stretches_.size(); ++s)
      region_[s + 1] = region_[s] + (stretches_[s].second - stretches_[s].first);
  }

  /// The first sweep. Returns false if some facets are coplanar or the surface is not that of a
  /// hull.
  bool sweep() {
    records_ = BigArray<TriangleRecord>(region_.back());
    starts_ = BigArray<Id>(stretches_.size() * (std::size_t{buckets_} + 1));
    std::vector<Counts> counts(stretches_.size());
    run_.each_item(stretches_.size(), [&](std::uint64_t s) {
      if (!stop_.load(std::memory_order_relaxed)) sweep_stretch(s, counts[s]);
    });
    if (stop_) return false;
    std::uint64_t live = 0;
    for (const Counts& c : counts) live += c.live;
    if (live != count_) return false;
    for (const Counts& c : counts) c.rungs.add_to(hull_.statistics.rung_counts);
    bucket_start_.assign(buckets_ + std::size_t{1}, 0);
    run_.each(buckets_, 64, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::size_t s = 0; s < stretches_.size(); ++s) {
        const Id* start = starts_.get() + s * (std::size_t{buckets_} + 1);
        for (std::uint64_t b = begin; b < end; ++b) bucket_start_[b] += start[b + 1] - start[b];
      }
    });
    exclusive_scan(bucket_start_);
    return true;
  }

  struct Counts {
    std::uint64_t live = 0;
    RungCounts rungs;
  };

  /// Checks and distributes the facets of range s.
  void sweep_stretch(std::uint64_t s, Counts& out) {
    const auto [begin, end] = stretches_[s];
    TriangleRecord* region = records_.get() + region_[s];
    Id* start = starts_.get() + s * (std::size_t{buckets_} + 1);
    std::vector<Id> next(buckets_, 0);
    out.live = count_triangles(source_, begin, end, shift_, next.data(), region);
    Id sum = 0;
    for (Id b = 0; b < buckets_; ++b) {
      start[b] = sum;
      sum += std::exchange(next[b], sum);
    }
    start[buckets_] = sum;
    std::vector<OpenRidge> open;
    if (!sweep_triangles(source_, begin, end, shift_, next.data(), region, open)) stop_ = true;
    for (const OpenRidge& r : open) {
      if (stop_.load(std::memory_order_relaxed)) return;
      if (exact_side(r, out) != Sign::negative) stop_ = true;
    }
    out.rungs.of[0] += out.live * 3 / 2 - open.size();  // a ridge belongs to two facets
  }

  /// The exact sign of a ridge that doubles could not decide: negative if it is convex.
  Sign exact_side(const OpenRidge& r, Counts& out) const {
    const auto point = [&](Id v) {
      return Orientation3D::Point{surface_.rows.get() + std::size_t{v} * Shared3D::row_stride,
                                  order_[v]};
    };
    const Id* v = surface_.facets[r.facet].vertices;
    return surface_.predicates->side(point(v[0]), point(v[1]), point(v[2]), point(r.across),
                                     out.rungs);
  }

  // ---------------------------------------------------------------- second sweep

  void resize(Id slots) {
    simplices_.resize(count_ * 3);
    next_.resize(count_ * 3);
    hull_.facet_planes.resize(count_ * 4);
    rank_ = BigArray<Id>(slots);
    runs_ = BigArray<Share<3>>(chunk_count(count_, measure_run));
    cut_.resize(buckets_);
  }

  /// Scratch of one thread.
  struct Scratch {
    BucketSort<std::uint64_t> sorted;  // keys: second vertex, then the record's index
    TriangleShares shares;
    alignas(64) double planes[4 * shares_at_once];
  };
  /// The shares of those facets of a bucket whose run continues in the bucket before (head) or
  /// after (tail).
  struct Cut {
    std::vector<Share<3>> head, tail;
  };

  /// The second sweep.
  void write_facets() {
    // One by one: the first buckets have three times as many facets as the mean, as a facet is in
    // the bucket of its lowest vertex.
    run_.each_item(buckets_, [&](std::uint64_t b) {
      Scratch scratch;
      sort(static_cast<Id>(b), scratch.sorted);
      write_bucket(static_cast<Id>(b), scratch);
    });
    join_cut_runs();
  }

  /// Calls body(first, last) for the records of bucket b in each range of facets.
  template <class Body>
  void each_segment(Id b, const Body& body) const {
    const std::size_t row = std::size_t{buckets_} + 1;
    const Id* start = starts_.get() + b;
    for (std::size_t s = 0; s < stretches_.size(); ++s, start += row)
      body(region_[s] + start[0], region_[s] + start[1]);
  }

  /// Sorts bucket b by the lowest and the second vertex, in which any two facets differ.
  void sort(Id b, BucketSort<std::uint64_t>& sorted) const {
    const Id base = b << shift_;
    sorted.sort(
        bucket_start_[b + 1] - bucket_start_[b], std::size_t{1} << shift_,
        [&](const auto& visit) {
      each_segment(b, [&](Id first, Id last) {
        for (Id i = first; i < last; ++i) visit(i);
      });
        },
        [&](Id i) { return records_[i].vertex[0] - base; },
        [&](Id i) {
      prefetch_line_to_write(&rank_[records_[i].slot]);
      return std::uint64_t{records_[i].vertex[1]} << 32 | i;
    },
        std::less<>());
  }

  /// Writes the facets of sorted bucket b run by run.
  void write_bucket(Id b, Scratch& scratch) {
    const std::uint64_t begin = bucket_start_[b], end = bucket_start_[b + 1];
    for (std::uint64_t at = begin; at < end;) {
      const std::uint64_t run = at / measure_run;
      const std::uint64_t to = std::min(end, (run + 1) * measure_run);
      const TriangleRecord* records[measure_run];
      const auto size = static_cast<unsigned>(to - at);
      for (unsigned k = 0; k < size; ++k) {
        records[k] = &records_[static_cast<Id>(scratch.sorted[at - begin + k])];
        write_simplex(at + k, *records[k]);
      }
      write_planes(at, records, size, scratch);
      const bool whole = at % measure_run == 0 && (size == measure_run || to == count_);
      if (whole)
        runs_[run] = scratch.shares.sum(0, size);
      else
        keep_shares(at % measure_run != 0 ? cut_[b].head : cut_[b].tail, scratch.shares, size);
      at = to;
    }
  }

  void write_simplex(std::uint64_t i, const TriangleRecord& r) {
    rank_[r.slot] = static_cast<Id>(i);
    std::uint64_t* simplex = simplices_.data() + i * 3;
    Id* across = next_.data() + i * 3;
    for (unsigned j = 0; j < 3; ++j) {
      simplex[j] = plain_ ? r.vertex[j] : vertices_.ids()[r.vertex[j]];
      across[j] = r.neighbour[j];  // renumbered in the third sweep
    }
  }

  /// Computes planes and shares of facets [at, at + size): with vectors, and singly for those that
  /// need more care.
  void write_planes(std::uint64_t at, const TriangleRecord* const* records, unsigned size,
                    Scratch& scratch) {
    double* planes = hull_.facet_planes.data() + at * 4;
    const bool direct = size == shares_at_once;
    const bool scaled = frame_.exponent > -1022 && frame_.exponent < 1023;
    std::uint32_t left =
        triangle_shares(records, size, frame_.at(0), frame_.at(0), scale_by(1, frame_.exponent),
                        scratch.shares, direct ? planes : scratch.planes);
    if (!direct) std::copy_n(scratch.planes, std::size_t{4} * size, planes);
    if (!scaled) left = static_cast<std::uint32_t>((std::uint64_t{1} << size) - 1);
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<unsigned>(std::countr_zero(left));
      const TriangleRecord& r = *records[k];
      const Share<3> share =
          facet_share(frame_, plane_, r.vertex, r.thin != 0, r.normal, r.sum, planes + 4 * k);
      scratch.shares.set(k, share);
    }
  }

  static void keep_shares(std::vector<Share<3>>& out, const TriangleShares& s, unsigned size) {
    for (unsigned k = 0; k < size; ++k) out.push_back(s.at(k));
  }

  /// Sums the runs that cross borders between buckets, in canonical order: each begins with the
  /// tail of a bucket.
  void join_cut_runs() {
    run_.each(buckets_, 64, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t b = begin; b < end; ++b) {
        const std::vector<Share<3>>& tail = cut_[b].tail;
        if (tail.empty()) continue;
        Share<3> run;
        std::uint64_t left = measure_run;
        const auto add = [&](const std::vector<Share<3>>& shares) {
          for (const Share<3>& share : shares) run.add(share);
          left -= shares.size();
        };
        add(tail);
        for (std::uint64_t next = b + 1; left > 0 && next < buckets_; ++next) add(cut_[next].head);
        runs_[(bucket_start_[b + 1] - tail.size()) / measure_run] = run;
      }
    });
  }

  // ---------------------------------------------------------------- third sweep and sums

  /// The third sweep: renumbers the neighbours and moves the lists into the result.
  void write_neighbours() {
    Array<Id> neighbours(count_ * 3);
    run_.each(count_, grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        Id* next = next_.data() + i * 3;
        Id* across = neighbours.data() + i * 3;
        for (unsigned j = 0; j < 3; ++j) {
          if (i + ahead < end) prefetch_line(&rank_[next[j + ahead * 3]]);
          next[j] = rank_[next[j]];
        }
        // The edge from vertex j is opposite to vertex j + 2.
        for (unsigned j = 0; j < 3; ++j) across[j] = next[(j + 2) % 3];
      }
    });
    keep_simplicial(3, std::move(simplices_), {}, std::move(next_), std::move(neighbours), hull_);
  }

  /// Prefetch distance in facets. Without prefetching the hull of 1M points on a sphere takes 37%
  /// more time; distances of 4, 8 and 32 differ by less than 3%.
  static constexpr std::uint64_t ahead = 16;

  const ResultInput& input_;
  TriangleMesh& surface_;
  Vertices3D& vertices_;
  const Id* const order_;
  const Frame& frame_;
  const FacetPlane<3> plane_;
  const Run& run_;
  Hull& hull_;
  const std::uint64_t count_;
  const bool plain_;  // a vertex's position is its id
  TriangleSource source_;
  BigArray<double> own_rows_;
  unsigned shift_ = 0;
  Id buckets_ = 0;
  std::vector<TriangleMesh::Run> stretches_;
  std::vector<Id> region_;  // first record of each range
  BigArray<Id> starts_;     // ranges x (buckets + 1): beginning of each bucket in a range
  std::vector<Id> bucket_start_;
  BigArray<TriangleRecord> records_;
  std::atomic<bool> stop_{false};
  Array<std::uint64_t> simplices_;
  Array<Id> next_;     // the neighbours of the simplices
  BigArray<Id> rank_;  // canonical number of each of the engine's slots
  BigArray<Share<3>> runs_;
  std::vector<Cut> cut_;
};

/// Writes ids as the caller counts them: those with the given names, which ascend; nullptr: 0, 1,
/// ...
template <class Number>
void put_ids(const Number* from, std::size_t count, const std::uint64_t* names, std::uint64_t* to) {
  if (names == nullptr) return widen(from, count, to);
  for (std::size_t i = 0; i < count; ++i) to[i] = names[from[i]];
}

/// The measures of hulls so thin that sums in doubles are not accurate, as finish_simplicial() has
/// them.
void measure_again(const TriangleLists& lists, const PointView& points, const Run& run,
                   Hull& hull) {
  std::vector<std::uint64_t> vertices(points.count);
  std::iota(vertices.begin(), vertices.end(), std::uint64_t{0});
  static constexpr unsigned axes[3] = {0, 1, 2};
  measure_thin(points, vertices, {lists.vertices.begin(), lists.vertices.end()}, axes, run, hull);
}

}  // namespace

template <class Points, class Small, class Target>
bool write_few_triangles(const PointView& view, const std::uint64_t* names, const Points& points,
                         const Small& small, SmallShares<Small::max_facets>& shares,
                         Target& target) {
  const std::size_t n = small.count;
  std::size_t corners = 3 * n;
  if (!small.simplicial())
    corners =
        std::accumulate(small.facet_size, small.facet_size + small.facet_count, std::size_t{0});
  NewLists<Target> to({3, small.vertex_count, n, small.facet_count, corners, corners}, target, 64);
  Measures measures;
  if (!SmallMeasurer(view, names, points, small, shares).run(to.planes, measures)) return false;
  write_measures(3, view.count, measures.volume, measures.area, measures.centroid, target);
  std::uint64_t* const vertices = to.vertices();
  for (unsigned i = 0; i < small.vertex_count; ++i)
    vertices[i] = names != nullptr ? names[small.ids[i]] : small.ids[i];
  put_ids(small.vertices, 3 * n, names, to.simplices);
  widen(small.opposite, 3 * n, to.simplex_neighbours);
  widen(small.beside, corners, to.facet_neighbours);
  if (to.facets != nullptr)
    put_ids(small.simplicial() ? small.vertices : small.corners, corners, names, to.facets);
  if (!small.simplicial()) widen(small.facet_of, n, to.simplex_facets);
  const auto size = [&](std::size_t i) { return small.facet_size[i]; };
  to.keep(size, size);
  return true;
}
template bool write_few_triangles(const PointView&, const std::uint64_t*, const SmallPoints3D&,
                                  const SmallHull3D&, SmallShares<SmallHull3D::max_facets>&, Hull&);
template bool write_few_triangles(const PointView&, const std::uint64_t*, const SmallPoints3D&,
                                  const SmallHull3D&, SmallShares<SmallHull3D::max_facets>&,
                                  HullBatch&);
template bool write_few_triangles(const PointView&, const std::uint64_t*, const MediumPoints3D&,
                                  const MediumHull3D&, SmallShares<MediumHull3D::max_facets>&,
                                  Hull&);

bool write_triangles(const ResultInput& input, TriangleMesh& surface, const Run& run, Hull& hull) {
  if (input.view->dimension != 3 || surface.live < 4) return false;
  BigArray<Id> lowest;
  if (!surface.duplicates.empty()) lowest = with_lowest_ids(surface, input.local->count, run);
  const Id* order = surface.duplicates.empty() ? surface.order.get() : lowest.get();
  Vertices3D vertices(surface, *input.local, order, input.ids, run);
  if (!vertices.good()) return false;
  const Frame frame = make_frame(*input.view, vertices.ids(), input.axes, 3, run);
  if (frame.wild) return false;
  if (!TriangleWriter(input, surface, vertices, order, frame, run, hull).run()) return false;
  hull.vertices = std::move(vertices.ids());
  return true;
}

bool write_measures(const TriangleLists& lists, Hull& hull) {
  Measures m;
  if (!finish_plain<3>(PointView::row_major(lists.first, 1, 3), 0, lists.exponent, lists.sums, m))
    return false;
  write_measures(3, hull.point_count, m.volume, m.area, m.centroid, hull);
  return true;
}

void write_lists(TriangleLists&& lists, const PointView& points, const std::uint64_t* ids,
                 const Run& run, Hull& hull) {
  const std::uint32_t count = lists.count();
  const auto id = [ids](std::uint64_t v) { return ids != nullptr ? ids[v] : v; };
  hull.affine_dimension = 3;
  resize_big(hull.vertices, points.count);
  run.each(hull.vertices.size(), grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) hull.vertices[v] = id(v);
  });
  Array<std::uint64_t> simplices(lists.vertices.size());
  Array<std::uint32_t> across(lists.neighbours.size());
  run.each(count, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = 3 * begin; i < 3 * end; ++i) simplices[i] = id(lists.vertices[i]);
    // The edge from vertex j is opposite to vertex j + 2.
    for (std::uint64_t i = 3 * begin; i < 3 * end; i += 3)
      for (unsigned j = 0; j < 3; ++j) across[i + j] = lists.neighbours[i + (j + 2) % 3];
  });
  if (!write_measures(lists, hull)) measure_again(lists, points, run, hull);
  hull.facet_planes = std::move(lists.planes);
  keep_simplicial(3, std::move(simplices), {}, std::move(lists.neighbours), std::move(across),
                  hull);
}

}  // namespace cullhull::internal
