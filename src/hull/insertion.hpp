// Incremental insertion: the exact engine for d >= 3. docs/algorithm.md, "The engine".
//
// No conflict lists: a point finds a facet it sees by climbing n . p over neighbouring facets, with
// planes scaled to n . (x - O) = 1 (linear programming on the dual polytope). What the climb cannot
// decide beyond its error bounds, an exact walk does.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "hull/engine.hpp"
#include "hull/insertion_order.hpp"
#include "parallel/raw_array.hpp"
#include "predicates/minors.hpp"
#include "predicates/orientation.hpp"

namespace cullhull::internal {

/// An array of `fixed` items, or of a run-time number of them where `fixed` is 0.
template <class T, unsigned fixed>
struct Scratch {
  explicit Scratch(std::size_t) {}
  T* data() { return items.data(); }
  std::array<T, fixed> items;
};
template <class T>
struct Scratch<T, 0> {
  explicit Scratch(std::size_t n) : items(n) {}
  T* data() { return items.data(); }
  std::vector<T> items;
};

/// D: the dimension, or 0 for one known at run time only.
template <unsigned D>
class Insertion {
 public:
  Insertion(const LocalPoints& points, const std::uint32_t* simplex, std::uint64_t budget,
            const Control& control);
  SimplicialHull run();

 private:
  using Id = std::uint32_t;
  static constexpr Id none = 0xFFFFFFFF;
  /// In a visible facet's neighbour slot across a horizon ridge: the new facet built on it.
  static constexpr Id horizon_tag = 0x80000000;
  static constexpr Id dead = 0xFFFFFFFF;
  static constexpr unsigned minors = D > 0 ? 1U << D : 0;

  unsigned dim() const {
    if constexpr (D > 0) return D;
    return dimension_;
  }
  /// A facet's record, in doubles: normal and error, then vertices, neighbours and mark as ids;
  /// 64 bytes, a cache line, in 3D.
  std::size_t stride() const { return (dim() + 1) + (2 * dim() + 2) / 2; }
  double* plane(Id f) { return records_.data() + f * stride(); }
  Id* vertices(Id f) { return reinterpret_cast<Id*>(plane(f) + dim() + 1); }
  Id* neighbours(Id f) { return vertices(f) + dim(); }
  Id& mark(Id f) { return vertices(f)[2 * dim()]; }
  const double* row(Id p) const { return ordered_.data() + std::size_t{p} * dim(); }
  const double* exact_row(Id p) const { return points_.exact_row(order_[p]); }
  double error(Id f) { return plane(f)[dim()]; }
  double gauge(Id f) {
    const double* n = plane(f);
    double sum = n[0] * offset_.data()[0];
    for (unsigned j = 1; j < dim(); ++j) sum += n[j] * offset_.data()[j];
    return sum;
  }

  void arrange(const Id* simplex);
  void build_simplex();
  Id new_facet();
  void grow();
  void compute_plane(Id f);
  bool cofactors(const Id* v, double* normal, double* normal_error);

  void aim(Id point);
  Id locate(Id point);
  Id locate_exactly(Id start, Id point);
  template <class Entry>
  Sign lattice_sign(const Entry& entry);
  Sign side(Id f, Id point);
  bool sees(Id f, Id point);
  Sign cone_side(Id f, unsigned j, Id point);
  bool note_duplicate(Id f, Id point);

  void insert(Id point, Id seed);
  void find_visible(Id point, Id seed);
  void replace_visible(Id point);
  void link(Id f, Id old_facet, unsigned apex);
  SimplicialHull collect();

  const LocalPoints& points_;
  const Control& control_;
  unsigned dimension_;
  std::uint64_t budget_;
  Scratch<double, D> centre_, simplex_sum_, offset_;
  RawArray<double> records_;
  /// Points in insertion order: an id here is a position in `order_`. The simplex comes first.
  std::vector<Id> order_;
  RawArray<double> ordered_;
  std::size_t facet_slots_ = 0, facet_capacity_ = 0;
  std::vector<Id> free_;
  Id hint_ = 0;
  Id epoch_ = 0;
  std::uint64_t random_ = 0x9E3779B97F4A7C15ULL;
  std::uint64_t created_ = 0;

  struct Ridge {
    Id facet, outside, created;
    unsigned apex;  // index in `facet` of the vertex opposite to the ridge
  };
  std::vector<Id> visible_, stack_;
  std::vector<Ridge> horizon_;
  /// 3D: the new facet on the horizon's edge that starts at a vertex; the horizon is a cycle.
  std::vector<Id> ridge_from_;
  Scratch<double, D * D> matrix_;
  Scratch<double, minors> det_, perm_;
  Scratch<double, D> normal_, normal_error_;
  Scratch<const double*, D + (D > 0)> rows_, simplex_rows_;
  SimplicialHull result_;
};

// -------------------------------------------------------------------------------- construction

template <unsigned D>
Insertion<D>::Insertion(const LocalPoints& points, const std::uint32_t* simplex,
                        std::uint64_t budget, const Control& control)
    : points_(points),
      control_(control),
      dimension_(points.dimension),
      budget_(budget),
      centre_(dimension_),
      simplex_sum_(dimension_),
      offset_(dimension_),
      matrix_(std::size_t{dimension_} * dimension_),
      det_(dimension_ <= 12 ? std::size_t{1} << dimension_ : 0),
      perm_(dimension_ <= 12 ? std::size_t{1} << dimension_ : 0),
      normal_(dimension_),
      normal_error_(dimension_),
      rows_(dimension_ + 1),
      simplex_rows_(dimension_ + 1) {
  for (unsigned j = 0; j < dim(); ++j) {
    double sum = 0;
    for (unsigned i = 0; i <= dim(); ++i) sum += points_.row(simplex[i])[j];
    simplex_sum_.data()[j] = sum;
    centre_.data()[j] = sum / (dim() + 1);
  }
  arrange(simplex);
}

template <unsigned D>
void Insertion<D>::arrange(const Id* simplex) {
  const unsigned d = dim();
  std::vector<Id> sorted(simplex, simplex + d + 1);
  std::sort(sorted.begin(), sorted.end());
  order_ = insertion_order(points_, centre_.data());
  std::size_t out = order_.size();
  for (std::size_t k = order_.size(); k-- > 0;)
    if (!std::binary_search(sorted.begin(), sorted.end(), order_[k])) order_[--out] = order_[k];
  std::copy(simplex, simplex + d + 1, order_.begin());
  if constexpr (D == 3) ridge_from_.resize(order_.size());
  ordered_.reserve(order_.size() * d);
  for (std::size_t k = 0; k < order_.size(); ++k)
    std::copy_n(points_.row(order_[k]), d, ordered_.data() + k * d);
}

template <unsigned D>
SimplicialHull Insertion<D>::run() {
  build_simplex();
  for (Id point = dim() + 1; point < order_.size(); ++point) {
    if (point % 1024 == 0) {
      control_.check();
      if (point % 65536 == 0)
        control_.report("hull", static_cast<double>(point) / static_cast<double>(order_.size()));
    }
    const Id seed = locate(point);
    if (seed != none) insert(point, seed);
  }
  return collect();
}

template <unsigned D>
void Insertion<D>::build_simplex() {
  const unsigned d = dim();
  for (unsigned i = 0; i <= d; ++i) {
    const Id f = new_facet();
    Id* v = vertices(f);
    Id* n = neighbours(f);
    for (unsigned k = 0, at = 0; k <= d; ++k) {
      if (k == i) continue;
      v[at] = k;
      n[at] = k;
      ++at;
    }
    mark(f) = 0;
    if (side(f, i) == Sign::positive) {
      std::swap(v[0], v[1]);
      std::swap(n[0], n[1]);
    }
    compute_plane(f);
  }
}

template <unsigned D>
typename Insertion<D>::Id Insertion<D>::new_facet() {
  ++created_;
  if (!free_.empty()) {
    const Id f = free_.back();
    free_.pop_back();
    return f;
  }
  if (facet_slots_ == facet_capacity_) grow();
  return static_cast<Id>(facet_slots_++);
}

template <unsigned D>
void Insertion<D>::grow() {
  const std::uint64_t per_facet = stride() * sizeof(double);
  const std::uint64_t capacity = std::max<std::uint64_t>(1024, facet_capacity_ * 2);
  // The result takes about twice as much beside the records (a sphere of 1M points: 450 MB in all).
  if (capacity >= horizon_tag || 3 * capacity * per_facet > budget_) {
    throw Error(ErrorCode::out_of_budget, "the hull has more than " + std::to_string(facet_slots_) +
                                              " facets in dimension " + std::to_string(dim()) +
                                              ", which exceeds the memory budget of " +
                                              std::to_string(budget_ >> 20) +
                                              " MiB; raise the budget or use fewer dimensions");
  }
  control_.check();
  records_.reserve(capacity * stride());
  facet_capacity_ = capacity;
}

// ------------------------------------------------------------------------------------- planes

/// Cofactor normal of the facet on v: normal . (x - v0) has the sign of orientation(v, x);
/// normal_error bounds each component's absolute error (docs/exactness.md, "Cached planes").
template <unsigned D>
bool Insertion<D>::cofactors(const Id* v, double* normal, double* normal_error) {
  const unsigned d = dim();
  // Roundings of a (d-1)-minor of differences, one for the product with the constant, one to spare.
  const double factor = (minor_roundings(d - 1) + 2) * unit_roundoff;
  constexpr double underflow = 0x1p-1000;
  const double* base = row(v[0]);
  if constexpr (D == 3) {
    const double* p = row(v[1]);
    const double* q = row(v[2]);
    const double ax = p[0] - base[0], ay = p[1] - base[1], az = p[2] - base[2];
    const double bx = q[0] - base[0], by = q[1] - base[1], bz = q[2] - base[2];
    const double yz = ay * bz, zy = az * by, zx = az * bx, xz = ax * bz, xy = ax * by, yx = ay * bx;
    normal[0] = yz - zy;
    normal[1] = zx - xz;
    normal[2] = xy - yx;
    normal_error[0] = factor * (std::abs(yz) + std::abs(zy)) + underflow;
    normal_error[1] = factor * (std::abs(zx) + std::abs(xz)) + underflow;
    normal_error[2] = factor * (std::abs(xy) + std::abs(yx)) + underflow;
    return true;
  }
  if (d > 12) {
    const double** p = rows_.data();
    for (unsigned i = 0; i < d; ++i) p[i] = row(v[i]);
    if (!plane_exact(d, p, normal)) return false;  // dependent only after underflow in scaling
    for (unsigned j = 0; j < d; ++j) normal_error[j] = 0x1p-50 * std::abs(normal[j]) + underflow;
    return points_.exact == points_.coordinates;
  }
  double* m = matrix_.data();
  for (unsigned i = 1; i < d; ++i) {
    const double* p = row(v[i]);
    for (unsigned j = 0; j < d; ++j) m[(i - 1) * d + j] = p[j] - base[j];
  }
  if constexpr (D > 0) {
    expand_minors<D, true>(reinterpret_cast<const double(*)[D]>(m), D - 1, det_.data(),
                           perm_.data());
  } else {
    expand_minors(m, d, d - 1, det_.data(), perm_.data());
  }
  const unsigned full = (1U << d) - 1;
  for (unsigned j = 0; j < d; ++j) {
    const double minor = det_.data()[full ^ (1U << j)];
    normal[j] = ((d - 1 + j) & 1U) != 0 ? -minor : minor;
    normal_error[j] = factor * perm_.data()[full ^ (1U << j)] + underflow;
  }
  return true;
}

/// Scales the plane to n . (x - O) = 1 and bounds |computed gauge - exact gauge| where that is at
/// most 1 in magnitude. Where nothing can be promised: n = 0, error = infinity.
template <unsigned D>
void Insertion<D>::compute_plane(Id f) {
  const unsigned d = dim();
  double* out = plane(f);
  const Id* v = vertices(f);
  double* n = normal_.data();
  double* e = normal_error_.data();
  bool good = cofactors(v, n, e);
  double sum = 0, total_error = 0, level = 0;
  if (good) {
    const double* base = row(v[0]);
    for (unsigned j = 0; j < d; ++j) {
      sum += std::abs(n[j]);
      total_error += e[j];
      level += n[j] * (base[j] - centre_.data()[j]);
    }
    // |x - O| <= 2 a coordinate; offsets are off by at most (d + 5) u.
    const double a = sum * (d + 5) * unit_roundoff + 2 * total_error;
    const double b = a + (2.0 * d + 2) * unit_roundoff * sum;
    const double bound = 1.0625 * (a + b + (2.0 * d + 6) * unit_roundoff * sum);
    good = level > 0x1p-900 && level > 8 * bound;
    if (good) {
      const double scale = 1 / level;
      for (unsigned j = 0; j < d; ++j) out[j] = n[j] * scale;
      out[d] = bound * scale * (1 + 0x1p-40);
    }
  }
  if (!good) {
    for (unsigned j = 0; j < d; ++j) out[j] = 0;
    out[d] = std::numeric_limits<double>::infinity();
  }
}

// ------------------------------------------------------------------------------------ location

template <unsigned D>
void Insertion<D>::aim(Id point) {
  const double* p = row(point);
  for (unsigned j = 0; j < dim(); ++j) offset_.data()[j] = p[j] - centre_.data()[j];
}

/// Sign of a determinant on a small lattice: every operation is exact, so is the value.
template <unsigned D>
template <class Entry>
Sign Insertion<D>::lattice_sign(const Entry& entry) {
  double m[D][D];
  for (unsigned i = 0; i < D; ++i)
    for (unsigned j = 0; j < D; ++j) m[i][j] = entry(i, j);
  expand_minors<D, false>(m, D, det_.data(), static_cast<double*>(nullptr));
  ++result_.rung_counts[static_cast<unsigned>(Rung::filter)];
  return sign_of(det_.data()[(1U << D) - 1]);
}

/// Exact side of the point against a facet: positive if it sees it.
template <unsigned D>
Sign Insertion<D>::side(Id f, Id point) {
  const unsigned d = dim();
  const Id* v = vertices(f);
  const double** p = rows_.data();
  if constexpr (D > 0) {
    if (points_.small_lattice)
      return lattice_sign([&](unsigned i, unsigned j) {
        return row(i + 1 < D ? v[i + 1] : point)[j] - row(v[0])[j];
      });
  }
  for (unsigned i = 0; i < d; ++i) p[i] = exact_row(v[i]);
  p[d] = exact_row(point);
  Rung rung = Rung::exact;
  const Sign s = orientation(d, p, &rung);
  ++result_.rung_counts[static_cast<unsigned>(rung)];
  return s;
}

template <unsigned D>
bool Insertion<D>::sees(Id f, Id point) {
  const double g = gauge(f), e = error(f);
  if (g > 1 + e) return true;
  if (g < 1 - e) return false;
  return side(f, point) == Sign::positive;
}

/// Whether the point lies on the facet's side (positive), on (zero) or beyond (negative) the
/// hyperplane through O and the ridge opposite to vertex j, where O is the simplex's centroid.
template <unsigned D>
Sign Insertion<D>::cone_side(Id f, unsigned j, Id point) {
  const unsigned d = dim();
  const Id other = neighbours(f)[j];
  const double g = gauge(f), h = gauge(other);
  const double e = 2 * (error(f) * (1 + std::abs(g)) + error(other) * (1 + std::abs(h)));
  if (g - h > e) return Sign::positive;
  if (h - g > e) return Sign::negative;
  const Id* v = vertices(f);
  // An outward facet has orientation (-1)^(d+1) seen from O.
  const auto outward = [d](Sign s) { return d % 2 == 1 ? s : -s; };
  if constexpr (D > 0) {
    if (points_.centroid_lattice)
      return outward(lattice_sign([&](unsigned i, unsigned c) {
        return (D + 1) * row(i == j ? point : v[i])[c] - simplex_sum_.data()[c];
      }));
  }
  for (unsigned i = 0; i < d; ++i) rows_.data()[i] = exact_row(i == j ? point : v[i]);
  for (unsigned i = 0; i <= d; ++i) simplex_rows_.data()[i] = exact_row(i);
  ++result_.rung_counts[static_cast<unsigned>(Rung::exact)];
  return outward(orientation_from_centroid_exact(d, rows_.data(), simplex_rows_.data()));
}

template <unsigned D>
bool Insertion<D>::note_duplicate(Id f, Id point) {
  const double* p = exact_row(point);
  for (unsigned i = 0; i < dim(); ++i) {
    const Id v = vertices(f)[i];
    const double* q = exact_row(v);
    if (std::equal(p, p + dim(), q)) {
      if (order_[point] < order_[v]) result_.duplicates.emplace_back(order_[point], order_[v]);
      return true;
    }
  }
  return false;
}

/// A facet the point sees, or `none`.
template <unsigned D>
typename Insertion<D>::Id Insertion<D>::locate(Id point) {
  aim(point);
  Id f = hint_;
  double g = gauge(f);
  for (;;) {
    if (g > 1 + error(f)) {
      ++result_.rung_counts[0];
      return f;
    }
    const Id* n = neighbours(f);
    Id best = none;
    double best_gauge = g, highest = -std::numeric_limits<double>::infinity();
    for (unsigned j = 0; j < dim(); ++j) {
      const double h = gauge(n[j]);
      highest = std::max(highest, h + error(n[j]));
      if (h > best_gauge) {
        best_gauge = h;
        best = n[j];
      }
    }
    if (best == none) {
      hint_ = f;
      const double e = error(f);
      // A strict maximum beyond the bounds: the ray from O to the point leaves through f, and the
      // point is beneath f.
      if (g > e && g + e < 1 && highest < g - e) {
        ++result_.rung_counts[0];
        return none;
      }
      return locate_exactly(f, point);
    }
    f = best;
    g = best_gauge;
  }
}

template <unsigned D>
typename Insertion<D>::Id Insertion<D>::locate_exactly(Id start, Id point) {
  if (note_duplicate(start, point)) return none;
  if (side(start, point) == Sign::positive) return start;
  const unsigned d = dim();
  Id f = start;
  // A visibility walk on the projection of the hull from O. The projection is a regular subdivision
  // but for its coplanar pieces, so a walk that picks the ridge at random ends with probability 1
  // (Devillers, Pion, Teillaud 2002).
  for (std::uint32_t step = 1;; ++step) {
    if (step % 1024 == 0) control_.check();
    random_ ^= random_ << 13;
    random_ ^= random_ >> 7;
    random_ ^= random_ << 17;
    const auto first = static_cast<unsigned>(random_ % d);
    Id next = none;
    for (unsigned k = 0; k < d && next == none; ++k) {
      const unsigned j = (first + k) % d;
      if (cone_side(f, j, point) == Sign::negative) next = neighbours(f)[j];
    }
    if (next == none) break;
    f = next;
    if (gauge(f) > 1 + error(f)) return f;
  }
  hint_ = f;
  const Sign s = side(f, point);
  if (s == Sign::positive) return f;
  if (s == Sign::zero) note_duplicate(f, point);
  return none;
}

// ----------------------------------------------------------------------------------- insertion

template <unsigned D>
void Insertion<D>::insert(Id point, Id seed) {
  if (++epoch_ >= 0x7FFFFFFF)
    throw Error(ErrorCode::out_of_budget, "more than 2^31 points had to be inserted");
  find_visible(point, seed);
  replace_visible(point);
  if (created_ >= 4096) {
    created_ = 0;
    control_.check();
  }
}

template <unsigned D>
void Insertion<D>::find_visible(Id point, Id seed) {
  visible_.clear();
  horizon_.clear();
  stack_.clear();
  const Id seen = 2 * epoch_ + 1, unseen = 2 * epoch_;
  mark(seed) = seen;
  stack_.push_back(seed);
  while (!stack_.empty()) {
    const Id f = stack_.back();
    stack_.pop_back();
    visible_.push_back(f);
    const Id* n = neighbours(f);
    for (unsigned j = 0; j < dim(); ++j) {
      const Id other = n[j];
      Id& m = mark(other);
      if (m < unseen) {
        if (sees(other, point)) {
          m = seen;
          stack_.push_back(other);
          continue;
        }
        m = unseen;
      }
      if (m == unseen) horizon_.push_back({f, other, none, j});
    }
  }
}

/// A new facet on every horizon ridge, then the visible ones are gone.
template <unsigned D>
void Insertion<D>::replace_visible(Id point) {
  const unsigned d = dim();
  for (Ridge& r : horizon_) {
    const Id f = new_facet();
    r.created = f;
    const Id* old_vertices = vertices(r.facet);
    Id* v = vertices(f);
    if constexpr (D == 3) {
      v[0] = point;  // turned, so that the ridge's ends are always at 1 and 2
      v[1] = old_vertices[r.apex == 2 ? 0 : r.apex + 1];
      v[2] = old_vertices[r.apex == 0 ? 2 : r.apex - 1];
      neighbours(f)[0] = r.outside;
      ridge_from_[v[1]] = f;
    } else {
      for (unsigned i = 0; i < d; ++i) v[i] = old_vertices[i];
      v[r.apex] = point;
      neighbours(f)[r.apex] = r.outside;
      neighbours(r.facet)[r.apex] = f | horizon_tag;
    }
    mark(f) = 0;
    Id* back = neighbours(r.outside);
    for (unsigned i = 0; i < d; ++i)
      if (back[i] == r.facet) back[i] = f;
    compute_plane(f);
  }
  for (const Ridge& r : horizon_) {
    if constexpr (D == 3) {
      const Id next = ridge_from_[vertices(r.created)[2]];
      neighbours(r.created)[1] = next;
      neighbours(next)[2] = r.created;
    } else {
      link(r.created, r.facet, r.apex);
    }
  }
  for (const Id f : visible_) {
    mark(f) = dead;
    free_.push_back(f);
  }
  hint_ = horizon_.back().created;
}

/// Finds the other new facets around: across the ridge of f opposite to vertex i lies the new facet
/// reached by turning through visible facets about what f and old_facet share without vertex i.
template <unsigned D>
void Insertion<D>::link(Id f, Id old_facet, unsigned apex) {
  const unsigned d = dim();
  for (unsigned i = 0; i < d; ++i) {
    if (i == apex) continue;
    Id at = old_facet;
    unsigned exit = i;
    Id kept = vertices(at)[apex];
    for (;;) {
      const Id next = neighbours(at)[exit];
      if ((next & horizon_tag) != 0) {
        neighbours(f)[i] = next & ~horizon_tag;
        break;
      }
      const Id* v = vertices(next);
      const Id* n = neighbours(next);
      unsigned enter = 0;
      while (n[enter] != at) ++enter;
      exit = 0;
      while (v[exit] != kept) ++exit;
      kept = v[enter];
      at = next;
    }
  }
}

template <unsigned D>
SimplicialHull Insertion<D>::collect() {
  const unsigned d = dim();
  std::vector<Id> number(facet_slots_, none);
  Id count = 0;
  for (Id f = 0; f < facet_slots_; ++f)
    if (mark(f) != dead) number[f] = count++;
  result_.dimension = d;
  result_.vertices.resize(std::size_t{count} * d);
  result_.neighbours.resize(std::size_t{count} * d);
  ordered_.release();
  for (Id f = 0; f < facet_slots_; ++f) {
    if (number[f] == none) continue;
    const std::size_t base = std::size_t{number[f]} * d;
    for (unsigned j = 0; j < d; ++j) {
      result_.vertices[base + j] = order_[vertices(f)[j]];
      result_.neighbours[base + j] = number[neighbours(f)[j]];
    }
  }
  return std::move(result_);
}

}  // namespace cullhull::internal
