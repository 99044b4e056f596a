// Questions about points in a device's memory: what doubles decide there, the rest here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "cuda/hull_questions.hpp"
#include "cullhull/query.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline query {

/// What kernels test points against; nothing for hulls that they do not take.
std::optional<cuda::HullTables> hull_tables(const InnerPolytope& hull,
                                            const std::vector<double>& planes);

/// One call about points of a device. Every function is given one that answers about points here.
class DeviceQuestions {
 public:
  template <class Out>
  using Here = std::function<void(const PointView&, Out*, const Options&)>;

  /// `tables`: null where the device does not take the hull. All must stay.
  DeviceQuestions(const DevicePointView& points, const cuda::HullTables* tables,
                  const Options& options);

  /// `inner`: a map of the hull, tested first; may be null.
  void sides(const GaugeTable* inner, Side* out, const Here<Side>& here);
  /// `ids`: of the vertices, by their places.
  void supports(const std::vector<std::uint64_t>& ids, std::uint64_t* out,
                const Here<std::uint64_t>& here);
  void distances(double* out, const Here<double>& here);

 private:
  template <class Out, class There>
  void answer(Out* out, const There& there, const Here<Out>& here);
  template <class Out>
  void ask_rest(const std::vector<std::uint64_t>& open, Out* out, const Here<Out>& here) const;
  void refuse(std::uint64_t id) const;

  const DevicePointView& points_;
  const cuda::HullTables* tables_;
  const Options options_;  // for what is asked here
  const Run run_;
  const bool must_;
  std::optional<cuda::QuestionsOnDevice> device_;
};

}  // namespace cullhull::internal::inline query
