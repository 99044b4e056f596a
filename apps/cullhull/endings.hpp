// How the programs end: exit status and message.
#pragma once

#include <string>
#include <vector>

#include "parser.hpp"

namespace app {

struct Ending {
  int status = 0;
  std::string line;
};

/// To be called in a catch block; `words`: the command line.
Ending ending_of_exception(const std::vector<std::string>& words);

/// "MESSAGE (see cullhull hull --help)" for words that the parser did not accept. `given`: the
/// command line after spell_out().
std::string usage_line(const Parsed& outcome, const std::vector<std::string>& given,
                       const std::vector<std::string>& words, const Parser& parser);

}  // namespace app
