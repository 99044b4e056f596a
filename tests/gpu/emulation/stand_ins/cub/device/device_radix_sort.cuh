#pragma once
#include "cub/cub_stand_in.hpp"
