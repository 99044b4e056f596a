// What main() of a program with commands does.
#pragma once

#include <vector>

#include "commands.hpp"
#include "topics.hpp"

namespace app {

struct Program {
  const char* name;
  const char* description;
  const char* footer;
  std::vector<Command (*)(Parser&)> commands;
  std::vector<Topic> topics = {};  ///< of `help TOPIC`
};

/// Runs the command that the words ask for, shows the help without any; returns the exit status. An
/// error is one line on standard error.
int run_program(const Program& program, int argc, char** argv);

}  // namespace app
