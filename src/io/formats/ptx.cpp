// Leica's .ptx: scans one after the other, each a header and a grid of records x y z i [r g b].
#include <string>
#include <vector>

#include "io/text/lines.hpp"
#include "io/text/text.hpp"

namespace cullhull::internal {
namespace {

class PtxReader {
 public:
  PtxReader(const Source& source, const ReadOptions& options)
      : source_(source), options_(options), lines_(source.data, source.data + source.size) {}

  PointData read() {
    while (next_line()) read_scan();
    if (scans_ == 0) fail(source_, "no scan");
    if (missed_ > 0)
      remark(source_, options_,
             std::to_string(missed_) + (missed_ == 1 ? " record" : " records") +
                 " without a return (0 0 0) skipped");
    PointData data = parsed_points(numbers_.size() / 3, 3, "ptx");
    std::copy(numbers_.begin(), numbers_.end(), data.storage.as<double>());
    return data;
  }

 private:
  /// The next line that is not empty.
  bool next_line() {
    while (lines_.next())
      if (skip_blanks(lines_.begin(), lines_.end()) != lines_.end()) return true;
    return false;
  }

  template <class... Parts>
  [[noreturn]] void fail_here(const Parts&... parts) const {
    fail_at_line(source_, lines_.number(), parts...);
  }

  std::uint64_t read_count(const char* what) {
    std::uint64_t count = 0;
    const std::string_view word = first_word(lines_.begin(), lines_.end());
    if (!parse_unsigned(word, count) ||
        skip_blanks(word.data() + word.size(), lines_.end()) != lines_.end())
      fail_here("a scan begins with its numbers of columns and rows; ", quoted_text(word),
                " is not a number of ", what);
    return count;
  }

  /// Reads the first `count` numbers of the line; returns how many words it has.
  std::size_t read_numbers(double* out, unsigned count, const char* what) const {
    try {
      const char* p = parse_coordinates(lines_.begin(), lines_.end(), count, out, what);
      std::size_t words = count;
      while ((p = skip_blanks(p, lines_.end())) != lines_.end()) {
        p += first_word(p, lines_.end()).size();
        ++words;
      }
      return words;
    } catch (const LineFault& fault) {
      fail_here(fault.message);
    }
  }

  void read_header(double* out, unsigned count, const char* what) {
    if (!next_line()) fail(source_, "ends within the header of a scan");
    if (read_numbers(out, count, what) != count)
      fail_here(what, " has more than ", count, " numbers");
  }

  void read_scan() {
    const std::uint64_t columns = read_count("columns");
    if (!next_line()) fail(source_, "ends within the header of a scan");
    const std::uint64_t rows = read_count("rows");
    double axis[3];
    read_header(axis, 3, "a scanner position");
    for (int i = 0; i < 3; ++i) read_header(axis, 3, "a scanner axis");
    for (double* const row : matrix_) read_header(row, 4, "a line of the transformation");
    std::uint64_t records = 0;
    if (!multiply(columns, rows, records))
      fail_here("a scan of ", columns, " x ", rows, " records");
    ++scans_;
    for (std::uint64_t i = 0; i < records; ++i) {
      if ((i & 0xFFF) == 0) check_stop(options_);
      if (!next_line())
        fail(source_, "ends after ", i, " of the ", records, " records of scan ", scans_);
      double p[3];
      const std::size_t words = read_numbers(p, 3, "a record");
      if (words != 3 && words != 4 && words != 6 && words != 7)
        fail_here("a record has ", words, " numbers, not 4 or 7");
      add(p);
    }
  }

  /// From the scanner to the world: (x, y, z, 1) times the matrix, whose last row is the position.
  void add(const double* p) {
    if (p[0] == 0 && p[1] == 0 && p[2] == 0) {
      ++missed_;
      return;
    }
    for (int j = 0; j < 3; ++j)
      numbers_.push_back(stays() ? p[j]
                                 : p[0] * matrix_[0][j] + p[1] * matrix_[1][j] +
                                       p[2] * matrix_[2][j] + matrix_[3][j]);
  }

  /// Whether the transformation is the identity: points then keep their very numbers.
  bool stays() const {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j)
        if (matrix_[i][j] != (i == j ? 1 : 0)) return false;
    return true;
  }

  const Source& source_;
  const ReadOptions& options_;
  LineScanner lines_;
  double matrix_[4][4] = {};
  std::vector<double> numbers_;
  std::uint64_t scans_ = 0, missed_ = 0;
};

}  // namespace

PointData read_ptx(const Source& source, const ReadOptions& options) {
  return PtxReader(source, options).read();
}

}  // namespace cullhull::internal
