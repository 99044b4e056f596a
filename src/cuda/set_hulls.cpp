#include "cuda/set_hulls.hpp"

#include <algorithm>
#include <span>
#include <type_traits>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {
namespace {

/// Copies runs of points to packed rows within the device's memory.
void copy_all(const DevicePointView& points, const std::vector<ItemRun>& runs, void* rows,
              cudaStream_t stream) {
  const DeviceArray<ItemRun> there = uploaded(runs, stream);
  check(
      copy_point_runs(points, there.data(), static_cast<std::uint32_t>(runs.size()), rows, stream),
      "copying sets");
}

/// Runs of items of the host, to copy into the device's memory.
template <class T>
class RunsOf {
 public:
  template <class Items>
  void add(const Items& items, std::uint64_t target) {
    runs_.push_back({items_.size(), target, items.size()});
    for (const auto item : items) items_.push_back(static_cast<T>(item));
  }
  void copy(T* to, cudaStream_t stream) const {
    if (items_.empty()) return;
    const DeviceArray<T> there = uploaded(items_, stream);
    // As points with one coordinate. Copying an integer as a float of its size changes no bit.
    using Scalar = std::conditional_t<sizeof(T) == sizeof(float), float, double>;
    const auto points = DevicePointView::row_major(reinterpret_cast<const Scalar*>(there.data()),
                                                   items_.size(), 1, stream);
    copy_all(points, runs_, to, stream);
  }

 private:
  std::vector<T> items_;
  std::vector<ItemRun> runs_;
};

/// Divides a block of memory into arrays, one after another; without a block it counts its bytes.
class Cutter {
 public:
  explicit Cutter(std::byte* block) : block_(block) {}
  std::size_t bytes() const { return bytes_; }
  /// Null unless wanted.
  template <class T>
  T* take(std::size_t count, bool wanted = true) {
    if (!wanted) return nullptr;
    const std::size_t begin = bytes_;
    bytes_ += count * sizeof(T);
    return block_ == nullptr ? nullptr : reinterpret_cast<T*>(block_ + begin);
  }

 private:
  std::byte* block_;
  std::size_t bytes_ = 0;
};

/// The lists of one kind of all sets' hulls: how many items there are, and of how many the longest
/// has. `most`: the room of a padded row; 0: any.
struct Lengths {
  const std::uint64_t most;
  std::uint64_t total = 0, longest = 0, over = 0, length_over = 0;

  void add(std::uint64_t set, std::uint64_t length) {
    total += length;
    longest = std::max(longest, length);
    if (most == 0 || length <= most || length_over != 0) return;
    over = set;
    length_over = length;
  }
  std::uint64_t width(const char* what) const {
    if (length_over != 0)
      throw Error(ErrorCode::invalid_argument, "set ", over, " has ", length_over, " ", what,
                  ", and a padded row has room for ", most);
    return most != 0 ? most : longest;
  }
};

/// The arrays of a result, in one block of memory.
struct ResultArrays {
  ResultArrays(const DeviceHullBatch& b, const DeviceBatchOptions& wanted, Cutter& cutter)
      : vertex_room(wanted.padded ? b.sets * b.vertex_width : b.vertex_count),
        simplex_room(wanted.padded ? b.sets * b.simplex_width : b.simplex_count) {
    const std::size_t d = b.dimension;
    vertex_offsets = cutter.take<std::int64_t>(b.sets + 1, !wanted.padded);
    simplex_offsets = cutter.take<std::int64_t>(b.sets + 1, !wanted.padded);
    planes = cutter.take<double>(simplex_room * (d + 1), wanted.planes);
    measures = cutter.take<double>(b.sets * (d + 2), wanted.measures);
    vertices = cutter.take<std::int32_t>(vertex_room);
    simplices = cutter.take<std::int32_t>(simplex_room * d);
    vertex_counts = cutter.take<std::int32_t>(b.sets, wanted.padded);
    simplex_counts = cutter.take<std::int32_t>(b.sets, wanted.padded);
    affine_dimensions = cutter.take<std::int32_t>(b.sets);
  }

  const std::uint64_t vertex_room, simplex_room;  ///< with padding
  std::int64_t *vertex_offsets, *simplex_offsets;
  double *planes, *measures;  ///< measures: all volumes, all areas, all centroids
  std::int32_t *vertices, *simplices, *vertex_counts, *simplex_counts, *affine_dimensions;
};

class SetsThere final : public SetsOnDevice {
 public:
  SetsThere(const DevicePointView& view, const Run& caller)
      : points(view),
        run(caller),
        stream(cuda_stream_of(view)),
        scope(view.count == 0 ? this_device().ordinal : device_of(view), caller.options) {}

  ~SetsThere() override {
    if (arriving || lists_arriving) (void)cudaStreamSynchronize(stream);
  }

  std::vector<std::uint64_t> fetch_offsets(const std::uint64_t* from,
                                           std::uint64_t number) const override {
    if (from == nullptr) throw Error(ErrorCode::invalid_argument, "offsets is null");
    cudaPointerAttributes attributes = {};
    check(cudaPointerGetAttributes(&attributes, from), "asking where the offsets are");
    if (attributes.type != cudaMemoryTypeDevice) {
      // Pinned and managed memory: work on the stream may still be writing it.
      if (attributes.type != cudaMemoryTypeUnregistered && points.count != 0)
        synchronise(stream, "waiting for the offsets");
      return {from, from + number};
    }
    if (points.count != 0 && attributes.device != this_device().ordinal)
      throw Error(ErrorCode::invalid_argument, "points and offsets are on different devices");
    std::vector<std::uint64_t> here(number);
    download(here.data(), from, number, stream);
    return here;
  }

  void find(const std::uint64_t* of, std::uint32_t sets, bool measured) override {
    find_nothing(of, sets);
    const unsigned classes = d() == 2 ? near_classes : std::size(set_classes);
    bool wanted[std::size(set_classes)] = {};
    for (std::uint32_t i = 0; i < sets; ++i) {
      const std::uint64_t n = offsets[i + 1] - offsets[i];
      if (n > d() && n <= set_classes[classes - 1])
        wanted[std::lower_bound(std::begin(set_classes), std::end(set_classes), n) - set_classes] =
            true;
    }
    if (std::count(std::begin(wanted), std::end(wanted), true) == 0) return;

    const std::uint64_t first = offsets[0], total = offsets[sets] - first;
    std::vector<std::uint64_t> starts_here(offsets, offsets + sets + 1);
    for (std::uint64_t& start : starts_here) start -= first;
    there.starts = uploaded(starts_here, stream);
    there.counts = DeviceArray<SetCounts>(sets, stream);
    there.vertices = DeviceArray<std::uint16_t>(total, stream);
    there.simplices = DeviceArray<std::uint16_t>(total * simplex_room(d()), stream);
    fill(there.counts.data(), sets, 0, stream);
    for (unsigned c = 0; c < std::size(wanted); ++c)
      if (wanted[c])
        check(find_set_hulls(from(first), this_sets(), c == 0 ? d() + 1 : set_classes[c - 1] + 1,
                             set_classes[c], stream),
              "hulling sets");
    if (measured) {
      there.measures = DeviceArray<double>(std::size_t{sets} * (d() + 2), stream);
      // The kernel leaves out open sets; `write` copies all and then replaces theirs.
      fill(there.measures.data(), there.measures.size(), 0, stream);
      there.exponents = DeviceArray<std::int8_t>(sets, stream);
      const SetMeasures to{there.measures.data(), there.measures.data() + sets,
                           there.measures.data() + 2 * std::size_t{sets}, there.exponents.data()};
      check(measure_sets(from(first), this_sets(), to, stream), "measuring hulls");
    }
    arriving = landing<SetCounts>(sets);
    begin_download(arriving.get(), there.counts.data(), sets, stream);
  }

  void find_nothing(const std::uint64_t* of, std::uint32_t sets) override {
    wait();
    there = {};
    offsets = of;
    count = sets;
    counts.assign(sets, {});
  }

  std::vector<std::uint32_t> open_sets() override {
    wait();
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < count; ++i)
      if (counts[i].vertices == 0) open.push_back(i);
    return open;
  }

  FoundLists fetch() override {
    wait();
    FoundLists found;
    found.vertex_at.assign(1, 0);
    found.simplex_at.assign(1, 0);
    for (const SetCounts c : counts) {
      found.vertex_at.push_back(found.vertex_at.back() + c.vertices);
      found.simplex_at.push_back(found.simplex_at.back() + c.simplices);
    }
    const std::uint64_t vertex_count = found.vertex_at.back(),
                        corners = found.simplex_at.back() * d();
    if (vertex_count == 0) return found;
    const DeviceArray<std::uint64_t> vertex_at(count + 1, stream), simplex_at(count + 1, stream);
    const PlacedLists at{vertex_at.data(), simplex_at.data()};
    check(place_lists(this_sets(), 0, nullptr, 0, at, stream), "placing lists");
    sum_in_place(vertex_at.data(), count + 1, stream);
    sum_in_place(simplex_at.data(), count + 1, stream);
    const DeviceArray<std::byte> rows(vertex_count * row_bytes(), stream);
    const DeviceArray<std::uint16_t> ids(vertex_count, stream), lists(corners, stream);
    check(pack_set_hulls(from(offsets[0]), this_sets(), at, ids.data(), lists.data(), rows.data(),
                         stream),
          "packing hulls");
    const bool space = d() == 3;  // in 2D the order of the vertices determines the edges
    const std::shared_ptr<std::byte> memory =
        landing<std::byte>(rows.size() + 2 * (vertex_count + (space ? corners : 0)));
    lists_arriving = memory;
    Cutter cutter(memory.get());
    auto* const rows_here = cutter.take<std::byte>(rows.size());
    auto* const ids_here = cutter.take<std::uint16_t>(vertex_count);
    auto* const simplices_here = cutter.take<std::uint16_t>(space ? corners : 0);
    begin_download(rows_here, rows.data(), rows.size(), stream);
    begin_download(ids_here, ids.data(), vertex_count, stream);
    begin_download(simplices_here, lists.data(), space ? corners : 0, stream);
    found.rows = rows_here;
    found.vertices = ids_here;
    found.simplices = simplices_here;
    found.memory = memory;
    return found;
  }

  void settle() override {
    if (!lists_arriving) return;
    synchronise(stream, "copying hulls from the device");
    lists_arriving = {};
  }

  SetRows fetch_rows(const std::vector<std::uint32_t>& which) const override {
    SetRows rows;
    rows.points.dimension = d();
    rows.starts.assign(1, 0);
    for (const std::uint32_t i : which)
      rows.starts.push_back(rows.starts.back() + offsets[i + 1] - offsets[i]);
    rows.points.count = rows.starts.back();
    if (rows.points.count == 0) return rows;
    try {
      return rows_by_kernel(which, SetRows(rows));
    } catch (const OutOfMemory&) {
      return rows_by_copies(which, std::move(rows));
    }
  }

  DeviceHullBatch join(const HullBatch& rest, const DeviceBatchOptions& wanted) const override {
    Lengths vertex_lengths{wanted.padded ? wanted.most_vertices : 0};
    Lengths simplex_lengths{wanted.padded ? wanted.most_simplices : 0};
    each_set(rest, [&](std::uint32_t i, const SetLengths& found) {
      vertex_lengths.add(i, found.vertices);
      simplex_lengths.add(i, found.simplices);
    });
    DeviceHullBatch all;
    all.dimension = d();
    all.sets = count;
    all.device = this_device().ordinal;
    all.vertex_count = vertex_lengths.total;
    all.simplex_count = simplex_lengths.total;
    if (wanted.padded) {
      all.vertex_width = vertex_lengths.width("vertices");
      all.simplex_width = simplex_lengths.width("simplices");
      const double row = std::max(static_cast<double>(all.vertex_width),
                                  static_cast<double>(all.simplex_width) * (d() + 1.0));
      if (row * count > 0x1p50) throw OutOfMemory("no device has memory for rows of this length");
    }
    Cutter size(nullptr);
    (void)ResultArrays(all, wanted, size);
    // At least a byte, so that empty arrays differ from those not asked for.
    const std::shared_ptr<std::byte> memory =
        result_memory(std::max<std::size_t>(size.bytes(), 1), stream);
    Cutter cutter(memory.get());
    const ResultArrays to(all, wanted, cutter);
    write(rest, wanted, all, to);
    all.vertex_offsets = to.vertex_offsets;
    all.simplex_offsets = to.simplex_offsets;
    all.vertices = to.vertices;
    all.simplices = to.simplices;
    all.affine_dimensions = to.affine_dimensions;
    all.vertex_counts = to.vertex_counts;
    all.simplex_counts = to.simplex_counts;
    all.planes = to.planes;
    if (wanted.measures) {
      all.volumes = to.measures;
      all.areas = to.measures + all.sets;
      all.centroids = to.measures + 2 * all.sets;
    }
    all.memory = memory;
    return all;
  }

 private:
  /// Waits for the kernels of find() and takes the counts that they have written.
  void wait() {
    if (!arriving) return;
    synchronise(stream, "hulling sets");
    std::copy_n(arriving.get(), count, counts.begin());
    arriving = {};
  }

  unsigned d() const { return points.dimension; }
  std::size_t row_bytes() const { return d() * scalar_size(points.scalar); }
  DevicePointView from(std::uint64_t first) const {
    return part_of(points, first, points.count - first);
  }
  WarpSets this_sets() const {
    return {there.starts.data(), count, there.counts.data(), there.vertices.data(),
            there.simplices.data()};
  }

  /// Gathers the points of all these sets by one kernel, then copies them to the host at once.
  SetRows rows_by_kernel(const std::vector<std::uint32_t>& which, SetRows&& rows) const {
    std::vector<ItemRun> runs;
    for (std::size_t k = 0; k < which.size(); ++k)
      runs.push_back({offsets[which[k]], rows.starts[k], rows.starts[k + 1] - rows.starts[k]});
    const std::size_t bytes = rows.points.count * row_bytes();
    const DeviceArray<std::byte> packed(bytes, stream);
    copy_all(points, runs, packed.data(), stream);
    const std::shared_ptr<std::byte> memory = landing<std::byte>(bytes);
    download(memory.get(), packed.data(), bytes, stream);
    rows.points = {memory.get(),
                   points.scalar,
                   d(),
                   rows.points.count,
                   static_cast<std::ptrdiff_t>(row_bytes()),
                   static_cast<std::ptrdiff_t>(scalar_size(points.scalar))};
    rows.memory = memory;
    return std::move(rows);
  }

  /// Copies each run of consecutive sets to the host by one copy. Packed points need no additional
  /// device memory.
  SetRows rows_by_copies(const std::vector<std::uint32_t>& which, SetRows&& rows) const {
    const auto memory = std::make_shared<Array<double>>(rows.points.count * d());
    for (std::size_t begin = 0, end = 1; begin < which.size(); begin = end++) {
      while (end < which.size() && which[end] == which[end - 1] + 1) ++end;
      const std::uint64_t n = rows.starts[end] - rows.starts[begin];
      const Array<double> copied =
          download_points(part_of(points, offsets[which[begin]], n), nullptr, n, run);
      std::copy(copied.begin(), copied.end(),
                memory->begin() + static_cast<std::ptrdiff_t>(rows.starts[begin] * d()));
    }
    rows.points = PointView::row_major(memory->data(), rows.points.count, d());
    rows.memory = memory;
    return std::move(rows);
  }

  /// Calls use(set, found) for all sets in turn; `found` has the lengths of its lists, those of
  /// open sets from `rest`.
  template <class Use>
  void each_set(const HullBatch& rest, const Use& use) const {
    std::size_t k = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (const SetCounts c = counts[i]; c.vertices != 0) {
        use(i, SetLengths{i, c.vertices, c.simplices, static_cast<std::int32_t>(d())});
        continue;
      }
      const bool full = rest.affine_dimensions[k] == static_cast<std::int32_t>(d());
      use(i, SetLengths{i, static_cast<std::uint32_t>(rest.vertices[k].size()),
                        full ? static_cast<std::uint32_t>(rest.simplices[k].size() / d()) : 0,
                        rest.affine_dimensions[k]});
      ++k;
    }
  }

  void write(const HullBatch& rest, const DeviceBatchOptions& wanted, const DeviceHullBatch& all,
             const ResultArrays& to) const {
    std::vector<SetLengths> open;
    each_set(rest, [&](std::uint32_t i, const SetLengths& found) {
      if (counts[i].vertices == 0) open.push_back(found);
    });
    DeviceArray<std::uint64_t> vertex_rows, simplex_rows;
    PlacedLists placed{reinterpret_cast<std::uint64_t*>(to.vertex_offsets),
                       reinterpret_cast<std::uint64_t*>(to.simplex_offsets),
                       to.vertex_counts,
                       to.simplex_counts,
                       to.affine_dimensions,
                       all.vertex_width,
                       all.simplex_width};
    if (wanted.padded) {
      vertex_rows = DeviceArray<std::uint64_t>(count + 1, stream);
      simplex_rows = DeviceArray<std::uint64_t>(count + 1, stream);
      placed.vertex_at = vertex_rows.data();
      placed.simplex_at = simplex_rows.data();
      fill(to.vertices, to.vertex_room, 0xFF, stream);
      fill(to.simplices, to.simplex_room * d(), 0xFF, stream);
      fill(to.planes, wanted.planes ? to.simplex_room * (d() + 1) : 0, 0, stream);
    }
    const DeviceArray<SetLengths> open_there = uploaded(open, stream);
    check(place_lists(this_sets(), static_cast<std::int32_t>(d()), open_there.data(),
                      static_cast<std::uint32_t>(open.size()), placed, stream),
          "placing lists");
    if (!wanted.padded) {
      sum_in_place(placed.vertex_at, count + 1, stream);
      sum_in_place(placed.simplex_at, count + 1, stream);
    }
    if (rest.size() < count) {
      const DevicePointView rows = from(offsets[0]);
      check(pack_set_hulls(rows, this_sets(), placed, to.vertices, to.simplices, nullptr, stream),
            "packing hulls");
      if (wanted.planes)
        check(write_set_planes(rows, this_sets(), there.exponents.data(), placed.simplex_at,
                               to.planes, stream),
              "writing planes");
      if (wanted.measures)
        check(cudaMemcpyAsync(to.measures, there.measures.data(),
                              there.measures.size() * sizeof(double), cudaMemcpyDeviceToDevice,
                              stream),
              "copying measures");
    }
    copy_rest(rest, all, to);
    synchronise(stream, "packing hulls");
  }

  /// Copies what the result has of the open sets' hulls from `rest`.
  void copy_rest(const HullBatch& rest, const DeviceHullBatch& all, const ResultArrays& to) const {
    RunsOf<std::int32_t> ids, corners;
    RunsOf<double> planes, numbers;
    const std::size_t n = d();
    std::size_t k = 0;
    std::uint64_t vertex_at = 0, simplex_at = 0;
    each_set(rest, [&](std::uint32_t i, const SetLengths& found) {
      const std::uint64_t vertex = all.vertex_width != 0 ? i * all.vertex_width : vertex_at;
      std::uint64_t at = all.simplex_width != 0 ? i * all.simplex_width : simplex_at;
      vertex_at += found.vertices;
      simplex_at += found.simplices;
      if (counts[i].vertices != 0) return;
      ids.add(rest.vertices[k], vertex);
      if (found.simplices != 0) {
        corners.add(rest.simplices[k], at * n);
        if (to.planes != nullptr)
          for (const std::uint32_t f : rest.simplex_facets[k])
            planes.add(
                std::span(rest.facet_planes).subspan((rest.facet_starts[k] + f) * (n + 1), n + 1),
                at++ * (n + 1));
      }
      if (to.measures != nullptr) {
        numbers.add(std::span(&rest.volumes[k], 1), i);
        numbers.add(std::span(&rest.areas[k], 1), std::uint64_t{count} + i);
        numbers.add(std::span(rest.centroids).subspan(k * n, n), 2 * std::uint64_t{count} + i * n);
      }
      ++k;
    });
    ids.copy(to.vertices, stream);
    corners.copy(to.simplices, stream);
    planes.copy(to.planes, stream);
    numbers.copy(to.measures, stream);
  }

  const DevicePointView points;
  const Run& run;
  const cudaStream_t stream;
  const DeviceScope scope;

  const std::uint64_t* offsets = nullptr;
  std::uint32_t count = 0;
  std::vector<SetCounts> counts;
  std::shared_ptr<SetCounts> arriving;        // where the counts are copied to, until wait()
  std::shared_ptr<std::byte> lists_arriving;  // where fetch() copies to, until settle()
  /// What find() leaves on the device.
  struct Found {
    DeviceArray<std::uint64_t> starts;  ///< relative to the first set's first point
    DeviceArray<SetCounts> counts;
    DeviceArray<std::uint16_t> vertices, simplices;
    DeviceArray<double> measures;  ///< volumes, areas, centroids
    DeviceArray<std::int8_t> exponents;
  };
  Found there;
};

}  // namespace

std::unique_ptr<SetsOnDevice> sets_on_device(const DevicePointView& points, const Run& run) {
  return std::make_unique<SetsThere>(points, run);
}

}  // namespace cullhull::internal
