// Independent, exact check of a hull.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

struct Certificate {
  bool valid = false;
  /// Empty when valid, else one line: the first thing found wrong, with ids.
  std::string reason;
  std::uint64_t ridges_checked = 0;
  std::uint64_t points_checked = 0;
  /// Orientations that needed exact arithmetic.
  std::uint64_t exact_decisions = 0;
  explicit operator bool() const noexcept { return valid; }
};

/// Checks `hull` against `points` with exact predicates, independently of the engine's code: every
/// ridge is shared by exactly two facets and is locally convex, an interior point is beneath every
/// facet and one ray meets one facet (Mehlhorn, Naeher, Seel, Seidel, Schilz, Schirra, Uhrig,
/// "Checking geometric programs or verification of geometric structures", 1999), every input point
/// is on or beneath the facet its ray meets. So a valid certificate proves that `hull` is the hull
/// of `points`, that `vertices` are exactly the extreme points (lowest id of equal ones), and that
/// `facets` are the maximal ones. Planes, measures and centroid are held against the accuracy that
/// docs/exactness.md ("Numbers") states. What is wrong with hull or points makes the certificate
/// invalid, whatever it is: lists of wrong lengths and points that are not finite, too.
///
/// Time O(n * walk + simplices * d^3), memory O(simplices). Thread safe. Options used: threads,
/// stop, progress. Errors: cancelled; invalid_argument for null data or no dimension.
Certificate certify(const PointView& points, const Hull& hull, const Options& options = {});

/// The same proof for the hull of its own vertices, by the coordinates that it carries
/// (Options::with_coordinates): whether the points it was computed from are all inside is not
/// checked. Error{invalid_argument} if the hull has no coordinates.
Certificate certify(const Hull& hull, const Options& options = {});

/// What one of several streams has found of the points that were pushed to it.
struct CertifiedPart {
  std::uint64_t points = 0, vertices = 0;  ///< checked, and of these vertices of the hull
  std::uint64_t exact_decisions = 0;
  std::string reason;    ///< as in Certificate
  std::uint64_t at = 0;  ///< the first id of the block that `reason` was found in
};

/// certify() of points that come in pieces: the same proof, in memory O(simplices).
class CertifyStream {
 public:
  /// Checks the hull by itself. `vertex_coordinates`: a row for each of hull.vertices, in that
  /// order; each is held against its point when that comes. The hull has to outlive the object.
  CertifyStream(const Hull& hull, std::vector<double> vertex_coordinates,
                const Options& options = {});
  CertifyStream(CertifyStream&&) noexcept;
  CertifyStream& operator=(CertifyStream&&) noexcept;
  ~CertifyStream();

  /// Points first_id, first_id + 1, ... of all; any order of blocks, any threads. Each point is to
  /// come once.
  void push(const PointView& block, std::uint64_t first_id);
  /// What came so far, for a stream of the same hull elsewhere; and taking it in there.
  CertifiedPart part() const;
  void add(const CertifiedPart& part);
  /// Call after the last block. Of several faults the one in the lowest block is reported.
  Certificate finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
