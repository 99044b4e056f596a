// The 3D engine: rounds of sorted insertion, large rounds on several pieces of the surface in
// parallel. docs/algorithm.md, "The engine in 3D".
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hull/engine.hpp"
#include "hull/space/insertion_3d.hpp"
#include "hull/space/order_3d.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

/// Borders between the pieces of a surface: parallel planes, or keys along a curve of directions or
/// of normals.
struct Cut3D {
  double axis[3] = {0, 0, 0};
  std::vector<double> levels;  // of the planes, ascending
  DirectionKey key;
  unsigned bits = 12;
  bool by_normals = false;
  std::vector<std::uint32_t> keys;  // the first of every piece except the first
  bool planes() const { return !levels.empty(); }
  /// For planes: the piece that contains p.
  std::uint32_t piece_of(const double* p) const;
  /// The piece of a facet: that of its middle or its normal. Not for ranks.
  std::uint32_t piece_of(const Shared3D& shared, const Facet3D& facet) const;
  /// Keys of the facets of up to DirectionKey::block waiting points.
  void keys_of(const Shared3D& shared, const Waiting3D* waiting, std::uint32_t count,
               std::uint32_t* out) const;
  std::uint32_t piece_of_key(std::uint32_t key) const;
};

class Engine3D {
 public:
  /// `simplex`: four affinely independent points, whose centroid should be deep inside the hull.
  Engine3D(const LocalPoints& points, const std::uint32_t* simplex, const Run& run);
  TriangleMesh run();

 private:
  using Id = std::uint32_t;
  static constexpr Id none = Facet3D::none;
  /// Smaller rounds are inserted by one thread: 8192 points take about a millisecond, cutting and
  /// joining about half of that.
  static constexpr Id smallest_parallel_round = 8192;

  void copy_rows();
  void build_simplex();
  void reserve(std::uint64_t slots);
  void insert_round(Id begin, Id end);
  void give_slots(Id points);
  void take_back_slots();
  /// The slots in use (their facets may be dead), in ranges of at most `length`.
  std::vector<std::pair<Id, Id>> used_slots(Id length) const;
  /// Whether a slot was ever used; others are uninitialised.
  bool in_use(Id slot) const;
  Id live_facet() const;
  TriangleMesh surface();

  // pieces_3d.cpp
  struct Work {  // the points of a piece: a range of positions, or of waiting_
    Id begin = 0, end = 0;
  };
  void insert_in_pieces(Id begin, Id end);
  void screen_and_insert(Id begin, Id end);
  void insert_waiting(Array<Waiting3D> left);
  std::vector<Work> cut_again(Array<Waiting3D>& left, Id count);
  template <class At, class PieceOf>
  std::vector<Work> deal(std::uint64_t points, Id count, const At& at, const PieceOf& piece_of);
  void make_pieces(const std::vector<Work>& work);
  void own_facets();
  void find_entries(Id begin, Id end);
  void run_pieces(const std::vector<Work>& work, bool waiting);
  Array<Waiting3D> join_pieces();

  // cut_3d.cpp
  Cut3D choose_cut(const std::vector<Work>& work) const;
  Cut3D cut_along_curve(const std::vector<Work>& work) const;
  void choose_next_cut(const Array<Waiting3D>& left, const Id* keys, std::size_t count);
  template <class Planes, class Share>
  void try_planes(const std::vector<Id>& sample, double least, const Planes& planes,
                  const Share& share, Cut3D& best) const;
  Cut3D cut_by_planes(const double* axis, Id begin, Id end, std::size_t count) const;
  double share_cut(const Cut3D& cut, const std::vector<Id>& sample) const;
  std::vector<Id> sample_facets() const;
  std::uint32_t key_of(const double* p) const;

  // normals_3d.cpp
  void sort_by_normals(std::size_t round);
  void rank_facets();
  double way_across(Id f, const double* p) const;
  bool shorter_walks(Id begin, Id end, const KeyedId* order) const;
  void permute(Id begin, const KeyedId* order);

  const LocalPoints& points_;
  const Run& run_;
  const Orientation3D predicates_;
  const DirectionKey key_, normal_key_;
  InsertionOrder3D order_;
  BigArray<double> rows_;
  RawArray<Facet3D> facets_;
  Shared3D shared_;
  Id slots_ = 0;              // number in use, or assigned to a piece
  bool by_normals_ = false;   // whether the remaining points and the cuts are ordered by normals
  BigArray<Id> rank_;         // of facets by their normals, at the start of the round
  bool normals_help_ = true;  // false once they did not shorten walks
  bool few_seen_ = false;     // few of the last round's points were outside
  std::vector<Piece3D> pieces_;
  Cut3D cut_;                    // the last one
  Id owners_ = 1;                // all facets' owners are below it
  BigArray<Waiting3D> waiting_;  // piece by piece
  std::vector<Entries3D::Entry> entries_;
};

}  // namespace cullhull::internal
