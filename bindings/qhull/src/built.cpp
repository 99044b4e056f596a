#include "built.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <thread>
#include <unordered_map>

#include "cullhull/voronoi.hpp"

namespace cullhull::qhull {
namespace {

/// Makes the first d columns of d rows of `width` numbers diagonal, by row pivots, as far as no
/// pivot is zero. Returns the magnitude of their determinant.
double eliminate(std::vector<double>& rows, unsigned d, unsigned width) {
  double product = 1;
  for (unsigned k = 0; k < d; ++k) {
    unsigned pivot = k;
    for (unsigned i = k + 1; i < d; ++i)
      if (std::abs(rows[i * width + k]) > std::abs(rows[pivot * width + k])) pivot = i;
    double* const row = &rows[k * width];
    if (pivot != k) std::swap_ranges(row, row + width, &rows[pivot * width]);
    product *= row[k];
    for (unsigned i = 0; i < d; ++i) {
      if (i == k || row[k] == 0) continue;
      const double f = rows[i * width + k] / row[k];
      for (unsigned j = k; j < width; ++j) rows[i * width + j] -= f * row[j];
    }
  }
  return std::abs(product);
}

/// Calls body(begin, end) for parts of [0, count), on all cores where they are many. Throws what it
/// throws, once all have ended.
template <class Body>
void each_part(std::size_t count, const Body& body) {
  const std::size_t cores = std::clamp(std::thread::hardware_concurrency(), 1U, 64U);
  const std::size_t parts = count < (std::size_t{1} << 15) ? 1 : cores;
  std::vector<std::exception_ptr> faults(parts);
  const auto part = [&](std::size_t k) noexcept {
    try {
      body(count * k / parts, count * (k + 1) / parts);
    } catch (...) {
      faults[k] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < parts; ++k) others.emplace_back(part, k);
    part(0);
  }
  for (const std::exception_ptr& fault : faults)
    if (fault) std::rethrow_exception(fault);
}

bool has(const setT* set, const void* item) {
  for (int i = 0; i < set->maxsize; ++i)
    if (set->e[i].p == item) return true;
  return false;
}

std::size_t place_of(const setT* set, const void* item) {
  std::size_t i = 0;
  while (set->e[i].p != item) ++i;
  return i;
}

void keep_once(std::vector<std::uint32_t>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

double factorial(unsigned n) {
  double product = 1;
  for (unsigned i = 2; i <= n; ++i) product *= i;
  return product;
}

}  // namespace

Built::Built(qhT* qh, const Command& command, unsigned dimension, std::uint64_t count,
             const double* points)
    : command_(command), dimension_(dimension), points_(points), count_(count) {
  const PointView view = PointView::row_major(points, count, dimension);
  if (command.delaunay) {
    TriangulationOptions options;
    options.furthest_site = command.furthest_site;
    cells_ = cullhull::delaunay(view, options);
    if (cells_.affine_dimension < static_cast<int>(dimension))
      throw Error(ErrorCode::not_exact, "the points span ", cells_.affine_dimension,
                  " dimensions of ", dimension);
    // Clients number points by their places in rows of one coordinate more.
    const unsigned d = dimension + 1;
    lifted_ = arena_.make<double>(count * d);
    for (std::uint64_t i = 0; i < count; ++i) {
      double square = 0;
      for (unsigned j = 0; j < dimension; ++j) {
        const double x = points[i * dimension + j];
        lifted_[i * d + j] = x;
        square += x * x;
      }
      lifted_[i * d + dimension] = square;
    }
    qh->first_point = lifted_;
    list_cells(qh, command.triangulated);
  } else {
    hull_ = convex_hull(view);
    if (hull_.affine_dimension < static_cast<int>(dimension))
      throw Error(ErrorCode::not_exact, "the points span ", hull_.affine_dimension,
                  " dimensions of ", dimension);
    qh->interior_point = arena_.make<double>(dimension);
    std::copy(hull_.centroid.begin(), hull_.centroid.end(), qh->interior_point);
    list_hull(qh, command.triangulated);
  }
}

void Built::make_vertices(qhT* qh, std::span<const std::uint64_t> ids) {
  auto* const all = arena_.make<vertexT>(ids.size() + 1);
  vertex_of_.assign(count_, nullptr);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    vertexT& v = all[i];
    v.id = static_cast<unsigned>(i + 1);
    v.point = qh->first_point + ids[i] * static_cast<std::uint64_t>(qh->hull_dim);
    v.next = &all[i + 1];
    all[i + 1].previous = &v;
    vertex_of_[ids[i]] = &v;
  }
  qh->vertex_list = qh->newvertex_list = all;
  qh->vertex_tail = all + ids.size();
  qh->num_vertices = static_cast<int>(ids.size());
  qh->vertex_id = static_cast<unsigned>(ids.size() + 1);
}

/// Lists the facets; the first `good` of them are.
void Built::make_facets(qhT* qh, std::size_t count, std::size_t good) {
  lower_ = good;
  facets_ = arena_.make<facetT>(count + 1);
  each_part(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      facetT& f = facets_[i];
      f.id = static_cast<unsigned>(i + 1);
      f.good = i < good;
      f.simplicial = f.toporient = 1;
      f.previous = i == 0 ? nullptr : &facets_[i - 1];
      f.next = &facets_[i + 1];
    }
  });
  facets_[count].previous = count == 0 ? nullptr : &facets_[count - 1];
  qh->facet_list = facets_;
  qh->facet_tail = qh->facet_next = qh->newfacet_list = qh->visible_list = facets_ + count;
  qh->num_facets = static_cast<int>(count);
  qh->num_good = static_cast<int>(good);
  qh->facet_id = static_cast<unsigned>(count + 1);
}

/// Fills a set in Qhull's order, descending by number, as ids do. Whether that is an odd
/// permutation of `ids`.
template <class Ids>
bool Built::sort_corners(setT* set, const Ids& ids) const {
  bool odd = false;
  setelemT* const e = set->e;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::size_t j = i;
    for (; j > 0 && e[j - 1].i < static_cast<int>(ids[i]); --j) {
      e[j].i = e[j - 1].i;
      odd = !odd;
    }
    e[j].i = static_cast<int>(ids[i]);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) e[i].p = vertex_of_[static_cast<unsigned>(e[i].i)];
  return odd;
}

void Built::list_members(std::size_t facets, std::size_t members, const auto& facet_of) {
  starts_.clear();
  if (facets == members) return;
  starts_.assign(facets + 1, 0);
  members_.resize(members);
  for (std::size_t m = 0; m < members; ++m) ++starts_[facet_of(m) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  std::vector<std::uint32_t> next(starts_);
  for (std::size_t m = 0; m < members; ++m)
    members_[next[facet_of(m)]++] = static_cast<std::uint32_t>(m);
}

std::span<const std::uint32_t> Built::members_of(const std::uint32_t& facet) const {
  if (starts_.empty()) return {&facet, 1};
  return {members_.data() + starts_[facet], starts_[facet + 1] - starts_[facet]};
}

void Built::list_hull(qhT* qh, bool triangulated) {
  triangulated_ = triangulated;
  const unsigned d = dimension_;
  std::vector<std::uint64_t> ids(hull_.vertices);
  std::sort(ids.begin(), ids.end());
  make_vertices(qh, ids);
  const std::size_t count = triangulated ? hull_.simplex_count() : hull_.facet_count();
  make_facets(qh, count, count);
  const auto of_simplex = [&](std::size_t s) { return hull_.simplex_facets[s]; };
  list_members(hull_.facet_count(), hull_.simplex_count(), of_simplex);
  const std::size_t items = triangulated ? count * d : hull_.facets.items.size();
  const std::size_t links = triangulated ? count * d : hull_.facet_neighbours.items.size();
  const Sets vertex_sets(arena_, items, count), neighbour_sets(arena_, links, count);
  each_part(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      facetT& f = facets_[i];
      const std::uint32_t of = triangulated ? of_simplex(i) : static_cast<std::uint32_t>(i);
      const auto members = members_of(of);
      f.normal = hull_.facet_planes.data() + std::size_t{of} * (d + 1);
      f.offset = f.normal[d];
      f.simplicial = triangulated || members.size() == 1;
      f.tricoplanar = triangulated && members.size() > 1;
      if (f.tricoplanar) f.f.triowner = &facets_[members[0]];
      f.keepcentrum = f.tricoplanar && members[0] == i;
      // A facet of one simplex has the simplex' orientation.
      const std::size_t s = triangulated ? i : members[0];
      const auto own = f.simplicial ? hull_.simplex(s) : hull_.facet(i);
      f.vertices = vertex_sets.at(i, triangulated ? i * d : hull_.facets.offsets[i], own.size());
      f.toporient = sort_corners(f.vertices, own);  // Qhull's is that seen from inside
      const std::size_t before = triangulated ? i * d : hull_.facet_neighbours.offsets[i];
      if (f.simplicial) {  // neighbours in the order of the vertices
        setT* const set = f.neighbors = neighbour_sets.at(i, before, d);
        for (unsigned k = 0; k < d; ++k) {
          const std::uint32_t across = hull_.simplex_neighbours[s * d + k];
          set->e[place_of(f.vertices, vertex_of_[own[k]])].p =
              &facets_[triangulated ? across : of_simplex(across)];
        }
      } else {
        const auto across = hull_.facet_neighbours[i];
        setT* const set = f.neighbors = neighbour_sets.at(i, before, across.size());
        for (std::size_t k = 0; k < across.size(); ++k) set->e[k].p = &facets_[across[k]];
      }
    }
  });
  if (triangulated) {
    starts_.clear();
  } else if (d == 3) {
    for (std::size_t i = 0; i < count; ++i)
      if (!facets_[i].simplicial) ridges(qh, &facets_[i]);
  }
}

/// The plane of a lifted cell, beneath which all points are; returns its offset.
double Built::lifted_plane(std::span<const std::uint32_t> cell, double* normal) const {
  const unsigned d = dimension_, width = d + 1;
  const double* const p = points_ + std::size_t{cell[0]} * d;
  // The circumcentre from the first corner: 2 (q - p) . e = |q - p|^2.
  std::vector<double> rows(std::size_t{d} * width);
  for (unsigned i = 0; i < d; ++i) {
    for (unsigned j = 0; j < d; ++j) {
      const double x = points_[std::size_t{cell[i + 1]} * d + j] - p[j];
      rows[i * width + j] = 2 * x;
      rows[i * width + d] += x * x;
    }
  }
  eliminate(rows, d, width);
  double square = 1, offset = 0;
  for (unsigned j = 0; j < d; ++j) {
    const double pivot = rows[j * width + j];
    normal[j] = 2 * (p[j] + (pivot == 0 ? 0 : rows[j * width + d] / pivot));
    square += normal[j] * normal[j];
    offset += p[j] * (p[j] - normal[j]);
  }
  const double length = (command_.furthest_site ? -1 : 1) * std::sqrt(square);
  for (unsigned j = 0; j < d; ++j) normal[j] /= length;
  normal[d] = -1 / length;
  return offset / length;
}

/// For each facet of the triangulation's hull those across its ridges.
std::vector<std::uint32_t> Built::outer_neighbours() const {
  const unsigned d = dimension_;
  const auto outer = static_cast<std::uint32_t>(cells_.hull_facet_count());
  std::vector<std::uint32_t> across(std::size_t{outer} * d, 0), order(across.size());
  // Ridge i is that of facet i / d without its corner i % d; its corners, ascending:
  std::vector<std::uint32_t> ridges(across.size() * (d - 1));
  for (std::size_t i = 0; i < across.size(); ++i) {
    std::uint32_t* to = ridges.data() + i * (d - 1);
    for (unsigned k = 0; k < d; ++k)
      if (k != i % d) *to++ = cells_.hull_facet(i / d)[k];
    std::sort(to - (d - 1), to);
  }
  const auto ridge = [&](std::uint32_t i) {
    return std::span<const std::uint32_t>(ridges.data() + std::size_t{i} * (d - 1), d - 1);
  };
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(ridge(a).begin(), ridge(a).end(), ridge(b).begin(),
                                        ridge(b).end());
  });
  for (std::size_t i = 0; i + 1 < order.size(); i += 2) {
    across[order[i]] = order[i + 1] / d;
    across[order[i + 1]] = order[i] / d;
  }
  return across;
}

void Built::list_cells(qhT* qh, bool triangulated) {
  triangulated_ = triangulated;
  const unsigned d = dimension_, corners = d + 1;
  std::vector<bool> is_vertex(count_, true);
  for (const DuplicatePoint& p : cells_.duplicates) is_vertex[p.id] = false;
  for (const std::uint32_t id : cells_.hidden) is_vertex[id] = false;
  std::vector<std::uint64_t> ids;
  for (std::uint64_t i = 0; i < count_; ++i)
    if (is_vertex[i]) ids.push_back(i);
  make_vertices(qh, ids);

  // Lower facets are cells, or groups of them with one circumsphere; behind them stands an upper
  // facet for each facet of the points' hull, which clients take for what is beyond it.
  const std::size_t cells = cells_.size(), outer = cells_.hull_facet_count();
  std::size_t groups = cells;
  if (!cells_.cell_groups.empty())
    groups =
        *std::max_element(cells_.cell_groups.begin(), cells_.cell_groups.end()) + std::size_t{1};
  list_members(groups, cells, [&](std::size_t c) { return cells_.group(c); });
  const std::size_t lower = triangulated ? cells : groups;
  make_facets(qh, lower + outer, lower);
  const auto facet_of = [&](std::uint64_t c) {
    return triangulated ? static_cast<std::uint32_t>(c) : cells_.group(c);
  };
  // The upper facet behind each facet of a cell that has no neighbour.
  std::unordered_map<std::uint64_t, std::uint32_t> beyond;
  for (std::uint64_t h = 0; h < outer; ++h) {
    const std::uint64_t c = cells_.hull_cells[h];
    const auto facet = cells_.hull_facet(h);
    for (unsigned k = 0; k < corners; ++k)
      if (std::find(facet.begin(), facet.end(), cells_.cell(c)[k]) == facet.end())
        beyond[c * corners + k] = static_cast<std::uint32_t>(lower + h);
  }
  // Each lower facet has room for the corners of all its cells.
  const Sets vertex_sets(arena_, (cells + outer) * corners, lower + outer);
  const Sets neighbour_sets(arena_, (cells + outer) * corners, lower + outer);
  auto* const normals = arena_.make<double>((lower + outer) * (d + 2));
  each_part(lower, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> own, across;
    for (std::size_t i = begin; i < end; ++i) {
      facetT& f = facets_[i];
      const auto number = static_cast<std::uint32_t>(i);
      const std::uint32_t of = triangulated ? cells_.group(i) : number;
      const auto group = members_of(of);
      const auto members = triangulated ? std::span<const std::uint32_t>(&number, 1) : group;
      own.clear();
      across.clear();
      for (const std::uint32_t c : members) {
        own.insert(own.end(), cells_.cell(c).begin(), cells_.cell(c).end());
        for (unsigned k = 0; k < corners; ++k) {
          const std::uint32_t n = cells_.neighbours_of(c)[k];
          const std::uint32_t g =
              n == no_index ? beyond.find(std::uint64_t{c} * corners + k)->second : facet_of(n);
          if (g != i) across.push_back(g);
        }
      }
      const std::size_t before =
          (triangulated || starts_.empty() ? i : starts_[i]) * std::size_t{corners};
      f.simplicial = members.size() == 1;
      if (!f.simplicial) {
        keep_once(own);
        keep_once(across);
      }
      f.vertices = vertex_sets.at(i, before, own.size());
      f.toporient = sort_corners(f.vertices, own) == command_.furthest_site;
      f.neighbors = neighbour_sets.at(i, before, across.size());
      for (std::size_t k = 0; k < across.size(); ++k)
        f.neighbors->e[f.simplicial ? place_of(f.vertices, vertex_of_[own[k]]) : k].p =
            &facets_[across[k]];
      f.tricoplanar = triangulated && group.size() > 1;
      if (f.tricoplanar) f.f.triowner = &facets_[group[0]];
      f.keepcentrum = f.tricoplanar && group[0] == i;
      f.upperdelaunay = command_.furthest_site;
      f.normal = normals + i * (d + 2);
      f.offset = lifted_plane(cells_.cell(members[0]), f.normal);
    }
  });
  const std::vector<std::uint32_t> around = outer_neighbours();
  for (std::size_t h = 0; h < outer; ++h) {
    const std::size_t i = lower + h, before = (cells + h) * corners;
    facetT& f = facets_[i];
    f.vertices = vertex_sets.at(i, before, d);
    f.toporient = sort_corners(f.vertices, cells_.hull_facet(h));
    f.neighbors = neighbour_sets.at(i, before, corners);
    f.neighbors->e[0].p = &facets_[facet_of(cells_.hull_cells[h])];
    for (unsigned k = 0; k < d; ++k) f.neighbors->e[k + 1].p = &facets_[lower + around[h * d + k]];
    f.upperdelaunay = !command_.furthest_site;
    f.normal = normals + i * (d + 2);
    f.normal[d] = command_.furthest_site ? -1 : 1;
  }
  if (triangulated) starts_.clear();
}

void Built::triangulate(qhT* qh) {
  qh->hasTriangulation = True;
  if (triangulated_) return;
  const bool neighbours = qh->VERTEXneighbors != False, centred = qh->CENTERtype == qh_ASvoronoi;
  qh->VERTEXneighbors = False;
  qh->CENTERtype = qh_ASnone;
  if (command_.delaunay)
    list_cells(qh, true);
  else
    list_hull(qh, true);
  if (neighbours) vertex_neighbours(qh);
  if (centred) centres(qh);
}

void Built::vertex_neighbours(qhT* qh) {
  if (qh->VERTEXneighbors) return;
  const auto count = static_cast<std::size_t>(qh->num_vertices);
  std::vector<std::uint32_t> sizes(count, 0);
  std::size_t all = 0;
  const auto each = [&](auto&& with) {
    for (facetT* f = qh->facet_list; f != nullptr && f->next != nullptr; f = f->next)
      for (int k = 0; k < f->vertices->maxsize; ++k)
        with(f, *static_cast<vertexT*>(f->vertices->e[k].p));
  };
  each([&](facetT*, vertexT& v) {
    ++sizes[v.id - 1];
    ++all;
  });
  const Sets sets(arena_, all, count);
  for (std::size_t i = 0, before = 0; i < count; before += sizes[i++])
    qh->vertex_list[i].neighbors = sets.at(i, before, sizes[i]);
  std::fill(sizes.begin(), sizes.end(), 0);
  each([&](facetT* f, vertexT& v) { v.neighbors->e[sizes[v.id - 1]++].p = f; });
  qh->VERTEXneighbors = True;
}

void Built::order_neighbours(vertexT* vertex) const {
  // A walk around the vertex by facets that share it; the upper facets stand together at one end.
  setT* const set = vertex->neighbors;
  const int size = set->maxsize;
  const auto facet = [&](int i) { return static_cast<facetT*>(set->e[i].p); };
  const auto upper = [&](const facetT* f) { return f->upperdelaunay != command_.furthest_site; };
  const auto adjacent = [](const facetT* f, const facetT* g) {
    for (int k = 0; k < f->neighbors->maxsize; ++k)
      if (f->neighbors->e[k].p == g) return true;
    return false;
  };
  for (int i = 1; i < size; ++i)
    if (upper(facet(i)) && !upper(facet(0))) std::swap(set->e[0].p, set->e[i].p);
  for (int i = 0; i + 1 < size; ++i)
    for (int j = i + 1; j < size; ++j)
      if ((i == 0 || !upper(facet(j)) || j == size - 1) && adjacent(facet(i), facet(j))) {
        std::swap(set->e[i + 1].p, set->e[j].p);
        break;
      }
}

void Built::centres(qhT* qh) {
  if (!command_.delaunay || qh->CENTERtype == qh_ASvoronoi) return;
  const Voronoi diagram = voronoi(PointView::row_major(points_, count_, dimension_), cells_);
  auto* const rows = arena_.make<double>(diagram.vertices.size());
  std::copy(diagram.vertices.begin(), diagram.vertices.end(), rows);
  for (std::uint32_t i = 0; i < lower_; ++i)
    facets_[i].center = rows + std::size_t{cells_.group(members_of(i)[0])} * dimension_;
  qh->CENTERtype = qh_ASvoronoi;
}

template <class Ids>
double Built::simplex_area(const Ids& ids) const {
  // The root of Gram's determinant of the edges from the first corner.
  const unsigned d = dimension_, k = static_cast<unsigned>(ids.size()) - 1;
  std::vector<double> edges(std::size_t{k} * d), gram(std::size_t{k} * k);
  for (unsigned i = 0; i < k; ++i)
    for (unsigned j = 0; j < d; ++j)
      edges[i * d + j] = points_[ids[i + 1] * d + j] - points_[ids[0] * d + j];
  for (unsigned a = 0; a < k; ++a)
    for (unsigned b = 0; b < k; ++b)
      gram[a * k + b] = std::inner_product(&edges[a * d], &edges[a * d] + d, &edges[b * d], 0.0);
  return std::sqrt(eliminate(gram, k, k)) / factorial(k);
}

double Built::area(const facetT* facet) const {
  const std::uint32_t i = facet->id - 1;
  if (i >= lower_) return 0;
  double sum = 0;
  for (const std::uint32_t m : members_of(i)) {
    if (command_.delaunay)
      sum += simplex_area(cells_.cell(m));
    else
      sum += simplex_area(hull_.simplex(m));
  }
  return sum;
}

void Built::ridges(qhT* qh, facetT* facet) {
  const bool polygon = !facet->simplicial && !command_.delaunay && dimension_ == 3;
  if (!facet->simplicial && !polygon) return;
  const auto* const corners = facet->vertices;
  std::vector<std::uint64_t> ids;
  for (int k = 0; k < facet->neighbors->maxsize; ++k) {
    auto* const across = static_cast<facetT*>(facet->neighbors->e[k].p);
    if (shares_ridge(facet, across)) continue;
    ids.clear();
    for (int i = 0; i < corners->maxsize; ++i) {
      const auto* const v = static_cast<vertexT*>(corners->e[i].p);
      if (polygon ? has(across->vertices, v) : i != k)
        ids.push_back(static_cast<std::uint64_t>((v->point - qh->first_point) / qh->hull_dim));
    }
    auto* const ridge = arena_.make<ridgeT>(1);
    ridge->id = qh->ridge_id++;
    ridge->vertices = Sets(arena_, ids.size(), 1).at(0, 0, ids.size());
    sort_corners(ridge->vertices, ids);
    const bool on_top = polygon || (facet->toporient != 0) != (k % 2 != 0);
    ridge->top = on_top ? facet : across;
    ridge->bottom = on_top ? across : facet;
    append_ridge(facet, ridge);
    append_ridge(across, ridge);
  }
  facet->simplicial = False;  // as there: its ridges are listed now
}

/// Of simplices and polygons in space, which have at most one ridge in common.
bool Built::shares_ridge(const facetT* facet, const facetT* across) {
  if (facet->ridges == nullptr) return false;
  for (int i = 0; facet->ridges->e[i].p != nullptr && i < facet->ridges->maxsize; ++i)
    if (otherfacet_(static_cast<ridgeT*>(facet->ridges->e[i].p), facet) == across) return true;
  return false;
}

void Built::append_ridge(facetT* facet, ridgeT* ridge) {
  const int room = facet->neighbors->maxsize;
  if (facet->ridges == nullptr) {
    const auto items = static_cast<std::size_t>(room);
    facet->ridges = Sets(arena_, items, 1).at(0, 0, items);
    for (int i = 0; i <= room; ++i) facet->ridges->e[i].p = nullptr;
  }
  int size = 0;
  while (size < room && facet->ridges->e[size].p != nullptr) ++size;
  if (size == room) return;
  facet->ridges->e[size].p = ridge;
  facet->ridges->e[room].p = nullptr;  // full, or how many there are
  if (size + 1 < room) facet->ridges->e[room].i = size + 2;
}

setT* Built::temporary(int items) {
  const std::size_t bytes = set_bytes(static_cast<std::size_t>(items));
  std::unique_ptr<setT, Free> set(static_cast<setT*>(std::calloc(1, bytes)));
  if (!set) throw std::bad_alloc();
  set->maxsize = items;
  set->e[items].i = items == 0 ? 0 : 1;
  setT* const made = set.get();
  temporary_.emplace(made, std::move(set));
  return made;
}

void Built::polygon(const facetT* facet, setT* out) const {
  const std::uint32_t i = facet->id - 1;
  std::vector<std::uint64_t> ids;
  if (command_.delaunay && i >= lower_) {
    for (int k = 0; k < out->maxsize; ++k) out->e[k] = facet->vertices->e[k];
    return;
  }
  if (command_.delaunay) {
    // From corner to corner of the border of its cells, which are convex together.
    std::unordered_map<std::uint32_t, std::uint32_t> next;
    for (const std::uint32_t c : members_of(i)) {
      for (unsigned k = 0; k < 3; ++k) {
        const std::uint32_t n = cells_.neighbours_of(c)[k];
        if (n == no_index || triangulated_ || cells_.group(n) != cells_.group(c))
          next[cells_.cell(c)[(k + 1) % 3]] = cells_.cell(c)[(k + 2) % 3];
      }
    }
    for (std::uint32_t at = next.begin()->first; ids.size() < next.size(); at = next[at])
      ids.push_back(at);
    if (command_.furthest_site) std::reverse(ids.begin(), ids.end());
  } else {
    const auto own = triangulated_ ? hull_.simplex(i) : hull_.facet(i);
    ids.assign(own.rbegin(), own.rend());
  }
  for (std::size_t k = 0; k < ids.size(); ++k) out->e[k].p = vertex_of_[ids[k]];
}

}  // namespace cullhull::qhull
