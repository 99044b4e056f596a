// What a suite of measurements hands on: figures of rows, as a table and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/hull.hpp"
#include "numbers.hpp"

namespace cullhull::bench {

/// One thing measured in several ways. Values are in the figure's unit, in the order measured.
struct Row {
  std::string name;   ///< "ball-3d-8M"
  std::string title;  ///< in prose, "3D ball 8M"; empty: as the name
  std::uint64_t points = 0;
  unsigned dimension = 0;
  std::string scalar = "f64";
  std::vector<std::pair<std::string, double>> values;
  double ratio = 0;             ///< the rival's time over ours; 0 where there is none
  bool ratio_is_bound = false;  ///< the rival was stopped: the ratio is at least that
  std::string paper;            ///< what the paper printed for it; empty where it printed nothing
  std::string check;  ///< how the results were held against each other, and whether they agree
  bool agrees = true;
  std::uint64_t vertices = 0;  ///< of the hull; 0 where the row has no one hull
  double bandwidth = 0;        ///< share of the read bandwidth the cull had; 0: nothing was culled
  double reads = 0;  ///< the whole hull's time over one read of its points; 0: not held against it
  std::string remark;                   ///< a footnote: what a reader of the row must know
  std::string slower;                   ///< "than CGAL"; empty: no rival was faster
  std::vector<std::string> unfinished;  ///< names of values that are a limit run into, so too low
};

struct Figure {
  std::string id;  ///< "figure-12"
  std::string title;
  std::string unit;     ///< "s", "%"
  std::string note;     ///< how to read it, one or two sentences
  bool series = false;  ///< rows are steps of something (rounds, frames, threads): draw lines
  std::vector<Row> rows;
};

struct Report {
  std::string suite;
  std::string date;     ///< as date_now()
  std::string command;  ///< that makes it again
  double scale = 1;
  unsigned threads = 0;
  std::vector<std::pair<std::string, std::string>> machine;  ///< processor, cores, memory, build
  /// Bytes per second read from memory by so many threads: what Row::bandwidth is a share of.
  std::vector<std::pair<unsigned, double>> read_bandwidth;
  std::vector<Figure> figures;

  bool agrees() const;  ///< every row does
};

/// The share of the read bandwidth at which a hull's points were culled: their bytes over the
/// seconds of the filter, its sample and its map included, over what as many threads can read. 0
/// where nothing was culled.
double bandwidth_share(const Report& report, const PointView& points, const Statistics& statistics);

/// Processor, cores, memory, compiler: what a reader must know to compare.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// One table a figure, wide as names need.
std::string report_table(const Report& report);
std::string report_json(const Report& report);
/// Tables in Markdown, times in ms; figures of frames are left out, as they have too many rows, and
/// that of lost rows, which has what another has.
std::string report_markdown(const Report& report);

}  // namespace cullhull::bench
