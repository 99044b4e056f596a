// The subcommands: each adds itself to the parser and returns what runs it.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace app {

/// Does the work and returns the exit status; throws cullhull::Error.
using Command = std::function<int()>;

Command add_hull(CLI::App& parent);
Command add_cull(CLI::App& parent);
Command add_certify(CLI::App& parent);
Command add_generate(CLI::App& parent);
Command add_info(CLI::App& parent);
Command add_track(CLI::App& parent);
Command add_view(CLI::App& parent);
Command add_qconvex(CLI::App& parent);
Command add_bench(CLI::App& parent);

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
