// Results as all ranks get them from one: field by field, bit for bit.
#pragma once

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "distributed/communicator.hpp"

namespace cullhull::internal {

// Makes that of `root` that of all ranks. Memory that fails on one rank fails on all.
void broadcast(Communicator& ranks, int root, Hull& hull);
void broadcast(Communicator& ranks, int root, ExtremePoints& points);
void broadcast(Communicator& ranks, int root, std::vector<double>& numbers);

}  // namespace cullhull::internal
