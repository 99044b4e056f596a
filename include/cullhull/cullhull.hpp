// Everything of cullhull::cullhull: include this one, or the header of the one idea you need. Files
// are read and written by cullhull/io.hpp, which needs cullhull::io.
#pragma once

#include "cullhull/array.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/growing_hull.hpp"
#include "cullhull/halfspaces.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/machine.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/query.hpp"
#include "cullhull/simplify.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "cullhull/version.hpp"
