// Many small hulls of points in a device's memory: the host completes the hulls that the device
// finds, and computes all others itself.
#include "cullhull/device_batch.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batch/batch_maker.hpp"
#include "cuda/backend.hpp"
#include "cuda/set_hulls.hpp"
#include "flow/pipeline.hpp"

namespace cullhull::internal {
namespace {

/// The sets of one call.
class DeviceBatch {
 public:
  DeviceBatch(const DevicePointView& points, const std::uint64_t* offsets, std::uint64_t sets,
              const Options& options)
      : points_(checked(points)),
        options_(on_host(options)),
        run_(options_),
        device_(sets_on_device(points, run_)),
        starts_(there_.fetch_offsets(offsets, sets + 1)),
        sets_(sets),
        must_(options.backend == Backend::cuda),
        warps_((points.dimension == 2 || points.dimension == 3) &&
               options.backend != Backend::cpu) {
    check_offsets(points.count, starts_.data(), sets);
  }

  HullBatch to_host() {
    BatchMaker maker = made_of(sets_, points_in(0, sets_));
    std::uint64_t piece = piece_points();
    std::uint32_t count = 0;
    bool started = false;             // the kernels for the sets [first, first + count)
    std::optional<FoundLists> found;  // theirs, if copying them has begun
    for (std::uint64_t first = 0; first < sets_;) {
      run_.check();
      if (!started) count = sets_within(first, piece);
      Piece taken;
      try {
        if (!started) find(first, count, warps_);
        taken = take(first, count, found);
      } catch (const OutOfMemory&) {
        started = false;
        if (count > least_sets) {
          piece = std::max<std::uint64_t>(points_in(first, first + count) / 2, 1);
          continue;
        }
        if (must_) throw;
        find(first, count, false);
        taken = take(first, count, found);
      }
      // While the CPU completes the sets taken, the device finds the hulls of the next ones, and
      // copies them when half of the CPU's work is done.
      first += count;
      count = first < sets_ ? sets_within(first, piece) : 0;
      started = count > 0 && spared([&] { find(first, count, warps_); });
      add(maker, taken, 0, taken.count / 2);
      if (started) spared([&] { found = there_.fetch(); });
      add(maker, taken, taken.count / 2, taken.count);
    }
    return std::move(maker).finish();
  }

  /// The coordinates of all sets' vertices.
  Array<double> vertex_rows(const HullBatch& batch) const {
    std::vector<std::uint64_t> ids;
    ids.reserve(batch.vertices.items.size());
    for (std::uint64_t i = 0; i < sets_; ++i)
      for (const std::uint64_t v : batch.vertices[i]) ids.push_back(starts_[i] + v);
    return fetch_points(points_, ids);
  }

  DeviceHullBatch to_device(const DeviceBatchOptions& wanted) {
    if (sets_ > most_sets)
      throw Error(ErrorCode::invalid_argument, "a batch on a device has at most 2^31 - 1 sets");
    for (std::uint64_t i = 0; i < sets_; ++i)
      if (starts_[i + 1] - starts_[i] > most_sets)
        throw Error(ErrorCode::invalid_argument, "set ", i, " has more than 2^31 - 1 points");
    run_.check();
    find(0, static_cast<std::uint32_t>(sets_), warps_, wanted.planes || wanted.measures);
    const std::vector<std::uint32_t> open = there_.open_sets();
    const SetRows rows = there_.fetch_rows(open);
    BatchMaker maker = made_of(open.size(), rows.points.count);
    maker.add(
        open.size(),
        [&](SetHuller& huller, std::uint64_t i, HullBatch& part) {
      huller.append(rows.set(i), part);
        },
        [&](std::uint64_t i) { return open[i]; });
    const HullBatch rest = std::move(maker).finish();
    run_.check();
    return there_.join(rest, wanted);
  }

 private:
  static constexpr std::uint64_t most_sets = std::numeric_limits<std::int32_t>::max();
  /// Where memory is short, a piece of at most this many sets goes to the host instead of being
  /// halved: with a warp a set, smaller pieces would leave most of a device idle. Untested.
  static constexpr std::uint32_t least_sets = 64;
  /// The most vertices of a hull that is written from its simplices; of more, the CPU hulls them.
  static constexpr unsigned most_listed = 128;

  static const DevicePointView& checked(const DevicePointView& points) {
    check_arguments(points);
    return points;
  }
  static Options on_host(const Options& options) {
    Options o = options;
    o.backend = Backend::cpu;
    return o;
  }

  std::uint64_t points_in(std::uint64_t begin, std::uint64_t end) const {
    return starts_[end] - starts_[begin];
  }
  BatchMaker made_of(std::uint64_t sets, std::uint64_t points) const {
    return {points_.dimension, points_.scalar, sets, points, run_};
  }

  /// Points per piece: enough to fill any device some times over, within a quarter of the budget. A
  /// point takes its row and 8 bytes of lists.
  std::uint64_t piece_points() const {
    constexpr std::uint64_t wanted = std::uint64_t{1} << 21;
    const std::uint64_t bytes = points_.dimension * sizeof(double) + 8;
    return std::clamp<std::uint64_t>(run_.budget / (4 * bytes), 1, wanted);
  }
  /// The number of sets from `first` on that have at most `points` points in all; at least one.
  std::uint32_t sets_within(std::uint64_t first, std::uint64_t points) const {
    const auto begin = starts_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = std::upper_bound(begin + 1, starts_.end(), *begin + points);
    const auto sets = static_cast<std::uint64_t>(end - begin) - 1;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(sets, 1, std::uint64_t{1} << 20));
  }

  void find(std::uint64_t first, std::uint32_t count, bool warps, bool measured = false) {
    if (warps)
      there_.find(starts_.data() + first, count, measured);
    else
      there_.find_nothing(starts_.data() + first, count);
  }

  /// Runs a step that is repeated later if the device has no memory for it now. False in that case.
  template <class Step>
  static bool spared(const Step& step) {
    try {
      step();
      return true;
    } catch (const OutOfMemory&) {
      return false;
    }
  }

  /// What the CPU needs of the sets [first, first + count).
  struct Piece {
    std::uint64_t first = 0;
    std::uint32_t count = 0;
    FoundLists found;
    SetRows rows;                      // of the open sets
    std::vector<std::uint32_t> place;  // of each set among these
  };

  /// Copies to the host what find() has found of the sets [first, first + count), unless that
  /// has `begun`, which is used up. Throws OutOfMemory.
  Piece take(std::uint64_t first, std::uint32_t count, std::optional<FoundLists>& begun) const {
    Piece piece;
    piece.first = first;
    piece.count = count;
    piece.found = begun ? std::move(*begun) : there_.fetch();
    begun.reset();
    there_.settle();
    const std::vector<std::uint32_t> open = there_.open_sets();
    piece.rows = there_.fetch_rows(open);
    piece.place.resize(count);
    for (std::size_t k = 0; k < open.size(); ++k)
      piece.place[open[k]] = static_cast<std::uint32_t>(k);
    return piece;
  }

  /// Adds sets [begin, end) of the piece.
  void add(BatchMaker& maker, const Piece& piece, std::uint32_t begin, std::uint32_t end) const {
    const FoundLists& found = piece.found;
    maker.add(
        end - begin,
        [&](SetHuller& huller, std::uint64_t k, HullBatch& part) {
      const std::uint64_t i = begin + k;
      if (found.vertex_at[i + 1] > found.vertex_at[i])
        append(found, piece.first, i, huller, part);
      else
        huller.append(piece.rows.set(piece.place[i]), part);
        },
        [&](std::uint64_t k) { return piece.first + begin + k; });
  }

  /// Appends set first + i, set i of those found.
  void append(const FoundLists& found, std::uint64_t first, std::uint64_t i, SetHuller& huller,
              HullBatch& part) const {
    const std::uint64_t at = found.vertex_at[i], vertices = found.vertex_at[i + 1] - at;
    const std::vector<std::uint64_t> ids(found.vertices + at, found.vertices + at + vertices);
    FoundHull hull;
    hull.rows.data = found.rows + at * points_.dimension * scalar_size(points_.scalar);
    hull.rows.scalar = points_.scalar;
    hull.rows.dimension = points_.dimension;
    hull.rows.count = vertices;
    hull.rows.coordinate_stride = static_cast<std::ptrdiff_t>(scalar_size(points_.scalar));
    hull.rows.point_stride = hull.rows.coordinate_stride * points_.dimension;
    hull.ids = ids.data();
    hull.point_count = points_in(first + i, first + i + 1);
    std::uint8_t place[std::numeric_limits<std::uint16_t>::max()], corners[3 * 2 * most_listed];
    if (points_.dimension == 3 && vertices <= most_listed) {
      for (std::uint64_t k = 0; k < vertices; ++k) place[ids[k]] = static_cast<std::uint8_t>(k);
      hull.simplex_count = static_cast<unsigned>(found.simplex_at[i + 1] - found.simplex_at[i]);
      const std::uint16_t* const from = found.simplices + 3 * found.simplex_at[i];
      for (unsigned k = 0; k < 3 * hull.simplex_count; ++k) corners[k] = place[from[k]];
      hull.simplices = corners;
    }
    huller.append(hull, part);
  }

  const DevicePointView points_;
  const Options options_;
  const Run run_;
  const std::unique_ptr<SetsOnDevice> device_;
  SetsOnDevice& there_ = *device_;
  const std::vector<std::uint64_t> starts_;
  const std::uint64_t sets_;
  const bool must_, warps_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

HullBatch convex_hulls(const DevicePointView& points, const std::uint64_t* offsets,
                       std::uint64_t set_count, const Options& options,
                       Array<double>* vertex_coordinates) {
  internal::DeviceBatch sets(points, offsets, set_count, options);
  HullBatch batch = sets.to_host();
  if (vertex_coordinates != nullptr) *vertex_coordinates = sets.vertex_rows(batch);
  return batch;
}

DeviceHullBatch convex_hulls_on_device(const DevicePointView& points, const std::uint64_t* offsets,
                                       std::uint64_t set_count, const Options& options,
                                       const DeviceBatchOptions& content) {
  return internal::DeviceBatch(points, offsets, set_count, options).to_device(content);
}

}  // namespace cullhull
