#include "hull/plane/planar.hpp"

namespace cullhull::internal::inline hull {
namespace {

/// Whether a - b was computed as `difference` without rounding (Knuth's error term is 0). False
/// where something overflows.
bool exact_difference(double a, double b, double difference) {
  const double t = a - difference;
  return (a - (difference + t)) + (t - b) == 0;
}

/// a * b = p + the result (Dekker, Veltkamp), if nothing under- or overflows.
double product_error(double a, double b, double p) {
  const double ta = 134217729.0 * a, tb = 134217729.0 * b;
  const double ah = ta - (ta - a), bh = tb - (tb - b);
  const double al = a - ah, bl = b - bh;
  return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
}

/// On lattices and lines turns of exactly zero are frequent, and mostly their differences are exact
/// in doubles. Then comparing the two products suffices: rounding is monotone, so if they differ
/// after rounding that is their order, else their errors decide. Sets `sign` where it returns true.
bool compare_products(const Entry& a, const Entry& b, const Entry& c, int& sign) {
  const double ax = a.x - c.x, ay = a.y - c.y, bx = b.x - c.x, by = b.y - c.y;
  if (!exact_difference(a.x, c.x, ax) || !exact_difference(a.y, c.y, ay) ||
      !exact_difference(b.x, c.x, bx) || !exact_difference(b.y, c.y, by))
    return false;
  const double l = ax * by, r = ay * bx;
  if (l != r) {
    sign = l > r ? 1 : -1;
    return l == l && r == r;
  }
  if (l == 0) {
    sign = 0;
    return (ax == 0 || by == 0) && (ay == 0 || bx == 0);
  }
  // From 2^-900 on the error is a multiple of 2^(-900 - 106) at least: a double.
  if (!(std::fabs(l) >= 0x1p-900)) return false;
  const double el = product_error(ax, by, l), er = product_error(ay, bx, r);
  sign = el > er ? 1 : el < er ? -1 : 0;
  return el == el && er == er;  // splitting a factor may overflow
}

}  // namespace

int Turn::exact(const Entry& a, const Entry& b, const Entry& c) {
  int sign = 0;
  if (compare_products(a, b, c, sign)) return sign;
  const double* p[3] = {&a.x, &b.x, &c.x};
  return static_cast<int>(orientation_exact(2, p));
}

}  // namespace cullhull::internal::inline hull
