// Texts of `cullhull help TOPIC`: what several commands have in common.
#pragma once

#include <string>
#include <vector>

namespace app {

struct Topic {
  const char* name;
  const char* about;  ///< one line
  const char* text;
};

const std::vector<Topic>& topics();

/// The end of the help of a command that reads points.
extern const char* const input_footer;

}  // namespace app
