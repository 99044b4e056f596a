// The suites of cullhull-bench: each adds itself to the parser and returns what runs it.
#pragma once

#include "commands.hpp"

namespace app {

Command add_paper(Parser& parent);
Command add_rivals(Parser& parent);
Command add_calls(Parser& parent);
Command add_lifting(Parser& parent);
Command add_stream(Parser& parent);
Command add_paths(Parser& parent);

}  // namespace app
