#include "hull/insertion.hpp"

namespace cullhull::internal {

SimplicialHull hull_nd(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, const Control& control) {
  switch (points.dimension) {
    case 4:
      return Insertion<4>(points, simplex, budget, control).run();
    case 5:
      return Insertion<5>(points, simplex, budget, control).run();
    case 6:
      return Insertion<6>(points, simplex, budget, control).run();
    case 7:
      return Insertion<7>(points, simplex, budget, control).run();
    case 8:
      return Insertion<8>(points, simplex, budget, control).run();
    default:
      return Insertion<0>(points, simplex, budget, control).run();
  }
}

}  // namespace cullhull::internal
