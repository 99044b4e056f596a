#include "cuda/hull_questions.hpp"

#include <algorithm>
#include <optional>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal::inline cuda {
namespace {

/// A copy of numbers on the device, which is uploaded once and used by several queries.
class Table {
 public:
  const double* on_device(const std::vector<double>& numbers, cudaStream_t stream) {
    if (there_.size() == 0 && !numbers.empty()) {
      DeviceArray<double> there(numbers.size(), stream);
      upload(there.data(), numbers.data(), numbers.size(), stream);
      there_ = std::move(there);
    }
    return there_.data();
  }

 private:
  DeviceArray<double> there_;
};

}  // namespace

struct QuestionsOnDevice::State {
  DevicePointView part(std::uint64_t first, std::uint64_t count) const {
    DevicePointView view = points;
    view.data = static_cast<const std::byte*>(points.data) +
                static_cast<std::ptrdiff_t>(first) * points.point_stride;
    view.count = count;
    return view;
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

  const DevicePointView points;
  const HullTables* const hull;
  const cudaStream_t stream;
  std::optional<DeviceScope> scope;
  Table simplices, planes, vertices;
};

QuestionsOnDevice::QuestionsOnDevice(const DevicePointView& points, const HullTables* hull)
    : state_(new State{points, hull, static_cast<cudaStream_t>(points.stream), {}, {}, {}, {}}) {
  const int ordinal = device_of(points);
  (void)device(ordinal);
  state_->scope.emplace(ordinal);
}
QuestionsOnDevice::~QuestionsOnDevice() = default;

void QuestionsOnDevice::sides(const GaugeTable* inner, std::uint64_t first, std::uint64_t count,
                              PointAnswer* out, double* distances) const {
  State& s = *state_;
  TablesThere tables = s.tables();
  tables.simplices = s.simplices.on_device(s.hull->simplices, s.stream);
  if (distances != nullptr) tables.planes = s.planes.on_device(s.hull->planes, s.stream);
  const DeviceArray<PointAnswer> answers(count, s.stream);
  const DeviceArray<double> values(distances != nullptr ? count : 0, s.stream);
  // The kernel writes the distances of points inside alone, and all are copied to the host.
  if (distances != nullptr)
    check(cudaMemsetAsync(values.data(), 0, count * sizeof(double), s.stream),
          "clearing device memory");
  const DevicePointView part = s.part(first, count);
  DeviceIds left;
  if (inner != nullptr) {
    left = survivors_of_device_points(*inner, part);
    check(cudaMemsetAsync(answers.data(), static_cast<int>(PointAnswer::inside), count, s.stream),
          "clearing device memory");
  }
  check(ask_sides(part, left.ids.data(), inner != nullptr ? left.count : count, tables,
                  answers.data(), values.data(), s.stream),
        "asking a hull");
  download(out, answers.data(), count, s.stream);
  if (distances != nullptr) download(distances, values.data(), count, s.stream);
}

void QuestionsOnDevice::supports(std::uint64_t first, std::uint64_t count,
                                 std::uint32_t* out) const {
  State& s = *state_;
  TablesThere tables = s.tables();
  tables.vertices = s.vertices.on_device(s.hull->vertices, s.stream);
  const DeviceArray<std::uint32_t> found(count, s.stream);
  check(ask_supports(s.part(first, count), tables, found.data(), s.stream), "asking a hull");
  download(out, found.data(), count, s.stream);
}

Array<double> QuestionsOnDevice::rows(const std::vector<std::uint64_t>& ids, const Run& run) const {
  return download_points(state_->points, ids.data(), ids.size(), run.control);
}

Array<double> QuestionsOnDevice::all_rows(const Run& run) const {
  return download_all(state_->points, run);
}

}  // namespace cullhull::internal::inline cuda
