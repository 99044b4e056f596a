// What SciPy's Delaunay has beside cells and neighbours: planes of lifted cells, maps to
// barycentric coordinates, lists by vertex. All is computed in doubles: it decides nothing about a
// triangulation.
#include <nanobind/stl/pair.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/error.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::Options;
using cullhull::PointView;
using cullhull::Triangulation;

namespace {

using Numbers = Array<std::int32_t>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The reciprocal condition number below which a map is NaN, as SciPy documents it.
constexpr double least_reciprocal_condition = 1000 * std::numeric_limits<double>::epsilon();

/// The points as packed doubles: in place where they are that already.
class Rows {
 public:
  explicit Rows(const PointView& points) : dimension_(points.dimension) {
    const auto row = static_cast<std::ptrdiff_t>(sizeof(double) * dimension_);
    const auto address = reinterpret_cast<std::uintptr_t>(points.data);
    if (address % alignof(double) == 0 && points.scalar == cullhull::ScalarType::f64 &&
        points.point_stride == row && points.coordinate_stride == sizeof(double)) {
      rows_ = reinterpret_cast<const double*>(points.data);
    } else {
      copies_ = rows_of_view(points);
      rows_ = copies_.data();
    }
  }
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;
  const double* operator[](std::size_t i) const { return rows_ + i * dimension_; }

 private:
  std::size_t dimension_;
  std::vector<double> copies_;
  const double* rows_;
};

/// The cells that are asked about: all of a triangulation, or rows of it.
struct Chosen {
  Chosen(const Cells& cells, Numbers& rows)
      : ids(reinterpret_cast<const std::uint32_t*>(rows.data())),
        corners(cells.triangulation().corners()),
        count(corners == 0 ? 0 : rows.size() / corners) {
    if (!rows.is_contiguous() || rows.size() != count * corners)
      throw nb::value_error("rows of cells are expected");
    const std::uint64_t points = cells.triangulation().point_count;
    if (std::any_of(ids, ids + rows.size(), [&](std::uint32_t id) { return id >= points; }))
      throw nb::index_error();
  }
  std::span<const std::uint32_t> operator[](std::size_t i) const {
    return {ids + i * corners, corners};
  }

  const std::uint32_t* ids;
  std::size_t corners, count;
};

/// Calls body(i) for each cell without the GIL; Ctrl-C is heard between blocks of cells.
template <class Body>
void each_cell(const Cells& cells, std::size_t count, const Body& body) {
  constexpr std::size_t block = 1 << 14;
  run(nullptr, length_of_cells(cells), [&](const Options& options) {
    for (std::size_t begin = 0; begin < count; begin += block) {
      if (options.poll) options.poll();
      if (options.stop.stop_requested())
        throw cullhull::Error(cullhull::ErrorCode::cancelled, "cancelled");
      for (std::size_t i = begin; i < std::min(count, begin + block); ++i) body(i);
    }
  });
}

/// Calls body(D, d): D is d where loops of that many steps are compiled, else 0.
template <class Body>
void with_dimension(unsigned d, const Body& body) {
  if (d == 2) return body(std::integral_constant<unsigned, 2>{}, d);
  if (d == 3) return body(std::integral_constant<unsigned, 3>{}, d);
  if (d == 4) return body(std::integral_constant<unsigned, 4>{}, d);
  body(std::integral_constant<unsigned, 0>{}, d);
}

/// d x `width` doubles.
template <unsigned D, unsigned Width>
struct Matrix {
  Matrix(unsigned, unsigned) {}
  std::array<double, D * Width> all;
};
template <unsigned Width>
struct Matrix<0, Width> {
  Matrix(unsigned d, unsigned width) : all(std::size_t{d} * width) {}
  std::vector<double> all;
};

/// Solves A X = B by elimination with row exchanges. `a`: d x d, `b`: d x width, both overwritten;
/// `x`: d x width. D and Width are d and width, or 0. False if A is singular in doubles. Rows are
/// exchanged by their numbers: a jump that half of the cells take costs as much as all the rest.
template <unsigned D, unsigned Width>
bool solve(unsigned dimension, unsigned columns, double* a, double* b, double* x) {
  const unsigned d = D == 0 ? dimension : D, width = Width == 0 ? columns : Width;
  Matrix<D, 1> inverses(d, 1);
  std::conditional_t<D == 0, std::vector<unsigned>, std::array<unsigned, D>> rows;
  if constexpr (D == 0) rows.resize(d);
  for (unsigned k = 0; k < d; ++k) rows[k] = k;
  for (unsigned k = 0; k < d; ++k) {
    unsigned pivot = k;
    double largest = std::fabs(a[rows[k] * d + k]);
    for (unsigned i = k + 1; i < d; ++i) {
      const double size = std::fabs(a[rows[i] * d + k]);
      pivot = size > largest ? i : pivot;
      largest = size > largest ? size : largest;
    }
    if (largest == 0) return false;
    std::swap(rows[k], rows[pivot]);
    const double* const up = a + rows[k] * d;
    inverses.all[k] = 1 / up[k];
    for (unsigned i = k + 1; i < d; ++i) {
      double* const row = a + rows[i] * d;
      const double factor = row[k] * inverses.all[k];
      for (unsigned j = k + 1; j < d; ++j) row[j] -= factor * up[j];
      for (unsigned j = 0; j < width; ++j)
        b[rows[i] * width + j] -= factor * b[rows[k] * width + j];
    }
  }
  for (unsigned k = d; k-- > 0;)
    for (unsigned j = 0; j < width; ++j) {
      double sum = b[rows[k] * width + j];
      for (unsigned i = k + 1; i < d; ++i) sum -= a[rows[k] * d + i] * x[i * width + j];
      x[k * width + j] = sum * inverses.all[k];
    }
  return true;
}

/// d - k normals of the flat that points in fewer dimensions k span: along each axis that is not
/// one of the triangulation's, minus what the flat has there. From the first cell that is not flat.
std::vector<double> normals_of_flat(const Triangulation& t, const Rows& points) {
  const unsigned d = t.dimension, k = t.corners() - 1;
  std::vector<unsigned> others;
  for (unsigned j = 0; j < d; ++j)
    if (std::find(t.axes.begin(), t.axes.end(), j) == t.axes.end()) others.push_back(j);
  const auto width = static_cast<unsigned>(others.size());
  std::vector<double> edges(std::size_t{k} * k), rises(std::size_t{k} * width), slopes(rises);
  bool found = false;
  for (std::uint64_t cell = 0; cell < t.size() && !found; ++cell) {
    const double* const first = points[t.cell(cell)[0]];
    for (unsigned i = 0; i < k; ++i) {
      const double* const corner = points[t.cell(cell)[i + 1]];
      for (unsigned j = 0; j < k; ++j) edges[i * k + j] = corner[t.axes[j]] - first[t.axes[j]];
      for (unsigned j = 0; j < width; ++j)
        rises[i * width + j] = corner[others[j]] - first[others[j]];
    }
    found = solve<0, 0>(k, width, edges.data(), rises.data(), slopes.data());
  }
  std::vector<double> normals(std::size_t{width} * d, 0.0);
  for (unsigned n = 0; n < width; ++n) {
    normals[std::size_t{n} * d + others[n]] = found ? 1 : not_a_number;
    for (unsigned j = 0; j < k; ++j)
      normals[std::size_t{n} * d + t.axes[j]] = -slopes[j * width + n];
  }
  return normals;
}

/// For each cell outward unit normal and offset of the cell lifted to scale * |x|^2 + shift, with
/// weights to |x|^2 - weight; not finite where it is flat in doubles. From the centre c of the
/// sphere through its corners and the power |c|^2 - r^2 of the origin: with weights, of the sphere
/// that has equal power from all corners. In a flat the sphere whose centre lies in it.
Array<double> lifted_planes(const Cells& cells, Numbers rows, double scale, double shift) {
  const Triangulation& t = cells.triangulation();
  const Chosen chosen(cells, rows);
  const Rows points(cells.points().view());
  const unsigned k = t.corners() == 0 ? 0 : t.corners() - 1;
  const double* const weights = cells.weights().empty() ? nullptr : cells.weights().data();
  const double side = t.furthest_site ? -1 : 1;
  Array<double> planes = Array<double>::make({chosen.count, std::size_t{t.dimension} + 2});
  std::vector<double> normals;
  if (k < t.dimension && chosen.count > 0) normals = normals_of_flat(t, points);
  double* const out = planes.data();
  with_dimension(t.dimension, [&](auto fixed, unsigned d) {
    each_cell(cells, chosen.count, [&](std::size_t cell) {
      Matrix<fixed(), fixed()> edges(d, d);
      Matrix<fixed(), 1> right(d, 1), away(d, 1);
      const std::span<const std::uint32_t> ids = chosen[cell];
      const double* const first = points[ids[0]];
      for (unsigned i = 0; i < k; ++i) {
        const double* const corner = points[ids[i + 1]];
        double square = 0;
        for (unsigned j = 0; j < d; ++j) {
          const double edge = corner[j] - first[j];
          edges.all[i * d + j] = edge;
          square += edge * edge;
        }
        if (weights != nullptr) square -= weights[ids[i + 1]] - weights[ids[0]];
        right.all[i] = 0.5 * square;
      }
      if (k < d) {
        std::copy(normals.begin(), normals.end(), edges.all.begin() + std::size_t{k} * d);
        std::fill(right.all.begin() + k, right.all.end(), 0.0);
      }
      double* const plane = out + cell * (d + 2);
      if (!solve<fixed(), 1>(d, 1, edges.all.data(), right.all.data(), away.all.data())) {
        std::fill_n(plane, d + 2, not_a_number);
        return;
      }
      // |first + away|^2 - |away|^2, in which |away|^2, large for a flat cell, cancels.
      double power = weights != nullptr ? weights[ids[0]] : 0, length = 1;
      for (unsigned j = 0; j < d; ++j) {
        power += first[j] * (first[j] + 2 * away.all[j]);
        plane[j] = 2 * scale * (first[j] + away.all[j]);
        length += plane[j] * plane[j];
      }
      plane[d] = -1;
      plane[d + 1] = shift - scale * power;
      const double factor = side / std::sqrt(length);
      for (unsigned j = 0; j < d + 2; ++j) plane[j] *= factor;
    });
  });
  return planes;
}

/// (cells, d + 1, d): [i, :d] @ (x - [i, d]) are the first d barycentric coordinates of x in cell
/// i; NaN where it is nearly flat.
Array<double> barycentric_maps(const Cells& cells, Numbers rows) {
  const Chosen chosen(cells, rows);
  const Rows points(cells.points().view());
  const std::size_t d = cells.triangulation().dimension;
  Array<double> maps = Array<double>::make({chosen.count, d + 1, d});
  double* const out = maps.data();
  with_dimension(static_cast<unsigned>(d), [&](auto fixed, unsigned dimension) {
    const unsigned n = fixed() == 0 ? dimension : fixed();
    each_cell(cells, chosen.count, [&](std::size_t cell) {
      Matrix<fixed(), fixed()> edges(n, n), units(n, n);
      double* const map = out + cell * (n + 1) * n;
      const std::span<const std::uint32_t> ids = chosen[cell];
      const double* const last = points[ids.back()];
      std::copy_n(last, n, map + n * n);
      std::fill(units.all.begin(), units.all.end(), 0.0);
      double norm = 0, norm_of_inverse = 0;
      if (ids.size() == n + 1) {
        for (unsigned i = 0; i < n; ++i) {
          double sum = 0;
          for (unsigned j = 0; j < n; ++j) {
            edges.all[j * n + i] = points[ids[i]][j] - last[j];
            sum += std::fabs(edges.all[j * n + i]);
          }
          norm = std::max(norm, sum);
          units.all[i * n + i] = 1;
        }
        if (solve<fixed(), fixed()>(n, n, edges.all.data(), units.all.data(), map))
          for (unsigned i = 0; i < n; ++i) {
            double sum = 0;
            for (unsigned j = 0; j < n; ++j) sum += std::fabs(map[j * n + i]);
            norm_of_inverse = std::max(norm_of_inverse, sum);
          }
      }
      if (!(1 / (norm * norm_of_inverse) >= least_reciprocal_condition) || norm_of_inverse == 0)
        std::fill_n(map, n * n, not_a_number);
    });
  });
  return maps;
}

/// Factor and summand of the heights of the paraboloid as Qhull's Qbb has them: between 0 and the
/// largest coordinate. `above`: a point at infinity is among them, a tenth above all others.
std::pair<double, double> paraboloid(const Cells& cells, bool above) {
  const PointView& view = cells.points().view();
  const Rows points(view);
  double least = std::numeric_limits<double>::infinity(), most = -least, largest = 0;
  for (std::uint64_t i = 0; i < view.count; ++i) {
    double height = 0;
    for (unsigned j = 0; j < view.dimension; ++j) {
      const double x = points[i][j];
      height += x * x;
      largest = std::max(largest, std::fabs(x));
    }
    least = std::min(least, height);
    most = std::max(most, height);
  }
  if (above) most *= 1.1;
  if (!(most > least)) return {1, 0};
  const double scale = largest / (most - least);
  return {scale, -least * scale};
}

/// The first cell of each vertex; of a point equal to another that one's; -1 without.
Numbers vertex_cells(const Cells& cells, Numbers rows) {
  const Triangulation& t = cells.triangulation();
  const Chosen chosen(cells, rows);
  Numbers all = Numbers::make({static_cast<std::size_t>(t.point_count)});
  std::int32_t* const of = all.data();
  std::fill_n(of, t.point_count, -1);
  for (std::size_t i = chosen.count; i-- > 0;)
    for (const std::uint32_t v : chosen[i]) of[v] = static_cast<std::int32_t>(i);
  for (const cullhull::DuplicatePoint& p : t.duplicates) of[p.id] = of[p.representative];
  return all;
}

/// Each vertex's neighbours, ascending: offsets and items.
std::pair<Numbers, Numbers> vertex_neighbours(const Cells& cells, Numbers rows) {
  const Chosen chosen(cells, rows);
  const std::size_t n = cells.triangulation().point_count, size = chosen.count * chosen.corners;
  // The cells of each vertex, from which its neighbours come in any order. As they are each
  // other's, lists that get them from one vertex after the other ascend.
  std::vector<std::uint32_t> begin(n + 2, 0), cells_of(size), seen(n, cullhull::no_index), found;
  std::vector<std::int32_t> ends(n + 1, 0);
  run(nullptr, length_of_cells(cells), [&](const Options&) {
    for (std::size_t i = 0; i < size; ++i) ++begin[chosen.ids[i] + 2];
    for (std::size_t v = 2; v < n + 2; ++v) begin[v] += begin[v - 1];
    for (std::size_t i = 0; i < chosen.count; ++i)
      for (const std::uint32_t v : chosen[i])
        cells_of[begin[v + 1]++] = static_cast<std::uint32_t>(i);
    found.reserve(size * 2);
    for (std::uint32_t v = 0; v < n; ++v) {
      for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i)
        for (const std::uint32_t w : chosen[cells_of[i]])
          if (w != v && seen[w] != v) {
            seen[w] = v;
            found.push_back(w);
          }
      ends[v + 1] = static_cast<std::int32_t>(found.size());
    }
  });
  check_numbers(found.size());
  std::pair<Numbers, Numbers> lists{Numbers::make({n + 1}), Numbers::make({found.size()})};
  std::int32_t *const offsets = lists.first.data(), *const items = lists.second.data();
  std::copy(ends.begin(), ends.end(), offsets);
  std::copy(ends.begin(), ends.end() - 1, seen.begin());
  for (std::uint32_t v = 0; v < n; ++v)
    for (std::int32_t i = offsets[v]; i < offsets[v + 1]; ++i)
      items[seen[found[static_cast<std::size_t>(i)]]++] = static_cast<std::int32_t>(v);
  return lists;
}

/// Rows of each point that equals a vertex: the point, the first cell of that vertex, the vertex.
Numbers equal_points(const Cells& cells, Numbers rows) {
  const Triangulation& t = cells.triangulation();
  if (t.duplicates.empty()) return Numbers::make({0, 3});
  Numbers first = vertex_cells(cells, std::move(rows));
  const std::int32_t* const of = first.data();
  const auto count = static_cast<std::size_t>(
      std::count_if(t.duplicates.begin(), t.duplicates.end(),
                    [&](const cullhull::DuplicatePoint& p) { return of[p.representative] >= 0; }));
  Numbers all = Numbers::make({count, 3});
  std::int32_t* row = all.data();
  for (const cullhull::DuplicatePoint& p : t.duplicates) {
    if (of[p.representative] < 0) continue;
    *row++ = static_cast<std::int32_t>(p.id);
    *row++ = of[p.representative];
    *row++ = static_cast<std::int32_t>(p.representative);
  }
  return all;
}

/// The least and the largest coordinates of points, as two rows.
Array<double> bounds(nb::handle array) {
  const Points points(array);
  const PointView& view = points.view();
  const std::size_t d = view.dimension;
  if (view.count == 0) throw nb::value_error("no points have no bounds");
  Array<double> rows = Array<double>::make({2, d});
  double* const out = rows.data();
  const Rows of(view);
  std::copy_n(of[0], d, out);
  std::copy_n(of[0], d, out + d);
  for (std::uint64_t i = 1; i < view.count; ++i)
    for (std::size_t j = 0; j < d; ++j) {
      out[j] = std::min(out[j], of[i][j]);
      out[d + j] = std::max(out[d + j], of[i][j]);
    }
  return rows;
}

}  // namespace

void bind_lifted(nb::module_& m, nb::class_<Cells>& c) {
  const auto rows = nb::arg("rows");
  c.def("lifted_planes", lifted_planes, rows, nb::arg("scale"), nb::arg("shift"))
      .def("barycentric_maps", barycentric_maps, rows)
      .def("paraboloid", paraboloid, nb::arg("above"))
      .def("vertex_cells", vertex_cells, rows)
      .def("vertex_neighbours", vertex_neighbours, rows)
      .def("equal_points", equal_points, rows);
  m.def("bounds", bounds, nb::arg("points"));
}

}  // namespace binding
