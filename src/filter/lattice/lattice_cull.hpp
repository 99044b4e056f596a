// A filter for points on small integer lattices, where equal coordinates are common and planes full
// of points slow down every other filter and engine.
//
// Why thinning is right: a point strictly between two others on a line is not extreme, whatever
// else there is, and no vertex of any simplex of the result. Example: the grid 0 .. 9 x 0 .. 9 has
// 100 points; along x 20 are left (the two ends of each of ten lines), along y of these 4. Thinning
// along an axis needs no arithmetic but comparisons: coordinates are replaced by their ranks.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"

namespace cullhull::internal {

struct Run;
/// Keeps of all points on one line parallel to an axis only the two ends, because no other can be
/// extreme; of equal points only the first. It thins along each axis in turn. Coordinates are
/// replaced by numbers in the same order, so the grid may be any, not only integers. Returns false
/// if a sample shows that few points share lines, or if the numbers do not pack into 64 bits;
/// `kept` is then unspecified. Else `kept` receives ascending indices, the same for any number of
/// threads.
/// `rows`: count x d finite doubles. Time O(d count); memory 16 bytes a point, at most 96 a point
/// for the lines of one axis.
bool lattice_cull(const Array<double>& rows, std::uint32_t count, unsigned d, const Run& run,
                  std::vector<std::uint32_t>& kept);

}  // namespace cullhull::internal
