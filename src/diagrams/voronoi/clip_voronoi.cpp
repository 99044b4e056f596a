// clip_voronoi(): clips each cell to each convex piece of the region, and adds up the parts.
#include <algorithm>
#include <cmath>
#include <deque>
#include <unordered_set>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/voronoi.hpp"
#include "diagrams/dual.hpp"
#include "diagrams/locate/power_sign.hpp"
#include "diagrams/memory_needs.hpp"
#include "diagrams/voronoi/cell_chain.hpp"
#include "diagrams/voronoi/clip_corners.hpp"
#include "diagrams/voronoi/clip_region.hpp"
#include "diagrams/voronoi/clip_rings.hpp"
#include "diagrams/voronoi/clip_shapes.hpp"
#include "diagrams/voronoi/whole_cells.hpp"
#include "exact/numbers/rationals.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/memory/pages.hpp"

namespace cullhull::internal {
namespace {

void check_dimension(const Triangulation& t) {
  if (t.dimension == 0 || t.dimension > 3)
    refuse("cells are clipped in dimensions 1 to 3, not in ", t.dimension);
}

void check_box(const Triangulation& t, std::span<const double> low, std::span<const double> high) {
  const unsigned d = t.dimension;
  if (low.size() != d || high.size() != d)
    refuse("a box in dimension ", d, " needs as many numbers for each corner");
  for (unsigned j = 0; j < d; ++j)
    if (!(low[j] < high[j]) || !std::isfinite(low[j]) || !std::isfinite(high[j]))
      refuse("the box is empty or not finite along axis ", j);
}

// ---------------------------------------------------------------------------- measures

/// Length, area or volume, times the factorial of the dimension. The two lists give indices into
/// `at`: in 2D the vertices counterclockwise, in 3D the faces.
template <class Real>
Real multiple_of_measure(const std::vector<std::array<Real, 1>>& at,
                         const std::vector<std::uint32_t>&, const std::vector<std::uint32_t>&) {
  return at[1][0] - at[0][0];
}
template <class Real>
Real multiple_of_measure(const std::vector<std::array<Real, 2>>& at,
                         const std::vector<std::uint32_t>&, const std::vector<std::uint32_t>&) {
  Real sum(0.0);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto &a = at[i], &b = at[i + 1 < at.size() ? i + 1 : 0];
    sum = sum + (a[0] * b[1] - a[1] * b[0]);
  }
  return sum;
}
/// The sum over the faces of twice the area vector times the first vertex.
template <class Real>
Real multiple_of_measure(const std::vector<std::array<Real, 3>>& at,
                         const std::vector<std::uint32_t>& starts,
                         const std::vector<std::uint32_t>& items) {
  Real sum(0.0);
  for (std::size_t f = 0; f + 1 < starts.size(); ++f) {
    const auto& o = at[items[starts[f]]];
    std::array<Real, 3> area{Real(0.0), Real(0.0), Real(0.0)}, a, b;
    for (std::uint32_t i = starts[f] + 1; i < starts[f + 1]; ++i) {
      for (unsigned j = 0; j < 3; ++j) b[j] = at[items[i]][j] - o[j];
      for (unsigned j = 0; j < 3 && i > starts[f] + 1; ++j) {
        const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
        area[j] = area[j] + (a[k] * b[l] - a[l] * b[k]);
      }
      a = b;
    }
    for (unsigned j = 0; j < 3; ++j) sum = sum + area[j] * o[j];
  }
  return sum;
}

/// Greatest relative error of a measure; documented for ClippedCells.
constexpr double measure_error = 0x1p-42;

constexpr double factorial_of(unsigned d) { return d == 3 ? 6 : d; }

/// The double nearest to a sum of measures: from double-doubles if their bound proves it, else from
/// rationals, which `exactly` computes.
template <unsigned D, class Exactly>
double rounded_measure(const BoundedDoubleDouble& multiple, const Exactly& exactly) {
  double out;
  if (rounds_alike(multiple / BoundedDoubleDouble(factorial_of(D)), out)) return out;
  return nearest_double(mpq_class(exactly() / mpq_class(factorial_of(D))));
}

// ---------------------------------------------------------------------------- one cell

/// Clips one cell to pieces of the region.
template <unsigned D>
class CellClipper {
 public:
  CellClipper(const DiagramCells& cells, const Triangulation& t, const Region<D>& region)
      : cells_(cells), t_(t), region_(region) {}

  void start(std::uint32_t site) {
    site_ = site;
    bounded_ = whole_.start(cells_, site);
    corners_started_ = false;
  }

  /// Whether the cell is bounded and certainly inside the piece.
  bool whole_within(std::uint32_t piece) const {
    if (!bounded_) return false;
    return std::all_of(whole_.vertices.begin(), whole_.vertices.end(), [&](std::uint32_t v) {
      return region_[piece].surely_inside(cells_.vertex(v));
    });
  }

  /// Clips the cell to a piece.
  const ClipShape<D>& clip(std::uint32_t piece) {
    start_corners();
    shape_.start(region_[piece], corners_);
    for (const std::uint32_t plane : nearest_first_) {
      shape_.cut(corners_, plane);
      if (shape_.empty()) break;
    }
    return shape_;
  }

  /// The exact side of x relative to the bisector between the site and a neighbour: negative on the
  /// site's side, positive on the neighbour's. `x`: in the coordinates of the points.
  Sign side_of(const double* x, std::uint32_t neighbour) const {
    const DualPoints& points = cells_.points();
    const Sign side = power_sign(D, points.weighted(), x, points.row(site_), points.row(neighbour));
    return t_.furthest_site ? -side : side;
  }

  /// The cell's measure, in doubles if their bound allows it; it fails only for slivers.
  double whole_measure() {
    const BoundedDouble measure = whole_multiple(places_) / BoundedDouble(factorial_of(D));
    if (measure.error <= measure_error * measure.value) return measure.value;
    std::vector<TrackedPoint<D>> near;
    return rounded_measure<D>(whole_multiple(near), [&] {
      std::vector<ExactPoint<D>> exact;
      return whole_multiple(exact);
    });
  }

  /// The shape's part of the sum for the cell's measure.
  BoundedDoubleDouble multiple(const ClipShape<D>& shape) const {
    std::vector<TrackedPoint<D>> at;
    for (const std::uint32_t v : shape.vertices) at.push_back(corners_.at(v));
    return multiple_of(shape, at);
  }
  mpq_class exact_multiple(const ClipShape<D>& shape) {
    std::vector<ExactPoint<D>> at;
    for (const std::uint32_t v : shape.vertices) at.push_back(corners_.exact(v));
    return multiple_of(shape, at);
  }

  CellCorners<D>& corners() { return corners_; }
  const WholeCell<D>& whole() const { return whole_; }

 private:
  /// Sorts the planes: if near planes cut first, the others have little left to cut.
  void start_corners() {
    if (corners_started_) return;
    corners_started_ = true;
    const DualPoints& points = cells_.points();
    corners_.start(points.row(site_), points.weighted(), t_.furthest_site);
    order_.clear();
    for (const auto& item : cells_.of(site_)) {
      const std::uint32_t plane = corners_.add_bisector(points.row(item.other), item.other);
      const auto& h = corners_.halfspace(plane);
      double largest = 0;
      for (const BoundedDoubleDouble& n : h.normal)
        largest = std::max(largest, std::abs(n.value.high));
      const double distance = h.offset.value.high / largest;
      order_.emplace_back(std::isnan(distance) ? INFINITY : distance, plane);
    }
    std::sort(order_.begin(), order_.end());
    nearest_first_.clear();
    for (const auto& [distance, plane] : order_) nearest_first_.push_back(plane);
  }

  template <class Real>
  Real whole_multiple(std::vector<std::array<Real, D>>& at) const {
    whole_.place(cells_, site_, at);
    return multiple_of_measure(at, whole_.starts, whole_.items);
  }

  template <class Point>
  static auto multiple_of(const ClipShape<D>& shape, const std::vector<Point>& at) {
    if constexpr (D == 3)
      return multiple_of_measure(at, shape.starts, shape.items);
    else
      return multiple_of_measure(at, {}, {});
  }

  const DiagramCells& cells_;
  const Triangulation& t_;
  const Region<D>& region_;
  std::uint32_t site_ = 0;
  bool bounded_ = false, corners_started_ = false;
  WholeCell<D> whole_;
  std::vector<std::array<BoundedDouble, D>> places_;
  CellCorners<D> corners_;
  std::vector<std::pair<double, std::uint32_t>> order_;
  std::vector<std::uint32_t> nearest_first_;
  ClipShape<D> shape_;
};

// ---------------------------------------------------------------------------- which pieces

/// For each cell the pieces of the region whose intersection with it has positive measure,
/// ascending.
class PiecesOfCells {
 public:
  /// For one piece, which every cell may intersect.
  PiecesOfCells() = default;

  PiecesOfCells(const DiagramCells& cells, const Triangulation& t, const Region<2>& region,
                const Run& run) {
    const std::vector<std::uint32_t> starts = sites_at_corners(cells, t, region, run);
    constexpr std::uint64_t grain = 64;
    std::vector<std::vector<Pair>> parts(chunk_count(region.size(), grain));
    run.each_chunk(region.size(), grain,
                   [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      CellClipper<2> clipper(cells, t, region);
      for (std::uint64_t piece = begin; piece < end; ++piece)
        spread(cells, region, static_cast<std::uint32_t>(piece), starts[piece], clipper,
               parts[chunk], run);
    });
    pieces_ = Adjacency<std::uint32_t>(t.point_count, [&](const auto& add) {
      for (const auto& part : parts)
        for (const Pair& pair : part) add(pair.site, pair.piece);
    });
  }

  std::span<const std::uint32_t> of(std::uint32_t site) const {
    static constexpr std::uint32_t only = 0;
    if (pieces_.empty()) return {&only, 1};
    return pieces_[site];
  }

 private:
  struct Pair {
    std::uint32_t site, piece;
  };

  /// For each piece a site whose cell contains the piece's first corner. Walks from the previous
  /// piece's site across bisectors; the distance falls with every step.
  static std::vector<std::uint32_t> sites_at_corners(const DiagramCells& cells,
                                                     const Triangulation& t,
                                                     const Region<2>& region, const Run& run) {
    CellClipper<2> clipper(cells, t, region);
    std::vector<std::uint32_t> starts;
    std::uint32_t site = cells.some_site();
    for (const RegionPiece<2>& piece : region) {
      run.check();
      for (bool moved = true; moved;) {
        clipper.start(site);
        moved = false;
        for (const auto& item : cells.of(site)) {
          if (clipper.side_of(piece.corners[0].data(), item.other) != Sign::positive) continue;
          site = item.other;
          moved = true;
          break;
        }
      }
      starts.push_back(site);
    }
    return starts;
  }

  /// Finds the cells that meet a piece: from the cells at its first corner across those edges of
  /// cells that are within the piece.
  static void spread(const DiagramCells& cells, const Region<2>& region, std::uint32_t piece,
                     std::uint32_t start, CellClipper<2>& clipper, std::vector<Pair>& out,
                     const Run& run) {
    std::unordered_set<std::uint32_t> seen{start};
    std::deque<std::pair<std::uint32_t, bool>> waiting{{start, true}};
    const auto add = [&](std::uint32_t site, bool at_corner) {
      if (seen.insert(site).second) waiting.emplace_back(site, at_corner);
    };
    for (; !waiting.empty(); waiting.pop_front()) {
      const auto [site, at_corner] = waiting.front();
      if (out.size() % 1024 == 0) run.check();
      clipper.start(site);
      if (at_corner)
        for (const auto& item : cells.of(site))
          if (clipper.side_of(region[piece].corners[0].data(), item.other) == Sign::zero)
            add(item.other, true);
      if (clipper.whole_within(piece)) {
        out.push_back({site, piece});
        for (const auto& item : cells.of(site)) add(item.other, false);
        continue;
      }
      const ClipShape<2>& shape = clipper.clip(piece);
      if (shape.empty()) continue;
      out.push_back({site, piece});
      for (const std::uint32_t plane : shape.planes)
        if (const std::uint32_t next = clipper.corners().site_across(plane); next != no_index)
          add(next, false);
    }
  }

  Adjacency<std::uint32_t> pieces_;  ///< by site; empty: one piece only
};

// ---------------------------------------------------------------------------- all cells

/// Result of a chunk of points, without measures.
struct Part {
  ClippedCells cells;
  std::vector<std::uint32_t> unsound;  ///< 2D: cells whose polygons rounding has made invalid
};

/// Writes clipped cells; converts numbers of planes and sites to those of the result.
template <unsigned D>
class CellWriter {
 public:
  CellWriter(const DiagramCells& cells, const Triangulation& t, const Region<D>& region,
             const PiecesOfCells& pieces, bool shapes, Part& part)
      : cells_(cells),
        clipper_(cells, t, region),
        pieces_(pieces),
        shapes_(shapes),
        out_(part.cells),
        unsound_(part.unsound) {
    out_.dimension = D;
    begin_lists(out_);
  }

  /// Appends the site's cell; returns its measure.
  double write(std::uint32_t site) {
    polygons_.clear();
    double measure = 0;
    if (cells_.is_site(site)) {
      clipper_.start(site);
      const auto pieces = pieces_.of(site);
      measure = pieces.size() == 1 && clipper_.whole_within(pieces[0]) ? write_whole()
                                                                       : write_clipped(pieces);
    }
    if (!shapes_) return measure;
    if (D == 2) {
      add_polygons(polygons_, out_);
      if (!sound(polygons_)) unsound_.push_back(site);
    } else {
      out_.vertex_offsets.push_back(out_.vertices.size() / D);
      if (D == 3) out_.face_offsets.push_back(out_.faces.size());
    }
    return measure;
  }

 private:
  double write_whole() {
    if (shapes_) add_whole();
    return clipper_.whole_measure();
  }
  void add_whole() {
    const WholeCell<D>& whole = clipper_.whole();
    if constexpr (D == 2) {
      CellRing ring{{}, whole.across};
      for (const std::uint32_t v : whole.vertices)
        ring.points.push_back({no_minus(cells_.vertex(v)[0]), no_minus(cells_.vertex(v)[1])});
      if (tidy(ring)) polygons_.push_back({std::move(ring)});
    } else {
      for (const std::uint32_t v : whole.vertices)
        for (unsigned j = 0; j < D; ++j) out_.vertices.push_back(no_minus(cells_.vertex(v)[j]));
      add_faces(whole.starts, whole.items, whole.across);
    }
  }

  double write_clipped(std::span<const std::uint32_t> pieces) {
    BoundedDoubleDouble sum;
    std::vector<CellPiece> parts;
    for (const std::uint32_t piece : pieces) {
      const ClipShape<D>& shape = clipper_.clip(piece);
      if (shape.empty()) continue;
      sum = sum + clipper_.multiple(shape);
      if constexpr (D == 2)
        parts.push_back({piece, shape.vertices, shape.planes});
      else if (shapes_)
        add_shape(shape);
    }
    if constexpr (D == 2)
      if (shapes_) polygons_ = join_pieces(clipper_.corners(), parts);
    return rounded_measure<D>(sum, [&] {
      mpq_class exact = 0;
      for (const std::uint32_t piece : pieces) {
        const ClipShape<D>& shape = clipper_.clip(piece);
        if (!shape.empty()) exact += clipper_.exact_multiple(shape);
      }
      return exact;
    });
  }

  void add_shape(const ClipShape<D>& shape) {
    CellCorners<D>& corners = clipper_.corners();
    for (const std::uint32_t v : shape.vertices) {
      double x[D];
      corners.round(v, x);
      out_.vertices.insert(out_.vertices.end(), x, x + D);
    }
    across_.clear();
    for (const std::uint32_t plane : shape.planes) across_.push_back(corners.site_across(plane));
    if constexpr (D == 3)
      add_faces(shape.starts, shape.items, across_);
    else
      add_faces({}, {}, across_);
  }
  void add_faces(const std::vector<std::uint32_t>& starts, const std::vector<std::uint32_t>& items,
                 const std::vector<std::uint32_t>& across) {
    out_.neighbours.insert(out_.neighbours.end(), across.begin(), across.end());
    out_.faces.items.insert(out_.faces.items.end(), items.begin(), items.end());
    for (std::size_t f = 0; f + 1 < starts.size(); ++f)
      out_.faces.offsets.push_back(out_.faces.offsets.back() + starts[f + 1] - starts[f]);
  }

  static double no_minus(double x) { return x == 0 ? 0 : x; }

  const DiagramCells& cells_;
  CellClipper<D> clipper_;
  const PiecesOfCells& pieces_;
  bool shapes_;
  ClippedCells& out_;
  std::vector<std::uint32_t>& unsound_;
  std::vector<CellPolygon> polygons_;
  std::vector<std::uint32_t> across_;
};

template <class T>
void append(Array<T>& to, const Array<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}
/// Both begin with 0, or are empty.
template <class Offsets>
void append_offsets(Offsets& to, const Offsets& from) {
  const std::uint64_t before = to.empty() ? 0 : to.back();
  for (std::size_t i = 1; i < from.size(); ++i) to.push_back(before + from[i]);
}

void join(std::vector<Part>& parts, ClippedCells& out) {
  begin_lists(out);
  for (Part& part : parts) {
    append(out.vertices, part.cells.vertices);
    append(out.faces.items, part.cells.faces.items);
    append(out.neighbours, part.cells.neighbours);
    append_offsets(out.vertex_offsets, part.cells.vertex_offsets);
    append_offsets(out.face_offsets, part.cells.face_offsets);
    append_offsets(out.faces.offsets, part.cells.faces.offsets);
    append_offsets(out.polygon_offsets, part.cells.polygon_offsets);
    append_offsets(out.polygon_rings, part.cells.polygon_rings);
    append_offsets(out.ring_starts, part.cells.ring_starts);
    part = {};
  }
}

template <unsigned D>
PiecesOfCells pieces_of(const DiagramCells& cells, const Triangulation& t, const Region<D>& region,
                        const Run& run) {
  if constexpr (D == 2)
    if (region.size() > 1 && !t.cells.empty()) return {cells, t, region, run};
  return {};
}

template <unsigned D>
ClippedCells clip(const PointView& points, const Triangulation& t, const Region<D>& region,
                  std::span<const double> weights, const ClipOptions& options, const Run& run) {
  const bool shapes = options.shapes;
  const Voronoi* const diagram = options.diagram;
  begin_step(run, clip_bytes(t.point_count, t.size(), D, shapes, diagram != nullptr),
             "the clipped cells of the diagram");
  ClippedCells out;
  out.dimension = t.dimension;
  out.point_count = t.point_count;
  out.measures.resize(t.point_count);
  const DualPoints rows(points, t, weights, run);
  const DiagramCells cells(rows, t, diagram, run);
  const PiecesOfCells pieces = pieces_of<D>(cells, t, region, run);
  constexpr std::uint64_t grain = 512;  // cells; a few hundred microseconds of clipping
  std::vector<Part> parts(chunk_count(t.point_count, grain));
  run.each_chunk(t.point_count, grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    CellWriter<D> writer(cells, t, region, pieces, shapes, parts[chunk]);
    for (std::uint64_t v = begin; v < end; ++v)
      out.measures[v] = writer.write(static_cast<std::uint32_t>(v));
  });
  if (shapes) {
    std::vector<std::uint32_t> unsound;
    for (const Part& part : parts)
      unsound.insert(unsound.end(), part.unsound.begin(), part.unsound.end());
    join(parts, out);
    if (!unsound.empty()) mend_cells(unsound, out, run);
  }
  run.report("done", 1);
  return out;
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

ClippedCells clip_voronoi(const PointView& points, const Triangulation& t,
                          std::span<const double> low, std::span<const double> high,
                          std::span<const double> weights, const ClipOptions& options) {
  using namespace internal;
  const Call call(options);
  check_dimension(t);
  check_box(t, low, high);
  return with_dimension<1, 2, 3>(t.dimension, [&](auto d) {
    return clip<d()>(points, t, box_region<d()>(low, high), weights, options, call.run);
  });
}

ClippedCells clip_voronoi(const PointView& points, const Triangulation& t, const PointView& region,
                          std::span<const double> weights, const ClipOptions& options) {
  using namespace internal;
  check_dimension(t);
  if (region.dimension != t.dimension)
    refuse("a region in dimension ", region.dimension, " for a diagram in dimension ", t.dimension);
  if (t.dimension == 2) {
    const std::uint64_t one[2] = {0, region.count};
    return clip_voronoi(points, t, region, one, weights, options);
  }
  const Call call(options);
  const Run& run = call.run;
  return t.dimension == 1 ? clip<1>(points, t, hull_region<1>(region, run), weights, options, run)
                          : clip<3>(points, t, hull_region<3>(region, run), weights, options, run);
}

ClippedCells clip_voronoi(const PointView& points, const Triangulation& t, const PointView& corners,
                          std::span<const std::uint64_t> ring_offsets,
                          std::span<const double> weights, const ClipOptions& options) {
  using namespace internal;
  const Call call(options);
  if (t.dimension != 2) refuse("a polygon for a diagram in dimension ", t.dimension);
  return clip<2>(points, t, polygon_region(corners, ring_offsets, call.run), weights, options,
                 call.run);
}

}  // namespace cullhull
