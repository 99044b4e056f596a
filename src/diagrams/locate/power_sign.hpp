// Which of two points is nearer to a third one, by power distances, exactly.
#pragma once

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// The sign of (|q - a|^2 - w_a) - (|q - b|^2 - w_b), for any finite doubles. `weighted`: a[d] and
/// b[d] are the weights; otherwise there are none.
Sign power_sign(unsigned d, bool weighted, const double* q, const double* a, const double* b);

}  // namespace cullhull::internal
