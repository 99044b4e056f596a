// cullhull bench paper, cullhull bench rivals: suites that give a report.
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "bench_command.hpp"
#include "cullhull/io.hpp"
#include "paper.hpp"
#include "rivals.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "viewer/assets.hpp"
#include "viewer/page.hpp"

namespace app {
namespace {

using cullhull::bench::Report;

constexpr const char* exit_status =
    "Exit status: 0 success; 1 the system refused; 2 bad usage; 4 out of memory;\n"
    "130 cancelled (Qhull's own runs are waited for).";

struct ReportArguments {
  std::string json, page;
  double scale = 1;
  unsigned repeat = 5, threads = 0;
  bool quiet = false;
  std::vector<std::string> only;

  void add_to(CLI::App& command) {
    command.add_option("--json", json, "The report as JSON, on standard output or to FILE")
        ->type_name("[=FILE]");
    command.add_option("--report", page, "The report as one HTML page with charts")
        ->type_name("FILE.html");
    command.add_option("--scale", scale, "Of every size: 0.05 for a short run")
        ->check(CLI::Range(1e-6, 100.0).description(""))
        ->type_name("S");
    allow_range(*command.add_option("--repeat", repeat, "Runs of ours; the median counts"), 1,
                1000);
    allow_range(*command.add_option("--threads", threads, "For ours; 0 means all"), 0, 4096);
    command.add_flag("-q,--quiet", quiet, "No table and no progress");
  }
};

/// One self-contained page: docs/viewer.md, "How a page is made".
void write_page(const std::string& path, const Report& report) {
  namespace viewer = cullhull::viewer;
  viewer::Page page;
  page.title = "cullhull bench " + report.suite;
  page.body = viewer::assets::report_html;
  page.styles = {viewer::assets::report_css};
  page.scripts = {viewer::assets::report_js};
  page.data.push_back({"report", "application/json", report_json(report)});
  cullhull::write_text(path, viewer::page_text(page));
}

using Measure = std::function<Report(const cullhull::Progress&)>;

int run(const ReportArguments& a, const Measure& measure) {
  Report report;
  {
    TerminalProgress progress(a.quiet);
    cancellable([&] { report = measure(progress.callback()); });
  }
  if (a.json == "-")
    write_stdout(report_json(report));
  else if (!a.json.empty())
    cullhull::write_text(a.json, report_json(report));
  if (!a.page.empty()) write_page(a.page, report);
  if (!a.quiet && a.json != "-") write_stdout(report_table(report));
  return 0;
}

}  // namespace

Command add_bench_paper(CLI::App& bench) {
  auto a = std::make_shared<ReportArguments>();
  CLI::App& command = *bench.add_subcommand(
      "paper", "The evaluation of Tang, Zhao, Tong and Manocha 2012, on this machine");
  a->add_to(command);
  allow_words(*command.add_option("--figure", a->only, "Only this one; may be given again"),
              cullhull::bench::paper_figures());
  command.footer(std::string("Takes some minutes and 4 GB at scale 1; Qhull runs beside us.\n\n") +
                 exit_status);
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::PaperSettings s;
      s.scale = a->scale;
      s.repeat = a->repeat;
      s.threads = a->threads;
      s.figures = a->only;
      return cullhull::bench::run_paper(s, progress, stop_token());
    });
  };
}

Command add_bench_rivals(CLI::App& bench) {
  auto a = std::make_shared<ReportArguments>();
  CLI::App& command =
      *bench.add_subcommand("rivals", "Ours beside Qhull and, where it was built, CGAL");
  a->add_to(command);
  allow_words(*command.add_option("--workload", a->only, "Only this one; may be given again"),
              cullhull::bench::rival_workloads());
  command.footer(
      std::string(
          "CGAL is timed by cullhull-rival-cgal, if that program lies beside this one.\n\n") +
      exit_status);
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      cullhull::bench::RivalSettings s;
      s.scale = a->scale;
      s.repeat = a->repeat;
      s.threads = a->threads;
      s.workloads = a->only;
      return cullhull::bench::run_rivals(s, progress, stop_token());
    });
  };
}

}  // namespace app
