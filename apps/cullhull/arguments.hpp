// Arguments that several subcommands share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/options.hpp"
#include "parser.hpp"

namespace app {

/// Which points to read: a file, how, and which of its coordinates.
struct InputArguments {
  std::string path;
  std::string format;
  std::uint32_t dimension = 0;
  std::string type;
  std::string columns;
  /// Where a command takes many: as they were given. Their files are one set of points.
  std::vector<std::string> words;

  void add_to(Parser& command);
  /// INPUT may be several words; `last`: what the help says of the last of them.
  void add_many_to(Parser& command, const std::string& last = "");
  /// The files that the words stand for (input_files), or the one path.
  std::vector<std::string> files() const;
  /// The same; from now on `path` is what messages call them all.
  std::vector<std::string> find_files();

 private:
  void add_format_to(Parser& command);
};

/// An open file and the view of it that was asked for.
struct Input {
  cullhull::PointFile file;
  /// Holds the points where they are of several files.
  std::vector<std::byte> gathered;
  cullhull::PointView points;
};

/// `memory`: most that what is compressed may unpack to; 0: ReadOptions has it.
Input open_input(const InputArguments& arguments, unsigned threads = 0, std::uint64_t memory = 0);
/// All of these files' points in memory, one after the other.
Input open_inputs(const InputArguments& arguments, const std::vector<std::string>& files,
                  unsigned threads, std::uint64_t memory = 0);

/// How open_input would open it.
cullhull::ReadOptions read_options(const InputArguments& arguments, unsigned threads,
                                   std::uint64_t memory = 0);

/// How to run: everything that ends up in cullhull::Options.
struct RunArguments {
  std::string cull = "auto";
  std::string backend = "auto";
  unsigned threads = 0;
  std::string memory;
  bool quiet = false;

  /// `filter`: with --cull and --backend, which checking a hull does not have.
  void add_to(Parser& command, bool filter);
  cullhull::Options options() const;
  /// What --memory says; 0 without it.
  std::uint64_t memory_bytes() const;
};

/// Where the machine's constants are: $CULLHULL_MACHINE, else cullhull/machine.json in
/// $XDG_CONFIG_HOME or ~/.config; empty without a home.
std::string machine_file();

/// "800", "1.5M", "2GiB", "1e6": a whole number with an optional unit (k M G T powers of 1000; Ki
/// Mi Gi Ti powers of 1024; a B may follow). Throws Error{invalid_argument} naming `option`.
std::uint64_t parse_size(std::string_view text, std::string_view option);

/// A whole number below 2^64. Throws Error{invalid_argument} naming `option`.
std::uint64_t parse_whole(std::string_view text, std::string_view option);

/// "standard input" for "-".
std::string input_name(const std::string& path);

/// Calls read(); where a point is not finite, the error names the file as well.
template <class Read>
auto naming_file(const std::string& path, const Read& read) -> decltype(read()) {
  try {
    return read();
  } catch (const cullhull::Error& e) {
    if (e.code() != cullhull::ErrorCode::not_finite) throw;
    throw cullhull::Error(e.code(), input_name(path) + ": " + e.what());
  }
}

/// Appended to the help of every command that reads points.
extern const char* const input_help;

}  // namespace app
