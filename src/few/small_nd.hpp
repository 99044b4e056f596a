// The hull of a few points in four to eight dimensions, in memory that is reused from set to set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hull/general/facet_planes.hpp"
#include "hull/general/ridge_pairs.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {

/// The surface of the hull of points in D dimensions, as simplices of which no two adjacent ones
/// are coplanar. Incremental insertion; each point is tested against all facets at once by their
/// planes in f32, so nothing is searched. Doubtful signs are decided by `orientation`.
template <unsigned D>
class SmallSurfaceNd {
 public:
  /// A surface of more facets than this is given up. With its result it takes less than 5 MiB
  /// (`WayRow::bytes`).
  static constexpr unsigned most_facets = 8192;

  /// Inserts `count` points, packed rows of finite doubles. False, and the surface then must not be
  /// used, where some point lies in the plane of a facet that it is tested against (so for points
  /// in a flat, too), for coordinates of extreme magnitude, for too many facets and too many signs
  /// that f32 leaves open. Time: that of testing each point against all facets, and about 50 (4D)
  /// to 150 ns (8D) for each facet made. Memory of at most 2.5 MB is kept.
  bool build(const double* rows, unsigned count);

  FewSimplices simplices() const { return {slots_, vertices_.data(), neighbours_.data()}; }

 private:
  struct Ridge {  // of the horizon
    std::uint32_t facet, outside;
    std::uint8_t slot, back;  // of the vertices off the ridge, in the two facets
  };
  /// On a horizon ridge the seen facet's neighbour is the new facet's number and this flag.
  static constexpr std::uint32_t is_new = 0x80000000U;

  bool live(unsigned f) const { return neighbours(f)[0] != no_index; }
  const std::uint32_t* vertices(unsigned f) const { return &vertices_[std::size_t{f} * D]; }
  const std::uint32_t* neighbours(unsigned f) const { return &neighbours_[std::size_t{f} * D]; }
  const double* row(std::uint32_t i) const { return &scaled_[std::size_t{i} * D]; }
  bool scale(const double* rows);
  bool choose_simplex(std::uint32_t* simplex);
  bool start(const std::uint32_t* simplex);
  void measure_extent();
  void order_outermost_first(const std::uint32_t* simplex);
  bool sieve(std::size_t begin);
  void aim(std::uint32_t point, float* y) const;
  bool insert(std::uint32_t point);
  bool find_seen(std::uint32_t point, bool& any);
  bool sees_exactly(std::uint32_t point, unsigned f, bool& sees);
  void find_horizon();
  std::uint32_t turn(std::size_t k, unsigned i) const;
  bool replace(std::uint32_t point);
  void store_plane(unsigned f, const float* plane);
  void clear_plane(unsigned f);
  bool grow(unsigned slots);

  unsigned count_ = 0, slots_ = 0, open_signs_ = 0;
  double centre_[D], reach_[D];
  std::vector<double> scaled_;  // rows with |x| <= 1
  std::vector<double> rest_;    // rows without their components along the chosen edges
  std::vector<float> distance_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> vertices_, neighbours_;
  std::vector<PlaneGroup<D>> planes_;
  std::vector<float> level_planes_;  // for the sieve
  std::vector<std::uint8_t> is_seen_;
  std::vector<std::uint8_t> seen_bits_, open_bits_;
  std::vector<std::uint32_t> seen_, free_;
  // New facets, before they have slots.
  std::vector<Ridge> horizon_;
  unsigned ridges_ = 0;
  std::vector<std::uint32_t> new_vertices_, new_neighbours_;
  std::vector<std::uint8_t> apex_;
  std::vector<float> new_planes_;
  RidgePairs pairs_;
};

}  // namespace cullhull::internal
