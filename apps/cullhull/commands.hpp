// The subcommands: each adds itself to the parser and returns what runs it.
#pragma once

#include <functional>

#include "parser.hpp"

namespace app {

/// Does the work and returns the exit status; throws cullhull::Error.
using Command = std::function<int()>;

Command add_hull(Parser& parent);
Command add_cull(Parser& parent);
Command add_certify(Parser& parent);
Command add_generate(Parser& parent);
Command add_info(Parser& parent);
Command add_track(Parser& parent);
Command add_delaunay(Parser& parent);
Command add_voronoi(Parser& parent);
Command add_alpha(Parser& parent);
Command add_view(Parser& parent);
Command add_qconvex(Parser& parent);
Command add_completion(Parser& parent);
Command add_man(Parser& parent);

/// Exit statuses (docs/formats.md); 0 is success.
enum ExitStatus : int {
  bad_input = 1,
  bad_usage = 2,
  not_certified = 3,
  over_budget = 4,
  no_backend = 5,
  cancelled = 130,
};

}  // namespace app
