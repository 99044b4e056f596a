#include "few/small_nd.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "exact/orientation/orientation.hpp"
#include "hull/general/facet_planes.hpp"

namespace cullhull::internal {
namespace {

/// Signs that f32 may leave open, for each point.
constexpr unsigned most_open_signs = 8;

/// The place of an item among the first n of a list that has it.
template <unsigned n>
unsigned index_of(const std::uint32_t* list, std::uint32_t item) {
  unsigned at = 0;
  for (unsigned j = 1; j < n; ++j) at = list[j] == item ? j : at;
  return at;
}

}  // namespace

template <unsigned D>
bool SmallSurfaceNd<D>::build(const double* rows, unsigned count) {
  count_ = count;
  slots_ = open_signs_ = 0;
  std::uint32_t simplex[D + 1];
  if (count < D + 1 || !scale(rows) || !choose_simplex(simplex) || !start(simplex)) return false;
  order_outermost_first(simplex);
  // Sieves after an eighth and after three eighths of the points: most later ones are then inside.
  std::size_t next_sieve = order_.size() < 2 * sieve_block ? order_.size() : order_.size() / 8;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    if (k == next_sieve) next_sieve = sieve(k) ? 3 * k : order_.size();
    if (k < order_.size() && !insert(order_[k])) return false;
  }
  return true;
}

/// Drops those of the points from position `begin` on that are inside, many at a time. Returns
/// false, having dropped nothing, if none of the last block is: they are the nearest to the mean.
template <unsigned D>
bool SmallSurfaceNd<D>::sieve(std::size_t begin) {
  level_planes_.clear();
  for (unsigned f = 0; f < slots_; ++f) {
    if (!live(f)) continue;
    const PlaneGroup<D>& group = planes_[f / PlaneGroup<D>::size];
    const unsigned lane = f % PlaneGroup<D>::size;
    for (unsigned j = 0; j < D; ++j) level_planes_.push_back(group.entry[j][lane]);
    level_planes_.push_back(1 - group.entry[D][lane]);
  }
  bool any = false;
  // From the last block to the first, so that points can be erased behind it.
  for (std::size_t end = order_.size(); end > begin;) {
    const std::size_t count = std::min(sieve_block, end - begin), first = end - count;
    alignas(64) float y[D * sieve_block];
    for (std::size_t i = 0; i < sieve_block; ++i) {
      float one[D];
      aim(order_[first + std::min(i, count - 1)], one);
      for (unsigned j = 0; j < D; ++j) y[j * sieve_block + i] = one[j];
    }
    std::uint8_t inside[sieve_block];
    beneath_facets(D, level_planes_.data(), level_planes_.size() / (D + 1), y, inside);
    for (std::size_t i = 0; i < count; ++i)
      if (inside[i] != 0) order_[first + i] = no_index;
    any = any || std::count(inside, inside + count, 1) > 0;
    if (!any) return false;
    end = first;
  }
  std::erase(order_, no_index);
  return true;
}

/// Scales all coordinates by one power of two. False where that could underflow: scaled rows are
/// exact.
template <unsigned D>
bool SmallSurfaceNd<D>::scale(const double* rows) {
  const std::size_t n = std::size_t{count_} * D;
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::fabs(rows[i]));
  if (!(largest > 0x1p-500 && largest < 0x1p500)) return false;
  const double factor = std::ldexp(1.0, -(std::ilogb(largest) + 1));
  scaled_.resize(n);
  bool small = false;
  for (std::size_t i = 0; i < n; ++i) {
    scaled_[i] = rows[i] * factor;
    small |= std::fabs(scaled_[i]) < 0x1p-300 && rows[i] != 0;
  }
  return !small;
}

/// Chooses D + 1 points far from one another: each the farthest from the flat of those before it,
/// as far as doubles tell.
template <unsigned D>
bool SmallSurfaceNd<D>::choose_simplex(std::uint32_t* simplex) {
  rest_ = scaled_;
  std::uint32_t first = 0;
  for (std::uint32_t i = 1; i < count_; ++i)
    if (row(i)[0] < row(first)[0]) first = i;
  simplex[0] = first;
  double base[D];
  std::copy_n(row(first), D, base);
  for (unsigned rank = 1; rank <= D; ++rank) {
    double longest = 0;
    std::uint32_t best = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      const double* r = &rest_[std::size_t{i} * D];
      double square = 0;
      for (unsigned j = 0; j < D; ++j) {
        const double x = rank == 1 ? r[j] - base[j] : r[j];
        square += x * x;
      }
      if (square > longest) {
        longest = square;
        best = i;
      }
    }
    if (!(longest > 0)) return false;
    simplex[rank] = best;
    if (rank == D) break;
    double q[D];
    for (unsigned j = 0; j < D; ++j)
      q[j] = rest_[std::size_t{best} * D + j] - (rank == 1 ? base[j] : 0);
    for (std::uint32_t i = 0; i < count_; ++i) {
      double* r = &rest_[std::size_t{i} * D];
      double dot = 0;
      for (unsigned j = 0; j < D; ++j) {
        if (rank == 1) r[j] -= base[j];
        dot += r[j] * q[j];
      }
      for (unsigned j = 0; j < D; ++j) r[j] -= dot / longest * q[j];
    }
  }
  return true;
}

/// Makes the facets of the simplex. False where it is flat, or its centroid, rounded, is not
/// certainly inside.
template <unsigned D>
bool SmallSurfaceNd<D>::start(const std::uint32_t* simplex) {
  const double* corner[D + 1];
  for (unsigned i = 0; i <= D; ++i) corner[i] = row(simplex[i]);
  const Sign whole = orientation(D, corner);
  if (whole == Sign::zero) return false;
  for (unsigned j = 0; j < D; ++j) {
    centre_[j] = 0;
    for (unsigned i = 0; i <= D; ++i) centre_[j] += corner[i][j];
    centre_[j] /= D + 1;
  }
  measure_extent();
  planes_.clear();
  is_seen_.clear();
  open_bits_.clear();
  free_.clear();
  if (!grow(D + 1)) return false;
  const PlaneFrame frame{D, scaled_.data(), centre_, reach_};
  for (unsigned i = 0; i <= D; ++i) {
    std::uint32_t* v = &vertices_[std::size_t{i} * D];
    std::uint32_t* n = &neighbours_[std::size_t{i} * D];
    for (unsigned k = 0, at = 0; k <= D; ++k) {
      if (k == i) continue;
      v[at] = simplex[k];
      n[at++] = k;
    }
    // Moving corner i behind the others takes D - i exchanges.
    if ((whole == Sign::positive) == ((D - i) % 2 == 0)) {
      std::swap(v[0], v[1]);
      std::swap(n[0], n[1]);
    }
    const std::uint8_t first = 0;
    float plane[D + 1], y[D], gauge = 0;
    facet_planes(frame, v[0], v, &first, 1, plane);
    store_plane(i, plane);
    // The gauge of the corner off the facet: if the corner is certainly beneath the plane, it and
    // the centre are on the same side.
    aim(simplex[i], y);
    for (unsigned j = 0; j < D; ++j) gauge += plane[j] * y[j];
    if (!(gauge < 1 - plane[D])) return false;
  }
  return true;
}

template <unsigned D>
void SmallSurfaceNd<D>::measure_extent() {
  double low[D], high[D];
  std::copy_n(row(0), D, low);
  std::copy_n(row(0), D, high);
  for (std::uint32_t i = 1; i < count_; ++i)
    for (unsigned j = 0; j < D; ++j) {
      low[j] = std::min(low[j], row(i)[j]);
      high[j] = std::max(high[j], row(i)[j]);
    }
  for (unsigned j = 0; j < D; ++j)
    reach_[j] = std::max(high[j] - centre_[j], centre_[j] - low[j]) * (1 + 0x1p-30) + 0x1p-40;
}

/// Lists the points off the simplex roughly by descending distance from their mean, so that few
/// inner points become temporary vertices: a counting sort into classes.
template <unsigned D>
void SmallSurfaceNd<D>::order_outermost_first(const std::uint32_t* simplex) {
  constexpr unsigned classes = 64;
  double mean[D] = {};
  for (std::uint32_t i = 0; i < count_; ++i)
    for (unsigned j = 0; j < D; ++j) mean[j] += row(i)[j];
  for (double& m : mean) m /= count_;
  distance_.resize(count_);
  float largest = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    float square = 0;
    for (unsigned j = 0; j < D; ++j) {
      const auto y = static_cast<float>(row(i)[j] - mean[j]);
      square += y * y;
    }
    distance_[i] = square;
    largest = std::max(largest, square);
  }
  const float factor = (classes - 0.5F) / largest;
  std::uint32_t place[classes + 1] = {};
  for (unsigned i = 0; i <= D; ++i) distance_[simplex[i]] = -1;
  const auto class_of = [&](std::uint32_t i) {
    return classes - 1 - static_cast<unsigned>(distance_[i] * factor);
  };
  for (std::uint32_t i = 0; i < count_; ++i)
    if (distance_[i] >= 0) ++place[class_of(i) + 1];
  for (unsigned k = 0; k < classes; ++k) place[k + 1] += place[k];
  order_.resize(count_ - D - 1);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (distance_[i] >= 0) order_[place[class_of(i)]++] = i;
}

template <unsigned D>
void SmallSurfaceNd<D>::aim(std::uint32_t point, float* y) const {
  for (unsigned j = 0; j < D; ++j) y[j] = static_cast<float>(row(point)[j] - centre_[j]);
}

/// Adds a point. False where the surface is given up.
template <unsigned D>
bool SmallSurfaceNd<D>::insert(std::uint32_t point) {
  bool any = false;
  if (!find_seen(point, any)) return false;
  if (!any) return true;
  find_horizon();
  const unsigned count = ridges_;
  new_vertices_.resize(std::size_t{count} * D);
  new_neighbours_.resize(std::size_t{count} * D);
  apex_.resize(count);
  for (unsigned k = 0; k < count; ++k) {
    const Ridge& ridge = horizon_[k];
    std::uint32_t* v = &new_vertices_[std::size_t{k} * D];
    std::copy_n(vertices(ridge.facet), D, v);
    v[ridge.slot] = point;
    apex_[k] = ridge.slot;
    neighbours_[std::size_t{ridge.facet} * D + ridge.slot] = k | is_new;
  }
  pairs_.find<D>(D, new_vertices_.data(), apex_.data(), count, new_neighbours_.data(),
                 [this](std::size_t k, unsigned i) { return turn(k, i); });
  return replace(point);
}

/// Lists the facets that the point sees. False where it lies in the plane of one.
template <unsigned D>
bool SmallSurfaceNd<D>::find_seen(std::uint32_t point, bool& any) {
  float y[D];
  aim(point, y);
  seen_.clear();
  any =
      seen_facets(D, planes_[0].entry[0], planes_.size(), y, seen_bits_.data(), open_bits_.data());
  if (!any) return true;
  for (unsigned first = 0; first < 2 * planes_.size(); first += 8) {
    std::uint64_t word;  // of 64 facets
    std::memcpy(&word, &open_bits_[first], sizeof word);
    const auto end = static_cast<unsigned>(std::min<std::size_t>(first + 8, 2 * planes_.size()));
    for (unsigned byte = first; word != 0 && byte < end; ++byte)
      for (unsigned bits = open_bits_[byte]; bits != 0; bits &= bits - 1) {
        const auto bit = static_cast<unsigned>(std::countr_zero(bits));
        const unsigned f = 8 * byte + bit;
        bool sees = (seen_bits_[byte] >> bit & 1) != 0;
        if (!sees && !sees_exactly(point, f, sees)) return false;
        if (sees) seen_.push_back(f);
      }
  }
  any = !seen_.empty();
  return true;
}

template <unsigned D>
bool SmallSurfaceNd<D>::sees_exactly(std::uint32_t point, unsigned f, bool& sees) {
  // Where points are closer than f32 tells, as in a cluster beside a large simplex, the engine,
  // which does not test all facets, asks for far fewer signs.
  if (++open_signs_ > most_open_signs * count_) return false;
  const double* corner[D + 1];
  for (unsigned j = 0; j < D; ++j) corner[j] = row(vertices(f)[j]);
  corner[D] = row(point);
  const Sign side = orientation(D, corner);
  sees = side == Sign::positive;
  return side != Sign::zero;
}

/// Lists the ridges between seen and other facets. Which neighbours are seen is unpredictable, so
/// no branch depends on it.
template <unsigned D>
void SmallSurfaceNd<D>::find_horizon() {
  horizon_.resize(std::max(horizon_.size(), seen_.size() * D + 1));
  for (const std::uint32_t f : seen_) is_seen_[f] = 1;
  Ridge* const list = horizon_.data();
  ridges_ = 0;
  for (const std::uint32_t f : seen_)
    for (unsigned j = 0; j < D; ++j) {
      const std::uint32_t other = neighbours(f)[j];
      list[ridges_] = {f, other, static_cast<std::uint8_t>(j), 0};
      ridges_ += 1U - is_seen_[other];
    }
  for (const std::uint32_t f : seen_) is_seen_[f] = 0;
  for (unsigned k = 0; k < ridges_; ++k)
    list[k].back =
        static_cast<std::uint8_t>(index_of<D>(neighbours(list[k].outside), list[k].facet));
}

/// The new facet across the ridge of new facet k opposite to vertex i: rotates, through seen
/// facets, about the face that the horizon ridge of k spans without vertex i, until the next
/// horizon ridge.
template <unsigned D>
std::uint32_t SmallSurfaceNd<D>::turn(std::size_t k, unsigned i) const {
  std::uint32_t at = horizon_[k].facet, kept = vertices(at)[horizon_[k].slot];
  for (unsigned exit = i;;) {
    const std::uint32_t next = neighbours(at)[exit];
    if ((next & is_new) != 0) return next & ~is_new;
    exit = index_of<D>(vertices(next), kept);
    kept = vertices(next)[index_of<D>(neighbours(next), at)];
    at = next;
  }
}

/// Puts the new facets into the slots of the seen ones, free slots and new slots.
template <unsigned D>
bool SmallSurfaceNd<D>::replace(std::uint32_t point) {
  const std::size_t count = ridges_;
  new_planes_.resize(count * (D + 1));
  const PlaneFrame frame{D, scaled_.data(), centre_, reach_};
  facet_planes(frame, point, new_vertices_.data(), apex_.data(), count, new_planes_.data());
  while (seen_.size() > count) {
    neighbours_[std::size_t{seen_.back()} * D] = no_index;
    clear_plane(seen_.back());
    free_.push_back(seen_.back());
    seen_.pop_back();
  }
  while (seen_.size() < count && !free_.empty()) {
    seen_.push_back(free_.back());
    free_.pop_back();
  }
  const unsigned more = static_cast<unsigned>(count - seen_.size()), first = slots_;
  if (!grow(slots_ + more)) return false;
  for (unsigned i = 0; i < more; ++i) seen_.push_back(first + i);
  for (std::size_t k = 0; k < count; ++k) {
    const Ridge& ridge = horizon_[k];
    const std::uint32_t f = seen_[k];
    store_plane(f, &new_planes_[k * (D + 1)]);
    std::copy_n(&new_vertices_[k * D], D, &vertices_[std::size_t{f} * D]);
    std::uint32_t* n = &neighbours_[std::size_t{f} * D];
    for (unsigned i = 0; i < D; ++i)
      n[i] = i == ridge.slot ? ridge.outside : seen_[new_neighbours_[k * D + i]];
    neighbours_[std::size_t{ridge.outside} * D + ridge.back] = f;
  }
  return true;
}

template <unsigned D>
void SmallSurfaceNd<D>::store_plane(unsigned f, const float* plane) {
  for (unsigned j = 0; j <= D; ++j)
    planes_[f / PlaneGroup<D>::size].entry[j][f % PlaneGroup<D>::size] = plane[j];
}

/// No point sees the plane of a slot without a facet.
template <unsigned D>
void SmallSurfaceNd<D>::clear_plane(unsigned f) {
  for (unsigned j = 0; j <= D; ++j)
    planes_[f / PlaneGroup<D>::size].entry[j][f % PlaneGroup<D>::size] = 0;
}

/// Makes room for as many slots. False where they are too many.
template <unsigned D>
bool SmallSurfaceNd<D>::grow(unsigned slots) {
  if (slots > most_facets) return false;
  slots_ = slots;
  const std::size_t groups = (slots + PlaneGroup<D>::size - 1) / PlaneGroup<D>::size;
  vertices_.resize(std::size_t{slots} * D);
  neighbours_.resize(std::size_t{slots} * D);
  planes_.resize(groups);
  is_seen_.resize(slots, 0);
  seen_bits_.resize(2 * groups + seen_room);
  open_bits_.resize((2 * groups + 7) / 8 * 8 + seen_room, 0);
  return true;
}

template class SmallSurfaceNd<4>;
template class SmallSurfaceNd<5>;
template class SmallSurfaceNd<6>;
template class SmallSurfaceNd<7>;
template class SmallSurfaceNd<8>;

}  // namespace cullhull::internal
