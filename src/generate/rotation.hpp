// Angles whose cosine and sine have the same bits on every machine.
#pragma once

#include <cmath>

namespace cullhull::internal {

struct Rotation {
  double cosine, sine;
};

/// Cosine and sine of the angle of `turns` full turns, with the same bits on every machine. The
/// angle is reduced to at most an eighth of a turn and inserted into Taylor's series, of which the
/// first omitted terms are below 2^-53.
inline Rotation rotation_by(double turns) {
  const double rest = turns - std::floor(turns + 0.5);
  const double quarter = std::floor(4 * rest + 0.5);
  const double a = (rest - quarter / 4) * 6.283185307179586477;
  const double q = -a * a;
  double c = 1, s = 1;
  for (int k = 16; k >= 2; k -= 2) {
    c = 1 + c * q / (k * (k - 1));
    s = 1 + s * q / (k * (k + 1));
  }
  s *= a;
  switch (static_cast<int>(quarter)) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case -1:
      return {s, -c};
    default:
      return {-c, -s};
  }
}

}  // namespace cullhull::internal
