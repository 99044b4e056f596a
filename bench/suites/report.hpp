// What a suite of measurements hands on: figures of rows, as a table and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace cullhull::bench {

/// One thing measured in several ways. Values are in the figure's unit, in the order measured.
struct Row {
  std::string name;  ///< "ball 3D 8M"
  std::uint64_t points = 0;
  unsigned dimension = 0;
  std::vector<std::pair<std::string, double>> values;
  double ratio = 0;   ///< the rival's time over ours; 0 where there is none
  std::string paper;  ///< what the paper printed for it; empty where it printed nothing
  std::string check;  ///< how the results were held against each other, and whether they agree
  bool agrees = true;
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
  std::vector<Figure> figures;
};

/// Processor, cores, memory, compiler: what a reader must know to compare.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// One table a figure, 120 columns at most where names allow.
std::string report_table(const Report& report);
std::string report_json(const Report& report);

/// 8000000 as "8M", 12500 as "12.5k".
std::string short_count(std::uint64_t n);

}  // namespace cullhull::bench
