// Text as Qhull's `qconvex` prints it. Facets are in our order; orientation is Qhull's: det(v1 -
// v0, ..., x - v0) > 0 for x inside, so polygons in space are clockwise seen from outside.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "parallel/sort_few.hpp"

namespace cullhull::internal {
namespace {

/// "%6s ", as Qhull pads its numbers.
void append_padded(std::string& out, double v) {
  const std::size_t at = out.size();
  append_number(out, v);
  const std::size_t length = out.size() - at;
  if (length < 6) out.insert(at, 6 - length, ' ');
  out += ' ';
}

void append_line(std::string& out, std::uint64_t v) {
  append_number(out, v);
  out += '\n';
}

void append_point(std::string& out, const Coordinates& points, std::uint64_t id) {
  for (std::uint32_t j = 0; j < points.dimension; ++j) append_padded(out, points.at(id, j));
  out += '\n';
}

void append_ids(std::string& out, const std::vector<std::uint64_t>& ids) {
  for (const std::uint64_t id : ids) {
    append_number(out, id);
    out += ' ';
  }
  out += '\n';
}

/// One simplex of every facet.
std::vector<std::uint64_t> simplex_of_facet(const Hull& hull) {
  std::vector<std::uint64_t> of(hull.facet_count(), 0);
  for (std::uint64_t s = 0; s < hull.simplex_count(); ++s) of[hull.simplex_facets[s]] = s;
  return of;
}

/// Simplex s with its last two vertices swapped: our orientation is the reverse of Qhull's.
std::vector<std::uint64_t> qhull_simplex(const Hull& hull, std::uint64_t s) {
  const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
  std::vector<std::uint64_t> ids(hull.simplices.data() + s * k,
                                 hull.simplices.data() + (s + 1) * k);
  if (k >= 3) std::swap(ids[k - 1], ids[k - 2]);
  return ids;
}

std::vector<std::uint64_t> facet_vertices(const Hull& hull, std::uint64_t i) {
  return {hull.facets.items.data() + hull.facets.offsets[i],
          hull.facets.items.data() + hull.facets.offsets[i + 1]};
}

/// The vertices of a facet in Qhull's order: det(v1 - v0, ..., x - v0) > 0 for x inside.
/// `simplex`: one of its simplices.
std::vector<std::uint64_t> qhull_facet(const Hull& hull, std::uint64_t i, std::uint64_t simplex) {
  const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
  std::vector<std::uint64_t> ids = facet_vertices(hull, i);
  if (k == 3) std::reverse(ids.begin(), ids.end());
  if (k > 3 && ids.size() == k) return qhull_simplex(hull, simplex);
  return ids;
}

/// The average of the points with these ids, summed so that huge coordinates do not overflow.
std::vector<double> average_of(const Coordinates& points, const std::vector<std::uint64_t>& ids) {
  std::vector<double> average(points.dimension, 0);
  const auto n = static_cast<double>(ids.size());
  for (std::uint32_t j = 0; j < points.dimension; ++j)
    for (const std::uint64_t id : ids) average[j] += points.at(id, j) / n;
  return average;
}

/// The k-measure of the simplex of these k + 1 points: the product of the edges' components
/// orthogonal to those before (Gram-Schmidt, twice for slivers), over k!. Scaled by powers of two.
double simplex_measure(const Coordinates& points, const std::uint64_t* ids, std::size_t k) {
  const std::uint32_t d = points.dimension;
  std::vector<double> edges(k * d);
  double largest = 0;
  for (std::size_t i = 0; i < k; ++i)
    for (std::uint32_t j = 0; j < d; ++j) {
      edges[i * d + j] = points.at(ids[i + 1], j) / 2 - points.at(ids[0], j) / 2;
      largest = std::max(largest, std::fabs(edges[i * d + j]));
    }
  if (largest == 0) return k == 0 ? 1 : 0;
  const int exponent = std::ilogb(largest);
  for (double& e : edges) e = std::scalbn(e, -exponent);
  double product = 1;
  for (std::size_t i = 0; i < k; ++i) {
    double* const e = &edges[i * d];
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t b = 0; b < i; ++b) {
        const double* const unit = &edges[b * d];
        double dot = 0;
        for (std::uint32_t j = 0; j < d; ++j) dot += e[j] * unit[j];
        for (std::uint32_t j = 0; j < d; ++j) e[j] -= dot * unit[j];
      }
    double norm = 0;
    for (std::uint32_t j = 0; j < d; ++j) norm = std::hypot(norm, e[j]);
    if (norm == 0) return 0;
    for (std::uint32_t j = 0; j < d; ++j) e[j] /= norm;
    product *= norm / static_cast<double>(i + 1);
  }
  return std::scalbn(product, (exponent + 1) * static_cast<int>(k));
}

/// i: 2D and 3D facets whole; in higher dimensions facets that are no simplices are triangulated
/// (Qhull does so, too, around an added centre).
std::string incidences(const Hull& hull) {
  std::string out;
  if (hull.affine_dimension > 3) {
    append_line(out, hull.simplex_count());
    for (std::uint64_t s = 0; s < hull.simplex_count(); ++s)
      append_ids(out, qhull_simplex(hull, s));
  } else {
    append_line(out, hull.facet_count());
    for (std::uint64_t i = 0; i < hull.facet_count(); ++i) append_ids(out, qhull_facet(hull, i, 0));
  }
  return out;
}

void append_off_counts(std::string& out, std::uint32_t dimension, std::uint64_t points,
                       std::uint64_t facets, std::uint64_t ridges) {
  append_line(out, dimension);
  append_number(out, points);
  out += ' ';
  append_number(out, facets);
  out += ' ';
  append_line(out, ridges);
}

std::string off_like(const Coordinates& points, const Hull& hull) {
  std::string out;
  append_off_counts(out, hull.dimension, points.count, hull.facet_count(),
                    hull.facet_neighbours.items.size() / 2);
  for (std::uint64_t i = 0; i < points.count; ++i) append_point(out, points, i);
  const std::vector<std::uint64_t> simplices = simplex_of_facet(hull);
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    const auto ids = qhull_facet(hull, i, simplices[i]);
    append_number(out, std::uint64_t{ids.size()});
    out += ' ';
    append_ids(out, ids);
  }
  return out;
}

/// Ft: facets that are no simplices are divided into pyramids over their ridges, around an added
/// point: the average of the vertices. The ridges are those of our simplices between two facets.
std::string centred_triangulation(const Coordinates& points, const Hull& hull) {
  const auto k = static_cast<std::uint64_t>(std::max(hull.affine_dimension, 0));
  std::vector<std::uint64_t> centre(hull.facet_count(), 0);
  std::string centres, list;
  std::uint64_t added = 0, count = 0;
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    const auto ids = facet_vertices(hull, i);
    if (ids.size() == k) continue;
    centre[i] = points.count + added++;
    for (const double x : average_of(points, ids)) append_padded(centres, x);
    centres += '\n';
  }
  const auto append_simplex = [&](const std::vector<std::uint64_t>& ids) {
    append_number(list, k);
    list += ' ';
    append_ids(list, ids);
    ++count;
  };
  for (std::uint64_t s = 0; s < hull.simplex_count(); ++s) {
    const std::uint32_t facet = hull.simplex_facets[s];
    const std::vector<std::uint64_t> ids = qhull_simplex(hull, s);
    if (centre[facet] == 0) {
      append_simplex(ids);
      continue;
    }
    for (std::uint64_t j = 0; j < k; ++j) {
      if (hull.simplex_facets[hull.simplex_neighbours[s * k + j]] == facet) continue;
      std::vector<std::uint64_t> pyramid = ids;  // the centre replaces the opposite vertex
      std::replace(pyramid.begin(), pyramid.end(), hull.simplices[s * k + j], centre[facet]);
      append_simplex(pyramid);
    }
  }
  std::string out;
  append_off_counts(out, hull.dimension, points.count + added, count,
                    hull.facet_neighbours.items.size() / 2);
  for (std::uint64_t i = 0; i < points.count; ++i) append_point(out, points, i);
  return out += centres + list;
}

std::string normals(const Hull& hull) {
  std::string out;
  const std::uint64_t width = std::uint64_t{hull.dimension} + 1;
  append_line(out, width);
  append_line(out, hull.facet_count());
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    for (std::uint64_t j = 0; j < width; ++j) append_padded(out, hull.facet_planes[i * width + j]);
    out += '\n';
  }
  return out;
}

/// FD: the normals in cdd's H-representation: offset - normal . x >= 0.
std::string cdd_normals(const Hull& hull) {
  const std::uint64_t d = hull.dimension, width = d + 1;
  std::string out = "begin\n    ";
  append_number(out, hull.facet_count());
  out += ' ';
  append_number(out, width);
  out += " real\n";
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    append_padded(out, -hull.facet_planes[i * width + d]);
    for (std::uint64_t j = 0; j < d; ++j) append_padded(out, -hull.facet_planes[i * width + j]);
    out += '\n';
  }
  return out += "end\n";
}

std::string vertex_coordinates(const Coordinates& points, const Hull& hull) {
  std::string out;
  append_line(out, hull.dimension);
  append_line(out, hull.vertices.size());
  for (const std::uint64_t id : sorted(hull.vertices)) append_point(out, points, id);
  return out;
}

std::string average_vertex(const Coordinates& points, const Hull& hull) {
  std::string out;
  append_number(out, std::uint64_t{hull.dimension});
  out += " 1\n";
  for (const double x : average_of(points, sorted(hull.vertices))) append_padded(out, x);
  return out += '\n';
}

std::string extreme_ids(const Hull& hull) {
  std::string out;
  append_line(out, hull.vertices.size());
  for (const std::uint64_t id : hull.vertices) append_line(out, id);
  return out;
}

/// Lists with their lengths, one a line, after the number of lists: Fv, Fn, FN.
template <class List>
std::string counted_lists(std::uint64_t count, const List& list) {
  std::string out;
  append_line(out, count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto items = list(i);
    append_number(out, std::uint64_t{items.size()});
    for (const auto item : items) {
      out += ' ';
      append_number(out, std::uint64_t{item});
    }
    out += '\n';
  }
  return out;
}

std::string facets_of_points(const Coordinates& points, const Hull& hull) {
  std::vector<std::vector<std::uint64_t>> of(points.count);
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i)
    for (const std::uint64_t id : facet_vertices(hull, i)) of[id].push_back(i);
  return counted_lists(points.count, [&](std::uint64_t id) { return of[id]; });
}

std::vector<std::uint64_t> neighbours_of(const Hull& hull, std::uint64_t i) {
  const auto& lists = hull.facet_neighbours;
  return {lists.items.data() + lists.offsets[i], lists.items.data() + lists.offsets[i + 1]};
}

std::string facet_centres(const Coordinates& points, const Hull& hull) {
  std::string out;
  append_line(out, hull.dimension);
  append_line(out, hull.facet_count());
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    for (const double x : average_of(points, facet_vertices(hull, i))) append_padded(out, x);
    out += '\n';
  }
  return out;
}

/// The (k-1)-measure of each facet.
std::vector<double> facet_measures(const Coordinates& points, const Hull& hull) {
  const auto k = static_cast<std::uint64_t>(std::max(hull.affine_dimension, 1));
  std::vector<double> measures(hull.facet_count(), 0);
  for (std::uint64_t s = 0; s < hull.simplex_count(); ++s)
    measures[hull.simplex_facets[s]] +=
        simplex_measure(points, hull.simplices.data() + s * k, static_cast<std::size_t>(k - 1));
  return measures;
}

std::string facet_areas(const Coordinates& points, const Hull& hull) {
  std::string out;
  append_line(out, hull.facet_count());
  for (const double measure : facet_measures(points, hull)) {
    append_padded(out, measure);
    out += '\n';
  }
  return out;
}

std::string facet_numbers(const Hull& hull) {
  std::string out;
  append_line(out, hull.facet_count());
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) append_line(out, i);
  return out;
}

std::uint64_t non_simplicial(const Hull& hull) {
  std::uint64_t count = 0;
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i)
    if (hull.facets.offsets[i + 1] - hull.facets.offsets[i] !=
        static_cast<std::uint64_t>(hull.affine_dimension))
      ++count;
  return count;
}

/// Fs: ten integers (points near a facet, deleted vertices and facets: all 0 here), then the
/// greatest distances of a point above and below its plane: 0.
std::string counts_line(const Hull& hull) {
  const std::string v = std::to_string(hull.vertices.size()),
                    f = std::to_string(hull.facet_count());
  return "10 " + std::to_string(hull.dimension) + ' ' + std::to_string(hull.point_count) + ' ' + v +
         ' ' + f + ' ' + v + ' ' + f + " 0 " + std::to_string(non_simplicial(hull)) +
         " 0 0\n2      0      0 \n";
}

std::string area_and_volume(const Hull& hull) {
  std::string out = "0\n2 ";  // no integers, two reals
  append_padded(out, hull.area);
  append_padded(out, hull.volume);
  return out += '\n';
}

std::string summary(const Hull& hull, bool measures) {
  std::string out = "\nConvex hull of " + std::to_string(hull.point_count) + " points in " +
                    std::to_string(hull.dimension) +
                    "-d:\n\n  Number of vertices: " + std::to_string(hull.vertices.size()) +
                    "\n  Number of facets: " + std::to_string(hull.facet_count()) + '\n';
  if (const std::uint64_t count = non_simplicial(hull); count > 0)
    out += "  Number of non-simplicial facets: " + std::to_string(count) + '\n';
  if (!measures) return out += '\n';
  out += "  Total facet area: ";
  append_padded(out, hull.area);
  out += "\n  Total volume:     ";
  append_padded(out, hull.volume);
  return out += "\n\n";
}

/// f, and FF without the ridges: all data of every vertex and facet. Vertices are numbered in the
/// order of hull.vertices, facets in ours.
std::string dump(const Coordinates& points, const Hull& hull) {
  const std::uint64_t width = std::uint64_t{hull.dimension} + 1;
  std::string out = "Vertices and facets:\n";
  std::vector<std::uint64_t> number(points.count, 0);
  std::vector<std::string> facets_of(points.count);
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i)
    for (const std::uint64_t id : facet_vertices(hull, i))
      facets_of[id] += " f" + std::to_string(i);
  for (std::uint64_t v = 0; v < hull.vertices.size(); ++v) {
    const std::uint64_t id = hull.vertices[v];
    number[id] = v;
    out += "- p" + std::to_string(id) + "(v" + std::to_string(v) + "): ";
    append_point(out, points, id);
    out += "  neighbors:" + facets_of[id] + '\n';
  }
  const auto append_list =
      [&](const char* head, const std::vector<std::uint64_t>& items, char kind) {
    out += head;
    for (const std::uint64_t item : items) {
      out.append(" ").append(1, kind).append(std::to_string(item));
      if (kind == 'p') out += "(v" + std::to_string(number[item]) + ')';
    }
    out += '\n';
  };
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    const auto ids = facet_vertices(hull, i);
    out += "- f" + std::to_string(i) + "\n    - flags:";
    if (ids.size() == static_cast<std::uint64_t>(hull.affine_dimension)) out += " simplicial";
    out += "\n    - normal: ";
    for (std::uint32_t j = 0; j < hull.dimension; ++j)
      append_padded(out, hull.facet_planes[i * width + j]);
    out += "\n    - offset: ";
    append_padded(out, hull.facet_planes[i * width + width - 1]);
    out += "\n    - center: ";
    for (const double x : average_of(points, ids)) append_padded(out, x);
    append_list("\n    - vertices:", ids, 'p');
    append_list("    - neighboring facets:", neighbours_of(hull, i), 'f');
  }
  return out;
}

/// Why a word that only Qhull knows is refused; empty for other words.
std::string refused_word(std::string_view what) {
  if (what == "Fc" || what == "FP")
    return "lists points within Qhull's tolerance of a facet; ask HullQuery for those exactly on "
           "it";
  if (what == "Fm") return "counts facets merged for being nearly coplanar, which nothing here is";
  if (what == "FO" || what == "FQ") return "prints Qhull's own options";
  if (what == "Fp") return "prints intersections of halfspaces (intersect_halfspaces has them)";
  if (what == "G" || what == "m" || what == "FM")
    return "is for Geomview, Mathematica or Maple; -o writes .obj, .off, .ply, .stl or .json";
  if (what == "Fd") return "says that the input is cdd's, which is seen without it";
  return "";
}

}  // namespace

}  // namespace cullhull::internal

namespace cullhull {

const std::vector<std::string>& qhull_formats() {
  static const std::vector<std::string> words = {"Fx", "i",  "o",  "n",  "p",  "f",  "s",  "Fa",
                                                 "FA", "FC", "FD", "FF", "Fi", "FI", "Fn", "FN",
                                                 "Fo", "Fs", "FS", "Ft", "Fv", "FV"};
  return words;
}

void check_qhull_format(std::string_view what) {
  const auto& known = qhull_formats();
  if (std::find(known.begin(), known.end(), what) != known.end()) return;
  if (const std::string why = internal::refused_word(what); !why.empty())
    throw Error(ErrorCode::invalid_argument, "--format ", what, " ", why);
  std::string list;
  for (const std::string& word : known) list += " " + word;
  for (const std::string_view ending : {"geojson", "json", "obj", "off", "ply", "stl", "wkt"})
    if (what == ending) list += "; -o FILE." + std::string(ending) + " writes a file";
  throw Error(ErrorCode::invalid_argument, "unknown text format ", internal::quoted_text(what),
              "; expected", list);
}

namespace {

/// Whether the text lists every point, extreme or not.
bool lists_all_points(std::string_view what) {
  return what == "o" || what == "f" || what == "FF" || what == "Ft" || what == "FN";
}

std::string qhull_text(const internal::Coordinates& points, const Hull& hull,
                       std::string_view what) {
  using namespace internal;
  check_qhull_format(what);
  points.require_hull(hull);
  if (!points.complete() && lists_all_points(what))
    throw Error(ErrorCode::invalid_argument, "--format ", what,
                " lists every point, of which a stream keeps the extreme ones alone");
  if (what == "Fx") return extreme_ids(hull);
  if (what == "i") return incidences(hull);
  if (what == "o") return off_like(points, hull);
  if (what == "n" || what == "Fi" || what == "Fo") return normals(hull);
  if (what == "p") return vertex_coordinates(points, hull);
  if (what == "f" || what == "FF") return dump(points, hull);
  if (what == "s" || what == "FA") return summary(hull, what == "FA");
  if (what == "Fa") return facet_areas(points, hull);
  if (what == "FC") return facet_centres(points, hull);
  if (what == "FD") return cdd_normals(hull);
  if (what == "FI") return facet_numbers(hull);
  if (what == "Fs") return counts_line(hull);
  if (what == "FS") return area_and_volume(hull);
  if (what == "Ft") return centred_triangulation(points, hull);
  if (what == "FN") return facets_of_points(points, hull);
  if (what == "FV") return average_vertex(points, hull);
  const std::uint64_t count = hull.facet_count();
  if (what == "Fn") return counted_lists(count, [&](auto i) { return neighbours_of(hull, i); });
  return counted_lists(count, [&](auto i) { return facet_vertices(hull, i); });  // Fv
}

}  // namespace

std::string hull_to_qhull_text(const PointView& points, const Hull& hull, std::string_view what) {
  return qhull_text(points, hull, what);
}

std::string hull_to_qhull_text(const HullState& state, const Hull& hull, std::string_view what) {
  return qhull_text(state, hull, what);
}

}  // namespace cullhull
