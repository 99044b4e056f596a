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

}  // namespace

std::uint32_t Cut3D::piece_of(const double* p) const {
  return place(levels, axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
}

void Engine3D::middle(const Facet3D& f, double* out) const {
  for (unsigned j = 0; j < 3; ++j)
    out[j] = (shared_.row(f.vertices[0])[j] + shared_.row(f.vertices[1])[j] +
              shared_.row(f.vertices[2])[j]) /
             3;
}

/// Cuts along the curve of directions or of normals: a piece begins at the key of its first point.
Cut3D Engine3D::cut_along_curve(const std::vector<Work>& work) const {
  Cut3D cut;
  for (std::size_t t = 1; t < work.size(); ++t) {
    const double* p = shared_.row(work[t].begin);
    cut.keys.push_back(by_normals_ ? rank_[climb(shared_, live_facet(), p)] : key_of(p));
  }
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
        if (k == 3) middle(facet, m);
        const double* p = k < 3 ? shared_.row(facet.vertices[k]) : m;
        for (unsigned j = 0; j < 3; ++j) x[j][4 * i + k] = p[j];
        if (cut.planes()) piece[4 * i + k] = cut.piece_of(p);
        if (by_normals_)
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
  least /= 2;  // halved, because planes require reordering the points
  for (unsigned k = 0; k < 6; ++k) {
    double axis[3] = {};
    for (unsigned j = 0; j < 3; ++j)
      for (unsigned i = 0; i < 3; ++i)
        axis[j] += k < 3 ? main_axes[k][i] * linear[i][j] : (i == k - 3 && i == j ? 1 : 0);
    Cut3D cut = cut_by_planes(axis, work.front().begin, work.back().end, work.size());
    if (!cut.planes()) continue;
    const double share = share_cut(cut, sample);
    if (!(share < least)) continue;
    least = share;
    best = std::move(cut);
  }
  return best;
}

}  // namespace cullhull::internal
