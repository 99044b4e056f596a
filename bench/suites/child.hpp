// Work in a separate process: a rival that takes too long, runs out of memory or crashes ends only
// that process, and Ctrl-C ends it at once.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace cullhull::bench {

struct ChildLimits {
  double seconds = 0;  ///< 0: no limit
  std::stop_token stop;
};

struct ChildRun {
  std::string output;
  bool timed_out = false;
};

/// The name of a .npy file for a rival; the destructor removes the file. Use one at a time.
struct Scratch {
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path;
};

/// Runs `work` in a fork of this process, which sees all memory as it is now and changes none of
/// it. `work` must not use this process's threads, which do not exist in a fork. Empty if the child
/// failed. Throws Error{cancelled}; Error{io} if no process can be created.
std::optional<ChildRun> run_forked(const std::function<std::string()>& work,
                                   const ChildLimits& limits);

/// The path of a program in the folder of the running program; empty if absent.
std::string program_beside(const char* name);

/// Runs a program and returns its standard output; words[0] is its path.
std::optional<ChildRun> run_program(const std::vector<std::string>& words,
                                    const ChildLimits& limits);

}  // namespace cullhull::bench
