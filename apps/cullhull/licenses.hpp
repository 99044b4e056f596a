// The licence of cullhull and those of what a program contains of others.
#pragma once

#include <string_view>

namespace app {

extern const std::string_view licenses;

}  // namespace app
