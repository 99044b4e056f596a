// How a program of ours ends: a status and a line.
#pragma once

#include <string>
#include <vector>

#include "parser.hpp"

namespace app {

struct Ending {
  int status = 0;
  std::string line;
};

/// To be called where an exception is handled; `words`: the command line.
Ending ending_of_exception(const std::vector<std::string>& words);

/// "The words (see cullhull hull --help)" for what the parser did not understand of the words as
/// `given`, after spell_out().
std::string usage_line(const Parsed& outcome, const std::vector<std::string>& given,
                       const std::vector<std::string>& words, const Parser& parser);

}  // namespace app
