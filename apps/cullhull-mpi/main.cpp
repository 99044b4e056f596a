// cullhull-mpi: `cullhull hull` over the ranks of an MPI job. Rank 0 alone prints and writes.
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "cullhull/mpi.hpp"
#include "cullhull/version.hpp"
#include "endings.hpp"
#include "measure.hpp"
#include "shares.hpp"
#include "signals.hpp"
#include "streaming.hpp"
#include "system.hpp"
#include "terminal.hpp"
#include "words.hpp"

namespace {

constexpr const char* description =
    "cullhull-mpi: the exact convex hull of points that the ranks of an MPI job read.\n"
    "Started by mpirun or srun; each rank reads its share of the files, which all ranks see. The\n"
    "result is that of 'cullhull hull', bit for bit.";
constexpr const char* footer =
    "Example:\n"
    "  mpirun -n 8 cullhull-mpi hull tiles/*.las -o hull.ply --json\n"
    "\n"
    "Exit status: that of cullhull. Errors are one line on standard error, from rank 0.";

/// Thrown on all ranks when the job ends: the error was reported.
struct Ended {
  app::Ending ending;
};

/// This rank's place in the job.
class Job {
 public:
  explicit Job(const std::vector<std::string>& words) : words_(words) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    elsewhere_.reports = rank_ == 0;
    elsewhere_.state = [this](const auto& input, const auto& files, const auto& run) {
      return state(input, files, run);
    };
    elsewhere_.certify = [this](const cullhull::Hull& hull, std::vector<double> rows) {
      return certify(hull, std::move(rows));
    };
  }
  int rank() const { return rank_; }
  const app::Elsewhere& elsewhere() const { return elsewhere_; }

  /// Runs `work` on this rank; where it throws on any rank, Ended is thrown on all.
  void together(const std::function<void()>& work) {
    app::Ending mine;
    bool named = false;
    try {
      work();
    } catch (const Ended&) {
      throw;
    } catch (const cullhull::Error& e) {
      // All ranks have learned of the point, and the rank that read it knows the file.
      const bool bad_point = e.code() == cullhull::ErrorCode::not_finite;
      const auto message = bad_point ? share_.named(e.what()) : std::nullopt;
      named = message.has_value();
      mine = app::ending_of_exception(words_);
      if (named) mine.line = *message;
    } catch (...) {
      mine = app::ending_of_exception(words_);
    }
    agree(mine, named);
  }

 private:
  /// The lowest rank that has failed speaks, first of those with a `named` point.
  void agree(app::Ending ending, bool named) {
    const int none = 2 * size_;
    int lowest = ending.status == 0 ? none : named ? rank_ : size_ + rank_;
    MPI_Request request;
    MPI_Iallreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD, &request);
    // Rank 0 may be using all processors for the hull: the others sleep.
    for (int done = 0;;) {
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done != 0) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (lowest == none) return;
    lowest %= size_;
    int head[2] = {ending.status, static_cast<int>(ending.line.size())};
    MPI_Bcast(head, 2, MPI_INT, lowest, MPI_COMM_WORLD);
    ending.status = head[0];
    ending.line.resize(static_cast<std::size_t>(head[1]));
    MPI_Bcast(ending.line.data(), head[1], MPI_CHAR, lowest, MPI_COMM_WORLD);
    throw Ended{ending};
  }

  app::Streamed state(const app::InputArguments& input, const std::vector<std::string>& files,
                      const app::RunArguments& run) {
    // All ranks have checked the command line alike; files may differ between them.
    together([] {});
    const app::Stopwatch watch;
    share_ = app::open_share(MPI_COMM_WORLD, input, files, run,
                             [this](const auto& work) { together(work); });
    options_.run = run.options();
    options_.root = 0;
    cullhull::mpi::Report report;
    options_.report = &report;
    app::TerminalProgress progress(run.quiet || rank_ != 0);
    options_.run.progress = progress.callback();
    app::Streamed result;
    together([&] {
      app::cancellable([&] {
        result.state = cullhull::mpi::hull_state(
            MPI_COMM_WORLD, std::span<const cullhull::mpi::Block>(share_.blocks), options_);
      });
    });
    options_.report = nullptr;
    options_.run.progress = {};
    result.read.blocks = files.size();
    result.read.dimension = result.state.dimension();
    result.read.scalar = result.state.scalar();
    result.read.format = share_.format;
    result.read.placement = share_.placing.placement;
    result.read.grid = share_.placing.grid;
    result.read.any_placed = share_.placing.any;
    result.read.columns = share_.placing.columns;
    result.input = input;
    result.report.maps = report.common > 0 ? 1 : 0;
    result.report.reductions = 1;
    result.seconds = watch.seconds();
    return result;
  }

  /// Rank 0 has its hull, or has failed: notifies the other ranks.
  cullhull::Certificate certify(const cullhull::Hull& hull, std::vector<double> rows) {
    together([] {});
    cullhull::Certificate result;
    together([&] {
      app::cancellable([&] {
        result = cullhull::mpi::certify(MPI_COMM_WORLD, share_.blocks, hull, rows, options_);
      });
    });
    return result;
  }

  const std::vector<std::string>& words_;
  int rank_ = 0, size_ = 1;
  app::Elsewhere elsewhere_;
  app::Share share_;
  cullhull::mpi::JobOptions options_;
};

/// Parses the command line, on all ranks alike.
int run(Job& job, const std::vector<std::string>& given) {
  app::Parser parser("cullhull-mpi", description);
  parser.set_version(CULLHULL_VERSION);
  parser.footer(footer);
  parser.require_subcommand(1, 1);
  const app::Command hull = app::add_hull_of(parser, &job.elsewhere());
  const std::vector<std::string> words =
      given.empty() ? std::vector<std::string>{"--help"} : app::spell_out(given, parser);
  const app::Parsed outcome = parser.parse(words);
  if (outcome.kind == app::Parsed::Kind::help) {
    if (job.rank() == 0)
      app::write_stdout(outcome.text.ends_with('\n') ? outcome.text : outcome.text + '\n');
    return 0;
  }
  if (outcome.kind != app::Parsed::Kind::command) {
    if (job.rank() == 0) app::complain(app::usage_line(outcome, given, words, parser));
    return app::bad_usage;
  }
  int status = 0;
  // An error of this rank alone ends the others where they next agree: at the latest here.
  job.together([&] { status = hull(); });
  return status;
}

/// Only rank 0 writes messages; it learns of the others' errors. A signal may arrive before MPI has
/// started, which takes a while: launchers give the rank in the environment, too.
void silence_others(bool started, int rank) {
  bool other = started && rank != 0;
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (const char* told = std::getenv(name); told != nullptr && !started)
      other = other || std::string_view(told) != "0";
  if (other) app::system::silence(app::system::standard_error);
}

}  // namespace

int main(int argc, char** argv) {
  app::system::prepare_heap();
  app::keep_standard_streams();
  const std::vector<std::string> words(argv + 1, argv + argc);
  int status = 0;
  silence_others(false, 0);
  try {
    app::install_signals();  // before MPI starts threads
    int level = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    Job job(words);
    silence_others(true, job.rank());
    try {
      status = run(job, words);
      MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
    } catch (const Ended& end) {
      if (job.rank() == 0) app::complain(end.ending.line);
      status = end.ending.status;
    }
    MPI_Finalize();
    return status;
  } catch (...) {
    // Outside of what ranks agree on: the others would wait forever.
    const app::Ending ending = app::ending_of_exception(words);
    app::complain(ending.line);
    int running = 0;
    if (MPI_Initialized(&running) == MPI_SUCCESS && running != 0)
      MPI_Abort(MPI_COMM_WORLD, ending.status);
    return ending.status;
  }
}
