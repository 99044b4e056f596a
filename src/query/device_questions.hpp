// Queries about points in a device's memory: the device answers what doubles decide, the host
// answers the rest.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "cuda/hull_questions.hpp"
#include "cullhull/query.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
#include "parallel/threads/run.hpp"
#include "query/facet_search.hpp"

namespace cullhull::internal {

/// The tables that kernels test points against; nullopt for hulls that kernels do not support.
std::optional<HullTables> hull_tables(const InnerPolytope& hull, const std::vector<double>& planes);

/// What a device can find sides with, besides HullTables; made when the way that needs it is
/// chosen.
struct SideTables {
  std::uint64_t cells = 0;  ///< how many cells the hull has or can get; 0: none
  bool cells_built = false;
  std::uint64_t asked_before = 0;  ///< points of earlier calls
  std::function<const FacetCells*(const Run&)> facet_cells;
  std::function<const GaugeMap*()> inner;  ///< may return null
};

/// Where the arrays are that answers are written to.
enum class AnswersIn { host, device };

/// One query call about points on a device. Every function takes `here`, which answers the same
/// query about points on the host.
class DeviceQuestions {
 public:
  template <class Out>
  using Here = std::function<void(const PointView&, Out*, const Options&)>;

  /// `tables`: null where kernels do not support the hull. With Backend::automatic the host answers
  /// where that is estimated to take less time. Points, tables and what is kept must outlive this
  /// object.
  DeviceQuestions(const DevicePointView& points, const HullTables* tables, KeptTables& kept,
                  const Options& options, AnswersIn answers_in = AnswersIn::host);

  /// `Out`: Side, or std::uint8_t for 1 (not outside) and 0.
  template <class Out>
  void sides(const SideTables& tables, Out* out, const Here<Out>& here);
  /// `ids`: the vertices' ids, by their positions in the tables.
  void supports(const std::vector<std::uint64_t>& ids, std::uint64_t* out,
                const Here<std::uint64_t>& here);
  void distances(double* out, const Here<double>& here);

 private:
  template <class Out, class There>
  void answer(Out* out, AskedPoints asked, const There& there, const Here<Out>& here);
  template <class Out>
  void ask_rest(const std::vector<std::uint64_t>& open, Out* out, const Here<Out>& here) const;
  template <class Out>
  void ask_all_here(Out* out, const Here<Out>& here) const;

  const DevicePointView& points_;
  const HullTables* tables_;
  const Options options_;  // for queries on the host
  const Run run_;
  const bool device_allowed_, must_, answers_stay_;
  std::unique_ptr<QuestionsOnDevice> device_;
};

}  // namespace cullhull::internal
