// From 4D on hulls have so many facets that passes over them take most of the time and memory. So
// the simplices are sorted first, by keys that contain all vertices of a simplex. Everything else
// is computed in canonical order and written directly into the result. In that order two facets
// that share a ridge are usually near each other in memory, because they have the same lowest
// vertex unless the ridge lacks it, and a vertex has some hundred facets.
//
// There are four sweeps: deal() distributes the keys to buckets by the lowest vertex,
// sort_buckets() sorts each bucket and writes its simplices, renumber() renumbers the neighbours,
// and scan() checks the ridges and computes planes and measures.
#include "result/write/write_simplices.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "exact/determinants/cofactors.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"
#include "parallel/sort_few.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "result/facets/facet_keys.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure.hpp"
#include "result/write/bucket_sort.hpp"
#include "result/write/hull_lists.hpp"

namespace cullhull::internal {
namespace {

/// What is written of a simplex in dimension K: one text for surfaces of few and of many.
template <unsigned K>
class SimplexLists {
 protected:
  static constexpr unsigned lanes = FacetBlock<K>::lanes;

  /// `vertices`: the ids of the hull's vertices. `plain`: each is its position.
  SimplexLists(const Frame& frame, const std::vector<std::uint64_t>& vertices, bool plain)
      : frame_(frame), plane_(frame), ids_(vertices.data()), plain_(plain) {}

  /// Writes the vertices of simplex i and of its facet, given by their positions in stored order:
  /// ascending, except that the last two are exchanged if that makes the simplex outward oriented.
  void put_vertices(std::uint64_t i, const std::uint32_t* stored) {
    std::uint64_t* simplex = simplices_.data() + i * K;
    std::uint64_t* facet = facets_.data() + i * K;
    for (unsigned j = 0; j < K; ++j) facet[j] = simplex[j] = plain_ ? stored[j] : ids_[stored[j]];
    facet[K - 2] = std::min(simplex[K - 2], simplex[K - 1]);
    facet[K - 1] = std::max(simplex[K - 2], simplex[K - 1]);
  }
  /// Writes its neighbours: number(j) lies opposite to stored vertex j.
  template <class Number>
  void put_neighbours(std::uint64_t i, const Number& number) {
    std::uint32_t* next = neighbours_.data() + i * K;
    std::uint32_t* ordered = facet_neighbours_.data() + i * K;
    for (unsigned j = 0; j < K; ++j) next[j] = ordered[j] = number(j);
    sort_few<K>(ordered);
  }

  FacetBlock<K> empty_block() const {
    FacetBlock<K> block;
    for (unsigned c = 0; c < K; ++c) std::fill_n(block.origin[c], lanes, frame_.at(0)[c]);
    return block;
  }
  void load(const std::uint32_t* corners, FacetBlock<K>& block, unsigned lane) const {
    for (unsigned j = 0; j < K; ++j) {
      const double* p = frame_.at(corners[j]);
      for (unsigned c = 0; c < K; ++c) block.corner[j][c][lane] = p[c];
    }
  }
  /// Writes the planes of the run of simplices [from, to), and returns the sum of their shares.
  /// corners(i): the positions of the vertices of simplex i, in stored order. with_normals(first,
  /// end) may use what facet_block has computed of these simplices.
  template <class Corners, class WithNormals>
  Share<K> put_planes(std::uint64_t from, std::uint64_t to, FacetBlock<K>& block,
                      const Corners& corners, const WithNormals& with_normals) {
    Share<K> run;
    for (std::uint64_t first = from; first < to; first += lanes) {
      const auto n = static_cast<unsigned>(std::min<std::uint64_t>(lanes, to - first));
      for (unsigned lane = 0; lane < lanes; ++lane)
        load(corners(first + std::min(lane, n - 1)), block, lane);
      facet_block(block);
      with_normals(first, first + n);
      facet_shares(block);
      for (unsigned lane = 0; lane < n; ++lane)
        run.add(facet_share(frame_, plane_, corners(first + lane), block, lane,
                            planes_.data() + (first + lane) * (K + 1)));
    }
    return run;
  }

  void keep_lists(Hull& hull) {
    hull.facet_planes = std::move(planes_);
    keep_simplicial(K, std::move(simplices_), std::move(facets_), std::move(neighbours_),
                    std::move(facet_neighbours_), hull);
  }

  const Frame& frame_;
  const FacetPlane<K> plane_;
  const std::uint64_t* const ids_;
  const bool plain_;
  Array<std::uint64_t> simplices_, facets_;
  Array<std::uint32_t> neighbours_, facet_neighbours_;
  Array<double> planes_;
};

/// The work of write_simplices in dimension K.
template <unsigned K>
class SimplexWriter : SimplexLists<K> {
  using Base = SimplexLists<K>;
  using Base::lanes, Base::frame_, Base::neighbours_, Base::load;

 public:
  SimplexWriter(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                const Frame& frame, const Run& run, unsigned key_bits)
      : Base(frame, vertices.ids, vertices.plain),
        input_(input),
        surface_(surface),
        vertices_(vertices),
        run_(run),
        count_(surface.facet_count()),
        shift_(bucket_shift(count_, vertices.ids.size(), 1024)),
        buckets_(static_cast<std::uint32_t>((vertices.ids.size() - 1) >> shift_) + 1),
        packing_(vertices.ids.size(), count_, shift_, key_bits) {}

  bool run(Hull& hull) {
    if (coplanar_sample()) return false;
    run_.report("facets", 0);
    deal();
    sort_buckets();
    keys_ = {};
    run_.report("neighbours", 0);
    renumber();
    run_.report("ridges", 0);
    if (!scan(hull.statistics.rung_counts)) return false;
    this->keep_lists(hull);
    run_.report("measures", 0);
    finish_simplicial<K>(input_, vertices_.ids, frame_, runs_.get(), run_, hull);
    return true;
  }

 private:
  // ---------------------------------------------------------------- keys, sorted

  /// Distributes the simplices' keys to buckets, in each in the surface's order.
  void deal() {
    // So large that a chunk's counts take less time than its keys.
    const std::uint64_t grain = std::max<std::uint64_t>(simplex_chunk, 8 * buckets_);
    std::vector<std::uint32_t> next(chunk_count(count_, grain) * buckets_, 0);
    run_.each_chunk(count_, grain,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* counts = next.data() + chunk * buckets_;
      for (std::uint64_t f = begin; f < end; ++f)
        ++counts[vertices_.position(surface_.simplex(f)[0]) >> shift_];
    });
    scan_buckets(next, buckets_, &bucket_start_);
    keys_ = BigArray<FacetKey>(count_);
    clear_pages_early(keys_.get(), count_ * sizeof(FacetKey), run_.threads, [&] { run_.check(); });
    run_.each_chunk(count_, grain,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* place = next.data() + chunk * buckets_;
      std::uint32_t corners[K];
      for (std::uint64_t f = begin; f < end; ++f) {
        stored(f, corners);
        keys_[place[corners[0] >> shift_]++] = packing_.key(corners, static_cast<std::uint32_t>(f));
      }
    });
  }

  /// Writes the positions of the vertices of the surface's simplex f, in stored order: ascending,
  /// except that the last two are exchanged if that makes the simplex outward oriented.
  void stored(std::uint64_t f, std::uint32_t* corners) const {
    const std::uint32_t* ids = surface_.simplex(f);
    for (unsigned j = 0; j < K; ++j) corners[j] = vertices_.position(ids[j]);
    const std::uint32_t a = corners[K - 2], b = corners[K - 1];
    corners[K - 2] = surface_.odd[f] ? b : a;
    corners[K - 1] = surface_.odd[f] ? a : b;
  }

  void sort_buckets() {
    order_ = BigArray<std::uint32_t>(count_);
    rank_ = BigArray<std::uint32_t>(count_);
    corners_ = BigArray<std::uint32_t>(count_ * K);
    this->simplices_.resize(count_ * K);
    this->facets_.resize(count_ * K);
    run_.each(buckets_, 4, [&](std::uint64_t begin, std::uint64_t end) {
      BucketSort<FacetKey> sorted;
      for (std::uint64_t b = begin; b < end; ++b) {
        sort(static_cast<std::uint32_t>(b), sorted);
        write_bucket(static_cast<std::uint32_t>(b), sorted);
      }
    });
  }

  /// Compares two simplices, by more than their keys if these lack vertices.
  bool less(const FacetKey& a, const FacetKey& b) const {
    if (packing_.complete() || !packing_.alike(a, b)) return a < b;
    std::uint32_t v[K], w[K];
    stored(packing_.number(a), v);
    stored(packing_.number(b), w);
    return std::lexicographical_compare(v, v + K, w, w + K);
  }

  /// Sorts bucket b.
  void sort(std::uint32_t b, BucketSort<FacetKey>& sorted) const {
    const std::uint32_t begin = bucket_start_[b], end = bucket_start_[b + 1];
    sorted.sort(
        end - begin, std::size_t{1} << shift_,
        [&](const auto& visit) { std::for_each(keys_.get() + begin, keys_.get() + end, visit); },
        [&](const FacetKey& key) { return packing_.first(key); },
        [&](const FacetKey& key) {
      prefetch_line_to_write(&rank_[packing_.number(key)]);
      return key;
        },
        [this](const FacetKey& x, const FacetKey& y) { return less(x, y); });
  }

  /// Writes order, rank, vertices and facets of the simplices of sorted bucket b.
  void write_bucket(std::uint32_t b, const BucketSort<FacetKey>& sorted) {
    const std::uint32_t base = b << shift_;
    bool twice = false;
    for (std::uint64_t i = bucket_start_[b]; i < bucket_start_[b + 1]; ++i) {
      const FacetKey& key = sorted[i - bucket_start_[b]];
      const std::uint32_t f = packing_.number(key);
      order_[i] = f;
      rank_[f] = static_cast<std::uint32_t>(i);
      std::uint32_t v[K];
      if (packing_.complete())
        packing_.unpack(key, base, v);
      else
        stored(f, v);
      std::copy_n(v, K, &corners_[i * K]);
      this->put_vertices(i, v);
      const std::uint64_t* facet = &this->facets_[i * K];
      for (unsigned j = 1; j < K; ++j) twice |= facet[j - 1] == facet[j];
    }
    if (twice) fail_not_exact("a simplex uses a point twice");
  }

  /// Whether the last two of the stored vertices are exchanged.
  static bool is_odd(const std::uint32_t* stored) { return stored[K - 2] > stored[K - 1]; }

  /// Writes the neighbours of the simplices and of the facets in the new numbers.
  void renumber() {
    // Prefetch distances: `far` for the neighbours of a simplex, `near` for their ranks. Hulls of
    // 50,000 points on a sphere in 4D take 2% more time without the near prefetch. Other distances
    // change the time by no more than the noise, 3%.
    constexpr std::uint64_t far = 40, near = 12;
    neighbours_.resize(count_ * K);
    this->facet_neighbours_.resize(count_ * K);
    const auto of = [&](std::uint64_t i) {
      return surface_.neighbours.data() + std::size_t{order_[i]} * K;
    };
    run_.each(count_, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      bool open = false;
      for (std::uint64_t i = begin; i < end; ++i) {
        if (i + far < end) prefetch_line(of(i + far));
        if (i + near < end)
          for (unsigned j = 0; j < K; ++j) prefetch_line(rank_.get() + of(i + near)[j]);
        const std::uint32_t* across = of(i);
        this->put_neighbours(i, [&](unsigned j) {
          const std::uint32_t g = across[j];
          open |= g >= count_ || g == order_[i];
          return rank_[g < count_ ? g : 0];
        });
        std::uint32_t* next = neighbours_.data() + i * K;
        if (is_odd(&corners_[i * K])) std::swap(next[K - 2], next[K - 1]);
      }
      if (open) fail_not_exact("a ridge has no second facet");
    });
  }

  // ---------------------------------------------------------------- ridges, planes, measures

  struct ChunkCounts {
    std::uint64_t ridges = 0;
    RungCounts rungs;
  };

  /// Checks all ridges and computes planes and shares. Returns false if some simplices are
  /// coplanar.
  bool scan(std::uint64_t* rung_counts) {
    this->planes_.resize(count_ * (K + 1));
    runs_ = BigArray<Share<K>>(chunk_count(count_, measure_run));
    std::vector<ChunkCounts> counts(chunk_count(count_, simplex_chunk));
    run_.each_chunk(count_, simplex_chunk,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      scan_chunk(begin, end, counts[chunk]);
    });
    if (coplanar_.load()) return false;
    std::uint64_t ridges = 0;
    for (const ChunkCounts& c : counts) {
      ridges += c.ridges;
      c.rungs.add_to(rung_counts);
    }
    // Each ridge was counted once, from its lower simplex. Two slots belong to a ridge.
    if (2 * ridges != count_ * K) fail_not_exact("a ridge is not shared by two facets");
    return true;
  }

  /// A ridge between a simplex and a neighbour of higher number. `across` is that neighbour at
  /// first; match() replaces it by the neighbour's vertex off the ridge.
  struct Ridge {
    std::uint32_t simplex, across, slot;
  };
  static_assert(simplex_chunk % measure_run == 0 && measure_run % lanes == 0);

  /// Processes a chunk run by run. The data of the next run is prefetched while a run is computed.
  void scan_chunk(std::uint64_t begin, std::uint64_t end, ChunkCounts& out) {
    FacetBlock<K> block = this->empty_block();
    Ridge lists[2][measure_run * K + 1];
    unsigned count = list_ridges(begin, std::min(end, begin + measure_run), lists[0]);
    for (std::uint64_t from = begin; from < end; from += measure_run) {
      if (coplanar_.load(std::memory_order_relaxed)) return;
      const std::uint64_t to = std::min<std::uint64_t>(end, from + measure_run);
      Ridge* ridges = lists[(from - begin) / measure_run % 2];
      const unsigned ahead = list_ridges(to, std::min(end, to + measure_run),
                                         lists[1 - (from - begin) / measure_run % 2]);
      out.ridges += count;
      for (Ridge* r = ridges; r < ridges + count; ++r) match(*r);
      const Ridge* ridge = ridges;
      runs_[from / measure_run] = this->put_planes(
          from, to, block, [this](std::uint64_t i) { return &corners_[i * K]; },
          [&](std::uint64_t first, std::uint64_t last) {
        for (; ridge < ridges + count && ridge->simplex < last; ++ridge)
          check_convex(*ridge, block, static_cast<unsigned>(ridge->simplex - first), out);
          });
      count = ahead;
    }
  }

  /// Lists the ridges of simplices [from, to) to neighbours of higher number, and prefetches their
  /// data. Returns their number. Which of two neighbours is higher is unpredictable, so the loop
  /// has no branch.
  unsigned list_ridges(std::uint64_t from, std::uint64_t to, Ridge* ridges) const {
    unsigned count = 0;
    for (std::uint64_t f = from; f < to; ++f)
      for (unsigned i = 0; i < K; ++i) {
        const std::uint32_t g = neighbours_[f * K + i];
        ridges[count] = {static_cast<std::uint32_t>(f), g, i};
        count += g > f;
      }
    for (const Ridge* r = ridges; r < ridges + count; ++r) {
      prefetch_line(&corners_[std::size_t{r->across} * K]);
      prefetch_line(&corners_[std::size_t{r->across} * K + K - 1]);
      prefetch_line(neighbours_.data() + std::size_t{r->across} * K);
      prefetch_line(neighbours_.data() + std::size_t{r->across} * K + K - 1);
    }
    return count;
  }

  /// Copies stored vertices in ascending order.
  static void straighten(const std::uint32_t* stored, std::uint32_t* v) {
    std::copy_n(stored, K, v);
    v[K - 2] = std::min(stored[K - 2], stored[K - 1]);
    v[K - 1] = std::max(stored[K - 2], stored[K - 1]);
  }

  /// Replaces `across` by the neighbour's vertex off the ridge. Throws Error{not_exact} unless both
  /// simplices contain the ridge, refer to each other, and have the same orientation.
  void match(Ridge& ridge) const {
    const std::uint32_t f = ridge.simplex, g = ridge.across;
    const std::uint32_t* stored = &corners_[std::size_t{f} * K];
    const std::uint32_t* other = &corners_[std::size_t{g} * K];
    std::uint32_t a[K], b[K];
    straighten(stored, a);
    straighten(other, b);
    // If both contain the ridge, the sums of their vertices differ by that of the two other
    // vertices.
    std::uint32_t x = stored[ridge.slot];
    for (unsigned c = 0; c < K; ++c) x += b[c] - a[c];
    unsigned i = 0, j = 0;  // indices of the two vertices off the ridge
    for (unsigned c = 0; c < K; ++c) {
      i += a[c] < stored[ridge.slot];
      j += b[c] < x;
    }
    bool same = j < K && b[j < K ? j : 0] == x;
    for (unsigned c = 0; c + 1 < K; ++c) same &= a[c + (c >= i)] == b[c + (c >= j)];
    const bool odd = is_odd(other);
    const unsigned slot = odd && j + 2 >= K ? 2 * K - 3 - j : j;
    if (!same || neighbours_[std::size_t{g} * K + slot] != f)
      fail_not_exact("neighbouring facets do not share their ridge");
    if (((i + j + is_odd(stored) + odd) & 1U) == 0)
      fail_not_exact("neighbouring facets are oriented differently");
    ridge.across = x;
    prefetch_line(frame_.at(x));
  }

  void check_convex(const Ridge& ridge, const FacetBlock<K>& block, unsigned lane,
                    ChunkCounts& out) {
    bool known = false;
    Sign sign = side(block, lane, ridge.across, known);
    if (known)
      out.rungs.count(Rung::plane);
    else
      sign = exact_side(ridge, out);
    if (sign == Sign::positive) fail_not_exact("a ridge is not convex");
    if (sign == Sign::zero) coplanar_.store(true, std::memory_order_relaxed);
  }

  /// The side of a vertex relative to the simplex in a lane, whose normal points outward: negative
  /// if the ridge between them is convex. Sets `known` to whether the sign is certain.
  Sign side(const FacetBlock<K>& block, unsigned lane, std::uint32_t vertex, bool& known) const {
    const double* p = frame_.at(vertex);
    double sum = 0, largest = 0;
    for (unsigned c = 0; c < K; ++c) {
      const double d = p[c] - block.corner[0][c][lane];
      sum = sum + block.normal[c][lane] * d;
      largest = std::max(largest, std::fabs(d));
    }
    const double bound = determinant_error(K) * block.reach[lane] * largest + determinant_tiny;
    known = std::fabs(sum) > bound || input_.local->small_lattice;
    return sign_of(sum);
  }

  /// The exact sign of a ridge that doubles could not decide, as side() defines it.
  Sign exact_side(const Ridge& ridge, ChunkCounts& out) const {
    // Local ids are the vertices of the surface's simplices.
    const std::uint32_t g = neighbours_[std::size_t{ridge.simplex} * K + ridge.slot];
    const std::uint32_t* ids = surface_.simplex(order_[g]);
    std::uint32_t x = ids[0];
    for (unsigned j = 1; j < K; ++j)
      if (vertices_.position(ids[j]) == ridge.across) x = ids[j];
    const double* rows[K + 1];
    for (unsigned j = 0; j < K; ++j)
      rows[j] = input_.local->exact_row(surface_.stored(order_[ridge.simplex], j));
    rows[K] = input_.local->exact_row(x);
    Rung rung = Rung::exact;
    const Sign sign = orientation(K, rows, &rung);
    out.rungs.count(rung);
    return sign;
  }

  // ---------------------------------------------------------------- before it all

  /// Whether some simplex of a sample has a coplanar neighbour: then the sweeps would be wasted. If
  /// not, other simplices may still have one. The sample has up to 512 simplices, in blocks of 8.
  bool coplanar_sample() const {
    const std::uint64_t blocks = std::min<std::uint64_t>(64, count_ / 128);
    std::atomic<bool> flat{false};
    run_.each(blocks, 8, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t k = begin; k < end && !flat.load(std::memory_order_relaxed); ++k)
        if (coplanar_block(k, blocks)) flat.store(true, std::memory_order_relaxed);
    });
    return flat.load();
  }

  /// Whether a simplex of block k of the sample has a coplanar neighbour.
  bool coplanar_block(std::uint64_t k, std::uint64_t blocks) const {
    FacetBlock<K> block = this->empty_block();
    const auto at = [&](unsigned lane) {
      return static_cast<std::uint32_t>(count_ * (k * lanes + lane) / (blocks * lanes));
    };
    for (unsigned lane = 0; lane < lanes; ++lane) {
      std::uint32_t corners[K];
      stored(at(lane), corners);
      load(corners, block, lane);
    }
    facet_block(block);
    for (unsigned lane = 0; lane < lanes; ++lane)
      for (unsigned i = 0; i < K; ++i) {
        const std::uint32_t g = surface_.neighbours[std::size_t{at(lane)} * K + i];
        if (g >= count_ || g == at(lane)) fail_not_exact("a ridge has no second facet");
        const std::uint32_t x = surface_.simplex(g)[opposite_slot<K>(surface_, at(lane), i, g)];
        bool known = false;
        const Sign sign = side(block, lane, vertices_.position(x), known);
        if (known ? sign == Sign::zero : exactly_flat(at(lane), x)) return true;
      }
    return false;
  }

  bool exactly_flat(std::uint32_t f, std::uint32_t x) const {
    const double* rows[K + 1];
    for (unsigned j = 0; j < K; ++j) rows[j] = input_.local->exact_row(surface_.simplex(f)[j]);
    rows[K] = input_.local->exact_row(x);
    return orientation(K, rows) == Sign::zero;
  }

  const ResultInput& input_;
  const Boundary& surface_;
  const VertexList& vertices_;
  const Run& run_;
  const std::uint64_t count_;
  const unsigned shift_;
  const std::uint32_t buckets_;
  const FacetKeys<K> packing_;
  std::vector<std::uint32_t> bucket_start_;  // first key of each bucket
  BigArray<FacetKey> keys_;
  BigArray<std::uint32_t> order_;    // the surface's simplices in canonical order
  BigArray<std::uint32_t> rank_;     // the inverse of order_
  BigArray<std::uint32_t> corners_;  // stored vertices of the simplices in canonical order
  std::atomic<bool> coplanar_{false};
  BigArray<Share<K>> runs_;
};

/// Working memory of FewSimplexWriter.
template <unsigned K>
struct FewSimplexMemory {
  struct Simplex {
    std::uint32_t corner[K];  ///< positions of the vertices in stored order
    std::uint32_t across[K];  ///< slots of the simplices opposite to them
  };
  std::vector<std::uint64_t> ids;            // of the vertices
  std::vector<std::uint32_t> position;       // of each point among the vertices
  std::vector<Simplex> stored;               // by slot
  std::vector<std::uint32_t> number, order;  // of each slot; the slot of each number
  std::vector<std::uint64_t> keys;           // the corners, then the slot
  BucketSort<std::uint64_t> sorted;
  std::vector<Share<K>> runs;
};

/// The work of write_few_simplices: without checks, on one thread, with keys of 64 bits.
template <unsigned K>
class FewSimplexWriter : SimplexLists<K> {
  using Memory = FewSimplexMemory<K>;

 public:
  FewSimplexWriter(const FewSimplices& surface, const Frame& frame, Memory& memory)
      : SimplexLists<K>(frame, memory.ids, false), surface_(surface), m_(memory) {}

  void run(const ResultInput& input, Hull& hull) {
    sort();
    const std::size_t count = m_.order.size();
    this->simplices_.resize(count * K);
    this->facets_.resize(count * K);
    this->neighbours_.resize(count * K);
    this->facet_neighbours_.resize(count * K);
    this->planes_.resize(count * (K + 1));
    for (std::size_t i = 0; i < count; ++i) {
      const auto& simplex = m_.stored[m_.order[i]];
      this->put_vertices(i, simplex.corner);
      this->put_neighbours(i, [&](unsigned j) { return m_.number[simplex.across[j]]; });
    }
    m_.runs.resize(chunk_count(count, measure_run));
    FacetBlock<K> block = this->empty_block();
    for (std::size_t i = 0; i < m_.runs.size(); ++i)
      m_.runs[i] = this->put_planes(
          i * measure_run, std::min<std::uint64_t>(count, (i + 1) * measure_run), block,
          [this](std::uint64_t f) { return m_.stored[m_.order[f]].corner; },
          [](std::uint64_t, std::uint64_t) {});
    this->keep_lists(hull);
    hull.affine_dimension = K;
    hull.vertices = m_.ids;
    finish_simplicial<K>(input, m_.ids, this->frame_, m_.runs.data(), short_run(), hull);
  }

  /// Lists the vertices of the surface of `count` points.
  static void list_vertices(const FewSimplices& surface, const std::uint64_t* ids, unsigned count,
                            Memory& m) {
    m.position.assign(count, 0);
    for (unsigned f = 0; f < surface.slots; ++f)
      if (surface.live(f, K))
        for (unsigned j = 0; j < K; ++j) m.position[surface.corners[std::size_t{f} * K + j]] = 1;
    m.ids.clear();
    for (unsigned i = 0; i < count; ++i) {
      if (m.position[i] == 0) continue;
      m.position[i] = static_cast<std::uint32_t>(m.ids.size());
      m.ids.push_back(ids != nullptr ? ids[i] : i);
    }
  }

 private:
  /// Brings each simplex into stored order, and all into the order of their vertices.
  void sort() {
    const auto bits = static_cast<unsigned>(std::bit_width(m_.ids.size() - 1)),
               slot_bits = static_cast<unsigned>(std::bit_width(surface_.slots - 1));
    m_.stored.resize(surface_.slots);
    m_.number.resize(surface_.slots);
    m_.keys.clear();
    for (unsigned f = 0; f < surface_.slots; ++f) {
      if (!surface_.live(f, K)) continue;
      std::uint32_t packed[K];
      for (unsigned j = 0; j < K; ++j)
        packed[j] = m_.position[surface_.corners[std::size_t{f} * K + j]] << 3 | j;
      if (sort_few<K>(packed)) std::swap(packed[K - 2], packed[K - 1]);
      auto& simplex = m_.stored[f];
      std::uint64_t key = 0;
      for (unsigned j = 0; j < K; ++j) {
        simplex.corner[j] = packed[j] >> 3;
        simplex.across[j] = surface_.across[std::size_t{f} * K + (packed[j] & 7)];
        key = key << bits | simplex.corner[j];
      }
      m_.keys.push_back(key << slot_bits | f);
    }
    const unsigned shift = slot_bits + (K - 1) * bits;
    m_.sorted.sort(
        m_.keys.size(), m_.ids.size(),
        [&](const auto& visit) { std::for_each(m_.keys.begin(), m_.keys.end(), visit); },
        [&](std::uint64_t key) { return static_cast<std::uint32_t>(key >> shift); },
        [](std::uint64_t key) { return key; },
        [](std::uint64_t a, std::uint64_t b) { return a < b; });
    m_.order.resize(m_.keys.size());
    for (unsigned i = 0; i < m_.order.size(); ++i) {
      m_.order[i] = static_cast<std::uint32_t>(m_.sorted[i]) & ((1U << slot_bits) - 1);
      m_.number[m_.order[i]] = i;
    }
  }

  const FewSimplices& surface_;
  Memory& m_;
};

}  // namespace

bool write_simplices(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                     const Frame& frame, const Run& run, Hull& hull, unsigned key_bits) {
  return with_dimension<4, 7, 8>(surface.dimension, [&](auto k) {
    return SimplexWriter<k>(input, surface, vertices, frame, run, key_bits).run(hull);
  });
}

bool write_few_simplices(const PointView& view, const std::uint64_t* ids, unsigned count,
                         const FewSimplices& surface, Hull& hull) {
  return with_dimension<4, 7, 8>(view.dimension, [&](auto k) {
    auto& memory = thread_memory<FewSimplexMemory<k>>();
    FewSimplexWriter<k>::list_vertices(surface, ids, count, memory);
    constexpr unsigned axes[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const Frame frame = make_frame(view, memory.ids, axes, k, short_run());
    if (frame.wild) return false;
    FewSimplexWriter<k>(surface, frame, memory).run({&view, nullptr, ids, axes}, hull);
    return true;
  });
}

}  // namespace cullhull::internal
