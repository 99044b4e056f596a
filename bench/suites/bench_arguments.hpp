// Command line arguments and clocks for the programs bench/*_bench.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

namespace cullhull::bench {

/// The arguments [--n N] [--threads 1,2] [--repeat K] [WORKLOAD ...].
struct BenchArguments {
  std::uint64_t n = 1'000'000;  ///< points
  unsigned repeat = 3;
  std::vector<unsigned> threads{1, 2};
  std::vector<std::string> workloads{};
};

/// Parses arguments; `given` are the defaults. Without a workload, all are selected. A word that is
/// not in `known` ends the program with status 2, after listing `all`.
template <class Known>
BenchArguments parse_arguments(int argc, char** argv, BenchArguments given, const Known& known,
                               const std::vector<std::string>& all) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (i + 1 < argc && word == "--n") {
      given.n = std::strtoull(argv[++i], nullptr, 10);
    } else if (i + 1 < argc && word == "--repeat") {
      given.repeat = static_cast<unsigned>(std::max(1, std::atoi(argv[++i])));
    } else if (i + 1 < argc && word == "--threads") {
      given.threads.clear();
      for (char* at = argv[++i]; *at != 0; at += *at == ',') {
        char* const before = at;
        given.threads.push_back(static_cast<unsigned>(std::strtoul(at, &at, 10)));
        if (at == before) {
          std::fprintf(stderr, "%s: --threads needs numbers such as 1,2\n", argv[0]);
          std::exit(2);
        }
      }
    } else if (known(word)) {
      given.workloads.emplace_back(word);
    } else {
      std::fprintf(stderr, "%s: no workload '%s'; there are:", argv[0], argv[i]);
      for (const std::string& name : all) std::fprintf(stderr, " %s", name.c_str());
      std::fprintf(stderr, "\n");
      std::exit(2);
    }
  }
  if (given.workloads.empty()) given.workloads = all;
  return given;
}

/// Processor time in ms of all threads of this process, in user and kernel mode; other programs
/// disturb it less than elapsed time.
inline double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace cullhull::bench
