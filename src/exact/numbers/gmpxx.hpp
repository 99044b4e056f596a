// GMP's C++ classes.
#pragma once

#include <cfloat>
// whose DBL_MAX_EXP the header of GMP 6.2.1 uses without including it
#include <gmpxx.h>
