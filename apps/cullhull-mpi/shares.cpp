#include "shares.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "cullhull/error.hpp"
#include "outputs.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::PointView;

/// The data of a file that all ranks get from the rank that opened it.
struct FileFacts {
  std::uint64_t count = 0, sliced = 0;
  std::uint64_t placed = 0;  ///< a hash of the placement, 0 for none
};

/// FNV-1a of the doubles' bits; not 0.
std::uint64_t hash_of(const cullhull::Placement& placement) {
  if (placement.empty()) return 0;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::vector<double>* numbers : {&placement.scale, &placement.offset})
    for (const double v : *numbers) hash = (hash ^ std::bit_cast<std::uint64_t>(v)) * 0x100000001b3;
  return hash | 1;
}

/// That of all files, of which this rank has opened the first; empty where one has none.
cullhull::Placement common_placement(const Input& first, const std::vector<FileFacts>& facts,
                                     const std::vector<std::string>& files) {
  for (const FileFacts& f : facts)
    if (f.placed == 0) return {};
  for (std::size_t i = 1; i < facts.size(); ++i)
    if (facts[i].placed != facts[0].placed)
      throw Error(ErrorCode::bad_file,
                  files[i] + ": scale or offset are not those of the numbers in " + files[0]);
  return first.placement;
}

/// The part that the options name, where the file comes in parts.
Input open_one(const InputArguments& arguments, const std::string& file,
               const cullhull::ReadOptions& options) {
  if (file == "-" || ending_of(file) == ".hullstate")
    throw Error(ErrorCode::invalid_argument,
                input_name(file) + ": cullhull-mpi reads files of points that all ranks see");
  InputArguments one = arguments;
  one.path = file;
  return open_input(one, options);
}

}  // namespace

Share open_share(MPI_Comm comm, const InputArguments& arguments,
                 const std::vector<std::string>& files, const RunArguments& run,
                 const Together& together) {
  int me = 0, size = 1;
  MPI_Comm_rank(comm, &me);
  MPI_Comm_size(comm, &size);
  const auto rank = static_cast<std::uint64_t>(me), ranks = static_cast<std::uint64_t>(size);
  const bool whole_files = files.size() >= 4 * ranks;
  const auto owner = [&](std::size_t i) {
    return whole_files ? i * ranks / files.size() : i % ranks;
  };
  cullhull::ReadOptions read =
      read_options(arguments, std::max(run.threads, 1U), run.memory_bytes());
  if (!whole_files) {
    read.part = rank;
    read.parts = ranks;
  }
  std::vector<Input> opened(files.size());
  std::vector<FileFacts> facts(files.size());
  Share share;
  together([&] {
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (owner(i) != rank) continue;
      opened[i] = open_one(arguments, files[i], read);
      facts[i] = {opened[i].file.total(), !whole_files && opened[i].file.in_parts(),
                  hash_of(opened[i].placement)};
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, facts.data(), static_cast<int>(3 * facts.size()), MPI_UINT64_T,
                MPI_MAX, comm);
  together([&] {
    share.placement = common_placement(opened[0], facts, files);
    std::uint64_t first = 0;
    for (std::size_t i = 0; i < files.size(); first += facts[i++].count) {
      const std::uint64_t n = facts[i].count;
      if (facts[i].sliced != 0 && owner(i) != rank)
        opened[i] = open_one(arguments, files[i], read);
      else if (owner(i) != rank)
        continue;
      Input& input = opened[i];
      if (input.file.total() != n)
        throw Error(ErrorCode::bad_file, files[i] + ": ranks see " + std::to_string(n) + " and " +
                                             std::to_string(input.file.total()) + " points");
      if (i == 0) share.format = input.file.format();
      share.blocks.push_back({input.points, first + input.file.first()});
    }
  });
  share.inputs = std::move(opened);  // the blocks view its memory, which does not move
  return share;
}

}  // namespace app
