// Frames of moving points: from one array through a window, or from many files.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "io/columns.hpp"
#include "io/file_formats.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/archive.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "parallel/paths.hpp"

namespace cullhull {

struct PointSequence::Impl {
  ReadOptions options;
  std::uint64_t next = 0;
  std::string name, format;
  PointView view;
  double seconds = 0;

  std::vector<std::string> files;  ///< one frame each; or empty, and:
  internal::NpyFrames array;
  internal::FileWindow window;  ///< closed where the array came from a stream:
  internal::MappedFile stream;
  internal::PointData data;

  PointFile file;
  Grid grid;
  Placement placement;
  std::vector<std::string> columns;

  std::uint64_t frames() const { return files.empty() ? array.frames : files.size(); }

  void read_file(std::uint64_t index) {
    file = PointFile();  // one frame in memory at a time
    file = open_points(files[index], options);
    view = file.points();
    name = internal::display_name(files[index]);
    format = file.format();
    placement = file.placement();
    columns = file.columns();
  }

  void read_array(std::uint64_t index) {
    const std::uint64_t offset = array.data_offset + index * array.frame_bytes;
    internal::Source bytes;
    if (window.is_open()) {
      bytes = window.move_to(offset, array.frame_bytes);
      if (index + 1 < array.frames) window.expect(offset + array.frame_bytes, array.frame_bytes);
    } else {
      bytes = {stream.source().name, stream.source().data + offset, array.frame_bytes};
    }
    // A frame of no bytes still needs an address that is not null.
    if (bytes.data == nullptr) bytes.data = "";
    data = array.frame(bytes, options);
    internal::choose_columns(data, bytes.name, {}, options);
    view = data.view;
    format = data.format;
    columns = data.columns.empty() ? internal::all_columns(format, view.dimension) : data.columns;
  }
};

}  // namespace cullhull

namespace cullhull::internal {
namespace {

/// By name, but digits by value: frame2 before frame10.
bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      while (i < a.size() && a[i] == '0') ++i;
      while (j < b.size() && b[j] == '0') ++j;
      std::size_t m = i, n = j;
      while (m < a.size() && digit(a[m])) ++m;
      while (n < b.size() && digit(b[n])) ++n;
      if (m - i != n - j) return m - i < n - j;
      const int order = a.compare(i, m - i, b, j, n - j);
      if (order != 0) return order < 0;
      i = m;
      j = n;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // 1 and 01
}

/// A Zarr array or group is a folder whose files hold no points in a format read here.
void refuse_zarr(const std::string& path) {
  for (const char* mark : {".zarray", ".zgroup", "zarr.json"})
    if (std::filesystem::exists(native_path(path) / mark))
      throw Error(ErrorCode::bad_file, display_name(path),
                  ": a Zarr folder is read by the Python package: cullhull.read(path), or "
                  "cullhull.dask");
}

/// Leaves the files of known formats, if there are any.
void skip_unknown(const std::string& folder, std::vector<std::string>& files,
                  const ReadOptions& options) {
  const auto known = std::stable_partition(files.begin(), files.end(), has_known_extension);
  if (known == files.begin() || known == files.end()) return;
  std::string list;
  constexpr std::ptrdiff_t most = 3;
  const std::ptrdiff_t count = files.end() - known;
  for (std::ptrdiff_t i = 0; i < std::min(count, most); ++i)
    list += (i > 0 ? ", " : "") + quoted_text(utf8_name(native_path(known[i]).filename()));
  if (options.remark)
    options.remark({display_name(folder),
                    std::to_string(count) + (count == 1 ? " file" : " files") +
                        " of unknown formats skipped: " + list + (count > most ? ", ..." : "")});
  files.erase(known, files.end());
}

void list_folder(const std::string& path, std::vector<std::string>& files,
                 const ReadOptions& options) {
  refuse_zarr(path);
  std::error_code error;
  std::vector<std::string> found;
  for (std::filesystem::directory_iterator it(native_path(path), error), end; !error && it != end;
       it.increment(error))
    if (utf8_name(it->path().filename())[0] != '.' && !it->is_directory())
      found.push_back(utf8_name(it->path()));
  if (error) throw Error(ErrorCode::io, display_name(path), ": ", error.message());
  if (found.empty())
    throw Error(ErrorCode::bad_file, display_name(path), ": a folder without files");
  std::sort(found.begin(), found.end(), natural_less);
  if (options.format.empty() && options.raw_dimension == 0) skip_unknown(path, found, options);
  files.insert(files.end(), found.begin(), found.end());
}

void list_pattern(const std::string& pattern, std::vector<std::string>& files) {
  std::vector<std::string> found = system::files_matching(pattern);
  if (found.empty())
    throw Error(ErrorCode::io, display_name(pattern), ": no file matches the pattern");
  std::sort(found.begin(), found.end(), natural_less);
  files.insert(files.end(), found.begin(), found.end());
}

/// True if `path` holds an array (frames, n, d); `impl` then reads from it.
template <class Impl>
bool open_array(const std::string& path, Impl& impl) {
  const std::string& format = impl.options.format;
  if (!(format.empty() ? path == "-" || extension_of(path) == "npy" : format == "npy"))
    return false;
  impl.window = FileWindow(path);
  if (!impl.window.is_open()) {
    const ReadLimit limit(display_name(path), impl.options);
    impl.stream = MappedFile(path, impl.options);
    const Source& all = impl.stream.source();
    if (format.empty() && (all.size < 6 || std::string_view(all.data, 6) != "\x93NUMPY"))
      fail(all, "a sequence on standard input has to be an .npy array (frames, n, d)");
    if (!impl.array.read_header(all, all.size))
      fail(all, "a sequence from a stream has to be an .npy array of 3 axes (frames, n, d)");
    return true;
  }
  constexpr std::uint64_t head = std::uint64_t{1} << 20;  // longer headers are in no known file
  const Source& beginning =
      impl.window.move_to(0, static_cast<std::size_t>(std::min(head, impl.window.size())));
  return impl.array.read_header(beginning, impl.window.size());
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

namespace {

/// Lists the files that match, each with the archive member that was given.
void list_matches(const std::string& path, std::vector<std::string>& files) {
  const internal::InputName input = internal::split_input(path);
  const std::size_t first = files.size();
  internal::list_pattern(input.file, files);
  for (std::size_t i = first; i < files.size() && !input.member.empty(); ++i)
    files[i] += ":" + input.member;
}

}  // namespace

std::vector<std::string> sequence_files(const std::vector<std::string>& paths,
                                        const ReadOptions& options) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    internal::system::FileStatus status{};
    const bool exists = path != "-" && internal::system::status_of(path.c_str(), status) == 0;
    if (exists && internal::system::is_folder(status))
      internal::list_folder(path, files, options);
    else if (!exists && path != "-" && path.find_first_of("*?[") != std::string::npos)
      list_matches(path, files);
    else
      files.push_back(path);
  }
  if (files.empty()) throw Error(ErrorCode::invalid_argument, "a sequence needs a file");
  return files;
}

PointSequence open_sequence(const std::vector<std::string>& paths, const ReadOptions& options) {
  if (options.skip_nan)
    throw Error(ErrorCode::invalid_argument,
                "skip_nan is not for sequences, where point i of a frame is point i of the next");
  auto impl = std::make_unique<PointSequence::Impl>();
  impl->options = options;
  impl->files = sequence_files(paths, options);
  impl->name = internal::display_name(impl->files[0]);
  if (impl->files.size() == 1 && internal::open_array(impl->files[0], *impl)) impl->files.clear();
  if (!impl->files.empty()) impl->window = internal::FileWindow();
  if (!impl->files.empty() && options.numbers == Numbers::grid && !options.grid)
    impl->options.grid = impl->grid = common_grid(impl->files, options);
  return PointSequence(std::move(impl));
}

PointSequence::PointSequence() : impl_(std::make_unique<Impl>()) {}
PointSequence::PointSequence(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PointSequence::PointSequence(PointSequence&&) noexcept = default;
PointSequence& PointSequence::operator=(PointSequence&&) noexcept = default;
PointSequence::~PointSequence() = default;

std::uint64_t PointSequence::frames() const noexcept { return impl_->frames(); }
const PointView& PointSequence::points() const noexcept { return impl_->view; }
std::uint64_t PointSequence::index() const noexcept {
  return impl_->next > 0 ? impl_->next - 1 : 0;
}
const std::string& PointSequence::name() const noexcept { return impl_->name; }
const std::string& PointSequence::format() const noexcept { return impl_->format; }
const Grid& PointSequence::grid() const noexcept { return impl_->grid; }
const Placement& PointSequence::placement() const noexcept { return impl_->placement; }
const std::vector<std::string>& PointSequence::columns() const noexcept { return impl_->columns; }
double PointSequence::read_seconds() const noexcept { return impl_->seconds; }

bool PointSequence::next() {
  if (impl_->next >= impl_->frames()) return false;
  const auto start = std::chrono::steady_clock::now();
  impl_->view = {};
  if (impl_->files.empty())
    impl_->read_array(impl_->next);
  else
    impl_->read_file(impl_->next);
  ++impl_->next;
  impl_->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return true;
}

}  // namespace cullhull
