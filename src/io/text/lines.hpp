// Parallel parsing of files with at most one point a line: one pass counts, a second parses into
// place, so that ids follow the file and messages name their line, for any number of threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/source.hpp"
#include "io/text/text_scan.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// Thrown by a format's rules; the line number is added here.
struct LineFault {
  std::string message;
};

inline void check_stop(const ReadOptions& options) {
  if (options.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
}

/// Chunks of bytes; a chunk owns the lines that begin in it.
struct LineIndex {
  const char* begin = nullptr;  ///< the body: from the line after the file's header
  const char* end = nullptr;
  std::uint64_t lines_before = 0;       ///< lines of the header
  std::vector<std::uint64_t> line_at;   ///< lines before chunk i, in the body
  std::vector<std::uint64_t> point_at;  ///< points before chunk i
  std::uint64_t lines = 0, points = 0;  ///< of the body

  static constexpr std::uint64_t chunk_bytes = std::uint64_t{1} << 20;
  std::uint64_t bytes() const { return static_cast<std::uint64_t>(end - begin); }

  /// The lines that belong to the chunk of bytes [from, to).
  LineScanner scanner(std::uint64_t from, std::uint64_t to) const {
    return LineScanner(line_start(from), line_start(to));
  }

 private:
  const char* line_start(std::uint64_t offset) const {
    if (offset == 0) return begin;
    if (offset >= bytes()) return end;
    const char* p = begin + offset - 1;
    const void* newline = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    return newline != nullptr ? static_cast<const char*>(newline) + 1 : end;
  }
};

/// `is_point(begin, end)`: whether a line holds a point.
template <class IsPoint>
LineIndex index_lines(const Source& source, const char* body, std::uint64_t lines_before,
                      const ReadOptions& options, const IsPoint& is_point) {
  LineIndex index;
  index.begin = body;
  index.end = source.data + source.size;
  index.lines_before = lines_before;
  const std::uint64_t chunks = chunk_count(index.bytes(), LineIndex::chunk_bytes);
  index.line_at.assign(chunks, 0);
  index.point_at.assign(chunks, 0);
  for_each_chunk(index.bytes(), LineIndex::chunk_bytes, resolve_threads(options.threads),
                 [&](std::uint64_t chunk, std::uint64_t from, std::uint64_t to) {
    check_stop(options);
    std::uint64_t points = 0;
    LineScanner lines = index.scanner(from, to);
    while (lines.next())
      if (is_point(lines.begin(), lines.end())) ++points;
    index.line_at[chunk] = lines.number();
    index.point_at[chunk] = points;
  });
  for (std::uint64_t c = 0; c < chunks; ++c) {
    index.lines += std::exchange(index.line_at[c], index.lines);
    index.points += std::exchange(index.point_at[c], index.points);
  }
  return index;
}

struct Ignored {
  void operator()(std::uint64_t, std::uint64_t) const {}
};

/// Calls `parse(point, begin, end)` for every line that is a point, `other(begin, end)` for the
/// others; either may throw LineFault. The fault on the lowest line is reported. Where a chunk has
/// none, `parsed(first, last)` follows for its points [first, last), which are still in the cache.
template <class IsPoint, class Parse, class Other, class Parsed = Ignored>
void parse_lines(const Source& source, const LineIndex& index, const ReadOptions& options,
                 const IsPoint& is_point, const Parse& parse, const Other& other,
                 const Parsed& parsed = {}) {
  struct Fault {
    std::uint64_t line;
    std::string message;
  };
  std::vector<std::optional<Fault>> faults(index.line_at.size());
  for_each_chunk(index.bytes(), LineIndex::chunk_bytes, resolve_threads(options.threads),
                 [&](std::uint64_t chunk, std::uint64_t from, std::uint64_t to) {
    check_stop(options);
    std::uint64_t point = index.point_at[chunk];
    LineScanner lines = index.scanner(from, to);
    try {
      while (lines.next()) {
        if (is_point(lines.begin(), lines.end()))
          parse(point++, lines.begin(), lines.end());
        else
          other(lines.begin(), lines.end());
      }
      parsed(index.point_at[chunk], point);
    } catch (const LineFault& fault) {
      faults[chunk] =
          Fault{index.lines_before + index.line_at[chunk] + lines.number(), fault.message};
    }
  });
  for (const auto& fault : faults)
    if (fault) fail_at_line(source, fault->line, fault->message);
}

/// Whether one of `count` doubles is a NaN or an infinity.
inline bool any_not_finite(const double* values, std::uint64_t count) {
  constexpr std::uint64_t exponent = 0x7FF0000000000000, step = 0x0010000000000000;
  std::uint64_t seen = 0;  // an exponent of ones, and only this, carries into the highest bit
  for (std::uint64_t i = 0; i < count; ++i)
    seen |= (std::bit_cast<std::uint64_t>(values[i]) & exponent) + step;
  return (seen >> 63) != 0;
}

/// The first row with a NaN or an infinity, view.count if there is none.
std::uint64_t first_not_finite(const PointView& view);

/// The same with its line. Row 0 is on the line of point `before`.
template <class IsPoint>
PointLine line_of_not_finite(const LineIndex& index, const PointView& view, const IsPoint& is_point,
                             std::uint64_t before = 0) {
  const std::uint64_t row = first_not_finite(view), point = row + before;
  if (row == view.count) return {};
  const auto chunk = static_cast<std::uint64_t>(
      std::upper_bound(index.point_at.begin(), index.point_at.end(), point) -
      index.point_at.begin() - 1);
  LineScanner lines = index.scanner(chunk * LineIndex::chunk_bytes,
                                    std::min((chunk + 1) * LineIndex::chunk_bytes, index.bytes()));
  for (std::uint64_t at = index.point_at[chunk]; lines.next();)
    if (is_point(lines.begin(), lines.end()) && at++ == point) break;
  return {row, index.lines_before + index.line_at[chunk] + lines.number()};
}

/// Packed rows of doubles that a parser fills.
inline PointData parsed_points(std::uint64_t count, std::uint32_t dimension, std::string format) {
  std::uint64_t bytes = 0;
  if (!multiply(count, std::uint64_t{dimension} * sizeof(double), bytes)) throw std::bad_alloc();
  PointData data;
  data.format = std::move(format);
  data.storage = Buffer(bytes);
  data.view = PointView::row_major(data.storage.as<const double>(), count, dimension);
  return data;
}

/// Reads exactly `count` blank-separated numbers and returns where they end; throws LineFault.
/// `what` names the line in messages, e.g. "vertex".
const char* parse_coordinates(const char* p, const char* end, unsigned count, double* out,
                              const char* what);

}  // namespace cullhull::internal
