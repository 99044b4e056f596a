// The result of a suite of measurements: figures of rows, as a table and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/hull.hpp"
#include "numbers.hpp"

namespace cullhull::bench {

/// One quantity measured in several ways. Values are in the figure's unit, in the order measured.
struct Row {
  std::string name;   ///< "ball-3d-8M"
  std::string title;  ///< for texts, "3D ball 8M"; empty: same as name
  std::uint64_t points = 0;
  unsigned dimension = 0;
  std::string scalar = "f64";
  std::vector<std::pair<std::string, double>> values;
  double ratio = 0;             ///< the rival's time over cullhull's; 0: no rival
  bool ratio_is_bound = false;  ///< the rival was stopped: the ratio is a lower bound
  std::string paper;            ///< value printed in the paper; empty: none
  std::string check;            ///< how the results were compared, and whether they agree
  bool agrees = true;
  std::uint64_t vertices = 0;  ///< of the hull; 0 if the row has several hulls
  double bandwidth = 0;        ///< share of the read bandwidth reached by the filter; 0: none
  double reads = 0;    ///< the whole hull's time over one read of its points; 0: not compared
  std::string remark;  ///< a footnote that readers of the row need
  std::string slower;  ///< "than CGAL"; empty: no rival was faster
  std::vector<std::string> unfinished;  ///< names of values that are exceeded limits, so too low
};

struct Figure {
  std::string id;  ///< "figure-12"
  std::string title;
  std::string unit;     ///< "s", "%"
  std::string note;     ///< how to read the figure, one or two sentences
  bool series = false;  ///< rows are steps (rounds, frames, threads): draw lines
  std::vector<Row> rows;
};

struct Report {
  std::string suite;
  std::string date;     ///< as date_now()
  std::string command;  ///< command that reproduces the report
  double scale = 1;
  unsigned threads = 0;
  std::vector<std::pair<std::string, std::string>> machine;  ///< processor, cores, memory, build
  /// Bytes per second that this many threads read from memory; Row::bandwidth is a share of it.
  std::vector<std::pair<unsigned, double>> read_bandwidth;
  std::vector<Figure> figures;

  bool agrees() const;  ///< whether all rows agree
};

/// The share of the read bandwidth at which a hull's points were filtered: their bytes over the
/// filter's seconds (including sample and map), divided by what as many threads can read. 0 if no
/// filter ran.
double bandwidth_share(const Report& report, const PointView& points, const Statistics& statistics);

/// A report of now, without figures.
Report begin_report(const char* suite);

/// Processor, cores, memory, compiler: what readers need for comparisons.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// One table per figure, as wide as names require.
std::string report_table(const Report& report);
std::string report_json(const Report& report);
/// Tables in Markdown, times in ms. Omits figures of frames, which have too many rows, and the
/// figure of lost rows, which repeats rows of another.
std::string report_markdown(const Report& report);

}  // namespace cullhull::bench
