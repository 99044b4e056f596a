// The version, which CMake, pip, the program and the documentation read here.
#pragma once

#define CULLHULL_VERSION_MAJOR 0
#define CULLHULL_VERSION_MINOR 1
#define CULLHULL_VERSION_PATCH 0
#define CULLHULL_VERSION "0.1.0"
