// .asc: CloudCompare's text. A first line "//X Y Z R G B" names the columns; the number of points
// may follow on a line of its own; then rows, separated by blanks, commas, semicolons or tabs.
// .xyzrgb has the rows alone.
#include <string>
#include <vector>

#include "io/columns.hpp"
#include "io/text/data_lines.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal {

bool find_cloud_compare_header(const Source& source, const ReadOptions& options,
                               const DataLine& first, Preamble& preamble) {
  // Of ESRI, whose files have the same extension.
  if (alike(first.word(), "ncols"))
    fail_at_line(source, first.number,
                 "holds a raster (an ESRI grid), not points; gdal_translate -of XYZ makes points");
  LineScanner lines(source.data, source.data + source.size);
  if (!lines.next()) return false;
  const std::string_view line(lines.begin(), static_cast<std::size_t>(lines.end() - lines.begin()));
  if (!line.starts_with("//")) return false;
  const char* const names = lines.begin() + 2;
  try {
    preamble.columns =
        split_columns(names, lines.end(), find_separator(names, lines.end(), options.decimal));
  } catch (const LineFault& fault) {
    fail_at_line(source, lines.number(), fault.message);
  }
  if (preamble.columns.size() == 1 && preamble.columns[0].empty()) preamble.columns.clear();
  return !preamble.columns.empty();
}

}  // namespace cullhull::internal
