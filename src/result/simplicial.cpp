// Three sweeps. The first runs over the simplices as the engine left them, neighbours near
// neighbours, so a vertex comes from memory once and not once for each of its facets: it computes
// normals, decides all ridges, and writes a record of everything the result needs to know about a
// facet into the bucket of its lowest vertex. The second sorts each bucket in the cache and writes
// the facets out, in order. The third renumbers the neighbours. The sums follow the canonical
// order, whatever the buckets are.
#include "result/simplicial.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "parallel/big_array.hpp"
#include "parallel/parallel.hpp"
#include "parallel/touch.hpp"
#include "predicates/cofactors.hpp"
#include "predicates/orientation.hpp"
#include "result/facet_kernel.hpp"
#include "result/facet_plane.hpp"
#include "result/facet_share.hpp"
#include "result/simplicial_measures.hpp"
#include "result/simplicial_nd.hpp"

namespace cullhull::internal {
namespace {

/// What the second sweep needs to know of a simplex. Vertices by position, in stored order.
template <unsigned K>
struct Record {
  std::uint32_t vertex[K];
  std::uint32_t simplex;       // in the engine's order
  std::uint32_t neighbour[K];  // the same
  std::uint32_t thin;          // the normal needs more bits than it got
  double normal[K];
  double sum[K];  // of the corners' differences from vertex 0
};

template <unsigned K>
class Simplicial {
 public:
  Simplicial(const ResultInput& input, const Surface& surface, const VertexList& vertices,
             const Frame& frame, unsigned threads, const Control& control, Hull& hull)
      : input_(input),
        surface_(surface),
        vertices_(vertices),
        frame_(frame),
        plane_(frame),
        threads_(threads),
        control_(control),
        hull_(hull),
        count_(surface.count()) {}

  bool run() {
    control_.report("ridges", 0);
    divide();
    if (!scan()) return false;
    control_.report("facets", 0);
    resize();
    write_facets();
    records_ = {};
    control_.report("neighbours", 0);
    write_neighbours();
    control_.report("measures", 0);
    finish();
    return true;
  }

 private:
  static constexpr unsigned lanes = FacetBlock<K>::lanes;
  static constexpr bool shared = facets_are_simplices(K);

  // ---------------------------------------------------------------- first sweep

  /// Buckets of consecutive lowest vertices, and where in a bucket each chunk of simplices writes:
  /// the arrangement depends on sizes alone.
  void divide() {
    const auto vertex_count = static_cast<std::uint32_t>(vertices_.ids.size());
    const std::uint64_t wanted =
        std::clamp<std::uint64_t>(std::bit_ceil(count_ / 1024), 1, max_buckets);
    const int bits = std::bit_width(vertex_count - 1U) - std::countr_zero(wanted);
    shift_ = static_cast<unsigned>(std::max(bits, 0));
    buckets_ = ((vertex_count - 1U) >> shift_) + 1;
    const std::uint64_t chunks = chunk_count(count_, simplex_chunk);
    next_.assign(chunks * buckets_, 0);
    for_each_chunk(count_, simplex_chunk, threads_,
                   [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     std::uint32_t* counts = next_.data() + chunk * buckets_;
                     for (std::uint64_t f = begin; f < end; ++f)
                       ++counts[vertices_.position(surface_.stored(f, 0)) >> shift_];
                   });
    bucket_start_.assign(buckets_ + std::size_t{1}, 0);
    std::uint32_t sum = 0;
    for (std::uint32_t b = 0; b < buckets_; ++b) {
      bucket_start_[b] = sum;
      for (std::uint64_t c = 0; c < chunks; ++c) sum += std::exchange(next_[c * buckets_ + b], sum);
    }
    bucket_start_[buckets_] = sum;
  }

  struct ChunkCounts {
    std::uint64_t ridges = 0;
    std::uint64_t rungs[3] = {0, 0, 0};
  };

  /// False if some simplices are coplanar.
  bool scan() {
    records_ = BigArray<Record<K>>(count_);
    touch_pages(records_.get(), count_ * sizeof(Record<K>), threads_, [&] { control_.check(); });
    std::vector<ChunkCounts> counts(chunk_count(count_, simplex_chunk));
    for_each_chunk(count_, simplex_chunk, threads_,
                   [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     scan_chunk(begin, end, next_.data() + chunk * buckets_, counts[chunk]);
                   });
    if (coplanar_.load()) return false;
    std::uint64_t ridges = 0;
    for (const ChunkCounts& c : counts) {
      ridges += c.ridges;
      for (unsigned i = 0; i < 3; ++i) hull_.statistics.rung_counts[i] += c.rungs[i];
    }
    // Each ridge was matched from its lower simplex to one slot of the higher: half of all slots.
    if (2 * ridges != surface_.ids.size()) fail_not_exact("a ridge is not shared by two facets");
    return true;
  }

  /// A ridge towards a higher simplex; first that simplex, then its vertex off the ridge.
  struct Ridge {
    std::uint32_t simplex, across, slot;
  };
  static constexpr unsigned batch = 8 * lanes;

  static void fetch_to_write(const Record<K>* r) {
    for (std::size_t byte = 0; byte < sizeof *r; byte += 64)
      __builtin_prefetch(reinterpret_cast<const char*>(r) + byte, 1);
  }

  /// Batches that are looked through twice: first for what they refer to, which is asked for, then
  /// to compute with it.
  void scan_chunk(std::uint64_t begin, std::uint64_t end, std::uint32_t* next, ChunkCounts& out) {
    FacetBlock<K> block;
    for (unsigned c = 0; c < K; ++c) std::fill_n(block.origin[c], lanes, frame_.at(0)[c]);
    std::uint32_t corners[lanes][K];
    Ridge ridges[batch * K + 1];
    for (std::uint64_t f = begin; f < std::min(end, begin + batch); ++f) prefetch(f);
    for (std::uint64_t from = begin; from < end; from += batch) {
      if (coplanar_.load(std::memory_order_relaxed)) return;
      const std::uint64_t to = std::min<std::uint64_t>(end, from + batch);
      const unsigned ridge_count = find_ridges(from, to, ridges);
      out.ridges += ridge_count;
      unsigned ridge = 0;
      for (std::uint64_t first = from; first < to; first += lanes) {
        const auto n = static_cast<unsigned>(std::min<std::uint64_t>(lanes, to - first));
        for (unsigned lane = 0; lane < lanes; ++lane) {
          const std::uint64_t f = first + std::min(lane, n - 1);
          prefetch(f + batch);
          load(f, corners[lane]);
          for (unsigned j = 0; j < K; ++j) {
            const double* p = frame_.at(corners[lane][j]);
            for (unsigned c = 0; c < K; ++c) block.corner[j][c][lane] = p[c];
          }
        }
        facet_block(block);
        for (; ridge < ridge_count && ridges[ridge].simplex < first + n; ++ridge)
          check_convex(ridges[ridge], block, static_cast<unsigned>(ridges[ridge].simplex - first),
                       out);
        for (unsigned lane = 0; lane < n; ++lane) {
          Record<K>* r = &records_[next[corners[lane][0] >> shift_]++];
          write_record(first + lane, corners[lane], block, lane, *r);
          fetch_to_write(r + 1);  // stores wait in line for those that miss
        }
      }
    }
  }

  void prefetch(std::uint64_t f) const {
    if (f >= count_) return;
    for (unsigned i = 0; i < K; ++i) {
      const std::size_t g = surface_.neighbours[f * K + i];
      __builtin_prefetch(surface_.ids.data() + g * K);
      __builtin_prefetch(surface_.neighbours.data() + g * K);
      if (vertices_.all_points)
        __builtin_prefetch(frame_.at(surface_.ids[f * K + i]));
      else
        __builtin_prefetch(&vertices_.positions[surface_.ids[f * K + i]]);
    }
  }

  /// The ridges of simplices [begin, end) towards higher ones; each must be shared by two simplices
  /// that are oriented alike. Which of two simplices is the higher is as good as random: no branch.
  unsigned find_ridges(std::uint64_t begin, std::uint64_t end, Ridge* ridges) const {
    unsigned count = 0;
    bool twice = false, open = false;
    for (std::uint64_t f = begin; f < end; ++f) {
      const std::uint32_t* ids = surface_.simplex(f);
      for (unsigned i = 1; i < K; ++i) twice |= ids[i - 1] == ids[i];
      for (unsigned i = 0; i < K; ++i) {
        const std::uint32_t g = surface_.neighbours[f * K + i];
        open |= g >= count_ || g == f;
        ridges[count] = {static_cast<std::uint32_t>(f), g, i};
        count += g > f;
      }
    }
    if (twice) fail_not_exact("a simplex uses a point twice");
    if (open) fail_not_exact("a ridge has no second facet");
    for (unsigned r = 0; r < count; ++r) {
      const std::uint32_t g = ridges[r].across;
      const unsigned j = opposite_slot<K>(surface_, ridges[r].simplex, ridges[r].slot, g);
      ridges[r].across = surface_.simplex(g)[j];
      __builtin_prefetch(frame_.at(vertices_.position(ridges[r].across)));
    }
    return count;
  }

  /// Positions of the vertices in stored order.
  void load(std::uint64_t f, std::uint32_t* corners) const {
    const std::uint32_t* ids = surface_.simplex(f);
    for (unsigned j = 0; j < K; ++j) corners[j] = vertices_.position(ids[j]);
    const std::uint32_t a = corners[K - 2], b = corners[K - 1];
    corners[K - 2] = surface_.odd[f] ? b : a;
    corners[K - 1] = surface_.odd[f] ? a : b;
  }

  void check_convex(const Ridge& ridge, const FacetBlock<K>& block, unsigned lane,
                    ChunkCounts& out) {
    const double* p = frame_.at(vertices_.position(ridge.across));
    double side = 0, largest = 0;
    for (unsigned c = 0; c < K; ++c) {
      const double d = p[c] - block.corner[0][c][lane];
      side = side + block.normal[c][lane] * d;
      largest = std::max(largest, std::fabs(d));
    }
    // Simplices are outward oriented here, so `side` is negative where the ridge is convex.
    Sign sign = sign_of(side);
    const double bound = determinant_error(K) * block.reach[lane] * largest + determinant_tiny;
    if (std::fabs(side) > bound || input_.local->small_lattice)
      ++out.rungs[0];
    else
      sign = exact_side(ridge.simplex, ridge.across, out);
    if (sign == Sign::positive) fail_not_exact("a ridge is not convex");
    if (sign == Sign::zero) coplanar_.store(true, std::memory_order_relaxed);
  }

  Sign exact_side(std::uint64_t f, std::uint32_t x, ChunkCounts& out) const {
    const double* rows[K + 1];
    for (unsigned j = 0; j < K; ++j) rows[j] = input_.local->exact_row(surface_.stored(f, j));
    rows[K] = input_.local->exact_row(x);
    Rung rung = Rung::exact;
    const Sign sign = orientation(K, rows, &rung);
    ++out.rungs[static_cast<unsigned>(rung)];
    return sign;
  }

  void write_record(std::uint64_t f, const std::uint32_t* corners, const FacetBlock<K>& block,
                    unsigned lane, Record<K>& r) const {
    const std::uint32_t* across = surface_.neighbours.data() + f * K;
    r.simplex = static_cast<std::uint32_t>(f);
    r.thin = !(block.length[lane] > conditioned * block.edges[lane]);
    for (unsigned j = 0; j < K; ++j) {
      r.vertex[j] = corners[j];
      r.neighbour[j] = across[surface_.stored_slot(f, j)];
      r.normal[j] = block.normal[j][lane];
      r.sum[j] = block.sum[j][lane];
    }
  }

  // ---------------------------------------------------------------- second sweep

  void resize() {
    simplices_.resize(count_ * K);
    if constexpr (!shared) facets_.resize(count_ * K);
    hull_.simplex_neighbours.resize(count_ * K);
    hull_.facet_planes.resize(count_ * (K + 1));
    rank_ = BigArray<std::uint32_t>(count_);
    runs_ = BigArray<Share<K>>(chunk_count(count_, measure_run));
    cut_.resize(buckets_);
  }

  struct Key {
    std::uint64_t rest;  // the second and third vertex
    std::uint32_t record;
  };
  /// Memory of one chunk of buckets.
  struct Scratch {
    std::vector<std::uint32_t> start;
    std::vector<Key> keys;
  };
  /// Shares of the facets of a bucket that begin before or end after the runs inside it.
  struct Cut {
    std::vector<Share<K>> head, tail;
  };

  void write_facets() {
    for_each_chunk(buckets_, 4, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     Scratch scratch;
                     for (std::uint64_t b = begin; b < end; ++b) {
                       sort(static_cast<std::uint32_t>(b), scratch);
                       write_bucket(static_cast<std::uint32_t>(b), scratch);
                     }
                   });
    join_cut_runs();
  }

  /// Counting sort on the lowest vertex, then by the others.
  void sort(std::uint32_t b, Scratch& scratch) {
    const std::uint32_t base = b << shift_;
    const std::uint32_t begin = bucket_start_[b], end = bucket_start_[b + 1];
    scratch.start.assign((std::size_t{1} << shift_) + 1, 0);
    scratch.keys.resize(end - begin);
    std::uint32_t* start = scratch.start.data();
    for (std::uint32_t i = begin; i < end; ++i) ++start[records_[i].vertex[0] - base + 1];
    for (std::size_t v = 1; v < scratch.start.size(); ++v) start[v] += start[v - 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const Record<K>& r = records_[i];
      __builtin_prefetch(&rank_[r.simplex], 1);
      const std::uint64_t second = r.vertex[1], third = K > 2 ? r.vertex[K > 2 ? 2 : 0] : 0;
      scratch.keys[start[r.vertex[0] - base]++] = {second << 32 | third, i};
    }  // start[v] is now the end of vertex v's keys
    const auto less = [this](const Key& x, const Key& y) {
      if (x.rest != y.rest || K <= 3) return x.rest < y.rest;
      const Record<K>&a = records_[x.record], &c = records_[y.record];
      return std::lexicographical_compare(a.vertex, a.vertex + K, c.vertex, c.vertex + K);
    };
    Key* keys = scratch.keys.data();
    for (std::size_t v = 0, from = 0; v + 1 < scratch.start.size(); from = start[v++]) {
      if (start[v] - from < 2) continue;
      if (start[v] - from > 16) {
        std::sort(keys + from, keys + start[v], less);
        continue;
      }
      for (std::size_t i = from + 1; i < start[v]; ++i) {
        const Key key = keys[i];
        std::size_t j = i;
        for (; j > from && less(key, keys[j - 1]); --j) keys[j] = keys[j - 1];
        keys[j] = key;
      }
    }
  }

  void write_bucket(std::uint32_t b, const Scratch& scratch) {
    const std::uint64_t begin = bucket_start_[b], end = bucket_start_[b + 1];
    Share<K> run;
    bool whole = begin % measure_run == 0;  // whether the run at hand began in this bucket
    for (std::uint64_t i = begin; i < end; ++i) {
      const Record<K>& r = records_[scratch.keys[i - begin].record];
      write_simplex(i, r);
      const Share<K> share = write_plane(i, r);
      if (i % measure_run == 0) {
        run = {};
        whole = true;
        // The last run of a bucket is cut, unless it ends with the bucket or the hull.
        if (i + measure_run > end && end != count_) whole = false;
      }
      if (!whole) {
        (i / measure_run == begin / measure_run && begin % measure_run != 0 ? cut_[b].head
                                                                            : cut_[b].tail)
            .push_back(share);
        continue;
      }
      run.add(share);
      if ((i + 1) % measure_run == 0 || i + 1 == count_) runs_[i / measure_run] = run;
    }
  }

  void write_simplex(std::uint64_t i, const Record<K>& r) {
    rank_[r.simplex] = static_cast<std::uint32_t>(i);
    std::uint64_t* simplex = simplices_.data() + i * K;
    std::uint32_t* across = hull_.simplex_neighbours.data() + i * K;
    for (unsigned j = 0; j < K; ++j) {
      simplex[j] = vertices_.plain ? r.vertex[j] : vertices_.ids[r.vertex[j]];
      across[j] = r.neighbour[j];  // renumbered in the third sweep
    }
    if constexpr (!shared) {
      std::uint64_t* facet = facets_.data() + i * K;
      for (unsigned j = 0; j < K; ++j) facet[j] = simplex[K == 2 ? 1 - j : j];
    }
  }

  Share<K> write_plane(std::uint64_t i, const Record<K>& r) {
    return facet_share(frame_, plane_, r.vertex, r.thin != 0, r.normal, r.sum,
                       hull_.facet_planes.data() + i * (K + 1));
  }

  /// Runs that bucket borders cut, in order.
  void join_cut_runs() {
    Share<K> run;
    const auto add = [&](std::uint64_t i, const Share<K>& share) {
      if (i % measure_run == 0) run = {};
      run.add(share);
      if ((i + 1) % measure_run == 0 || i + 1 == count_) runs_[i / measure_run] = run;
    };
    for (std::uint32_t b = 0; b < buckets_; ++b) {
      std::uint64_t i = bucket_start_[b];
      for (const Share<K>& share : cut_[b].head) add(i++, share);
      i = bucket_start_[b + 1] - cut_[b].tail.size();
      for (const Share<K>& share : cut_[b].tail) add(i++, share);
    }
  }

  // ---------------------------------------------------------------- third sweep and sums

  void write_neighbours() {
    Array<std::uint32_t> neighbours(count_ * K);
    for_each_chunk(count_, simplex_chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     for (std::uint64_t i = begin; i < end; ++i) {
                       std::uint32_t* next = hull_.simplex_neighbours.data() + i * K;
                       std::uint32_t* across = neighbours.data() + i * K;
                       for (unsigned j = 0; j < K; ++j) {
                         if (i + ahead < end) __builtin_prefetch(&rank_[next[j + ahead * K]]);
                         next[j] = rank_[next[j]];
                       }
                       // k = 3: the edge from vertex j is opposite to vertex j + 2.
                       for (unsigned j = 0; j < K; ++j)
                         across[j] = next[K == 2 ? 1 - j : K == 3 ? (j + 2) % 3 : j];
                     }
                   });
    using Ids = SharedArray<std::uint64_t>;
    hull_.simplices = Ids(std::move(simplices_));
    hull_.facets =
        Lists<std::uint64_t, Ids>::of_length(K, shared ? hull_.simplices : Ids(std::move(facets_)));
    hull_.facet_neighbours = Lists<std::uint32_t>::of_length(K, std::move(neighbours));
    hull_.simplex_facets = EvenArray<std::uint32_t>::of_step(count_, 1);
  }

  void finish() {
    finish_simplicial<K>(input_, vertices_, frame_, runs_.get(), threads_, control_, hull_);
  }

  static constexpr std::uint64_t max_buckets = 2048;
  static constexpr std::uint64_t ahead = 16;

  const ResultInput& input_;
  const Surface& surface_;
  const VertexList& vertices_;
  const Frame& frame_;
  const FacetPlane<K> plane_;
  const unsigned threads_;
  const Control& control_;
  Hull& hull_;
  const std::uint64_t count_;
  unsigned shift_ = 0;
  std::uint32_t buckets_ = 0;
  std::vector<std::uint32_t> next_;          // chunks x buckets: place of the next record
  std::vector<std::uint32_t> bucket_start_;  // records of each bucket
  BigArray<Record<K>> records_;
  std::atomic<bool> coplanar_{false};
  Array<std::uint64_t> simplices_, facets_;  // the result's; facets_ where they are not shared
  BigArray<std::uint32_t> rank_;             // of the engine's simplices in canonical order
  BigArray<Share<K>> runs_;
  std::vector<Cut> cut_;
};

template <unsigned K>
bool build(const ResultInput& input, const Surface& surface, const VertexList& vertices,
           const Frame& frame, unsigned threads, const Control& control, Hull& hull) {
  return Simplicial<K>(input, surface, vertices, frame, threads, control, hull).run();
}

}  // namespace

bool build_simplicial(const ResultInput& input, const Surface& surface, const VertexList& vertices,
                      unsigned threads, const Control& control, Hull& hull) {
  const unsigned k = surface.k;
  if (k < 2 || k > 8 || k != input.view->dimension) return false;
  const Frame frame = make_frame(*input.view, vertices.ids, input.axes, k, threads);
  if (frame.wild) return false;
  using Build = bool (*)(const ResultInput&, const Surface&, const VertexList&, const Frame&,
                         unsigned, const Control&, Hull&);
  if (k >= 4)
    return build_simplicial_nd(input, surface, vertices, frame, threads, control, hull);
  static constexpr Build builds[] = {build<2>, build<3>};
  return builds[k - 2](input, surface, vertices, frame, threads, control, hull);
}

}  // namespace cullhull::internal
