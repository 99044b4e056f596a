// cullhull bench paper, cullhull bench rivals: suites that give a report.
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
#include "bench_command.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "families.hpp"
#include "outputs.hpp"
#include "paper.hpp"
#include "rivals.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "viewer/assets.hpp"
#include "viewer/page.hpp"

namespace app {
namespace {

using cullhull::bench::Report;

constexpr const char* exit_status_text =
    "Exit status: 0 success; 1 the system refused; 2 bad usage; 3 extreme points differ and ours\n"
    "are not proved; 4 out of memory; 130 cancelled.";

/// Where a report goes.
struct ReportArguments {
  std::string json, page, markdown;
  double scale = 1, limit = 300;
  unsigned repeat = 5;
  bool quiet = false;

  void add_to(Parser& command) {
    add_json_option(command, json, "The report");
    command.add_option("--report", page, "The report as one HTML page with charts")
        ->type_name("FILE.html");
    command.add_option("--markdown", markdown, "Its tables as Markdown; - for standard output")
        ->type_name("FILE.md");
    const std::string sizes = fmt::format("Of every size; {:g} if not given", scale);
    allow_real_range(*command.add_option("--scale", scale, sizes)->type_name("S"), 1e-6, 100);
    allow_range(*command.add_option("--repeat", repeat, "Runs of ours; the median counts"), 1,
                1000);
    const std::string runs =
        fmt::format("Seconds for one run of a rival, 0 without; {:g} if not given", limit);
    allow_real_range(*command.add_option("--limit", limit, runs)->type_name("SECONDS"), 0, 1e6);
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

struct PaperArguments : ReportArguments {
  unsigned threads = 0;
  std::vector<std::string> figures;
};

struct RivalArguments : ReportArguments {
  std::string threads;
  std::vector<std::string> workloads, shapes, points, scalars, without;
  std::vector<unsigned> dimensions;
};

/// "1,2,all"
std::vector<unsigned> thread_counts(const std::string& text) {
  std::vector<unsigned> counts;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    unsigned count = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    const bool number = error == std::errc() && end == word.data() + word.size();
    if (word != "all" && (!number || count == 0 || count > 1024))
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "--threads needs numbers such as 1,2,all, not '" + text + "'");
    counts.push_back(count);
  }
  return counts;
}

/// The workloads that were named, else the product of what was given, else the usual ones; each
/// for every scalar type that was given.
std::vector<cullhull::bench::Workload> chosen_workloads(const RivalArguments& a) {
  using cullhull::bench::Workload;
  std::vector<Workload> sets;
  for (const std::string& name : a.workloads) sets.push_back(cullhull::bench::workload_named(name));
  if (!a.shapes.empty() || !a.dimensions.empty() || !a.points.empty()) {
    const auto or_else = [](const auto& given, auto usual) {
      return given.empty() ? std::decay_t<decltype(given)>{usual} : given;
    };
    for (const std::string& shape : or_else(a.shapes, std::string("ball")))
      for (const unsigned d : or_else(a.dimensions, 3U))
        for (const std::string& n : or_else(a.points, std::string("1M")))
          sets.push_back({shape, d, parse_size(n, "--points"), cullhull::ScalarType::f64});
  }
  if (a.scalars.empty()) return sets;
  if (sets.empty())
    for (const Workload& w : cullhull::bench::rival_workloads())
      if (w.scalar == cullhull::ScalarType::f64) sets.push_back(w);
  std::vector<Workload> all;
  for (const Workload& w : sets)
    for (const std::string& scalar : a.scalars) {
      all.push_back(w);
      all.back().scalar = scalar == "f32"   ? cullhull::ScalarType::f32
                          : scalar == "i32" ? cullhull::ScalarType::i32
                                            : cullhull::ScalarType::f64;
    }
  return all;
}

std::string rivals_help() {
  std::string text =
      "A workload is a name such as ball-3d-8M or grid-3d-2M-i32: points, dimension, how many,\n"
      "scalar type (f64 if not given). Points are the shapes of 'cullhull generate' and, in 3D,\n";
  for (const cullhull::Shape& family : cullhull::bench::hard_families())
    text += fmt::format("  {:<24}{}\n", family.name, family.description);
  text += "If nothing is chosen:";
  std::size_t column = 80;
  for (const auto& w : cullhull::bench::rival_workloads()) {
    const std::string name = w.name();
    if (column + name.size() > 78) {
      text += "\n ";
      column = 1;
    }
    text += " " + name;
    column += name.size() + 1;
  }
  return text +
         "\nf32 and i32 round, and rivals get what was rounded. CGAL is timed by\n"
         "cullhull-rival-cgal, if that program lies beside this one.\n"
         "\n"
         "Examples:\n"
         "  cullhull bench rivals --report rivals.html             some minutes\n"
         "  cullhull bench rivals --scale 1 --markdown rivals.md   the README's table\n"
         "  cullhull bench rivals --scale 1 --shape ball --shape sphere --dimension 2 \\\n"
         "    --dimension 3 --points 100k --points 10M --scalar f64 --scalar f32 --threads "
         "1,2,all\n"
         "\n" +
         exit_status_text;
}

}  // namespace

Command add_bench_paper(Parser& bench) {
  auto a = std::make_shared<PaperArguments>();
  Parser& command = *bench.add_subcommand(
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

Command add_bench_rivals(Parser& bench) {
  auto a = std::make_shared<RivalArguments>();
  a->scale = 0.2;
  a->limit = 30;
  Parser& command =
      *bench.add_subcommand("rivals", "Ours beside Qhull and, where it was built, CGAL");
  a->add_to(command);
  command.add_option("--threads", a->threads, "For ours, e.g. 1,2,4,all; one and all if not given")
      ->type_name("LIST");
  command.add_option("--workload", a->workloads, "This one; may be given again, as all below")
      ->type_name("NAME");
  command.add_option("--shape", a->shapes, "Every combination of these: points")
      ->type_name("SHAPE");
  allow_range(*command.add_option("--dimension", a->dimensions, "dimensions"), 2, 16);
  command.add_option("--points", a->points, "and sizes, e.g. 100k or 8M")->type_name("N");
  allow_words(*command.add_option("--scalar", a->scalars, "As this type"), {"f64", "f32", "i32"});
  allow_words(*command.add_option("--without", a->without, "Leave this rival out"),
              {"qhull", "cgal"});
  command.footer(rivals_help());
  return [a] {
    return run(*a, [&](const cullhull::Progress& progress) {
      const auto given = [&](const char* name) {
        return std::find(a->without.begin(), a->without.end(), name) == a->without.end();
      };
      cullhull::bench::RivalSettings s;
      s.workloads = chosen_workloads(*a);
      s.scale = a->scale;
      s.repeat = a->repeat;
      if (!a->threads.empty()) s.threads = thread_counts(a->threads);
      s.limit = a->limit;
      s.with_qhull = given("qhull");
      s.with_cgal = given("cgal");
      return cullhull::bench::run_rivals(s, progress, stop_token());
    });
  };
}

}  // namespace app
