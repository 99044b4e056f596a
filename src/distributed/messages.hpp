// Sends results from one rank to all: field by field, bit for bit.
#pragma once

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "distributed/communicator.hpp"

namespace cullhull::internal::inline distributed {

// Overwrites the argument by that of `root`. Where memory fails on one rank, all throw.
void broadcast(Communicator& ranks, int root, Hull& hull);
void broadcast(Communicator& ranks, int root, ExtremePoints& points);
void broadcast(Communicator& ranks, int root, std::vector<double>& numbers);

}  // namespace cullhull::internal::inline distributed
