#include "cuda/set_hulls.hpp"

#include <algorithm>
#include <optional>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/result_memory.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal::inline cuda {
namespace {

/// Host memory for copies from the device: pinned or, if none is available, pageable.
std::shared_ptr<std::byte> landing(std::size_t bytes) {
  try {
    const auto pinned = std::make_shared<PinnedArray<std::byte>>(bytes);
    return {pinned, pinned->data()};
  } catch (const OutOfMemory&) {
    const auto pageable = std::make_shared<Array<std::byte>>(bytes);
    return {pageable, pageable->data()};
  }
}

/// Starts a copy from the device. `to` may be read after the stream has been waited for.
template <class T>
void send_back(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyDeviceToHost, stream),
        "copying hulls from the device");
}

/// A copy of the items on the device.
template <class T>
DeviceArray<T> uploaded(const std::vector<T>& items, cudaStream_t stream) {
  DeviceArray<T> there(items.size(), stream);
  upload(there.data(), items.data(), items.size(), stream);
  return there;
}

/// Runs of items to copy within the device's memory: `length` items from `from` to `to`.
struct Runs {
  std::vector<std::uint64_t> from, to, length;

  void add(std::uint64_t begin, std::uint64_t target, std::uint64_t count) {
    from.push_back(begin);
    to.push_back(target);
    length.push_back(count);
  }
  /// Uploads the runs and calls launch(runs), which launches a kernel that copies them.
  template <class Launch>
  void run(cudaStream_t stream, const Launch& launch) const {
    if (from.empty()) return;
    const DeviceArray<std::uint64_t> f = uploaded(from, stream), t = uploaded(to, stream),
                                     l = uploaded(length, stream);
    check(launch(ItemRuns{f.data(), t.data(), l.data(), static_cast<std::uint32_t>(from.size())}),
          "copying sets");
  }
};

/// Divides a block of memory into arrays, one after another.
class Cutter {
 public:
  explicit Cutter(std::byte* at) : at_(at) {}
  template <class T>
  T* take(std::size_t count) {
    T* const begin = reinterpret_cast<T*>(at_);
    at_ += count * sizeof(T);
    return begin;
  }

 private:
  std::byte* at_;
};

/// The offsets and dimensions of all sets' hulls: of those that the device found, and of the others
/// from `rest`.
struct Lengths {
  std::vector<std::int64_t> vertex_at{0}, simplex_at{0};
  std::vector<std::int32_t> affine_dimensions;

  void add(std::uint64_t vertices, std::uint64_t simplices, std::int32_t affine_dimension) {
    vertex_at.push_back(vertex_at.back() + static_cast<std::int64_t>(vertices));
    simplex_at.push_back(simplex_at.back() + static_cast<std::int64_t>(simplices));
    affine_dimensions.push_back(affine_dimension);
  }
};

}  // namespace

struct SetsOnDevice::State {
  State(const DevicePointView& view, const Run& caller)
      : points(view), run(caller), stream(static_cast<cudaStream_t>(view.stream)) {
    if (view.count == 0) {
      (void)device();
      return;
    }
    const int ordinal = device_of(view);
    (void)device(ordinal);
    scope.emplace(ordinal);
  }

  unsigned d() const { return points.dimension; }
  std::size_t row_bytes() const { return d() * scalar_size(points.scalar); }
  DevicePointView from(std::uint64_t first) const {
    DevicePointView view = points;
    view.data = static_cast<const std::byte*>(points.data) +
                static_cast<std::ptrdiff_t>(first) * points.point_stride;
    view.count -= first;
    return view;
  }
  WarpSets sets() const {
    return {starts.data(), count, device_counts.data(), vertices.data(), simplices.data()};
  }
  SetRows rows_by_kernel(const std::vector<std::uint32_t>& which, SetRows&& rows) const;
  SetRows rows_by_copies(const std::vector<std::uint32_t>& which, SetRows&& rows) const;
  void copy_rest(const HullBatch& rest, const Lengths& lengths, std::int32_t* vertices_to,
                 std::int32_t* simplices_to) const;

  const DevicePointView points;
  const Run& run;
  const cudaStream_t stream;
  std::optional<DeviceScope> scope;

  const std::uint64_t* offsets = nullptr;
  std::uint32_t count = 0;
  std::vector<std::uint16_t> counts;
  DeviceArray<std::uint64_t> starts;  // relative to the first set's first point
  DeviceArray<std::uint16_t> device_counts;
  DeviceArray<std::uint8_t> vertices, simplices;
};

SetsOnDevice::SetsOnDevice(const DevicePointView& points, const Run& run)
    : state_(std::make_unique<State>(points, run)) {}
SetsOnDevice::~SetsOnDevice() = default;

std::vector<std::uint64_t> SetsOnDevice::fetch_offsets(const std::uint64_t* offsets,
                                                       std::uint64_t count) const {
  if (offsets == nullptr) throw Error(ErrorCode::invalid_argument, "offsets is null");
  cudaPointerAttributes attributes = {};
  check(cudaPointerGetAttributes(&attributes, offsets), "asking where the offsets are");
  if (attributes.type != cudaMemoryTypeDevice) {
    // Pinned and managed memory: work on the stream may still be writing it.
    if (attributes.type != cudaMemoryTypeUnregistered && state_->scope)
      synchronise(state_->stream, "waiting for the offsets");
    return {offsets, offsets + count};
  }
  if (state_->scope && attributes.device != device().ordinal)
    throw Error(ErrorCode::invalid_argument, "points and offsets are on different devices");
  std::vector<std::uint64_t> here(count);
  download(here.data(), offsets, count, state_->stream);
  return here;
}

std::vector<std::uint32_t> SetsOnDevice::open_sets() const {
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < state_->count; ++i)
    if (state_->counts[i] == 0) open.push_back(i);
  return open;
}

void SetsOnDevice::find_nothing(const std::uint64_t* offsets, std::uint32_t sets) {
  State& s = *state_;
  s.starts = {};
  s.device_counts = {};
  s.vertices = {};
  s.simplices = {};
  s.offsets = offsets;
  s.count = sets;
  s.counts.assign(sets, 0);
}

void SetsOnDevice::find(const std::uint64_t* offsets, std::uint32_t sets) {
  find_nothing(offsets, sets);
  State& s = *state_;
  // One launch each for sets of up to 32, 64, 96 and 128 points, since the warps of a launch have
  // the same amount of shared memory.
  constexpr unsigned step = 32;
  bool wanted[most_warp_points / step] = {};
  for (std::uint32_t i = 0; i < sets; ++i) {
    const std::uint64_t n = offsets[i + 1] - offsets[i];
    if (n > s.d() && n <= most_warp_points) wanted[(n - 1) / step] = true;
  }
  if (std::none_of(std::begin(wanted), std::end(wanted), [](bool w) { return w; })) return;

  const std::uint64_t first = offsets[0], total = offsets[sets] - first;
  std::vector<std::uint64_t> starts(offsets, offsets + sets + 1);
  for (std::uint64_t& start : starts) start -= first;
  s.starts = uploaded(starts, s.stream);
  s.device_counts = DeviceArray<std::uint16_t>(sets, s.stream);
  s.vertices = DeviceArray<std::uint8_t>(total, s.stream);
  s.simplices = DeviceArray<std::uint8_t>(total * simplex_room(s.d()), s.stream);
  check(cudaMemsetAsync(s.device_counts.data(), 0, sets * sizeof(std::uint16_t), s.stream),
        "clearing device memory");
  for (unsigned c = 0; c < std::size(wanted); ++c)
    if (wanted[c])
      check(find_set_hulls(s.from(first), s.sets(), std::max(step * c + 1, s.d() + 1),
                           step * (c + 1), s.stream),
            "hulling sets");
  download(s.counts.data(), s.device_counts.data(), sets, s.stream);
}

FoundLists SetsOnDevice::fetch() const {
  const State& s = *state_;
  FoundLists found;
  found.vertex_at.assign(1, 0);
  found.simplex_at.assign(1, 0);
  for (const std::uint16_t c : s.counts) {
    found.vertex_at.push_back(found.vertex_at.back() + (c & 0xFF));
    found.simplex_at.push_back(found.simplex_at.back() + (c >> 8));
  }
  const std::uint64_t vertices = found.vertex_at.back(), corners = found.simplex_at.back() * s.d();
  if (vertices == 0) return found;
  const DeviceArray<std::uint64_t> vertex_at = uploaded(found.vertex_at, s.stream),
                                   simplex_at = uploaded(found.simplex_at, s.stream);
  const DeviceArray<std::byte> rows(vertices * s.row_bytes(), s.stream);
  const DeviceArray<std::uint8_t> ids(vertices, s.stream), simplices(corners, s.stream);
  check(pack_set_hulls(s.from(s.offsets[0]), s.sets(), {vertex_at.data(), simplex_at.data()},
                       ids.data(), simplices.data(), rows.data(), s.stream),
        "packing hulls");
  const bool space = s.d() == 3;  // in 2D the order of the vertices determines the edges
  const std::shared_ptr<std::byte> memory = landing(rows.size() + vertices + (space ? corners : 0));
  const Settled settled(s.stream);
  Cutter cutter(memory.get());
  auto* const rows_here = cutter.take<std::byte>(rows.size());
  auto* const ids_here = cutter.take<std::uint8_t>(vertices);
  auto* const simplices_here = cutter.take<std::uint8_t>(space ? corners : 0);
  send_back(rows_here, rows.data(), rows.size(), s.stream);
  send_back(ids_here, ids.data(), vertices, s.stream);
  send_back(simplices_here, simplices.data(), space ? corners : 0, s.stream);
  synchronise(s.stream, "copying hulls from the device");
  found.rows = rows_here;
  found.vertices = ids_here;
  found.simplices = simplices_here;
  found.memory = memory;
  return found;
}

SetRows SetsOnDevice::fetch_rows(const std::vector<std::uint32_t>& which) const {
  const State& s = *state_;
  SetRows rows;
  rows.points.dimension = s.d();
  rows.starts.assign(1, 0);
  for (const std::uint32_t i : which)
    rows.starts.push_back(rows.starts.back() + s.offsets[i + 1] - s.offsets[i]);
  rows.points.count = rows.starts.back();
  if (rows.points.count == 0) return rows;
  try {
    return s.rows_by_kernel(which, SetRows(rows));
  } catch (const OutOfMemory&) {
    return s.rows_by_copies(which, std::move(rows));
  }
}

/// Gathers the points of all these sets by one kernel, then copies them to the host at once.
SetRows SetsOnDevice::State::rows_by_kernel(const std::vector<std::uint32_t>& which,
                                            SetRows&& rows) const {
  Runs runs;
  for (std::size_t k = 0; k < which.size(); ++k)
    runs.add(offsets[which[k]], rows.starts[k], rows.starts[k + 1] - rows.starts[k]);
  const std::size_t bytes = rows.points.count * row_bytes();
  const DeviceArray<std::byte> there(bytes, stream);
  runs.run(stream,
           [&](const ItemRuns& all) { return copy_point_runs(points, all, there.data(), stream); });
  const std::shared_ptr<std::byte> memory = landing(bytes);
  const Settled settled(stream);
  send_back(memory.get(), there.data(), bytes, stream);
  synchronise(stream, "copying points from the device");
  rows.points = points.scalar == ScalarType::f64
                    ? PointView::row_major(reinterpret_cast<const double*>(memory.get()),
                                           rows.points.count, d())
                    : PointView::row_major(reinterpret_cast<const float*>(memory.get()),
                                           rows.points.count, d());
  rows.memory = memory;
  return std::move(rows);
}

/// Copies each run of consecutive sets to the host by one copy. Packed points need no additional
/// device memory.
SetRows SetsOnDevice::State::rows_by_copies(const std::vector<std::uint32_t>& which,
                                            SetRows&& rows) const {
  const auto memory = std::make_shared<Array<double>>(rows.points.count * d());
  for (std::size_t begin = 0, end = 1; begin < which.size(); begin = end++) {
    while (end < which.size() && which[end] == which[end - 1] + 1) ++end;
    const std::uint64_t n = rows.starts[end] - rows.starts[begin];
    DevicePointView part = from(offsets[which[begin]]);
    part.count = n;
    const Array<double> copied = download_points(part, nullptr, n, run);
    std::copy(copied.begin(), copied.end(),
              memory->begin() + static_cast<std::ptrdiff_t>(rows.starts[begin] * d()));
  }
  rows.points = PointView::row_major(memory->data(), rows.points.count, d());
  rows.memory = memory;
  return std::move(rows);
}

DeviceHullBatch SetsOnDevice::join(const HullBatch& rest) const {
  const State& s = *state_;
  Lengths lengths;
  std::size_t k = 0;
  for (const std::uint16_t c : s.counts) {
    if (c != 0) {
      lengths.add(c & 0xFF, c >> 8, static_cast<std::int32_t>(s.d()));
      continue;
    }
    const bool full = rest.affine_dimensions[k] == static_cast<std::int32_t>(s.d());
    lengths.add(rest.vertices[k].size(), full ? rest.simplices[k].size() / s.d() : 0,
                rest.affine_dimensions[k]);
    ++k;
  }
  DeviceHullBatch all;
  all.dimension = s.d();
  all.sets = s.count;
  all.device = device().ordinal;
  all.vertex_count = static_cast<std::uint64_t>(lengths.vertex_at.back());
  all.simplex_count = static_cast<std::uint64_t>(lengths.simplex_at.back());

  const std::size_t ends = std::size_t{s.count} + 1;
  const auto memory = std::make_shared<ResultMemory>(
      2 * ends * sizeof(std::int64_t) +
          (all.vertex_count + all.simplex_count * s.d() + s.count) * sizeof(std::int32_t),
      s.stream);
  Cutter cutter(memory->data());
  auto* const vertex_at = cutter.take<std::int64_t>(ends);
  auto* const simplex_at = cutter.take<std::int64_t>(ends);
  auto* const vertices = cutter.take<std::int32_t>(all.vertex_count);
  auto* const simplices = cutter.take<std::int32_t>(all.simplex_count * s.d());
  auto* const dimensions = cutter.take<std::int32_t>(s.count);
  upload(vertex_at, lengths.vertex_at.data(), ends, s.stream);
  upload(simplex_at, lengths.simplex_at.data(), ends, s.stream);
  upload(dimensions, lengths.affine_dimensions.data(), s.count, s.stream);
  if (k < s.count) {
    const PackedLists at{reinterpret_cast<const std::uint64_t*>(vertex_at),
                         reinterpret_cast<const std::uint64_t*>(simplex_at)};
    check(pack_set_hulls(s.from(s.offsets[0]), s.sets(), at, vertices, simplices, s.stream),
          "packing hulls");
  }
  s.copy_rest(rest, lengths, vertices, simplices);
  synchronise(s.stream, "packing hulls");
  all.vertex_offsets = vertex_at;
  all.simplex_offsets = simplex_at;
  all.vertices = vertices;
  all.simplices = simplices;
  all.affine_dimensions = dimensions;
  all.memory = memory;
  return all;
}

/// Copies the lists of the open sets' hulls from `rest` to the result.
void SetsOnDevice::State::copy_rest(const HullBatch& rest, const Lengths& lengths,
                                    std::int32_t* vertices_to, std::int32_t* simplices_to) const {
  std::vector<std::int32_t> ids, corners;
  Runs id_runs, corner_runs;
  std::size_t k = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (counts[i] != 0) continue;
    const auto list = [&](const Lists<std::uint64_t>& lists, std::vector<std::int32_t>& items,
                          Runs& runs, std::int64_t at) {
      const auto of_set = lists[k];
      runs.add(items.size(), static_cast<std::uint64_t>(at), of_set.size());
      for (const std::uint64_t id : of_set) items.push_back(static_cast<std::int32_t>(id));
    };
    list(rest.vertices, ids, id_runs, lengths.vertex_at[i]);
    if (lengths.simplex_at[i + 1] > lengths.simplex_at[i])
      list(rest.simplices, corners, corner_runs,
           lengths.simplex_at[i] * static_cast<std::int64_t>(d()));
    ++k;
  }
  const auto copy =
      [&](const std::vector<std::int32_t>& items, const Runs& runs, std::int32_t* to) {
    if (items.empty()) return;
    const DeviceArray<std::int32_t> there = uploaded(items, stream);
    runs.run(stream, [&](const ItemRuns& all) { return copy_runs(there.data(), all, to, stream); });
  };
  copy(ids, id_runs, vertices_to);
  copy(corners, corner_runs, simplices_to);
}

}  // namespace cullhull::internal::inline cuda
