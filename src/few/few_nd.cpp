// The canonical hull of few points in four to eight dimensions, from their coordinates.
#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "few/few_in_space.hpp"
#include "few/small_nd.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/sort_few.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure.hpp"
#include "result/write/bucket_sort.hpp"

namespace cullhull::internal {
namespace {

/// Writes a surface as a hull, with the bits that build_hull gives: simplices in canonical order,
/// then planes and measures, run by run.
template <unsigned K>
class SmallWriter {
 public:
  /// False, with the hull unchanged, where coordinates span too many powers of two.
  bool run(const PointView& view, const std::uint64_t* ids, unsigned count,
           const SmallSurfaceNd<K>& surface, Hull& hull) {
    list_vertices(ids, count, surface);
    constexpr unsigned axes[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const Frame frame = make_frame(view, ids_, axes, K, short_run());
    if (frame.wild) return false;
    sort_facets(surface);
    hull.affine_dimension = K;
    hull.vertices = ids_;
    write_lists(hull);
    write_planes(frame, hull);
    const ResultInput input{&view, nullptr, ids, axes};
    finish_simplicial<K>(input, ids_, frame, runs_.data(), short_run(), hull);
    return true;
  }

 private:
  static constexpr unsigned lanes = FacetBlock<K>::lanes;
  static constexpr unsigned slot_bits = std::bit_width(SmallSurfaceNd<K>::most_facets - 1);
  static_assert(slot_bits + K * std::bit_width(row_of(few_way(K)).most_left - 1) <= 64);
  struct Facet {
    std::uint32_t corner[K];  ///< ranks of the vertices in stored order
    std::uint32_t across[K];  ///< slots of the facets opposite to them
  };

  void list_vertices(const std::uint64_t* ids, unsigned count, const SmallSurfaceNd<K>& surface) {
    rank_.assign(count, 0);
    facets_ = 0;
    for (unsigned f = 0; f < surface.slots(); ++f) {
      if (!surface.live(f)) continue;
      ++facets_;
      for (unsigned j = 0; j < K; ++j) rank_[surface.vertices(f)[j]] = 1;
    }
    ids_.clear();
    for (unsigned i = 0; i < count; ++i) {
      if (rank_[i] == 0) continue;
      rank_[i] = static_cast<std::uint32_t>(ids_.size());
      ids_.push_back(ids != nullptr ? ids[i] : i);
    }
  }

  /// Brings each facet into stored order, ascending but for the last two where that turns it
  /// outward, and all facets into the order of their vertices.
  void sort_facets(const SmallSurfaceNd<K>& surface) {
    const auto bits = static_cast<unsigned>(std::bit_width(ids_.size() - 1));
    stored_.resize(surface.slots());
    number_.resize(surface.slots());
    keys_.clear();
    for (unsigned f = 0; f < surface.slots(); ++f) {
      if (!surface.live(f)) continue;
      std::uint32_t packed[K];
      for (unsigned j = 0; j < K; ++j) packed[j] = rank_[surface.vertices(f)[j]] << 3 | j;
      if (sort_few<K>(packed)) std::swap(packed[K - 2], packed[K - 1]);
      Facet& facet = stored_[f];
      std::uint64_t key = 0;
      for (unsigned j = 0; j < K; ++j) {
        facet.corner[j] = packed[j] >> 3;
        facet.across[j] = surface.neighbours(f)[packed[j] & 7];
        key = key << bits | facet.corner[j];
      }
      keys_.push_back(key << slot_bits | f);
    }
    const unsigned shift = slot_bits + (K - 1) * bits;
    sorted_.sort(
        keys_.size(), ids_.size(),
        [&](const auto& visit) { std::for_each(keys_.begin(), keys_.end(), visit); },
        [&](std::uint64_t key) { return static_cast<std::uint32_t>(key >> shift); },
        [](std::uint64_t key) { return key; },
        [](std::uint64_t a, std::uint64_t b) { return a < b; });
    order_.resize(facets_);
    for (unsigned i = 0; i < facets_; ++i) {
      order_[i] = static_cast<std::uint32_t>(sorted_[i]) & ((1U << slot_bits) - 1);
      number_[order_[i]] = i;
    }
  }

  void write_lists(Hull& hull) const {
    using Ids = SharedArray<std::uint64_t>;
    const std::size_t size = std::size_t{facets_} * K;
    Array<std::uint64_t> simplices(size), facets(size);
    Array<std::uint32_t> neighbours(size), across(size);
    for (unsigned i = 0; i < facets_; ++i) {
      const Facet& from = stored_[order_[i]];
      const std::size_t at = std::size_t{i} * K;
      for (unsigned j = 0; j < K; ++j) {
        facets[at + j] = simplices[at + j] = ids_[from.corner[j]];
        across[at + j] = neighbours[at + j] = number_[from.across[j]];
      }
      if (from.corner[K - 2] > from.corner[K - 1])
        std::swap(facets[at + K - 2], facets[at + K - 1]);
      sort_few<K>(&across[at]);
    }
    hull.simplices = Ids(std::move(simplices));
    hull.simplex_neighbours = std::move(neighbours);
    hull.facets = Lists<std::uint64_t, Ids>::of_length(K, Ids(std::move(facets)));
    hull.facet_neighbours = Lists<std::uint32_t>::of_length(K, std::move(across));
    hull.simplex_facets = EvenArray<std::uint32_t>::of_step(facets_, 1);
  }

  void write_planes(const Frame& frame, Hull& hull) {
    const FacetPlane<K> plane(frame);
    hull.facet_planes.resize(std::size_t{facets_} * (K + 1));
    runs_.assign((facets_ + measure_run - 1) / measure_run, Share<K>());
    FacetBlock<K> block;
    for (unsigned c = 0; c < K; ++c) std::fill_n(block.origin[c], lanes, frame.at(0)[c]);
    for (unsigned first = 0; first < facets_; first += lanes) {
      const unsigned n = std::min(lanes, facets_ - first);
      for (unsigned lane = 0; lane < lanes; ++lane) {
        const Facet& facet = stored_[order_[first + std::min(lane, n - 1)]];
        for (unsigned j = 0; j < K; ++j) {
          const double* p = frame.at(facet.corner[j]);
          for (unsigned c = 0; c < K; ++c) block.corner[j][c][lane] = p[c];
        }
      }
      facet_block(block);
      facet_shares(block);
      for (unsigned lane = 0; lane < n; ++lane) {
        const unsigned i = first + lane;
        runs_[i / measure_run].add(facet_share(frame, plane, stored_[order_[i]].corner, block, lane,
                                               &hull.facet_planes[std::size_t{i} * (K + 1)]));
      }
    }
  }

  unsigned facets_ = 0;
  std::vector<std::uint64_t> ids_;             // of the vertices
  std::vector<std::uint32_t> rank_;            // of each point among the vertices
  std::vector<Facet> stored_;                  // by slot
  std::vector<std::uint32_t> number_, order_;  // of each slot; the slot of each number
  std::vector<std::uint64_t> keys_;            // the corners, then the slot
  BucketSort<std::uint64_t> sorted_;
  std::vector<Share<K>> runs_;
};

/// Working memory of a thread.
template <unsigned K>
struct Memory {
  SmallSurfaceNd<K> surface;
  SmallWriter<K> writer;
};

}  // namespace

bool hull_of_few_nd(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                    Hull& hull) {
  const Array<double> rows = gather_points(view, ids, count, short_run());
  const auto n = static_cast<unsigned>(count);
  return with_dimension<4, 7, 8>(view.dimension, [&](auto k) {
    auto& memory = thread_memory<Memory<k>>();
    const bool done = memory.surface.build(rows.data(), n) &&
                      memory.writer.run(view, ids, n, memory.surface, hull);
    // Free large surfaces: small sets rarely need them.
    if (!done && memory.surface.slots() > 1024) memory = {};
    return done;
  });
}

}  // namespace cullhull::internal
