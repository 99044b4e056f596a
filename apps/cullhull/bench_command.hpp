// The suites of `cullhull bench`, one file each.
#pragma once

#include "commands.hpp"

namespace app {

Command add_bench_machine(Parser& bench);
Command add_bench_paper(Parser& bench);
Command add_bench_rivals(Parser& bench);
Command add_bench_calls(Parser& bench);
Command add_bench_lifting(Parser& bench);
Command add_bench_stream(Parser& bench);

}  // namespace app
