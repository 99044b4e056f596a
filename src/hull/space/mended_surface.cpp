// Makes the hull of a surface whose points have moved: concave ridges are flipped until none is
// left, then the points that are not on the surface are inserted as the engine inserts them.
//
// Example: a frame of 8,364 triangles, of which 1,100 are not those of the frame before, in some
// 600 flips; of 4,500 points 330 were no vertices.
#include <algorithm>
#include <limits>
#include <vector>

#include "hull/space/order_3d.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;
constexpr Id none = Facet3D::none;

constexpr unsigned after(unsigned k) { return k == 2 ? 0 : k + 1; }
constexpr unsigned before(unsigned k) { return k == 0 ? 2 : k - 1; }
constexpr unsigned place_of(Id x, const Id (&three)[3]) {
  return three[0] == x ? 0 : three[1] == x ? 1 : 2;
}
constexpr void set(Id (&three)[3], Id a, Id b, Id c) { three[0] = a, three[1] = b, three[2] = c; }

/// The ridge opposite to corner k of a facet.
struct Side {
  Id facet;
  unsigned k;
};

// Exactness rests on the exact sign of each ridge and on the insertion. Flips need no proof: they
// keep each triangle certainly seen from beneath from O, so the surface goes on covering each
// direction once, and a vertex that they remove is inserted again, if it is outside.

class Mender {
 public:
  Mender(TriangleMesh& surface, const LocalPoints& points, const Id* simplex, const Run& run)
      : surface_(surface),
        key_(points, surface.predicates->centre(), simplex),
        run_(run),
        facets_(surface.facets.data()) {
    shared_.predicates = &*surface.predicates;
    shared_.control = &run.control;
    shared_.order = surface.order.get();
    shared_.rows = surface.rows.get();
    shared_.facets = facets_;
  }

  /// False where too much has changed, or flips do not end.
  bool run() {
    if (!find_concave() || !flip_all()) return false;
    insert_others();
    return true;
  }

 private:
  bool find_concave() {
    struct Found {
      std::vector<Side> concave;
      RungCounts rungs;
      bool certain = true;
    };
    constexpr std::uint64_t grain = 512;
    std::vector<Found> found(chunk_count(surface_.live, grain));
    run_.each_chunk(surface_.live, grain,
                    [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      Found& here = found[c];
      compute_planes(shared_, facets_ + begin, static_cast<Id>(end - begin));
      for (auto f = static_cast<Id>(begin); f < end; ++f) {
        here.certain = here.certain && is_certain(facets_[f]);
        for (unsigned k = 0; k < 3; ++k)
          if (facets_[f].neighbours[k] > f && concave(f, k, here.rungs))
            here.concave.push_back({f, k});
      }
    });
    for (const Found& f : found) {
      if (!f.certain) return false;
      waiting_.insert(waiting_.end(), f.concave.begin(), f.concave.end());
      piece_.rungs += f.rungs;
    }
    const std::uint64_t others = surface_.count - (surface_.live / 2 + 2);
    return worth_mending(others + waiting_.size(), surface_.count, run_);
  }

  /// Whether O is certainly beneath the facet.
  static bool is_certain(const Facet3D& f) {
    return f.error < std::numeric_limits<double>::infinity();
  }

  /// Exactly; reads the plane of f alone.
  bool concave(Id f, unsigned k, RungCounts& rungs) const {
    const Facet3D& facet = facets_[f];
    const Id g = facet.neighbours[k], p = facets_[g].vertices[corner_beyond(g, f)];
    const double *const centre = shared_.predicates->centre(), *const row = shared_.row(p);
    double gauge = 0;
    for (unsigned j = 0; j < 3; ++j) gauge += facet.normal[j] * (row[j] - centre[j]);
    if (gauge > 1 + facet.error) return true;
    if (gauge < 1 - facet.error) return false;
    const auto point = [&](Id v) { return Orientation3D::Point{shared_.row(v), shared_.order[v]}; };
    const Id* v = facet.vertices;
    return shared_.predicates->side(point(v[0]), point(v[1]), point(v[2]), point(p), rungs) ==
           Sign::positive;
  }
  /// The corner of g that is opposite to f.
  unsigned corner_beyond(Id g, Id f) const { return place_of(f, facets_[g].neighbours); }

  bool flip_all() {
    std::uint64_t left = 8 * surface_.live;
    while (!waiting_.empty()) {
      if (--left % 1024 == 0) run_.check();
      if (left == 0) return false;
      const auto [f, k] = waiting_.back();
      waiting_.pop_back();
      if (!facets_[f].live() || !concave(f, k, piece_.rungs)) continue;
      const Id inside = flip(f, k);
      if (inside != none && !remove(inside, f)) return false;
    }
    return true;
  }

  /// The neighbour g of `old` is now one of f.
  void relink(Id g, Id old, Id f) { facets_[g].neighbours[corner_beyond(g, old)] = f; }

  /// Replaces the ridge a b, opposite to corner c of f, by c d. Returns `none`; or, having changed
  /// nothing, the end that is within the triangle of the three others, seen from O.
  Id flip(Id f, unsigned k) {
    const Facet3D x = facets_[f];
    const Id g = x.neighbours[k];
    const Facet3D y = facets_[g];
    const unsigned m = corner_beyond(g, f);
    const Id c = x.vertices[k], a = x.vertices[after(k)], b = x.vertices[before(k)],
             d = y.vertices[m];
    Facet3D made[2] = {};
    set(made[0].vertices, c, a, d);
    set(made[1].vertices, c, d, b);
    compute_planes(shared_, made, 2);
    if (!is_certain(made[0])) return a;
    if (!is_certain(made[1])) return b;
    const Id bc = x.neighbours[after(k)], ca = x.neighbours[before(k)], ad = y.neighbours[after(m)],
             db = y.neighbours[before(m)];
    relink(ad, g, f);
    relink(bc, f, g);
    set(made[0].neighbours, ad, g, ca);
    set(made[1].neighbours, db, bc, f);
    facets_[f] = made[0];
    facets_[g] = made[1];
    waiting_.insert(waiting_.end(), {{f, 0}, {f, 1}, {f, 2}, {g, 0}, {g, 1}});
    return none;
  }

  /// Removes the vertex v, which f has: flips its ridges until it has three triangles, which become
  /// one. False if that cannot be done.
  bool remove(Id v, Id f) {
    for (Id start = f;;) {
      const unsigned k =
          after(place_of(v, facets_[f].vertices));  // v ends the ridge opposite to it
      const Id g = facets_[f].neighbours[k], h = facets_[f].neighbours[after(k)];
      const unsigned m = corner_beyond(g, f);
      if (facets_[g].neighbours[before(m)] == h) return join_three(v, f, g, h);
      const bool flipped = flip(f, k) == none;
      f = g;  // which has v still
      if (flipped)
        start = f;
      else if (f == start)
        return false;
    }
  }
  /// The facets in their order around v.
  bool join_three(Id v, Id f, Id g, Id h) {
    const Id three[3] = {f, g, h};
    Id corner[3], outer[3];
    for (unsigned j = 0; j < 3; ++j) {
      const Facet3D& t = facets_[three[j]];
      const unsigned k = place_of(v, t.vertices);
      corner[j] = t.vertices[after(k)];
      outer[j] = t.neighbours[k];
    }
    Facet3D joined = {};
    set(joined.vertices, corner[0], corner[1], corner[2]);
    compute_planes(shared_, &joined, 1);
    if (!is_certain(joined)) return false;
    set(joined.neighbours, outer[1], outer[2], outer[0]);
    relink(outer[1], g, f);
    relink(outer[2], h, f);
    facets_[f] = joined;
    for (const Id gone : {g, h}) {
      facets_[gone].owner = none;
      piece_.free.push_back(gone);
    }
    removed_.push_back({v, f});
    waiting_.insert(waiting_.end(), {{f, 0}, {f, 1}, {f, 2}});
    return true;
  }

  /// Inserts what is not on the surface, and takes over what that leaves.
  void insert_others() {
    const auto slots = static_cast<Id>(surface_.live), vertices = slots / 2 + 2;
    Id live = 0;
    while (!facets_[live].live()) ++live;
    const std::size_t gone = removed_.size();
    const std::vector<Id> others = along_curve(vertices);
    removed_.resize(gone + others.size());
    run_.each(others.size(), 128, [&](std::uint64_t begin, std::uint64_t end) {
      Id f = live;
      for (std::uint64_t i = begin; i < end; ++i) {
        f = climb(shared_, f, live, shared_.row(others[i]));
        removed_[gone + i] = {others[i], f};
      }
    });
    piece_.owner_count = none;  // all facets
    piece_.hint = live;
    piece_.spare = {{slots, static_cast<Id>(surface_.facets.capacity())}};
    insert_points(shared_, piece_, removed_.data(), 0, static_cast<Id>(removed_.size()), nullptr);
    const Id end = piece_.spare.empty() ? piece_.next_slot : slots;
    surface_.used = {{0, end}};
    surface_.live = end - piece_.free.size();
    surface_.duplicates = std::move(piece_.duplicates);
    surface_.rung_counts = piece_.rungs;
  }

  /// The points from `first` on, in an order in which the walks from one to the next are short.
  std::vector<Id> along_curve(Id first) const {
    constexpr unsigned bits = 6;
    constexpr Id block = DirectionKey::block;
    const Id count = surface_.count - first;
    std::vector<KeyedId> memory(2 * std::size_t{count});
    KeyedId *keyed = memory.data(), *scratch = memory.data() + count;
    run_.each(count, 16 * block, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t at = begin; at < end; at += block) {
        const auto some = static_cast<Id>(std::min<std::uint64_t>(block, end - at));
        double x[3][block] = {};
        Id keys[block];
        for (Id i = 0; i < some; ++i)
          for (unsigned j = 0; j < 3; ++j)
            x[j][i] = shared_.row(first + static_cast<Id>(at) + i)[j];
        key_.keys(x[0], x[1], x[2], bits, keys, some);
        for (Id i = 0; i < some; ++i) keyed[at + i] = {keys[i], first + static_cast<Id>(at) + i};
      }
    });
    radix_sort(keyed, scratch, count, 2 * bits + 3, run_);
    std::vector<Id> order(count);
    for (Id i = 0; i < count; ++i) order[i] = keyed[i].id;
    return order;
  }

  TriangleMesh& surface_;
  const DirectionKey key_;
  const Run& run_;
  Facet3D* const facets_;
  Shared3D shared_;
  Piece3D piece_;
  std::vector<Side> waiting_;
  std::vector<Waiting3D> removed_;
};

}  // namespace

bool mend_surface(TriangleMesh& surface, const LocalPoints& points, const std::uint32_t* simplex,
                  const Run& run) {
  return Mender(surface, points, simplex, run).run();
}

}  // namespace cullhull::internal
