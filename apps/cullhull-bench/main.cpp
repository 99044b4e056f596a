// cullhull-bench: measurements of the library on this machine. Not installed.
#include "bench_commands.hpp"
#include "program.hpp"

int main(int argc, char** argv) {
  return app::run_program(
      {.name = "cullhull-bench",
       .description =
           "cullhull-bench: the paper's evaluation, rivals, single calls, triangulations, "
           "streams, ways.",
       .footer = "Examples:\n"
                 "  cullhull-bench rivals --report rivals.html    beside Qhull and CGAL\n"
                 "\n"
                 "Exit status: 0 success; 1 the system refused; 2 bad usage; 3 results differ and "
                 "ours are\n"
                 "not proved; 4 out of memory; 130 cancelled. 'cullhull-bench help SUITE' tells "
                 "more.",
       .commands = {app::add_paper, app::add_rivals, app::add_calls, app::add_lifting,
                    app::add_stream, app::add_paths}},
      argc, argv);
}
