// How the surface is divided into pieces for the threads of a round: along the curve of the
// insertion order, or, where that would cut many long facets, by parallel planes.
#include <algorithm>
#include <cmath>

#include "hull/space/engine_3d.hpp"
#include "parallel/random_stream.hpp"

namespace cullhull::internal {
namespace {

/// Eigenvectors (rows) of a symmetric matrix by Jacobi's rotations; approximations suffice.
void eigenvectors(double (&m)[3][3], double (&vectors)[3][3]) {
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) vectors[i][j] = i == j;
  for (unsigned sweep = 0; sweep < 8; ++sweep)
    for (unsigned p = 0; p < 2; ++p)
      for (unsigned q = p + 1; q < 3; ++q) {
        if (!(std::abs(m[p][q]) > 1e-12 * (std::abs(m[p][p]) + std::abs(m[q][q])))) continue;
        const double theta = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
        const double c = std::cos(theta), s = std::sin(theta);
        for (unsigned k = 0; k < 3; ++k) {  // columns, then rows
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b;
          m[k][q] = s * a + c * b;
        }
        for (unsigned k = 0; k < 3; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b;
          m[q][k] = s * a + c * b;
          const double v = vectors[p][k], w = vectors[q][k];
          vectors[p][k] = c * v - s * w;
          vectors[q][k] = s * v + c * w;
        }
      }
}

template <class T>
std::uint32_t place(const std::vector<T>& borders, T v) {
  return static_cast<std::uint32_t>(std::upper_bound(borders.begin(), borders.end(), v) -
                                    borders.begin());
}

/// Borders between `count` parts of about the same size: the middles of the widest gaps between the
/// values in reach of a quarter of a part.
template <class T>
std::vector<T> in_gaps(std::vector<T>& values, std::size_t count) {
  std::sort(values.begin(), values.end());
  const auto at = [&](std::size_t quarters) {
    return std::clamp<std::size_t>(values.size() * quarters / (4 * count), 1, values.size() - 1);
  };
  std::vector<T> borders;
  for (std::size_t t = 1; t < count; ++t) {
    std::size_t best = at(4 * t - 1);
    for (std::size_t i = best; i <= at(4 * t + 1); ++i)
      if (values[i] - values[i - 1] > values[best] - values[best - 1]) best = i;
    borders.push_back(values[best] - (values[best] - values[best - 1]) / 2);
  }
  std::sort(borders.begin(), borders.end());
  return borders;
}

/// Keys of up to `room` facets.
template <std::uint32_t room, class At>
void facet_keys(const Cut3D& cut, const Shared3D& shared, std::uint32_t count, const At& at,
                std::uint32_t* out) {
  double x[3][room] = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    double m[3];
    if (cut.by_normals)
      std::copy_n(at(i).normal, 3, m);
    else
      shared.middle(at(i), m);
    for (unsigned j = 0; j < 3; ++j) x[j][i] = m[j];
  }
  cut.key.keys(x[0], x[1], x[2], cut.bits, out, count);
}

}  // namespace

std::uint32_t Cut3D::piece_of(const double* p) const {
  return place(levels, axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
}

std::uint32_t Cut3D::piece_of_key(std::uint32_t k) const { return place(keys, k); }

std::uint32_t Cut3D::piece_of(const Shared3D& shared, const Facet3D& facet) const {
  if (planes()) {
    double m[3];
    shared.middle(facet, m);
    return piece_of(m);
  }
  std::uint32_t out[16];
  facet_keys<16>(
      *this, shared, 1, [&](std::uint32_t) -> const Facet3D& { return facet; }, out);
  return place(keys, out[0]);
}

void Cut3D::keys_of(const Shared3D& shared, const Waiting3D* waiting, std::uint32_t count,
                    std::uint32_t* out) const {
  std::uint32_t padded[DirectionKey::block];
  facet_keys<DirectionKey::block>(
      *this, shared, count,
      [&](std::uint32_t i) -> const Facet3D& { return shared.facets[waiting[i].facet]; }, padded);
  std::copy_n(padded, count, out);
}

/// Cuts along the curve of directions or of normals: a piece begins at the key of its first point.
Cut3D Engine3D::cut_along_curve(const std::vector<Work>& work) const {
  Cut3D cut;
  cut.key = by_normals_ ? normal_key_ : key_;
  cut.bits = order_.key_bits;
  cut.by_normals = by_normals_;
  cut.keys.resize(work.size() - 1);
  const Id start = live_facet();
  run_.each_item(cut.keys.size(), [&](std::uint64_t t) {
    const double* p = shared_.row(work[t + 1].begin);
    cut.keys[t] = by_normals_ ? rank_[climb(shared_, start, start, p)] : key_of(p);
  });
  return cut;
}

std::uint32_t Engine3D::key_of(const double* p) const {
  constexpr std::uint32_t block = DirectionKey::block;
  double x[3][block] = {};
  std::uint32_t keys[block];
  for (unsigned j = 0; j < 3; ++j) x[j][0] = p[j];
  key_.keys(x[0], x[1], x[2], order_.key_bits, keys);
  return keys[0];
}

/// The share of sampled facets that the cut would divide between pieces: those whose corners are
/// not all in the piece of their centroid.
double Engine3D::share_cut(const Cut3D& cut, const std::vector<Id>& sample) const {
  constexpr std::size_t together = DirectionKey::block / 4;  // positions of each: corners, middle
  std::size_t between = 0;
  for (std::size_t first = 0; first < sample.size(); first += together) {
    const std::size_t count = std::min(together, sample.size() - first);
    double x[3][DirectionKey::block] = {};
    Id piece[DirectionKey::block];
    for (std::size_t i = 0; i < count; ++i) {
      const Facet3D& facet = facets_[sample[first + i]];
      for (unsigned k = 0; k < 4; ++k) {
        double m[3];
        if (k == 3) shared_.middle(facet, m);
        const double* p = k < 3 ? shared_.row(facet.vertices[k]) : m;
        for (unsigned j = 0; j < 3; ++j) x[j][4 * i + k] = p[j];
        if (cut.planes())
          piece[4 * i + k] = cut.piece_of(p);
        else if (by_normals_)
          piece[4 * i + k] =
              place(cut.keys, rank_[k < 3 ? facet.neighbours[k] : sample[first + i]]);
      }
    }
    if (!cut.planes() && !by_normals_) {
      key_.keys(x[0], x[1], x[2], order_.key_bits, piece);
      for (Id& k : piece) k = place(cut.keys, k);
    }
    for (std::size_t i = 0; i < count; ++i)
      between += !std::equal(piece + 4 * i + 1, piece + 4 * i + 4, piece + 4 * i);
  }
  return static_cast<double>(between) / static_cast<double>(sample.size());
}

std::vector<Engine3D::Id> Engine3D::sample_facets() const {
  // 1024 facets: a share is estimated within 2 % (a standard deviation of 1.6 % at most).
  constexpr std::size_t wanted = 1024;
  std::vector<Id> sample;
  XorShift random;
  for (std::size_t tries = 0; tries < 16 * wanted && sample.size() < wanted; ++tries) {
    const auto f = random.below(slots_);
    if (in_use(f) && facets_[f].live()) sample.push_back(f);
  }
  if (sample.empty()) sample.push_back(live_facet());
  return sample;
}

/// Planes orthogonal to `axis` that divide the points of [begin, end) into equal parts; no planes
/// where a part would get over 5/4 of its share because many points lie on one plane.
Cut3D Engine3D::cut_by_planes(const double* axis, Id begin, Id end, std::size_t count) const {
  Cut3D cut;
  std::copy_n(axis, 3, cut.axis);
  std::vector<double> along;
  const Id step = std::max<Id>(1, (end - begin) / 4096);
  for (std::uint64_t i = begin; i < end; i += step) {
    const double* p = shared_.row(static_cast<Id>(i));
    along.push_back(axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
  }
  std::sort(along.begin(), along.end());
  for (std::size_t t = 1; t < count; ++t) cut.levels.push_back(along[along.size() * t / count]);
  std::size_t before = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const std::size_t upto =
        t + 1 < count
            ? static_cast<std::size_t>(std::lower_bound(along.begin(), along.end(), cut.levels[t]) -
                                       along.begin())
            : along.size();
    if (4 * (upto - before) * count > 5 * along.size()) return {};
    before = upto;
  }
  return cut;
}

/// Replaces `best` by planes(axis) where share(planes) is the least, and below `least`: orthogonal
/// to the main axes of the facets' edges (after the map that makes the points round) and to the
/// coordinate axes.
template <class Planes, class Share>
void Engine3D::try_planes(const std::vector<Id>& sample, double least, const Planes& planes,
                          const Share& share, Cut3D& best) const {
  const auto& linear = key_.map().linear;
  double moments[3][3] = {}, main_axes[3][3];
  for (const Id f : sample)
    for (unsigned k = 0; k < 3; ++k) {
      const double* a = shared_.row(facets_[f].vertices[k]);
      const double* b = shared_.row(facets_[f].vertices[(k + 1) % 3]);
      double e[3], square = 0;
      for (unsigned i = 0; i < 3; ++i) {
        e[i] = 0;
        for (unsigned j = 0; j < 3; ++j) e[i] += linear[i][j] * (b[j] - a[j]);
        square += e[i] * e[i];
      }
      if (!(square > 0)) continue;
      for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = 0; j < 3; ++j) moments[i][j] += e[i] * e[j] / std::sqrt(square);
    }
  eigenvectors(moments, main_axes);
  for (unsigned k = 0; k < 6; ++k) {
    double axis[3] = {};
    for (unsigned j = 0; j < 3; ++j)
      for (unsigned i = 0; i < 3; ++i)
        axis[j] += k < 3 ? main_axes[k][i] * linear[i][j] : (i == k - 3 && i == j ? 1 : 0);
    Cut3D cut = planes(axis);
    if (!cut.planes()) continue;
    const double s = share(cut);
    if (!(s < least)) continue;
    least = s;
    best.levels = std::move(cut.levels);
    std::copy_n(axis, 3, best.axis);
  }
}

/// Chooses the cut that divides the fewest facets. Facets as long as the body, as on cylinders or
/// between two polygons, should lie along the cut, not across it. So, besides the curve, tries
/// planes orthogonal to the main axes of the facets' edges (after the map that makes the points
/// round) and to the coordinate axes.
Cut3D Engine3D::choose_cut(const std::vector<Work>& work) const {
  Cut3D best = cut_along_curve(work);
  const std::vector<Id> sample = sample_facets();
  double least = share_cut(best, sample);
  // A round piece has about 6 sqrt(F / pieces) of all F facets at its border: where the curve
  // divides no more, planes would not do better, and trying them takes two milliseconds.
  const double round =
      6 * std::sqrt(static_cast<double>(work.size()) / static_cast<double>(slots_));
  if (least <= std::max(1.0 / 32, round)) return best;

  // Halved, because planes require reordering the points.
  try_planes(
      sample, least / 2,
      [&](const double* axis) {
    return cut_by_planes(axis, work.front().begin, work.back().end, work.size());
      },
      [&](const Cut3D& cut) { return share_cut(cut, sample); }, best);
  return best;
}

/// Chooses borders for points that wait at others: along the turned curve or, where these would be
/// beside many of the points' facets, by planes. Borders lie in gaps between the points, which are
/// wide where facets are slivers and points wait in as many stripes as there were borders.
void Engine3D::choose_next_cut(const Array<Waiting3D>& left, const Id* keys, std::size_t count) {
  const std::size_t step = 1 + left.size() / (64 * count), few = 1 + left.size() / 256;
  std::vector<Id> along, sample;
  for (std::size_t i = 0; i < left.size(); i += step) along.push_back(keys[i]);
  for (std::size_t i = 0; i < left.size(); i += few) sample.push_back(left[i].facet);
  cut_.keys = in_gaps(along, count);
  if (!by_normals_) return;
  const auto share = [&](const Cut3D& cut) {
    std::size_t beside = 0;
    for (const Id f : sample) {
      const Id piece = cut.piece_of(shared_, facets_[f]);
      const auto other = [&](Id g) { return cut.piece_of(shared_, facets_[g]) != piece; };
      const Id* n = facets_[f].neighbours;
      beside += std::any_of(n, n + 3, [&](Id g) {
        const Id* m = facets_[g].neighbours;
        return other(g) || std::any_of(m, m + 3, other);
      });
    }
    return static_cast<double>(beside) / static_cast<double>(sample.size());
  };
  // Where normals order the points, a border along the rim of a cylinder would be one after every
  // turn: cap and lateral surface are far apart by their normals.
  const double least = share(cut_);
  if (least <= 0.25) return;
  try_planes(
      sample, least,
      [&](const double* axis) {
    Cut3D cut;
    std::copy_n(axis, 3, cut.axis);
    std::vector<double> places;
    for (std::size_t i = 0; i < left.size(); i += step) {
      double m[3];
      shared_.middle(facets_[left[i].facet], m);
      places.push_back(axis[0] * m[0] + axis[1] * m[1] + axis[2] * m[2]);
    }
    cut.levels = in_gaps(places, count);
    return cut;
      },
      share, cut_);
}

}  // namespace cullhull::internal
