// Input and output of every reader: named bytes, and points in place or copied.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"

namespace cullhull::internal {

/// The bytes of a file or of standard input. `name` is used in messages.
struct Source {
  std::string name;
  const char* data = nullptr;
  std::size_t size = 0;
};

/// The memory that reading one input may take. While it exists, every Buffer that this thread
/// allocates is counted, so that no reader need know the limit.
class ReadLimit {
 public:
  /// `name`: of the input. `options`: memory_budget and blocks_hint.
  ReadLimit(std::string name, const ReadOptions& options);
  ~ReadLimit();
  ReadLimit(const ReadLimit&) = delete;
  ReadLimit& operator=(const ReadLimit&) = delete;

  std::uint64_t left() const noexcept { return left_; }
  /// Counts bytes that are about to be allocated. Throws Error{out_of_budget} if they do not fit.
  void take(std::uint64_t bytes);
  void give_back(std::uint64_t bytes) noexcept { left_ = std::min(budget_, left_ + bytes); }
  /// Throws the error of an input that takes more than `bytes`.
  [[noreturn]] void refuse(std::uint64_t bytes) const;
  /// Whether visit_blocks would read the input in blocks: its errors then say `blocks_hint`.
  void set_in_blocks(bool in_blocks) noexcept { in_blocks_ = in_blocks; }

  /// That of this thread; null if there is none.
  static ReadLimit* current() noexcept;

 private:
  std::string name_;
  std::uint64_t budget_, left_;
  const char* hint_;
  bool in_blocks_ = false;
  ReadLimit* outer_;
};

/// Uninitialised memory, on huge pages where it is large.
class Buffer {
 public:
  Buffer() = default;  ///< no memory: data() is null
  /// Throws std::bad_alloc, and Error{out_of_budget} beyond this thread's ReadLimit.
  explicit Buffer(std::size_t size);
  std::byte* data() const noexcept { return data_.get(); }
  std::size_t size() const noexcept { return data_ == nullptr ? 0 : data_.get_deleter().size; }
  template <class T>
  T* as() const noexcept {
    return reinterpret_cast<T*>(data_.get());
  }

 private:
  struct Free {
    std::align_val_t alignment;
    std::size_t size;
    void operator()(std::byte* p) const noexcept;
  };
  std::unique_ptr<std::byte, Free> data_;
};

/// A point of a text file and its line, from 1.
struct PointLine {
  std::uint64_t point = 0, line = 0;
};

struct PointData {
  PointView view;
  PointView colours;  ///< u8 red, green, blue, where the file has them
  std::string format;
  Buffer storage;                    ///< what `view` points into unless `in_place`
  Buffer colour_storage;             ///< what `colours` points into unless that is the source
  bool in_place = false;             ///< `view` points into the source
  Placement placement;               ///< of the view's axes
  Grid grid;                         ///< as PointFile::grid()
  std::vector<std::string> columns;  ///< as PointFile::columns(); empty: those of the format
  PointKeys keys;                    ///< of every point, where ReadOptions::key asks for them
  bool chosen = false;               ///< `view` and `keys` are what the options ask for
  PointLine not_finite;              ///< the first such point of a text; line 0: none
};

/// Whether numbers stay as they are stored.
inline bool stays(Numbers numbers) { return numbers == Numbers::file || numbers == Numbers::raw; }

/// Converts little-endian numbers to this machine's byte order: in place where that is
/// little-endian.
PointData in_machine_order(PointData data);
/// A copy of `data` with the bytes of each number in the other order.
PointData with_reversed_bytes(PointData data);

/// Readers, one file each. They throw Error{bad_file}; `options` gives threads and stop token.
PointData read_ply(const Source& source, const ReadOptions& options);
PointData read_pcd(const Source& source, const ReadOptions& options);
PointData read_obj(const Source& source, const ReadOptions& options);
PointData read_off(const Source& source, const ReadOptions& options);
PointData read_stl(const Source& source, const ReadOptions& options);
/// `format`: "csv", "xyz", "pts", "node", "txt" or "text".
PointData read_text(const Source& source, const ReadOptions& options, const std::string& format);
/// Scans of Leica's: each with its placement and a grid of records.
PointData read_ptx(const Source& source, const ReadOptions& options);

/// Moving points in one array (frames, n, d), frame after frame.
struct NpyFrames {
  std::uint64_t frames = 0, count = 0, data_offset = 0, frame_bytes = 0;
  std::uint32_t dimension = 0;
  std::string descr;

  /// `head`: the beginning of a file of `file_size` bytes. False for an array without 3 axes.
  bool read_header(const Source& head, std::uint64_t file_size);
  /// `bytes`: of one frame.
  PointData frame(const Source& bytes, const ReadOptions& options) const;
};

/// By the format that options.format names, else by the extension, else by the content.
PointData read_points(const Source& source, const ReadOptions& options);
/// Options used: stop, poll. `first_id`: the id of point 0 in the file.
Hull read_hull_json(const Source& source, std::vector<double>* vertex_coordinates = nullptr,
                    const Options& options = {}, std::uint64_t first_id = 0);

template <class... Parts>
[[noreturn]] void fail(const Source& source, const Parts&... parts) {
  throw Error(ErrorCode::bad_file, source.name, ": ", parts...);
}
/// Calls options.remark, if there is one.
void remark(const Source& source, const ReadOptions& options, const std::string& message,
            bool of_columns = false);
template <class... Parts>
[[noreturn]] void fail_at_line(const Source& source, std::uint64_t line, const Parts&... parts) {
  throw Error(ErrorCode::bad_file, source.name, ":", line, ": ", parts...);
}
template <class... Parts>
[[noreturn]] void fail_at_byte(const Source& source, std::uint64_t offset, const Parts&... parts) {
  throw Error(ErrorCode::bad_file, source.name, ": byte ", offset, ": ", parts...);
}

/// A piece of a file on one line and printable: letters of UTF-8 stay, other bytes become '?'.
std::string printable_text(std::string_view text);
/// The same for a message: shortened, in quotes.
std::string quoted_text(std::string_view text);
/// A file name for a message: on one line.
std::string display_name(const std::string& path);

/// "OBJ" -> "obj"; the part after the last dot of the last component, "" without one.
std::string extension_of(const std::string& path);

/// a * b, or false on overflow.
inline bool multiply(std::uint64_t a, std::uint64_t b, std::uint64_t& product) {
  product = a * b;
  return a == 0 || product / a == b;
}

}  // namespace cullhull::internal
