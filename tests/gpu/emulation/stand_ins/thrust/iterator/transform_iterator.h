#pragma once
#include "thrust/iterators_stand_in.hpp"
