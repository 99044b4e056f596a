// TriangulationQuery: single queries and batches.
#include "cullhull/triangulation_query.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <variant>

#include "cullhull/error.hpp"
#include "diagrams/locate/cell_maps.hpp"
#include "diagrams/locate/nearest_tree.hpp"
#include "diagrams/locate/queries.hpp"
#include "diagrams/locate/walk.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/once.hpp"

namespace cullhull::internal {
namespace {

/// Visits the points of a batch along the curve, their rows in the mesh's columns.
template <class Body>
void each_along_curve(const WalkMesh& mesh, const PointView& view, const Run& run,
                      const Body& body) {
  const unsigned d = mesh.dimension;
  const auto set_keys = [&](double* rows, std::uint64_t count, const auto& put) {
    std::vector<double> row(d);
    for (std::uint64_t i = 0; mesh.corners < d + 1 && i < count; ++i) {
      std::copy_n(rows + i * d, d, row.begin());
      for (unsigned j = 0; j < d; ++j) rows[i * d + j] = row[mesh.columns[j]];
    }
    mesh.frame.keys(
        count, [&](std::uint64_t i) { return rows + i * d; }, put);
  };
  each_query(view, mesh.frame.key_bits(), run, set_keys, body);
}

// ------------------------------------------------------------------- barycentric coordinates

/// Computes, in double-doubles, the determinants of all rows p_i - q but one. Operations have
/// relative errors of 2^-102: each determinant has an error of at most `bound`; their sum, the
/// cell's own determinant, of (k + 1) times that plus some roundings. Returns false if that does
/// not prove the result.
template <unsigned K>
bool by_double_doubles(const double* const* p, const double* q, double* out) {
  DoubleDouble m[K + 1][K];
  double product = 1;
  for (unsigned j = 0; j < K; ++j) {
    double largest = 0;
    for (unsigned i = 0; i <= K; ++i) {
      m[i][j] = DoubleDouble::sum(p[i][j], -q[j]);
      largest = std::max(largest, std::abs(m[i][j].high));
    }
    // Then nothing overflows, and underflows add up to less than 2^-300.
    if (!(largest >= 0x1p-100 && largest <= 0x1p100)) return false;
    product *= largest;
  }
  const double bound = (minor_roundings(K) + 4) * 0x1p-101 * factorial(K) * product + 0x1p-300;
  DoubleDouble part[K + 1], whole;
  double sizes = 0;
  for (unsigned i = 0; i <= K; ++i) {
    DoubleDouble rows[K][K];
    for (unsigned r = 0, to = 0; r <= K; ++r)
      if (r != i) std::copy_n(m[r], K, rows[to++]);
    const DoubleDouble det = determinant(rows);
    part[i] = i % 2 == 0 ? det : -det;
    whole = whole + part[i];
    sizes += std::abs(part[i].high);
  }
  const double doubt = (K + 1) * bound + (K + 1) * 0x1p-101 * sizes;
  if (!(doubt < 0x1p-55 * std::abs(whole.high))) return false;
  for (unsigned i = 0; i <= K; ++i) {
    if (std::abs(part[i].high) > bound) {
      out[i] = (part[i] / whole).value();
      continue;
    }
    const double* corners[K + 1];
    for (unsigned r = 0; r <= K; ++r) corners[r] = r == i ? q : p[r];
    if (orientation(K, corners) != Sign::zero) return false;
    out[i] = 0;
  }
  return true;
}

void by_rationals(unsigned k, const double* const* p, const double* q, double* out) {
  RationalRows m(k, std::vector<mpq_class>(k + 1));
  for (unsigned j = 0; j < k; ++j) {
    for (unsigned i = 0; i < k; ++i) m[j][i] = mpq_class(p[i + 1][j]) - mpq_class(p[0][j]);
    m[j][k] = mpq_class(q[j]) - mpq_class(p[0][j]);
  }
  if (!solve(m)) {
    std::fill_n(out, k + 1, NAN);
    return;
  }
  mpq_class first = 1;
  for (unsigned i = 0; i < k; ++i) {
    first -= m[i][k];
    out[i + 1] = nearest_double(m[i][k]);
  }
  out[0] = nearest_double(first);
}

/// The barycentric coordinates of q in the simplex of k + 1 affinely independent points of R^k, k
/// >= 0. Each has an error of at most 2^-50 max(1, |itself|); exact zeros are zero.
/// docs/exactness.md, "Points in cells", derives the bound.
void barycentric(unsigned k, const double* const* p, const double* q, double* out) {
  with_dimension<1, 6, 0>(k, [&](auto known) {
    if constexpr (known() != 0) {
      if (by_double_doubles<known()>(p, q, out)) return;
    }
    by_rationals(k, p, q, out);
  });
}

/// How far, as a share of the way to the middle of all vertices, a point outside is moved to look
/// for the cell that a tolerance puts it into; also a quarter of it.
double longest_pull(double tolerance) { return std::min(4 * tolerance, 0x1p-20); }

/// Where such a step leads.
void pull_to_middle(const Extent& extent, const double* q, double pull, double* to) {
  for (std::size_t j = 0; j < extent.middle.size(); ++j)
    to[j] = q[j] + pull * (extent.middle[j] - q[j]);
}

/// A cell that a step from q towards the middle leads to, if no barycentric coordinate of q in it
/// is below -tolerance; q is outside. Walks begin at `place`.
template <unsigned K>
std::uint32_t near_cell(const WalkMesh& mesh, const Extent& extent, Walk<K>& walk, const double* q,
                        std::uint32_t place, double tolerance) {
  const unsigned d = mesh.dimension;
  std::vector<double> pulled(d), shares(d + 1);
  std::vector<const double*> corners(d + 1);
  const double longest = longest_pull(tolerance);
  for (const double pull : {longest, 0.25 * longest}) {
    pull_to_middle(extent, q, pull, pulled.data());
    const std::uint32_t at = walk.find_from(place, pulled.data());
    if (at == no_index) continue;
    for (unsigned i = 0; i <= d; ++i) corners[i] = mesh.row(mesh.corners_of(at)[i]);
    barycentric(d, corners.data(), q, shares.data());
    if (*std::min_element(shares.begin(), shares.end()) >= -tolerance) return at;
  }
  return no_index;
}

/// Answers of one thread to questions about few cells.
template <unsigned K>
class FewCells {
 public:
  FewCells(const WalkMesh& mesh, const Extent& extent, const CellMaps<K>& maps, double tolerance)
      : mesh_(mesh), extent_(extent), maps_(maps), tolerance_(tolerance) {}

  /// Calls body(i, place of the cell, shares) for the points [begin, end); shares are barycentric
  /// coordinates if `with_shares`.
  template <class Body>
  void find(const PointView& points, std::uint64_t begin, std::uint64_t end, bool with_shares,
            const Body& body) {
    double rows[answered_at_once * K];
    MappedAnswer<K> answers[answered_at_once];
    for (std::uint64_t first = begin; first < end; first += answered_at_once) {
      const auto n =
          static_cast<std::size_t>(std::min<std::uint64_t>(answered_at_once, end - first));
      load_rows(points, first, first + n, rows);
      answer(maps_, rows, n, with_shares, 0x1p-40 + (K + 1) * tolerance_, answers);
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t place = place_of(rows + i * K, answers[i]);
        if (with_shares && place != no_index &&
            !(answers[i].found == Found::inside && answers[i].refined))
          exact_shares(rows + i * K, place, answers[i].shares);
        body(first + i, place, answers[i].shares);
      }
    }
  }

 private:
  std::uint32_t place_of(const double* q, const MappedAnswer<K>& answer) {
    if (answer.found == Found::inside) return answer.place;
    if (answer.found == Found::far) return no_index;
    if (answer.found == Found::outside && (tolerance_ == 0 || stays_outside(answer.place, q)))
      return no_index;
    if (!walk_) walk_.emplace(mesh_);
    if (answer.found == Found::doubtful) {
      const std::uint32_t exact = walk_->find_from(answer.place, q);
      if (exact != no_index || tolerance_ == 0) return exact;
    }
    return near_cell(mesh_, extent_, *walk_, q, answer.place, tolerance_);
  }
  /// Whether near_cell() would find none.
  bool stays_outside(std::uint32_t place, const double* q) const {
    double pulled[K];
    const double longest = longest_pull(tolerance_);
    for (const double pull : {longest, 0.25 * longest}) {
      pull_to_middle(extent_, q, pull, pulled);
      if (!maps_.is_outside(place, pulled)) return false;
    }
    return true;
  }
  void exact_shares(const double* q, std::uint32_t place, double* shares) const {
    const double* corners[K + 1];
    for (unsigned i = 0; i <= K; ++i) corners[i] = mesh_.row(mesh_.corners_of(place)[i]);
    barycentric(K, corners, q, shares);
  }

  const WalkMesh& mesh_;
  const Extent& extent_;
  const CellMaps<K>& maps_;
  std::optional<Walk<K>> walk_;
  double tolerance_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

struct TriangulationQuery::State {
  State(const PointView& points, const Triangulation& t, std::span<const double> weights,
        const Run& run)
      : mesh(points, t, weights, run) {}

  /// The coordinates of one point in the mesh's columns. Throws not_finite.
  std::vector<double> row_of(const double* point) const {
    std::vector<double> row(mesh.dimension);
    for (unsigned j = 0; j < mesh.dimension; ++j) {
      row[j] = point[mesh.columns[j]];
      require_finite(row[j], mesh.columns[j]);
    }
    return row;
  }
  void check(const PointView& view, const Run& run) const {
    require_points(view);
    if (view.dimension != mesh.dimension)
      throw Error(ErrorCode::invalid_argument, "points of dimension ", view.dimension,
                  " asked of a triangulation in dimension ", mesh.dimension);
    check_finite(view, nullptr, run);
  }
  /// Calls body(run), which writes cells or vertices for all points. If the triangulation is empty,
  /// writes no_index for each point instead.
  template <class Body>
  void answer(const PointView& points, std::uint32_t* out, const RunOptions& options,
              const Body& body) const {
    const Call call(options);
    const Run& run = call.run;
    check(points, run);
    if (mesh.corners == 0)
      std::fill_n(out, points.count, no_index);
    else
      body(run);
  }
  std::uint32_t key(const double* row) const { return mesh.corners > 1 ? mesh.frame.key(row) : 0; }

  /// Whether the row is in the flat of the points: for each further axis, a cell's corners and the
  /// row, projected onto the flat's axes and that axis, have no volume.
  bool in_flat(const double* row) const {
    const unsigned k = mesh.corners - 1, d = mesh.dimension;
    if (k == d) return true;
    if (k == 0) return std::equal(row, row + d, mesh.row(mesh.corners_of(0)[0]));
    std::vector<double> projected((k + 2) * (k + 1));
    std::vector<const double*> rows(k + 2);
    for (unsigned other = k; other < d; ++other) {
      for (unsigned i = 0; i < k + 2; ++i) {
        const double* from = i <= k ? mesh.row(mesh.corners_of(0)[i]) : row;
        double* to = projected.data() + std::size_t{i} * (k + 1);
        std::copy_n(from, k, to);
        to[k] = from[other];
        rows[i] = to;
      }
      if (orientation(k + 1, rows.data()) != Sign::zero) return false;
    }
    return true;
  }

  const Extent& extent() const {
    extent_once.call([&] { made_extent.emplace(mesh); });
    return *made_extent;
  }
  using Maps = std::variant<std::monostate, CellMaps<2>, CellMaps<3>, CellMaps<4>>;
  /// Of few cells in 2D to 4D; made when first asked for.
  const Maps& maps(const Run& run) const {
    maps_once.call([&] {
      const unsigned k = mesh.corners == 0 ? 0 : mesh.corners - 1;
      if (k != mesh.dimension) return;
      with_dimension<2, 4, 0>(k, [&](auto known) {
        if constexpr (known() != 0)
          if (mesh.numbers.size() * sizeof(MappedCell<known()>) <= most_map_bytes)
            made_maps.emplace<CellMaps<known()>>(mesh, extent(), run);
      });
    });
    return made_maps;
  }
  /// Whether maps would have paid for the questions so far and these. The map of a cell takes 40 to
  /// 340 ns, a question by a walk 50 to 600 ns more than by maps, with shares 0.3 to 2 us, and a
  /// call by walks 2 us more.
  bool maps_pay(std::uint64_t questions, bool with_shares) const {
    const std::uint64_t cells = mesh.numbers.size(), more = 24 + questions * (with_shares ? 3 : 1);
    return asked.fetch_add(more, std::memory_order_relaxed) + more > cells / 2 || cells <= 1024;
  }
  /// Calls body(i, place of its cell, shares) for all points, as FewCells does. False without a
  /// call where there are no maps.
  template <class Body>
  bool each_mapped(const PointView& points, double tolerance, bool with_shares, const Run& run,
                   const Body& body) const {
    if (!maps_pay(points.count, with_shares)) return false;
    return std::visit(
        [&](const auto& made) {
      using Made = std::remove_cvref_t<decltype(made)>;
      if constexpr (std::is_same_v<Made, std::monostate>) {
        return false;
      } else {
        run.each(points.count, queries_per_chunk, [&](std::uint64_t begin, std::uint64_t end) {
          FewCells<Made::dimension>(mesh, extent(), made, tolerance)
              .find(points, begin, end, with_shares, body);
        });
        return true;
      }
        },
        maps(run));
  }

  /// Whether a tolerance may put q, which is outside, into a cell.
  bool is_near(const double* q, double tolerance) const {
    const unsigned d = mesh.dimension;
    if (tolerance == 0 || mesh.corners <= d) return false;
    const Extent& box = extent();
    for (unsigned j = 0; j < d; ++j) {
      const double margin = (d + 1) * tolerance * (box.high[j] - box.low[j]);
      if (!(q[j] >= box.low[j] - margin && q[j] <= box.high[j] + margin)) return false;
    }
    return true;
  }

  template <unsigned K>
  std::uint32_t find_row(Walk<K>& walk, const double* row, std::uint32_t key) const {
    if (!in_flat(row)) return no_index;
    if (mesh.corners == 1) return 0;
    const std::uint32_t place = walk.find(row, key);
    return place == no_index ? no_index : mesh.numbers[place];
  }

  void find_by_walks(const PointView& points, std::uint32_t* out, double tolerance,
                     const Run& run) const {
    with_dimension<2, 3, 0>(mesh.corners - 1, [&](auto k) {
      each_along_curve(mesh, points, run, [&] {
        return [&, walk = Walk<k()>(mesh)](std::uint64_t i, const double* row,
                                           std::uint32_t key) mutable {
          out[i] = find_row(walk, row, key);
          if (out[i] == no_index && is_near(row, tolerance)) {
            const std::uint32_t place =
                near_cell(mesh, extent(), walk, row, walk.place(), tolerance);
            if (place != no_index) out[i] = mesh.numbers[place];
          }
        };
      });
    });
  }

  void barycentric_row(const double* row, std::uint32_t cell, double* out) const {
    if (cell == no_index) {
      std::fill_n(out, mesh.corners, std::numeric_limits<double>::quiet_NaN());
      return;
    }
    if (cell >= mesh.numbers.size())
      throw Error(ErrorCode::invalid_argument, "there is no cell ", cell);
    if (mesh.corners == 1) {
      out[0] = 1;
      return;
    }
    std::vector<const double*> corners(mesh.corners);
    const std::uint32_t* v = mesh.corners_of(mesh.places[cell]);
    for (unsigned i = 0; i < mesh.corners; ++i) corners[i] = mesh.row(v[i]);
    internal::barycentric(mesh.corners - 1, corners.data(), row, out);
  }

  const Adjacency<std::uint32_t>& graph(const Run& run) const {
    graph_once.call([&] {
      made_graph = neighbour_rows(mesh, run);
      has_graph = true;
    });
    return made_graph;
  }

  /// The tree that is to be asked for the vertices nearest to `count` queries; null: walks are
  /// better, or the distances are none of a tree. One query takes about as long either way, on
  /// uniform points: 0.2 us by a walk and 0.5 us by a tree in the plane, 0.3 and 0.5 us in 3D, 1.5
  /// and 1.1 us in 5D. The first one prepares for all: a tree in 0.2 us a point, the graph of a
  /// walk in 0.2 us in the plane, 2.2 us in 3D, 130 us in 5D.
  const NearestTree* tree_for(std::uint64_t count, const Run& run) const {
    if (mesh.stride > mesh.dimension || mesh.furthest || mesh.corners <= 3 ||
        mesh.dimension > NearestTree::most_dimensions)
      return nullptr;
    const std::uint64_t points = mesh.vertex_count();
    if (mesh.corners == 4 && (has_graph || (!has_tree && count > 8 * points))) return nullptr;
    if (has_graph && !has_tree && count < points) return nullptr;
    return &tree(run);
  }
  const NearestTree& tree(const Run& run) const {
    tree_once.call([&] {
      const unsigned d = mesh.dimension;
      Array<double> rows(std::size_t{mesh.vertex_count()} * d);
      for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
        for (unsigned j = 0; j < d; ++j)
          rows[std::size_t{v} * d + mesh.columns[j]] = mesh.row(v)[j];
      made_tree = NearestTree::of(d, rows.data(), mesh.ids.data(), mesh.vertex_count(), run);
      has_tree = true;
    });
    return *made_tree;
  }

  WalkMesh mesh;
  mutable Once graph_once, tree_once, extent_once, maps_once;
  mutable std::optional<const Extent> made_extent;
  mutable Maps made_maps;
  mutable Adjacency<std::uint32_t> made_graph;
  mutable std::unique_ptr<const NearestTree> made_tree;
  mutable std::atomic<bool> has_graph = false, has_tree = false;
  mutable std::atomic<std::uint64_t> asked = 0;  ///< see maps_pay()
};

TriangulationQuery::TriangulationQuery(const PointView& points, const Triangulation& triangulation,
                                       std::span<const double> weights, const RunOptions& options) {
  const Call call(options);
  const Run& run = call.run;
  state_ = std::make_unique<State>(points, triangulation, weights, run);
}
TriangulationQuery::~TriangulationQuery() = default;
TriangulationQuery::TriangulationQuery(TriangulationQuery&&) noexcept = default;
TriangulationQuery& TriangulationQuery::operator=(TriangulationQuery&&) noexcept = default;

std::uint32_t TriangulationQuery::dimension() const noexcept { return state_->mesh.dimension; }

unsigned TriangulationQuery::corners() const noexcept { return state_->mesh.corners; }

std::uint32_t TriangulationQuery::find(const double* point) const {
  const State& s = *state_;
  const std::vector<double> row = s.row_of(point);
  if (s.mesh.corners == 0) return no_index;
  Walk<0> walk(s.mesh);
  return s.find_row(walk, row.data(), s.key(row.data()));
}

void TriangulationQuery::barycentric(const double* point, std::uint32_t cell, double* out) const {
  state_->barycentric_row(state_->row_of(point).data(), cell, out);
}

std::uint32_t TriangulationQuery::nearest(const double* point) const {
  const State& s = *state_;
  const std::vector<double> row = s.row_of(point);
  if (s.mesh.corners == 0) return no_index;
  if (const NearestTree* const tree = s.tree_for(1, short_run())) {
    std::vector<double> given(s.mesh.dimension);
    for (unsigned j = 0; j < s.mesh.dimension; ++j) given[s.mesh.columns[j]] = row[j];
    const std::uint32_t id = tree->nearest(given.data(), NearestTree::FarQueries::left_out);
    if (id != no_index) return id;
  }
  return NearestVertex(s.mesh, s.graph(short_run())).find(row.data(), s.key(row.data()));
}

void TriangulationQuery::find(const PointView& points, std::uint32_t* out,
                              const RunOptions& options, double tolerance) const {
  const State& s = *state_;
  s.answer(points, out, options, [&](const Run& run) {
    const auto keep = [&](std::uint64_t i, std::uint32_t place, const double*) {
      out[i] = place == no_index ? no_index : s.mesh.numbers[place];
    };
    if (s.each_mapped(points, tolerance, false, run, keep)) return;
    s.find_by_walks(points, out, tolerance, run);
  });
}

void TriangulationQuery::interpolate(const PointView& points, const double* values,
                                     std::uint32_t components, std::span<const double> outside,
                                     double* out, const RunOptions& options,
                                     double tolerance) const {
  const State& s = *state_;
  if (components == 0 || outside.empty())
    throw Error(ErrorCode::invalid_argument, "values need at least one component");
  const Call call(options);
  s.check(points, call.run);
  const auto write = [&](std::uint64_t i, std::uint32_t place, const double* shares) {
    double* const row = out + i * components;
    if (place == no_index) {
      for (std::uint32_t c = 0; c < components; ++c) row[c] = outside[c % outside.size()];
      return;
    }
    std::fill_n(row, components, 0.0);
    const std::uint32_t* const v = s.mesh.corners_of(place);
    for (unsigned j = 0; j < s.mesh.corners; ++j) {
      if (shares[j] == 0) continue;  // even a NaN there has no effect
      const double* const value = values + std::size_t{s.mesh.ids[v[j]]} * components;
      for (std::uint32_t c = 0; c < components; ++c) row[c] += shares[j] * value[c];
    }
  };
  if (s.each_mapped(points, tolerance, true, call.run, write)) return;
  // Cells and shares of so many points at once, which bounds the memory.
  const std::uint64_t block = queries_at_once / 4;
  Array<std::uint32_t> cells(std::min(points.count, block));
  Array<double> shares(cells.size() * std::max(1U, s.mesh.corners));
  for (std::uint64_t first = 0; first < points.count; first += block) {
    PointView part = points;
    part.count = std::min(block, points.count - first);
    part.data = points.address(first, 0);
    if (s.mesh.corners == 0)
      std::fill_n(cells.data(), part.count, no_index);
    else
      s.find_by_walks(part, cells.data(), tolerance, call.run);
    barycentric(part, cells.data(), shares.data(), options);
    call.run.each(part.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i)
        write(first + i, cells[i] == no_index ? no_index : s.mesh.places[cells[i]],
              shares.data() + i * s.mesh.corners);
    });
  }
}

void TriangulationQuery::barycentric(const PointView& points, const std::uint32_t* cells,
                                     double* out, const RunOptions& options) const {
  const State& s = *state_;
  const Call call(options);
  const Run& run = call.run;
  s.check(points, run);
  run.each(points.count, queries_per_chunk, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<double> point(s.mesh.dimension), row(s.mesh.dimension);
    for (std::uint64_t i = begin; i < end; ++i) {
      load_row(points, i, point.data());
      for (unsigned j = 0; j < s.mesh.dimension; ++j) row[j] = point[s.mesh.columns[j]];
      s.barycentric_row(row.data(), cells[i], out + i * s.mesh.corners);
    }
  });
}

void TriangulationQuery::nearest(const PointView& points, std::uint32_t* out,
                                 const RunOptions& options) const {
  const State& s = *state_;
  s.answer(points, out, options, [&](const Run& run) {
    const NearestTree* const tree = s.tree_for(points.count, run);
    if (tree != nullptr && !tree->nearest(points, NearestTree::FarQueries::left_out, out, run))
      return;
    const Adjacency<std::uint32_t>& graph = s.graph(run);
    each_along_curve(s.mesh, points, run, [&] {
      return [&, walk = NearestVertex(s.mesh, graph)](std::uint64_t i, const double* row,
                                                      std::uint32_t key) mutable {
        if (tree == nullptr || out[i] == no_index) out[i] = walk.find(row, key);
      };
    });
  });
}

}  // namespace cullhull
