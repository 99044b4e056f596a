// Keys of directions, compiled once per instruction set and chosen at run time.

#include "hull/space/order_3d.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/space/direction_key.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Face of the cube and cell on it, for a block of positions.
void cells(const DirectionKey::Map& map, const double* x, const double* y, const double* z,
           std::uint32_t count, double cells_per_axis, std::int32_t* face, std::int32_t* u,
           std::int32_t* v) {
  using D = hn::ScalableTag<double>;
  using V = hn::Vec<D>;
  const D d;
  const hn::Rebind<std::int32_t, D> i32;
  const V half = hn::Set(d, 0.5 * cells_per_axis), last = hn::Set(d, cells_per_axis - 1);
  const auto image = [&](const double* row, V a, V b, V c) HWY_ATTR {
    return hn::MulAdd(hn::Set(d, row[0]), a,
                      hn::MulAdd(hn::Set(d, row[1]), b, hn::Mul(hn::Set(d, row[2]), c)));
  };
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V a = hn::Sub(hn::LoadU(d, x + i), hn::Set(d, map.centre[0]));
    const V b = hn::Sub(hn::LoadU(d, y + i), hn::Set(d, map.centre[1]));
    const V c = hn::Sub(hn::LoadU(d, z + i), hn::Set(d, map.centre[2]));
    const V p = image(map.linear[0], a, b, c), q = image(map.linear[1], a, b, c),
            r = image(map.linear[2], a, b, c);
    const V ap = hn::Abs(p), aq = hn::Abs(q), ar = hn::Abs(r);
    const V m = hn::Max(ap, hn::Max(aq, ar));
    const auto on_p = hn::Eq(ap, m), on_r = hn::AndNot(on_p, hn::Gt(ar, aq));
    const V s = hn::IfThenElse(on_p, q, p), t = hn::IfThenElse(on_r, q, r);
    const V w = hn::IfThenElse(on_p, p, hn::IfThenElse(on_r, r, q));
    V number = hn::IfThenElseZero(hn::Lt(w, hn::Zero(d)), hn::Set(d, 3.0));
    number = hn::Add(
        number,
        hn::IfThenElse(on_p, hn::Zero(d), hn::IfThenElse(on_r, hn::Set(d, 2.0), hn::Set(d, 1.0))));
    // A zero direction gets an arbitrary cell.
    const V scale = hn::Div(half, hn::Max(m, hn::Set(d, 0x1p-900)));
    const auto place = [&](V k) HWY_ATTR {
      return hn::Min(hn::Max(hn::MulAdd(k, scale, half), hn::Zero(d)), last);
    };
    hn::StoreU(hn::DemoteTo(i32, number), i32, face + i);
    hn::StoreU(hn::DemoteTo(i32, place(s)), i32, u + i);
    hn::StoreU(hn::DemoteTo(i32, place(t)), i32, v + i);
  }
}

HWY_INLINE hn::Vec<hn::ScalableTag<std::uint32_t>> load(hn::ScalableTag<std::uint32_t>,
                                                        const std::int32_t* from) {
  return hn::LoadU(hn::ScalableTag<std::uint32_t>(), reinterpret_cast<const std::uint32_t*>(from));
}
HWY_INLINE hn::Vec<hn::ScalableTag<std::uint64_t>> load(hn::ScalableTag<std::uint64_t> d,
                                                        const std::int32_t* from) {
  const hn::Rebind<std::int32_t, decltype(d)> i32;
  return hn::BitCast(d, hn::PromoteTo(hn::RebindToSigned<decltype(d)>(), hn::LoadU(i32, from)));
}

/// Position on the Hilbert curve of a face's cells; branchless, as branches would be unpredictable.
template <class Key>
void curve(const std::int32_t* face, const std::int32_t* u, const std::int32_t* v,
           std::uint32_t count, unsigned bits, Key* keys) {
  const hn::ScalableTag<Key> d;
  using V = hn::Vec<decltype(d)>;
  const V one = hn::Set(d, Key{1});
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    V key = load(d, face + i), x = load(d, u + i), y = load(d, v + i);
    for (unsigned digit = bits; digit-- > 0;) {
      const V rx = hn::And(hn::ShiftRightSame(x, static_cast<int>(digit)), one);
      const V ry = hn::And(hn::ShiftRightSame(y, static_cast<int>(digit)), one);
      const V step = hn::Xor(hn::Or(rx, hn::Add(rx, rx)), ry);
      key = hn::Or(hn::ShiftLeft<2>(key), step);
      const V turn = hn::Sub(ry, one);  // all ones where ry == 0
      const V flip = hn::And(turn, hn::Sub(hn::Zero(d), rx));
      x = hn::Xor(x, flip);
      y = hn::Xor(y, flip);
      const V swap = hn::And(hn::Xor(x, y), turn);
      x = hn::Xor(x, swap);
      y = hn::Xor(y, swap);
    }
    hn::StoreU(key, d, keys + i);
  }
}

template <class Key>
void keys_of(const DirectionKey::Map& map, const double* x, const double* y, const double* z,
             std::uint32_t count, unsigned bits, Key* keys) {
  HWY_ALIGN std::int32_t face[DirectionKey::block], u[DirectionKey::block], v[DirectionKey::block];
  cells(map, x, y, z, count, static_cast<double>(1U << bits), face, u, v);
  curve(face, u, v, count, bits, keys);
}

void direction_keys(const DirectionKey::Map& map, const double* x, const double* y, const double* z,
                    std::uint32_t count, unsigned bits, std::uint32_t* keys) {
  keys_of(map, x, y, z, count, bits, keys);
}

void fine_direction_keys(const DirectionKey::Map& map, const double* x, const double* y,
                         const double* z, std::uint64_t* keys) {
  keys_of(map, x, y, z, DirectionKey::block, 24, keys);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(direction_keys);
HWY_EXPORT(fine_direction_keys);

void DirectionKey::keys(const double* x, const double* y, const double* z, unsigned bits,
                        std::uint32_t* keys, std::uint32_t count) const {
  HWY_DYNAMIC_DISPATCH(direction_keys)(map_, x, y, z, count, bits, keys);
}

void DirectionKey::fine_keys(const double* x, const double* y, const double* z,
                             std::uint64_t* keys) const {
  HWY_DYNAMIC_DISPATCH(fine_direction_keys)(map_, x, y, z, keys);
}

namespace {

bool cholesky(const double (&a)[3][3], double (&l)[3][3]) {
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j <= i; ++j) {
      double s = a[i][j];
      for (unsigned k = 0; k < j; ++k) s -= l[i][k] * l[j][k];
      if (i == j) {
        if (!(s > 1e-6 * a[i][i])) return false;
        l[i][i] = std::sqrt(s);
      } else {
        l[i][j] = s / l[j][j];
      }
    }
  return true;
}

/// Inverse of the matrix with the given columns; false where doubles cannot hold it.
bool invert(const double (&c)[3][3], double (&out)[3][3]) {
  double det = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const double *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
    for (unsigned j = 0; j < 3; ++j)
      out[i][j] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
  }
  for (unsigned j = 0; j < 3; ++j) det += c[0][j] * out[0][j];
  if (!(std::abs(det) > 0x1p-900)) return false;
  for (auto& row : out)
    for (double& v : row) {
      v /= det;
      if (!(std::abs(v) < 0x1p400)) return false;
    }
  return true;
}

}  // namespace

DirectionKey::DirectionKey(const LocalPoints& points, const double* centre,
                           const std::uint32_t* simplex)
    : map_{{centre[0], centre[1], centre[2]}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}} {
  // First changes to coordinates along the simplex's edges: the sums below are then
  // well-conditioned however thin the body is.
  double edges[3][3], rough[3][3];
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j)
      edges[i][j] = points.row(simplex[i + 1])[j] - points.row(simplex[0])[j];
  if (!invert(edges, rough)) return;
  std::copy(&rough[0][0], &rough[0][0] + 9, &map_.linear[0][0]);
  double moments[3][3] = {};
  const std::uint32_t stride = points.count / 1024 + 1;
  for (std::uint64_t i = 0; i < points.count; i += stride) {
    const double* p = points.row(static_cast<std::uint32_t>(i));
    double y[3];
    for (unsigned k = 0; k < 3; ++k)
      y[k] = rough[k][0] * (p[0] - centre[0]) + rough[k][1] * (p[1] - centre[1]) +
             rough[k][2] * (p[2] - centre[2]);
    for (unsigned a = 0; a < 3; ++a)
      for (unsigned b = 0; b <= a; ++b) moments[a][b] += y[a] * y[b];
  }
  double l[3][3] = {};
  if (!cholesky(moments, l)) return;
  for (unsigned j = 0; j < 3; ++j)
    for (unsigned i = 0; i < 3; ++i) {  // forward substitution, column by column
      double s = rough[i][j];
      for (unsigned k = 0; k < i; ++k) s -= l[i][k] * map_.linear[k][j];
      map_.linear[i][j] = s / l[i][i];
    }
}

DirectionKey DirectionKey::for_normals() const {
  DirectionKey key;
  key.map_ = {{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double inverse[3][3];  // of the transpose, as rows are passed as columns
  if (invert(map_.linear, inverse))
    std::copy(&inverse[0][0], &inverse[0][0] + 9, &key.map_.linear[0][0]);
  return key;
}

DirectionKey DirectionKey::turned() const {
  // The rotation of the quaternion (4, 1, 2, 3): no power of it maps the cube to itself.
  constexpr double rotation[3][3] = {{4, -20, 22}, {28, 10, 4}, {-10, 20, 20}};
  DirectionKey key(*this);
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) {
      key.map_.linear[i][j] = 0;
      for (unsigned k = 0; k < 3; ++k)
        key.map_.linear[i][j] += rotation[i][k] / 30 * map_.linear[k][j];
    }
  return key;
}

}  // namespace cullhull::internal
#endif
