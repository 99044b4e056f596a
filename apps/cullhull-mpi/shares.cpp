#include "shares.hpp"

#include <algorithm>
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
  std::uint64_t placed = 0;  ///< whether it has a placement
};

/// The part that the options name, where the file comes in parts.
Input open_one(const InputArguments& arguments, const std::string& file,
               const cullhull::ReadOptions& options) {
  if (file == "-" || ending_of(file) == ".hullstate")
    throw Error(ErrorCode::invalid_argument, input_name(file),
                ": cullhull-mpi reads files of points that all ranks see");
  InputArguments one = arguments;
  one.path = file;
  return open_input(one, options);
}

}  // namespace

std::optional<std::string> Share::named(std::string_view message) const {
  const std::size_t at = message.find("point ");  // behind "rank 2: "
  if (at == std::string_view::npos) return std::nullopt;
  message.remove_prefix(at);
  const auto point = point_of(message);
  for (std::size_t i = 0; point && i < blocks.size(); ++i) {
    const std::uint64_t first = blocks[i].first_id;
    if (*point < first || *point - first >= blocks[i].points.count) continue;
    const auto& bad = places[i].not_finite;
    const std::string line =
        bad && bad->point + first == *point ? ":" + std::to_string(bad->line) : "";
    return places[i].name + line + ": " + std::string(message);
  }
  return std::nullopt;
}

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
  together([&] {
    if (!arguments.raw) read.grid = cullhull::common_grid(files, read);
  });
  std::vector<Input> opened(files.size());
  std::vector<FileFacts> facts(files.size());
  Share share;
  together([&] {
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (owner(i) != rank) continue;
      opened[i] = open_one(arguments, files[i], read);
      facts[i] = {opened[i].file.total(), !whole_files && opened[i].file.in_parts(),
                  opened[i].placing.any ? std::uint64_t{1} : 0};
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, facts.data(), static_cast<int>(3 * facts.size()), MPI_UINT64_T,
                MPI_MAX, comm);
  together([&] {
    share.placing = opened[0].placing;
    share.placing.grid = read.grid.value_or(cullhull::Grid());
    for (const FileFacts& f : facts) share.placing.any = share.placing.any || f.placed != 0;
    std::uint64_t first = 0;
    for (std::size_t i = 0; i < files.size(); first += facts[i++].count) {
      const std::uint64_t n = facts[i].count;
      if (facts[i].sliced != 0 && owner(i) != rank)
        opened[i] = open_one(arguments, files[i], read);
      else if (owner(i) != rank)
        continue;
      Input& input = opened[i];
      if (input.file.total() != n)
        throw Error(ErrorCode::bad_file, files[i], ": ranks see ", n, " and ", input.file.total(),
                    " points");
      if (i == 0) share.format = input.file.format();
      share.blocks.push_back({input.points, first + input.file.first()});
      share.places.push_back(input.places.parts[0]);
    }
  });
  share.inputs = std::move(opened);  // the blocks view its memory, which does not move
  return share;
}

}  // namespace app
