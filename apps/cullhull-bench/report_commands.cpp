// cullhull-bench paper, rivals, calls, lifting, stream and paths: suites that give a report.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "arguments.hpp"
#include "bench_commands.hpp"
#include "calls.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "families.hpp"
#include "lifting.hpp"
#include "outputs.hpp"
#include "paper.hpp"
#include "paths.hpp"
#include "rivals.hpp"
#include "signals.hpp"
#include "stream.hpp"
#include "terminal.hpp"
#include "viewer/assets.hpp"
#include "viewer/page.hpp"

namespace app {
namespace {

using cullhull::bench::Report;

constexpr const char* exit_status_text =
    "Exit status: 0 success; 1 the system refused; 2 bad usage; 3 results differ and ours are\n"
    "not proved; 4 out of memory; 130 cancelled.";

/// Where to write a report.
struct ReportArguments {
  std::string json, page, markdown;
  double limit = 300;
  bool quiet = false;

  void add_outputs(Parser& command) {
    add_json_option(command, json, "The report");
    command.add_option("--report", page, "The report as one HTML page with charts")
        ->type_name("FILE.html");
    command.add_option("--markdown", markdown, "Its tables as Markdown; - for standard output")
        ->type_name("FILE.md");
    command.add_flag("-q,--quiet", quiet, "No table and no progress");
  }

  void add_limit(Parser& command, const char* what) {
    allow_real_range(
        *command
             .add_option("--limit", limit,
                         fmt::format("Seconds for {}, 0 without; {:g} if not given", what, limit))
             ->type_name("SECONDS"),
        0, 1e6);
  }
};

/// Options of suites that measure a few long runs.
struct RunsArguments : ReportArguments {
  double scale = 1;
  unsigned repeat = 5;

  void add_to(Parser& command) {
    add_outputs(command);
    const std::string sizes = fmt::format("Factor on every size; {:g} if not given", scale);
    allow_real_range(*command.add_option("--scale", scale, sizes)->type_name("S"), 1e-6, 100);
    allow_range(*command.add_option("--repeat", repeat, "Runs of ours; the median counts"), 1,
                1000);
    add_limit(command, "one run of a rival");
  }
};

/// One self-contained page: docs/viewer.md, "How a page is made".
void write_page(const std::string& path, const Report& report) {
  namespace viewer = cullhull::viewer;
  viewer::Page page;
  page.title = "cullhull-bench " + report.suite;
  page.body = viewer::assets::report_html;
  page.styles = {viewer::assets::report_css};
  page.scripts = {viewer::assets::report_js};
  page.data.push_back({"report", "application/json", report_json(report)});
  cullhull::write_text(path, viewer::page_text(page));
}

using Measure = std::function<Report(const cullhull::Progress&)>;

int run(const ReportArguments& a, const Measure& measure) {
  FilePlan plan;
  plan.writes_json(a.json);
  plan.writes("--report", a.page, page_endings);
  plan.writes("--markdown", a.markdown, {".md", ".markdown"});
  Report report;
  {
    TerminalProgress progress(a.quiet);
    cancellable([&] { report = measure(progress.callback()); });
  }
  if (!a.json.empty()) cullhull::write_text(a.json, report_json(report));
  if (!a.page.empty()) write_page(a.page, report);
  if (!a.markdown.empty()) cullhull::write_text(a.markdown, report_markdown(report));
  if (!a.quiet && !plan.uses_stdout()) write_stdout(report_table(report));
  if (report.agrees()) return 0;
  complain("some rows differ");
  return not_certified;
}

struct PaperArguments : RunsArguments {
  unsigned threads = 0;
  std::vector<std::string> figures;
};

/// Which sets to measure.
struct SetArguments {
  std::vector<std::string> workloads, shapes, points, scalars;
  std::vector<unsigned> dimensions;

  void add_to(Parser& command) {
    command.add_option("--workload", workloads, "This one; may be given again, as all below")
        ->type_name("NAME");
    command.add_option("--shape", shapes, "Every combination of these: points")->type_name("SHAPE");
    allow_range(*command.add_option("--dimension", dimensions, "dimensions"), 2, 16);
    command.add_option("--points", points, "and sizes, e.g. 100k or 8M")->type_name("N");
    allow_words(*command.add_option("--scalar", scalars, "As this type"), {"f64", "f32", "i32"});
  }

  using Workload = cullhull::bench::Workload;
  std::vector<Workload> chosen(const std::vector<Workload>& usual,
                               const char* usual_shape = "ball") const;
};

void add_without(Parser& command, std::vector<std::string>& without) {
  allow_words(*command.add_option("--without", without, "Leave this rival out"), {"qhull", "cgal"});
}

void add_programs(Parser& command, std::vector<std::string>& programs) {
  command.add_option("--rival", programs, "Another program that is timed; may be given again")
      ->type_name("NAME=PROGRAM");
}

std::vector<cullhull::bench::RivalProgram> programs_in(const std::vector<std::string>& given) {
  std::vector<cullhull::bench::RivalProgram> programs;
  for (const std::string& rival : given) {
    const std::size_t equals = rival.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == rival.size())
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "--rival needs NAME=PROGRAM, not '" + rival + "'");
    programs.push_back({rival.substr(0, equals), rival.substr(equals + 1)});
  }
  return programs;
}

struct RivalArguments : RunsArguments {
  std::string threads;
  SetArguments sets;
  std::vector<std::string> without;

  void add_to(Parser& command) {
    RunsArguments::add_to(command);
    command.add_option("--threads", threads, "For ours, e.g. 1,2,4,all; one and all if not given")
        ->type_name("LIST");
    sets.add_to(command);
    add_without(command, without);
  }
  void write_to(cullhull::bench::ContestSettings& settings) const;  ///< all but the workloads
};

struct LiftingArguments : RivalArguments {
  std::string scan;
  std::vector<std::string> programs;
};

struct CallArguments : ReportArguments {
  std::string threads, callers, busy;
  SetArguments sets;
  std::vector<std::string> rivals, without;
  double seconds = 0.5;
  std::uint64_t seed = 1;
};

struct StreamBenchArguments : ReportArguments {
  double scale = 1;
  unsigned repeat = 5;
  std::vector<std::string> formats;
  std::string folder, memory = "1GiB";
};

struct PathArguments : ReportArguments, cullhull::bench::PathSettings {};

/// "1,2,all" where `all`, which gives 0, is allowed.
std::vector<unsigned> counts_in(const std::string& text, const char* option, unsigned least,
                                bool all) {
  std::vector<unsigned> counts;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    unsigned count = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    const bool number = error == std::errc() && end == word.data() + word.size();
    if (!(all && word == "all") && (!number || count < least || count > 1024))
      throw cullhull::Error(
          cullhull::ErrorCode::invalid_argument,
          fmt::format("{} needs numbers such as 1,2{}, not '{}'", option, all ? ",all" : "", text));
    counts.push_back(count);
  }
  return counts;
}

/// The workloads named, else the product of the options given, else the default ones; each for
/// every scalar type given.
std::vector<cullhull::bench::Workload> SetArguments::chosen(const std::vector<Workload>& usual,
                                                            const char* usual_shape) const {
  std::vector<Workload> sets;
  for (const std::string& name : workloads) sets.push_back(cullhull::bench::workload_named(name));
  if (!shapes.empty() || !dimensions.empty() || !points.empty()) {
    const auto or_else = [](const auto& given, auto otherwise) {
      return given.empty() ? std::decay_t<decltype(given)>{otherwise} : given;
    };
    for (const std::string& shape : or_else(shapes, std::string(usual_shape)))
      for (const unsigned d : or_else(dimensions, 3U))
        for (const std::string& n : or_else(points, std::string("1M")))
          sets.push_back({shape, d, parse_size(n, "--points"), cullhull::ScalarType::f64});
  }
  if (scalars.empty()) return sets;
  if (sets.empty())
    for (const Workload& w : usual)
      if (w.scalar == cullhull::ScalarType::f64) sets.push_back(w);
  std::vector<Workload> all;
  for (const Workload& w : sets)
    for (const std::string& scalar : scalars) {
      all.push_back(w);
      all.back().scalar = scalar == "f32"   ? cullhull::ScalarType::f32
                          : scalar == "i32" ? cullhull::ScalarType::i32
                                            : cullhull::ScalarType::f64;
    }
  return all;
}

bool left_out(const std::vector<std::string>& without, const char* name) {
  return std::find(without.begin(), without.end(), name) != without.end();
}

void RivalArguments::write_to(cullhull::bench::ContestSettings& settings) const {
  settings.scale = scale;
  settings.repeat = repeat;
  if (!threads.empty()) settings.threads = counts_in(threads, "--threads", 1, true);
  settings.limit = limit;
  settings.with_qhull = !left_out(without, "qhull");
  settings.with_cgal = !left_out(without, "cgal");
}

/// "If nothing is chosen:" and the names.
std::string usual_workloads(const std::vector<cullhull::bench::Workload>& usual) {
  std::string text = "If nothing is chosen:";
  std::size_t column = 80;
  for (const auto& w : usual) {
    const std::string name = w.name();
    if (column + name.size() > 78) {
      text += "\n ";
      column = 1;
    }
    text += " " + name;
    column += name.size() + 1;
  }
  return text;
}

std::string rivals_help() {
  std::string text =
      "A workload is a name such as ball-3d-8M or grid-3d-2M-i32: points, dimension, how many,\n"
      "scalar type (f64 if not given). Points are the shapes of 'cullhull generate' and, in 3D,\n";
  for (const cullhull::Shape& family : cullhull::bench::hard_families())
    text += fmt::format("  {:<24}{}\n", family.name, family.description);
  text += usual_workloads(cullhull::bench::rival_workloads());
  return text +
         "\nf32 and i32 round, and rivals get what was rounded. CGAL is timed by\n"
         "cullhull-rival-cgal, if that program lies beside this one.\n"
         "\n"
         "Examples:\n"
         "  cullhull-bench rivals --report rivals.html             some minutes\n"
         "  cullhull-bench rivals --scale 1 --markdown rivals.md   docs/performance.md's table\n"
         "  cullhull-bench rivals --scale 1 --shape ball --shape sphere --dimension 2 \\\n"
         "    --dimension 3 --points 100k --points 10M --scalar f64 --scalar f32 --threads "
         "1,2,all\n"
         "\n" +
         exit_status_text;
}

std::string lifting_help() {
  std::string text = "Points are the shapes of 'cullhull generate', and\n";
  for (const cullhull::Shape& family : cullhull::bench::spread_families())
    text += fmt::format("  {:<11}{}\n", family.name, family.description);
  text += "  scan       the first coordinates of the points of --scan FILE\n";
  text += usual_workloads(cullhull::bench::lifting_workloads(false));
  return text +
         "\nand with --scan scan-2d-100k scan-2d-1M. Qhull is called as SciPy calls it; CGAL is "
         "timed\n"
         "by cullhull-rival-cgal, if that program lies beside this one, in 2D and 3D. A rival's\n"
         "PROGRAM is run with a .npy of doubles and the word delaunay, and writes its seconds and "
         "the\n"
         "number of simplices as doubles in binary.\n"
         "\n"
         "Examples:\n"
         "  cullhull-bench lifting --scale 0.1                     a minute\n"
         "  cullhull-bench lifting --scan tile.laz.npy --workload scan-2d-1M\n"
         "  cullhull-bench lifting --shape uniform --dimension 4 --points 10k --without cgal\n"
         "\n" +
         std::string(exit_status_text);
}

std::string calls_help() {
  return "Calls follow one another over different sets of the points of 'cullhull generate'; a\n"
         "name is that of a set, such as ball-3d-100 or sphere-2d-1k-f32.\n" +
         usual_workloads(cullhull::bench::call_workloads()) +
         "\nA rival's PROGRAM is run with a .npy of doubles and the number of sets to cut it "
         "into,\n"
         "and writes the seconds of each set's hull as doubles in binary.\n"
         "\n"
         "Examples:\n"
         "  cullhull-bench calls                                   three minutes\n"
         "  cullhull-bench calls --dimension 3 --points 50 --threads 0,1,2 --callers 1,4\n"
         "  cullhull-bench calls --busy 0 --rival VQhull=./vqhull-calls --dimension 2\n"
         "\n" +
         std::string(exit_status_text);
}

}  // namespace

Command add_paper(Parser& parent) {
  auto a = std::make_shared<PaperArguments>();
  Parser& command = *parent.add_subcommand(
      "paper", "The evaluation of Tang, Zhao, Tong and Manocha 2012, on this machine");
  a->add_to(command);
  allow_range(*command.add_option("--threads", a->threads, "For ours; 0 means all"), 0, 1024);
  allow_words(*command.add_option("--figure", a->figures, "Only this one; may be given again"),
              cullhull::bench::paper_figures());
  command.footer(std::string("Takes some minutes and 4 GB at scale 1; Qhull runs beside us.\n\n") +
                 exit_status_text);
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::PaperSettings s;
      s.scale = a->scale;
      s.repeat = a->repeat;
      s.threads = a->threads;
      s.figures = a->figures;
      s.limit = a->limit;
      return cullhull::bench::run_paper(s, progress, stop_token());
    });
  };
}

Command add_rivals(Parser& parent) {
  auto a = std::make_shared<RivalArguments>();
  a->scale = 0.2;
  a->limit = 30;
  Parser& command =
      *parent.add_subcommand("rivals", "Ours beside Qhull and, where it was built, CGAL");
  a->add_to(command);
  command.footer(rivals_help());
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::ContestSettings s;
      a->write_to(s);
      s.workloads = a->sets.chosen(cullhull::bench::rival_workloads());
      return cullhull::bench::run_rivals(s, progress, stop_token());
    });
  };
}

Command add_lifting(Parser& parent) {
  auto a = std::make_shared<LiftingArguments>();
  a->repeat = 3;
  a->limit = 60;
  Parser& command = *parent.add_subcommand(
      "lifting", "Delaunay triangulations beside Qhull and, where it was built, CGAL");
  a->add_to(command);
  needs_value(*command.add_option("--scan", a->scan, "Points of a file, named scan above"))
      .type_name("FILE");
  add_programs(command, a->programs);
  command.footer(lifting_help());
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::LiftingSettings s;
      a->write_to(s);
      s.workloads = a->sets.chosen(cullhull::bench::lifting_workloads(!a->scan.empty()), "uniform");
      s.scan = a->scan;
      s.rivals = programs_in(a->programs);
      return cullhull::bench::run_lifting(s, progress, stop_token());
    });
  };
}

Command add_calls(Parser& parent) {
  auto a = std::make_shared<CallArguments>();
  a->limit = 30;
  Parser& command = *parent.add_subcommand(
      "calls", "Latency of single calls, on an idle machine and a busy one, and the first call");
  a->add_outputs(command);
  a->add_limit(command, "all calls of a program");
  const auto list = [&](const char* name, std::string& value, const char* what) {
    needs_value(*command.add_option(name, value, what)).type_name("LIST");
  };
  list("--threads", a->threads, "For ours, 0 the default; 0,1 if not given");
  list("--callers", a->callers, "Threads that call at once; 1 if not given");
  list("--busy", a->busy, "Other processes that keep a core busy each; 0,1 if not given");
  a->sets.add_to(command);
  allow_real_range(
      *command
           .add_option("--seconds", a->seconds, "Seconds of calls for each value; 0.5 if not given")
           ->type_name("S"),
      0, 1e6);
  command.add_option("--seed", a->seed, "Seed of the random sets; 1 if not given");
  add_programs(command, a->rivals);
  add_without(command, a->without);
  command.footer(calls_help());
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::CallSettings s;
      s.workloads = a->sets.chosen(cullhull::bench::call_workloads());
      if (!a->threads.empty()) s.threads = counts_in(a->threads, "--threads", 0, false);
      if (!a->callers.empty()) s.callers = counts_in(a->callers, "--callers", 1, false);
      if (!a->busy.empty()) s.busy = counts_in(a->busy, "--busy", 0, false);
      s.seconds = a->seconds;
      s.seed = a->seed;
      s.limit = a->limit;
      s.with_qhull = !left_out(a->without, "qhull");
      s.with_cgal = !left_out(a->without, "cgal");
      s.rivals = programs_in(a->rivals);
      return cullhull::bench::run_calls(s, progress, stop_token());
    });
  };
}

Command add_stream(Parser& parent) {
  auto a = std::make_shared<StreamBenchArguments>();
  Parser& command = *parent.add_subcommand(
      "stream", "Files hulled in blocks, beside a plain read of the same file");
  a->add_outputs(command);
  allow_real_range(
      *command
           .add_option("--scale", a->scale, "Factor on 20M points (.csv, .gz: 2M); 1 if not given")
           ->type_name("S"),
      1e-6, 1000);
  allow_range(*command.add_option("--repeat", a->repeat, "Runs; the median counts"), 1, 1000);
  allow_words(*command.add_option("--format", a->formats, "Only this one; may be given again"),
              cullhull::bench::stream_formats());
  needs_value(*command.add_option("--folder", a->folder,
                                  "Where the files are made and removed; else the system's"))
      .type_name("FOLDER");
  needs_value(
      *command.add_option("--memory", a->memory, "Memory limit of a run; 1GiB if not given"))
      .type_name("BYTES");
  command.footer(std::string("Files come from the page cache; --folder on a disk and a --scale "
                             "beyond memory\nmeasure the disk.\n\n") +
                 exit_status_text);
  return [a] {
    parse_size(a->memory, "--memory");
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::StreamSettings s;
      s.scale = a->scale;
      s.repeat = a->repeat;
      s.formats = a->formats;
      s.folder = a->folder;
      s.memory = a->memory;
      return cullhull::bench::run_stream(s, progress, stop_token());
    });
  };
}

Command add_paths(Parser& parent) {
  auto a = std::make_shared<PathArguments>();
  Parser& command =
      *parent.add_subcommand("paths", "What each way to a hull gains, and what it costs elsewhere");
  a->add_outputs(command);
  allow_words(*command.add_option("--way", a->ways, "Only this one; may be given again"),
              cullhull::bench::path_names());
  allow_real_range(*command.add_option("--scale", a->scale, "Factor on every size; 1 if not given")
                        ->type_name("S"),
                   1e-6, 100);
  allow_real_range(
      *command.add_option("--seconds", a->seconds, "Seconds of calls for each set; 1 if not given")
           ->type_name("S"),
      0, 1e6);
  command.footer(std::string("Ways are those of 'cullhull info --plan'. A minute.\n\n") +
                 exit_status_text);
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      return cullhull::bench::run_paths(*a, progress, stop_token());
    });
  };
}

}  // namespace app
