// Hull for headers whose functions take or return one. Users get it complete; the sources of this
// project, which are compiled anew whenever it changes, include hull.hpp where they need it.
#pragma once

#ifndef CULLHULL_OWN_SOURCES
#include "cullhull/hull.hpp"
#endif

#pragma GCC visibility push(default)
namespace cullhull {
struct Hull;
}  // namespace cullhull
#pragma GCC visibility pop
