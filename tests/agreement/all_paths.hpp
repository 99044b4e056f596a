// Runs a set through every path (filter, threads, layout, scalar type) and holds all of them to one
// answer: the oracle's vertices, a valid certificate, the same bits.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>

#include "call_options.hpp"
#include "canonical_hash.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "made_sets.hpp"
#include "oracles.hpp"

namespace cullhull::testing_support {

inline Ids sorted_vertices(const Hull& h) {
  Ids ids = h.vertices;
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// True if every coordinate survives the way through T and back, the sign of zero included.
template <class T>
bool converted(const PointSet& s, std::vector<T>& out) {
  out.clear();
  for (double v : s.coordinates) {
    if constexpr (std::is_integral_v<T>) {
      if (v < static_cast<double>(std::numeric_limits<T>::min()) ||
          v > static_cast<double>(std::numeric_limits<T>::max()))
        return false;
    } else if (std::fabs(v) > static_cast<double>(std::numeric_limits<T>::max())) {
      return false;
    }
    out.push_back(static_cast<T>(v));
    if (std::bit_cast<std::uint64_t>(static_cast<double>(out.back())) !=
        std::bit_cast<std::uint64_t>(v))
      return false;
  }
  return true;
}

/// For sets that take seconds: `few` is the filter with two threads beside the reference, which is
/// serial and unfiltered.
enum class Paths { all, few, reference };

class AllPaths {
 public:
  explicit AllPaths(const PointSet& set, Paths paths = Paths::all) : set_(set), paths_(paths) {}

  /// The reference path's hull; every other path is compared to it.
  Hull run() {
    const Hull reference = convex_hull(view_of(set_), options_of(1, CullMethod::none));
    hash_ = canonical_hash(reference);
    certified(view_of(set_), reference, "reference");
    if (paths_ == Paths::reference) return reference;
    if (paths_ == Paths::few) {
      for (CullMethod cull : {CullMethod::gauge, CullMethod::pseudo_hull})
        compare(view_of(set_), cull, 2, "rows of f64");
      return reference;
    }
    for (CullMethod cull :
         {CullMethod::none, CullMethod::gauge, CullMethod::pseudo_hull, CullMethod::automatic})
      for (unsigned threads : {1U, 2U}) compare(view_of(set_), cull, threads, "rows of f64");
    layouts(set_.coordinates, "f64");
    scalar<float>("f32");
    scalar<std::int8_t>("i8");
    scalar<std::uint8_t>("u8");
    scalar<std::int16_t>("i16");
    scalar<std::uint16_t>("u16");
    scalar<std::int32_t>("i32");
    scalar<std::uint32_t>("u32");
    return reference;
  }

 private:
  void certified(const PointView& view, const Hull& hull, const std::string& path) {
    const Certificate c = certify(view, hull, options_of(2));
    EXPECT_TRUE(c.valid) << set_.name << ", " << path << ": " << c.reason;
  }
  void compare(const PointView& view, CullMethod cull, unsigned threads, const std::string& path) {
    const Hull h = convex_hull(view, options_of(threads, cull));
    EXPECT_EQ(canonical_hash(h), hash_)
        << set_.name << ", " << path << ", cull " << static_cast<int>(cull) << ", threads "
        << threads << ": " << h.vertices.size() << " vertices, " << h.facet_count() << " facets";
  }
  template <class T>
  void layouts(const std::vector<T>& rows, const std::string& path) {
    const unsigned d = set_.dimension;
    const std::vector<T> columns = transposed(rows, d);
    const auto by_column = PointView::column_major(columns.data(), set_.count(), d);
    compare(by_column, CullMethod::gauge, 2, "columns of " + path);
    compare(by_column, CullMethod::pseudo_hull, 3, "columns of " + path);
    compare(by_column, CullMethod::automatic, 1, "columns of " + path);
    // Records of d scalars and three bytes, from an odd address.
    const std::size_t record = d * sizeof(T) + 3;
    std::vector<std::byte> bytes(set_.count() * record + 1);
    for (std::uint64_t i = 0; i < set_.count(); ++i)
      std::memcpy(&bytes[1 + i * record], &rows[i * d], d * sizeof(T));
    const PointView strided{
        bytes.data() + 1, scalar_type_of<T>(), d, set_.count(), static_cast<std::ptrdiff_t>(record),
        sizeof(T)};
    compare(strided, CullMethod::none, 2, "records of " + path);
    compare(strided, CullMethod::gauge, 1, "records of " + path);
    compare(strided, CullMethod::pseudo_hull, 1, "records of " + path);
  }
  template <class T>
  void scalar(const std::string& path) {
    std::vector<T> rows;
    if (!converted(set_, rows)) return;
    const auto view = PointView::row_major(rows.data(), set_.count(), set_.dimension);
    compare(view, CullMethod::none, 1, "rows of " + path);
    compare(view, CullMethod::automatic, 1, "rows of " + path);
    compare(view, CullMethod::gauge, 2, "rows of " + path);
    compare(view, CullMethod::pseudo_hull, 2, "rows of " + path);
    layouts(rows, path);
    certified(view, convex_hull(view), path);
  }

  const PointSet& set_;
  Paths paths_;
  std::uint64_t hash_ = 0;
};

/// All paths agree, are certified, and the extreme points are `expected` (ascending).
inline Hull expect_everywhere(const PointSet& set, const Ids& expected, Paths paths = Paths::all) {
  SCOPED_TRACE(set.name);
  Hull h;
  try {
    h = AllPaths(set, paths).run();
    EXPECT_EQ(sorted_vertices(h), expected) << set.name;
  } catch (const std::exception& e) {
    ADD_FAILURE() << set.name << ": " << e.what();
  }
  return h;
}

/// The same, with the vertices told by exact linear programs: for small sets.
inline Hull expect_exact(const PointSet& set) {
  return expect_everywhere(set, exact_extreme_points(set));
}

}  // namespace cullhull::testing_support
