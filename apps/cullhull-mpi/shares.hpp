// The part of a job's files that a rank reads.
#pragma once

#include <mpi.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "cullhull/mpi.hpp"

namespace app {

/// A rank's share of the files' points; views memory that it owns.
struct Share {
  std::vector<Input> inputs;
  std::vector<cullhull::mpi::Block> blocks;
  std::vector<Places::Part> places;  ///< of each block
  std::string format;                ///< of the first file, on the ranks that opened it
  Placing placing;                   ///< of all files, on rank 0

  /// A message about a point of this rank, with its file and, where it is a text, its line; nothing
  /// about points of others.
  std::optional<std::string> named(std::string_view message) const;
};

/// Runs `work` on this rank; where it throws on any rank, all end.
using Together = std::function<void(const std::function<void()>& work)>;

/// Collective. Files that are read in place are divided into slices, one a rank; where there are
/// many files, or text files, which every rank would have to parse, each is read whole by one rank.
Share open_share(MPI_Comm comm, const InputArguments& arguments,
                 const std::vector<std::string>& files, const RunArguments& run,
                 const Together& together);

}  // namespace app
