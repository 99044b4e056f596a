#include "cuda/hull_questions.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "cuda/cells_on_device.hpp"
#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {
namespace {

/// A copy of numbers on the device, which is uploaded once and used by several queries.
template <class T>
class Table {
 public:
  const T* on_device(std::span<const T> numbers, cudaStream_t stream) {
    if (there_.size() == 0) there_ = uploaded(numbers, stream);
    return there_.data();
  }

 private:
  DeviceArray<T> there_;
};

/// Memory on the device that grows as needed.
template <class T>
T* room_in(DeviceArray<T>& array, std::uint64_t count, cudaStream_t stream) {
  if (array.size() < count) {
    array = {};
    array = DeviceArray<T>(count, stream);
  }
  return array.data();
}

}  // namespace

struct QuestionsOnDevice::State {
  State(const DevicePointView& view, const HullTables* tables)
      : points(view), hull(tables), stream(cuda_stream_of(view)) {
    const int ordinal = device_of(view);
    (void)device(ordinal);
    scope.emplace(ordinal);
  }

  DevicePointView part(std::uint64_t first, std::uint64_t count) const {
    return part_of(points, first, count);
  }
  TablesThere tables() const {
    TablesThere t = {};
    std::copy(hull->low.begin(), hull->low.end(), t.low);
    std::copy(hull->high.begin(), hull->high.end(), t.high);
    t.vertex_reach = hull->vertex_reach;
    t.simplex_count = static_cast<std::uint32_t>(hull->simplex_count());
    t.plane_count = static_cast<std::uint32_t>(hull->planes.size() / (hull->dimension + 1));
    t.vertex_count = static_cast<std::uint32_t>(hull->vertices.size() / hull->dimension);
    return t;
  }
  /// The list for the points that a kernel leaves open, empty. The count is the first word.
  OpenList begin_open(std::uint64_t count) {
    std::uint32_t* const words = room_in(open, count + 1, stream);
    check(cudaMemsetAsync(words, 0, sizeof(std::uint32_t), stream), "clearing device memory");
    return {words, words + 1};
  }
  std::vector<std::uint64_t> listed(std::uint64_t first) const {
    std::uint32_t count = 0;
    download(&count, open.data(), 1, stream);
    std::vector<std::uint32_t> points_left(count);
    download(points_left.data(), open.data() + 1, count, stream);
    std::sort(points_left.begin(), points_left.end());
    std::vector<std::uint64_t> found(count);
    std::transform(points_left.begin(), points_left.end(), found.begin(),
                   [first](std::uint32_t i) { return first + i; });
    return found;
  }

  const DevicePointView points;
  const HullTables* const hull;
  const cudaStream_t stream;
  std::optional<DeviceScope> scope;
  Table<double> simplices, planes, vertices;
  Table<std::uint64_t> ids;
  std::optional<CellsOnDevice> cells;
  DeviceArray<std::uint32_t> open;
  DeviceArray<std::byte> answers;
};

QuestionsOnDevice::QuestionsOnDevice(const DevicePointView& points, const HullTables* hull)
    : state_(new State(points, hull)) {}
QuestionsOnDevice::~QuestionsOnDevice() = default;

std::vector<std::uint64_t> QuestionsOnDevice::sides(const GaugeTable* inner, SideCodes codes,
                                                    std::uint64_t first, std::uint64_t count,
                                                    std::uint8_t* out) const {
  State& s = *state_;
  TablesThere tables = s.tables();
  tables.simplices = s.simplices.on_device(s.hull->simplices, s.stream);
  const DevicePointView part = s.part(first, count);
  DeviceIds left;
  if (inner != nullptr) {
    left = survivors_of_device_points(*inner, part);
    check(cudaMemsetAsync(out, codes.inside, count, s.stream), "clearing device memory");
  }
  const OpenList open = s.begin_open(count);
  check(ask_sides(part, left.ids.data(), inner != nullptr ? left.count : count, tables, codes, out,
                  open, s.stream),
        "asking a hull");
  return s.listed(first);
}

std::vector<std::uint64_t> QuestionsOnDevice::sides(const FacetCellTable& cells, SideCodes codes,
                                                    std::uint64_t first, std::uint64_t count,
                                                    std::uint8_t* out) const {
  State& s = *state_;
  if (!s.cells) s.cells.emplace(cells, s.stream);
  const OpenList open = s.begin_open(count);
  check(ask_sides_by_cells(s.part(first, count), s.cells->tables(), codes, out, open, s.stream),
        "asking a hull");
  return s.listed(first);
}

std::vector<std::uint64_t> QuestionsOnDevice::supports(const std::vector<std::uint64_t>& ids,
                                                       std::uint64_t first, std::uint64_t count,
                                                       std::uint64_t* out) const {
  State& s = *state_;
  TablesThere tables = s.tables();
  tables.vertices = s.vertices.on_device(s.hull->vertices, s.stream);
  const std::uint64_t* const ids_there = s.ids.on_device(ids, s.stream);
  const OpenList open = s.begin_open(count);
  check(ask_supports(s.part(first, count), tables, ids_there, out, open, s.stream),
        "asking a hull");
  return s.listed(first);
}

std::vector<std::uint64_t> QuestionsOnDevice::distances(std::uint64_t first, std::uint64_t count,
                                                        double* out) const {
  State& s = *state_;
  TablesThere tables = s.tables();
  tables.simplices = s.simplices.on_device(s.hull->simplices, s.stream);
  tables.planes = s.planes.on_device(s.hull->planes, s.stream);
  const OpenList open = s.begin_open(count);
  check(ask_distances(s.part(first, count), tables, out, open, s.stream), "asking a hull");
  return s.listed(first);
}

void* QuestionsOnDevice::room(std::uint64_t bytes) const {
  return room_in(state_->answers, bytes, state_->stream);
}

void QuestionsOnDevice::fetch(void* to, const void* from, std::uint64_t bytes) const {
  download(static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes, state_->stream);
}

void QuestionsOnDevice::require_room(const void* answers, std::size_t item) const {
  if (device_of_memory(answers, "the memory for answers is") != this_device().ordinal)
    throw Error(ErrorCode::invalid_argument,
                "the memory for answers is on another device than the points");
  if (reinterpret_cast<std::uintptr_t>(answers) % item != 0)
    throw Error(ErrorCode::invalid_argument, "the memory for answers is not aligned to an answer");
}

void QuestionsOnDevice::put(void* to, const void* from, std::uint64_t bytes) const {
  upload(static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes, state_->stream);
}

namespace {

template <class T>
void put_each(T* out, const std::vector<std::uint64_t>& ids, const T* items, cudaStream_t stream) {
  const DeviceArray<std::uint64_t> ids_there = uploaded(ids, stream);
  const DeviceArray<T> items_there = uploaded(std::span(items, ids.size()), stream);
  check(scatter_items(ids_there.data(), items_there.data(), ids.size(), out, stream),
        "copying answers");
  synchronise(stream, "copying answers");
}

}  // namespace

void QuestionsOnDevice::put_items(std::uint8_t* out, const std::vector<std::uint64_t>& ids,
                                  const std::uint8_t* items) const {
  put_each(out, ids, items, state_->stream);
}
void QuestionsOnDevice::put_items(std::uint64_t* out, const std::vector<std::uint64_t>& ids,
                                  const std::uint64_t* items) const {
  put_each(out, ids, items, state_->stream);
}

Array<double> QuestionsOnDevice::rows(const std::vector<std::uint64_t>& ids, const Run& run) const {
  return download_points(state_->points, ids.data(), ids.size(), run);
}

Array<double> QuestionsOnDevice::all_rows(const Run& run) const {
  return download_all(state_->points, run);
}

}  // namespace cullhull::internal
