// A report as text, for terminals and in Markdown.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report.hpp"

namespace cullhull::bench {
namespace {

using Line = std::vector<std::string>;

constexpr const char* bandwidth_note =
    "Of read bandwidth: bytes of the points divided by the seconds of the whole filter (sample, "
    "map and passes), as a share of the read bandwidth of as many threads on this machine";

constexpr const char* reads_note =
    "Reads: the whole hull's time over that of reading its points once, by as many threads";

/// A value with its unit, which may differ within a column.
std::string amount(double v, const std::string& unit) {
  if (std::isnan(v)) return "-";
  if (unit == "s")
    return v < 1e-3 ? fmt::format("{:.1f} us", v * 1e6)
           : v < 1  ? fmt::format("{:.2f} ms", v * 1e3)
                    : fmt::format("{:.2f} s", v);
  if (unit == "%")
    return v != 0 && v < 0.1 ? fmt::format("{:.4f} %", v) : fmt::format("{:.2f} %", v);
  return fmt::format("{:.3g} {}", v, unit);
}

/// At least three significant digits: 0.0123, 1.23, 12.3, 123, 1234.
std::string three_digits(double v) {
  if (v >= 99.95) return grouped(static_cast<std::uint64_t>(std::llround(v)));
  const int decimals =
      v > 0 ? std::max(0, 2 - static_cast<int>(std::floor(std::log10(v * 1.0005)))) : 0;
  return fmt::format("{:.{}f}", v, std::min(decimals, 9));
}

/// A value without its unit, below a heading that says ms or %.
std::string bare(double v, const std::string& unit) {
  if (std::isnan(v)) return "";
  return three_digits(unit == "s" ? v * 1e3 : v);
}

/// The names of values, in order of first appearance.
Line columns(const Figure& figure) {
  Line names;
  for (const Row& row : figure.rows)
    for (const auto& [name, value] : row.values)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

bool is_unfinished(const Row& row, const std::string& name) {
  return std::find(row.unfinished.begin(), row.unfinished.end(), name) != row.unfinished.end();
}

template <class Test>
bool any_row(const Figure& figure, const Test& test) {
  return std::any_of(figure.rows.begin(), figure.rows.end(), test);
}

/// The columns that a figure has in addition to its values.
struct Extras {
  bool ratio, paper, bandwidth, reads, vertices;
  explicit Extras(const Figure& f)
      : ratio(any_row(f, [](const Row& r) { return r.ratio > 0; })),
        paper(any_row(f, [](const Row& r) { return !r.paper.empty(); })),
        bandwidth(any_row(f, [](const Row& r) { return r.bandwidth > 0; })),
        reads(any_row(f, [](const Row& r) { return r.reads > 0; })),
        vertices(any_row(f, [](const Row& r) { return r.vertices > 0; })) {}
};

/// How a report writes a value, and the sign of a factor.
struct Style {
  std::string (*value)(double, const std::string&);
  const char* times;
};

/// A row's values, and of the columns in addition those that text and Markdown have in common.
void add_cells(Line& line, const Figure& figure, const Row& row, const Line& names,
               const Extras& extras, const Style& style) {
  for (const std::string& name : names) {
    const auto at = std::find_if(row.values.begin(), row.values.end(),
                                 [&](const auto& v) { return v.first == name; });
    line.push_back(at == row.values.end() ? ""
                                          : (is_unfinished(row, name) ? "> " : "") +
                                                style.value(at->second, figure.unit));
  }
  if (extras.ratio)
    line.push_back(row.ratio > 0
                       ? (row.ratio_is_bound ? "> " : "") + three_digits(row.ratio) + style.times
                       : "");
  if (extras.paper)
    line.push_back(row.paper.ends_with('x')
                       ? row.paper.substr(0, row.paper.size() - 1) + style.times
                       : row.paper);
  if (extras.bandwidth)
    line.push_back(row.bandwidth > 0 ? fmt::format("{:.0f} %", 100 * row.bandwidth) : "");
  if (extras.reads) line.push_back(row.reads > 0 ? three_digits(row.reads) + style.times : "");
}

std::string figure_table(const Figure& figure) {
  const Line names = columns(figure);
  const Extras extras(figure);
  std::vector<Line> cells{{""}};
  cells[0].insert(cells[0].end(), names.begin(), names.end());
  if (extras.ratio) cells[0].emplace_back("ratio");
  if (extras.paper) cells[0].emplace_back("the paper");
  if (extras.bandwidth) cells[0].emplace_back("of read bandwidth");
  if (extras.reads) cells[0].emplace_back("reads");
  cells[0].emplace_back("check");
  for (const Row& row : figure.rows) {
    Line& line = cells.emplace_back(Line{row.name});
    add_cells(line, figure, row, names, extras, {amount, "x"});
    line.push_back((row.agrees ? "" : "DIFFER: ") + row.check +
                   (row.slower.empty() ? "" : "; SLOWER " + row.slower));
  }
  std::vector<std::size_t> width(cells[0].size(), 0);
  for (const Line& line : cells)
    for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
  std::string text = fmt::format("{}: {}\n", figure.id, figure.title);
  for (const Line& line : cells) {
    std::string row;
    for (std::size_t c = 0; c < line.size(); ++c)
      row += c == 0 || c + 1 == line.size() ? fmt::format("{:<{}}  ", line[c], width[c])
                                            : fmt::format("{:>{}}  ", line[c], width[c]);
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  if (!figure.note.empty()) text += figure.note + '\n';
  if (extras.bandwidth) text += std::string(bandwidth_note) + ".\n";
  if (extras.reads) text += std::string(reads_note) + ".\n";
  return text;
}

/// Footnotes, without repeated texts.
class Footnotes {
 public:
  std::string mark(const std::string& text) {
    if (text.empty()) return "";
    auto at = std::find(texts_.begin(), texts_.end(), text);
    if (at == texts_.end()) at = texts_.insert(texts_.end(), text);
    std::string mark(1, ' ');
    return mark += sign(static_cast<std::size_t>(at - texts_.begin()));
  }
  std::string text() const {
    std::string all;
    for (std::size_t i = 0; i < texts_.size(); ++i)
      all += (i > 0 ? " \\\n" : "\n") + sign(i) + " " + texts_[i];
    return all.empty() ? "" : all + "\n";
  }

 private:
  static std::string sign(std::size_t i) {
    static constexpr const char* signs[] = {"¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    return i < std::size(signs) ? signs[i] : fmt::format("({})", i + 1);
  }
  Line texts_;
};

std::string markdown_row(const Line& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + '\n';
}

std::string figure_markdown(const Figure& figure, Footnotes& notes) {
  const Line names = columns(figure);
  const Extras extras(figure);
  const std::string unit = figure.unit == "s" ? "ms" : figure.unit;
  Line head{""};
  for (const std::string& name : names) head.push_back(name + ", " + unit);
  if (extras.ratio) head.emplace_back("ratio");
  if (extras.paper) head.emplace_back("the paper");
  if (extras.bandwidth)
    head.push_back("of read bandwidth" + notes.mark(bandwidth_note + std::string(".")));
  if (extras.reads) head.push_back("reads" + notes.mark(reads_note + std::string(".")));
  if (extras.vertices) head.emplace_back("vertices");
  std::string text = fmt::format("**{}.** {}\n\n", figure.title, figure.note);
  text += markdown_row(head) + "|---|";
  for (std::size_t c = 1; c < head.size(); ++c) text += "---:|";
  text += '\n';
  for (const Row& row : figure.rows) {
    Line line{row.title.empty() ? row.name : row.title};
    add_cells(line, figure, row, names, extras, {bare, "×"});
    const std::string mark = notes.mark(row.remark) + (row.agrees ? "" : notes.mark(row.check));
    if (extras.vertices)
      line.push_back((row.vertices > 0 ? grouped(row.vertices) : "") + mark);
    else
      line[0] += mark;
    if (!row.slower.empty()) line[0] += notes.mark("Slower " + row.slower + ".");
    text += markdown_row(line);
  }
  return text;
}

}  // namespace

std::string report_table(const Report& report) {
  std::string text;
  for (const Figure& figure : report.figures) text += figure_table(figure) + '\n';
  text += fmt::format("{}; {} threads; {}", report.command,
                      report.threads == 0 ? "all" : std::to_string(report.threads), report.date);
  for (const auto& [key, value] : report.machine) text += fmt::format("; {} {}", key, value);
  for (const auto& [threads, rate] : report.read_bandwidth)
    text += fmt::format("; {} thread{} read {:.1f} GB/s", threads, threads == 1 ? "" : "s",
                        rate * 1e-9);
  return text + '\n';
}

std::string report_markdown(const Report& report) {
  std::string text = fmt::format("`{}`, {}:", report.command, report.date.substr(0, 10));
  for (const auto& [key, value] : report.machine)
    if (key != "version" && key != "compiler")
      text += key == "cores" ? fmt::format(" {} cores,", value) : fmt::format(" {},", value);
  for (const auto& [threads, rate] : report.read_bandwidth)
    text += fmt::format(" {} thread{} read {:.1f} GB/s,", threads, threads == 1 ? "" : "s",
                        rate * 1e-9);
  text.back() = '.';
  Footnotes notes;
  text += '\n';
  constexpr std::size_t most_steps = 12;  // lost rows are marked in the table of all rows
  for (const Figure& figure : report.figures)
    if (figure.id != "lost" && (!figure.series || figure.rows.size() <= most_steps))
      text += '\n' + figure_markdown(figure, notes);
  return text + notes.text();
}

}  // namespace cullhull::bench
