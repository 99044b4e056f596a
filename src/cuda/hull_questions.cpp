#include "cuda/hull_questions.hpp"

#include <algorithm>
#include <optional>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kept_tables.hpp"
#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {
namespace {

class QuestionsThere final : public QuestionsOnDevice {
 public:
  QuestionsThere(const DevicePointView& view, const HullTables* tables, KeptTables& kept,
                 const Options& options)
      : points_(view), hull_(tables), kept_(kept), stream_(cuda_stream_of(view)) {
    scope_.emplace(device_of(view), options);
  }

  std::vector<std::uint64_t> sides(const GaugeTable* inner, SideCodes codes, std::uint64_t first,
                                   std::uint64_t count, std::uint8_t* out) override {
    TablesThere there = tables();
    there.simplices = kept_there(kept_, hull_->simplices, stream_);
    const DevicePointView part = part_of(points_, first, count);
    DeviceIds left;
    if (inner != nullptr) {
      left = survivors_of_device_points(*inner, part);
      fill(out, count, codes.inside, stream_);
    }
    return answered(first, count, [&](const OpenList& open) {
      return ask_sides(part, left.ids.data(), inner != nullptr ? left.count : count, there, codes,
                       out, open, stream_);
    });
  }
  std::vector<std::uint64_t> sides(const FacetCellTable& cells, SideCodes codes,
                                   std::uint64_t first, std::uint64_t count,
                                   std::uint8_t* out) override {
    const CellsThere there = kept_there(kept_, cells, stream_);
    return answered(first, count, [&](const OpenList& open) {
      return ask_sides_by_cells(part_of(points_, first, count), there, codes, out, open, stream_);
    });
  }
  std::vector<std::uint64_t> supports(const std::vector<std::uint64_t>& ids, std::uint64_t first,
                                      std::uint64_t count, std::uint64_t* out) override {
    TablesThere there = tables();
    there.vertices = kept_there(kept_, hull_->vertices, stream_);
    const std::uint64_t* const ids_there = kept_there(kept_, ids, stream_);
    return answered(first, count, [&](const OpenList& open) {
      return ask_supports(part_of(points_, first, count), there, ids_there, out, open, stream_);
    });
  }
  std::vector<std::uint64_t> distances(std::uint64_t first, std::uint64_t count,
                                       double* out) override {
    TablesThere there = tables();
    there.simplices = kept_there(kept_, hull_->simplices, stream_);
    there.planes = kept_there(kept_, hull_->planes, stream_);
    return answered(first, count, [&](const OpenList& open) {
      return ask_distances(part_of(points_, first, count), there, out, open, stream_);
    });
  }

  void* room(std::uint64_t bytes) override { return answers_.reserve(bytes, stream_); }
  void require_room(const void* answers, std::size_t item) const override {
    if (device_of_memory(answers, "the memory for answers is") != this_device().ordinal)
      throw Error(ErrorCode::invalid_argument,
                  "the memory for answers is on another device than the points");
    if (reinterpret_cast<std::uintptr_t>(answers) % item != 0)
      throw Error(ErrorCode::invalid_argument,
                  "the memory for answers is not aligned to an answer");
  }
  void fetch(void* to, const void* from, std::uint64_t bytes) const override {
    download(static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes, stream_);
  }
  void put(void* to, const void* from, std::uint64_t bytes) const override {
    upload(static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes, stream_);
  }
  void put_items(void* out, const std::vector<std::uint64_t>& ids, const void* items,
                 std::size_t item) const override {
    const std::span bytes(static_cast<const std::byte*>(items), ids.size() * item);
    const DeviceArray<std::uint64_t> ids_there = uploaded(ids, stream_);
    const DeviceArray<std::byte> items_there = uploaded(bytes, stream_);
    check(scatter_items(ids_there.data(), items_there.data(), item, bytes.size(),
                        static_cast<std::byte*>(out), stream_),
          "copying answers");
    synchronise(stream_, "copying answers");
  }
  Array<double> rows(const std::vector<std::uint64_t>& ids, const Run& run) const override {
    return download_points(points_, ids.data(), ids.size(), run);
  }
  Array<double> all_rows(const Run& run) const override { return download_all(points_, run); }

 private:
  TablesThere tables() const {
    TablesThere t = {};
    std::copy(hull_->low.begin(), hull_->low.end(), t.low);
    std::copy(hull_->high.begin(), hull_->high.end(), t.high);
    t.vertex_reach = hull_->vertex_reach;
    t.simplex_count = static_cast<std::uint32_t>(hull_->simplex_count());
    t.plane_count = static_cast<std::uint32_t>(hull_->planes.size() / (hull_->dimension + 1));
    t.vertex_count = static_cast<std::uint32_t>(hull_->vertices.size() / hull_->dimension);
    return t;
  }
  /// The points that ask() leaves open of `count`. It lists them in the order of threads, behind
  /// their number.
  template <class Ask>
  std::vector<std::uint64_t> answered(std::uint64_t first, std::uint64_t count, const Ask& ask) {
    std::uint32_t* const words = open_.reserve(count + 1, stream_);
    fill(words, 1, 0, stream_);
    check(ask(OpenList{words, words + 1}), "asking a hull");
    std::uint32_t listed = 0;
    download(&listed, words, 1, stream_);
    std::vector<std::uint32_t> left(listed);
    download(left.data(), words + 1, listed, stream_);
    std::sort(left.begin(), left.end());
    std::vector<std::uint64_t> found(left.begin(), left.end());
    for (std::uint64_t& i : found) i += first;
    return found;
  }

  const DevicePointView points_;
  const HullTables* const hull_;
  KeptTables& kept_;
  const cudaStream_t stream_;
  std::optional<DeviceScope> scope_;
  CudaArray<std::uint32_t> open_;
  CudaArray<std::byte> answers_;
};

}  // namespace

std::unique_ptr<QuestionsOnDevice> questions_on_device(const DevicePointView& points,
                                                       const HullTables* hull, KeptTables& kept,
                                                       const Options& options) {
  return std::make_unique<QuestionsThere>(points, hull, kept, options);
}

}  // namespace cullhull::internal
