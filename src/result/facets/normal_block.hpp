// Normals of eight simplices at a time, in dimensions above those of `cofactors`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cullhull::internal {

/// Eight simplices of k corners in R^k, one a lane, and their cofactor normals: the bits that
/// simplex_normal computes for one simplex. Elimination of a single small matrix waits for the
/// search for each pivot. Eight side by side take 0.4 to 0.5 of the time a simplex, and a fifth in
/// double-doubles (measured in 9D to 20D with AVX-512).
class NormalBlock {
 public:
  static constexpr unsigned lanes = 8;
  /// Beyond this dimension a block would not fit the cache.
  static constexpr unsigned most_dimensions = 48;

  /// A number of each simplex.
  struct alignas(64) Row {
    double of[lanes];
  };

  explicit NormalBlock(unsigned k);

  unsigned dimension() const { return k_; }
  /// Coordinate c of corner j of each simplex.
  double* corner(unsigned j, unsigned c) { return corners_[std::size_t{j} * k_ + c].of; }

  /// Computes the normals in doubles, their lengths, and the products of the lengths of the edges
  /// from corner 0. A normal is 0 if the edges are dependent.
  void compute();
  /// Computes the normals in double-doubles and rounds them, and their lengths. Leaves edges() as
  /// it is.
  void compute_carefully();

  double normal(unsigned lane, unsigned c) const { return normals_[c].of[lane]; }
  double length(unsigned lane) const { return length_.of[lane]; }
  double edges(unsigned lane) const { return edges_.of[lane]; }

 private:
  friend struct NormalKernel;

  const unsigned k_;
  std::vector<Row> corners_, normals_;
  Row length_{}, edges_{};
  std::vector<Row> scratch_;
};

}  // namespace cullhull::internal
