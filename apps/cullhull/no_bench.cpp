// cullhull bench in a program that was built without its suites.
#include "bench_command.hpp"
#include "cullhull/error.hpp"

namespace app {

Command add_bench(Parser& parent) {
  auto words = std::make_shared<std::vector<std::string>>();
  Parser& command = *parent.add_subcommand("bench", "Measurements: not part of this program");
  command.add_option("WORDS", *words, "Whatever was meant")->type_name("");
  command.footer(
      "'make bench', or CMake with -DCULLHULL_WITH_SUITES=ON, builds a program that has them.\n"
      "\n"
      "Exit status: 2 bad usage; 5 always else.");
  return [words]() -> int {
    throw cullhull::Error(cullhull::ErrorCode::backend_unavailable,
                          "bench: this program was built without measurements; build it with "
                          "-DCULLHULL_WITH_SUITES=ON (make bench)");
  };
}

}  // namespace app
