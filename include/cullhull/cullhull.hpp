// Everything: include this one, or the header of the one idea you need.
#pragma once

#include "cullhull/array.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/track.hpp"
#include "cullhull/version.hpp"
