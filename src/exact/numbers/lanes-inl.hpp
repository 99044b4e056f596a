// Vectors of doubles with the operators of a number, and of double-doubles, for kernels that are
// compiled for several instruction sets. It is included once for each, hence Highway's unusual
// include guard.

#if defined(CULLHULL_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CULLHULL_LANES_INL
#undef CULLHULL_LANES_INL
#else
#define CULLHULL_LANES_INL
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// A vector of doubles with the operators of a number.
struct Lanes {
  V v;
  Lanes() = default;
  HWY_INLINE Lanes(V all) : v(all) {}                       // NOLINT: implicit, a vector is one
  HWY_INLINE Lanes(double each) : v(hn::Set(D(), each)) {}  // NOLINT: text is written for numbers
  HWY_INLINE Lanes operator-() const { return hn::Neg(v); }
};
HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return hn::Add(a.v, b.v); }
HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return hn::Sub(a.v, b.v); }
HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return hn::Mul(a.v, b.v); }
HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return hn::Div(a.v, b.v); }
HWY_INLINE M operator<(Lanes a, Lanes b) { return hn::Lt(a.v, b.v); }
HWY_INLINE M operator>(Lanes a, Lanes b) { return hn::Gt(a.v, b.v); }
HWY_INLINE Lanes root(Lanes a) { return hn::Sqrt(a.v); }
HWY_INLINE Lanes absolute(Lanes a) { return hn::Abs(a.v); }
HWY_INLINE Lanes greater_of(Lanes a, Lanes b) { return hn::Max(a.v, b.v); }
HWY_INLINE Lanes chosen(M mask, Lanes yes, Lanes no) { return hn::IfThenElse(mask, yes.v, no.v); }

HWY_INLINE unsigned lane_count() { return static_cast<unsigned>(hn::Lanes(D())); }
HWY_INLINE Lanes load(const double* from) { return hn::Load(D(), from); }
HWY_INLINE void store(Lanes a, double* to) { hn::Store(a.v, D(), to); }

// Why an unfused product exists: a fused one gives the exact low part in one operation, but where
// products underflow its bits differ from those of DoubleDouble, and results that are written must
// not depend on the instruction set.

/// A DoubleDouble in each lane, with the same error bounds. `fused`: multiplies by fused operations
/// where there are any, in less time; otherwise each lane has the bits of DoubleDouble also where
/// products underflow. No operator is a friend: GCC compiles friends of a template for the
/// instruction set of the whole file, not for this one, and where nothing is inlined they then hand
/// vectors over in another way than is expected.
template <bool fused>
struct WideLanes {
  Lanes high, low;
  WideLanes() = default;
  HWY_INLINE WideLanes(Lanes v) : high(v), low(0.0) {}  // NOLINT: every double is one
  HWY_INLINE WideLanes(Lanes h, Lanes l) : high(h), low(l) {}

  static HWY_INLINE WideLanes sum(Lanes a, Lanes b) {
    const Lanes s = a + b;
    const Lanes t = s - a;
    return {s, (a - (s - t)) + (b - t)};
  }
  static HWY_INLINE WideLanes product(Lanes a, Lanes b) {
    const Lanes p = a * b;
    if constexpr (fused && HWY_NATIVE_FMA) return {p, hn::MulSub(a.v, b.v, p.v)};
    const Lanes split = 134217729.0;
    const Lanes ta = split * a, tb = split * b;
    const Lanes ah = ta - (ta - a), bh = tb - (tb - b);
    const Lanes al = a - ah, bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
  }
  static HWY_INLINE WideLanes quick(Lanes a, Lanes b) {
    const Lanes s = a + b;
    return {s, b - (s - a)};
  }
  HWY_INLINE WideLanes operator-() const { return {-high, -low}; }
  HWY_INLINE WideLanes operator+(const WideLanes& b) const {
    WideLanes s = sum(high, b.high);
    const WideLanes t = sum(low, b.low);
    s = quick(s.high, s.low + t.high);
    return quick(s.high, s.low + t.low);
  }
  HWY_INLINE WideLanes operator-(const WideLanes& b) const { return *this + -b; }
  HWY_INLINE WideLanes operator*(const WideLanes& b) const {
    const WideLanes p = product(high, b.high);
    return quick(p.high, p.low + (high * b.low + low * b.high));
  }
  HWY_INLINE WideLanes operator/(const WideLanes& b) const {
    const Lanes q1 = high / b.high;
    WideLanes rest = *this - b * WideLanes(q1);
    const Lanes q2 = rest.high / b.high;
    rest = rest - b * WideLanes(q2);
    return quick(q1, q2) + WideLanes(rest.high / b.high);
  }
};
template <bool fused>
HWY_INLINE WideLanes<fused> chosen(M mask, const WideLanes<fused>& yes,
                                   const WideLanes<fused>& no) {
  return {chosen(mask, yes.high, no.high), chosen(mask, yes.low, no.low)};
}

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CULLHULL_LANES_INL
