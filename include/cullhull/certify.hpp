// Independent, exact verification of a hull.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::internal {
/// The partial result of one CertifyStream, to be added to another stream of the same hull.
struct CertifiedPart {
  std::uint64_t points = 0, vertices = 0;  ///< points checked, and how many of them are vertices
  std::uint64_t exact_decisions = 0;
  std::string reason;    ///< as in Certificate
  std::uint64_t at = 0;  ///< first id of the block in which `reason` was found
};

}  // namespace cullhull::internal

namespace cullhull {

struct Certificate {
  bool valid = false;
  /// Empty when valid, else one line: the first fault found, with ids.
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
/// `facets` are the maximal ones. Planes, measures and centroid are checked against the accuracy
/// that docs/exactness.md ("Numbers") states. Any fault of the hull or the points makes the
/// certificate invalid, including lists of wrong lengths and points that are not finite.
///
/// Time O(n * walk + simplices * d^3), where a walk is the number of simplices visited for a point;
/// memory O(simplices). Thread safe. Options used: threads, stop, progress. Errors: cancelled;
/// invalid_argument for null data or dimension 0.
Certificate certify(const PointView& points, const Hull& hull, const Options& options = {});

/// The same proof for the hull of its own vertices, by the coordinates that it carries
/// (Options::with_coordinates): whether the points it was computed from are all inside is not
/// checked. Error{invalid_argument} if the hull has no coordinates.
Certificate certify(const Hull& hull, const Options& options = {});

/// certify() for points that arrive in blocks: the same proof, in memory O(simplices).
class CertifyStream {
 public:
  /// Checks the hull on its own. `vertex_coordinates`: a row for each of hull.vertices, in that
  /// order; each row is compared with its point when that is pushed. The hull must outlive this
  /// object.
  CertifyStream(const Hull& hull, std::vector<double> vertex_coordinates,
                const Options& options = {});
  CertifyStream(Hull&& hull, std::vector<double>, const Options& = {}) = delete;
  CertifyStream(CertifyStream&&) noexcept;
  CertifyStream& operator=(CertifyStream&&) noexcept;
  ~CertifyStream();

  /// Checks the points first_id, first_id + 1, ... Blocks may be pushed in any order, from any
  /// threads. Each point must be pushed exactly once.
  void push(const PointView& block, std::uint64_t first_id);
  /// Counts points that the hull leaves out (HullStream::skip): each id is pushed or skipped. A
  /// vertex among them makes the certificate invalid.
  void skip(std::uint64_t count);
  /// part(): what this stream has checked so far. add(): counts another stream's part in this one.
  internal::CertifiedPart part() const;
  void add(const internal::CertifiedPart& part);
  /// Call after the last block. Of several faults, the one in the block with the lowest id is
  /// reported.
  Certificate finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
