#include "hull/insertion.hpp"

namespace cullhull::internal {

SimplicialHull hull_3d(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, const Control& control) {
  return Insertion<3>(points, simplex, budget, control).run();
}

}  // namespace cullhull::internal
