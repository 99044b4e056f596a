// Man pages and shell completions, made of what the parser knows of commands and options.
#pragma once

#include <string>
#include <vector>

#include "parser.hpp"
#include "topics.hpp"

namespace app {

/// A script that completes the program's words in "bash", "zsh" or "fish".
std::string completion_script(const Parser& program, const std::vector<Topic>& topics,
                              const std::string& shell);

struct ManPage {
  std::string name;  ///< "cullhull-hull"
  char section = '1';
  std::string text;  ///< for man and groff
};

/// The program's own page, one for each command and one for each topic.
std::vector<ManPage> man_pages(const Parser& program, const std::vector<Topic>& topics);

}  // namespace app
