// The suites of `cullhull bench`, one file each.
#pragma once

#include "commands.hpp"

namespace app {

Command add_bench_machine(CLI::App& bench);
Command add_bench_paper(CLI::App& bench);
Command add_bench_rivals(CLI::App& bench);

}  // namespace app
