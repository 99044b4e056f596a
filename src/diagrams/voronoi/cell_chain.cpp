#include "diagrams/voronoi/cell_chain.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

#include "exact/numbers/gmpxx.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

Sign turn(const RingPoint& a, const RingPoint& b, const RingPoint& c) {
  const double* const p[] = {a.data(), b.data(), c.data()};
  return orientation(2, p);
}

/// Twice the signed area of the triangle a b c.
mpq_class twice_area(const RingPoint& a, const RingPoint& b, const RingPoint& c) {
  const mpq_class x(a[0]), y(a[1]);
  return (mpq_class(b[0]) - x) * (mpq_class(c[1]) - y) -
         (mpq_class(b[1]) - y) * (mpq_class(c[0]) - x);
}
mpq_class squared_length(const RingPoint& a, const RingPoint& b) {
  const mpq_class x = mpq_class(b[0]) - mpq_class(a[0]), y = mpq_class(b[1]) - mpq_class(a[1]);
  return x * x + y * y;
}

/// Sweeps a line over the edges, from left to right and in columns from below. Finds the first edge
/// that another one crosses or touches; without one, how often the chain turns around the points
/// beside each edge.
class ChainSweep {
 public:
  explicit ChainSweep(const CellChain& chain) : segments_(chain.size()) {
    for (std::uint32_t e = 0; e < chain.size(); ++e) {
      const bool forward = chain[e].from < chain[e].to;
      segments_[e] = {forward ? &chain[e].from : &chain[e].to,
                      forward ? &chain[e].to : &chain[e].from, forward, 0};
      events_.push_back({segments_[e].low, e});
      events_.push_back({segments_[e].high, no_index});
    }
    std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
      return *a.at != *b.at ? *a.at < *b.at : a.starts < b.starts;
    });
  }

  ChainMend run() {
    for (std::size_t i = 0, next = 0; i < events_.size(); i = next) {
      while (next < events_.size() && *events_[next].at == *events_[i].at) ++next;
      const ChainMend mend = pass(i, next);
      if (mend.kind != ChainMend::Kind::none) return mend;
    }
    return {};
  }

  /// The number of turns around the points to the left of an edge.
  int left(std::uint32_t e) const {
    return segments_[e].forward ? segments_[e].above : segments_[e].above + 1;
  }
  bool turns_once() const {
    for (std::uint32_t e = 0; e < segments_.size(); ++e)
      if (left(e) != 1) return false;
    return true;
  }
  /// Pairs of edges with the same part of the cell's inside between them.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& beside() const { return beside_; }
  bool touches() const { return touches_; }

 private:
  struct Segment {
    const RingPoint *low, *high;  ///< the end that the line reaches first, and the other one
    bool forward;                 ///< whether the edge runs from low to high
    int above;                    ///< turns around the points above it
  };
  struct Event {
    const RingPoint* at;
    std::uint32_t starts;  ///< the segment that starts here; no_index: one ends
  };

  Sign side(std::uint32_t segment, const RingPoint& x) const {
    const Segment& s = segments_[segment];
    return x == *s.high || x == *s.low ? Sign::zero : turn(*s.low, *s.high, x);
  }

  static ChainMend through(const Segment& s, const RingPoint& via) {
    return {ChainMend::Kind::through, *s.low, *s.high, via};
  }

  ChainMend pass(std::size_t begin, std::size_t end) {
    const RingPoint& x = *events_[begin].at;
    const auto first = std::partition_point(line_.begin(), line_.end(),
                                            [&](auto s) { return side(s, x) == Sign::positive; });
    const auto last =
        std::partition_point(first, line_.end(), [&](auto s) { return side(s, x) == Sign::zero; });
    for (auto s = first; s != last; ++s)
      if (*segments_[*s].high != x) return through(segments_[*s], x);
    starting_.clear();
    for (std::size_t i = begin; i < end; ++i)
      if (events_[i].starts != no_index) starting_.push_back(events_[i].starts);
    touches_ = touches_ || end - begin > 2;
    // Few edges start at a point, so that each is compared with each.
    for (const std::uint32_t a : starting_)
      for (const std::uint32_t b : starting_) {
        const Segment &s = segments_[a], &t = segments_[b];
        if (*s.high < *t.high && turn(x, *s.high, *t.high) == Sign::zero)
          return through(t, *s.high);
      }
    std::sort(starting_.begin(), starting_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const Sign sign = turn(x, *segments_[a].high, *segments_[b].high);
      return sign != Sign::zero ? sign == Sign::positive : a < b;
    });
    auto place = line_.erase(first, last);
    place = line_.insert(place, starting_.begin(), starting_.end());
    return connect(static_cast<std::size_t>(place - line_.begin()), starting_.size());
  }

  /// Counts the turns of the `count` segments inserted at a place of the line, and compares those
  /// that became neighbours there.
  ChainMend connect(std::size_t place, std::size_t count) {
    for (std::size_t i = place; i < place + count; ++i) {
      const int below = i > 0 ? segments_[line_[i - 1]].above : 0;
      segments_[line_[i]].above = below + (segments_[line_[i]].forward ? 1 : -1);
      if (i > 0 && below == 1) beside_.emplace_back(line_[i - 1], line_[i]);
    }
    const std::size_t next = place + count;
    if (place > 0 && place < line_.size() && cross(line_[place - 1], line_[place]))
      return mend_crossing(line_[place - 1], line_[place]);
    if (count > 0 && next < line_.size() && cross(line_[next - 1], line_[next]))
      return mend_crossing(line_[next - 1], line_[next]);
    return {};
  }

  /// Whether two segments cross in inner points of both.
  bool cross(std::uint32_t a, std::uint32_t b) const {
    const auto parted = [&](std::uint32_t s, std::uint32_t t) {
      const Sign low = side(s, *segments_[t].low);
      return low != Sign::zero && side(s, *segments_[t].high) == -low;
    };
    return parted(a, b) && parted(b, a);
  }

  /// The end nearest to the crossing, of the four, becomes a corner of the other segment. It is
  /// nearer to that segment than the end that rounding moved across it, and both new edges are
  /// shorter than the one that they replace.
  ChainMend mend_crossing(std::uint32_t a, std::uint32_t b) const {
    ChainMend best;
    mpq_class least;
    for (const auto& [s, t] : {std::pair(a, b), std::pair(b, a)}) {
      const Segment &of = segments_[s], &other = segments_[t];
      const mpq_class low = twice_area(*other.low, *other.high, *of.low),
                      high = twice_area(*other.low, *other.high, *of.high);
      const mpq_class share = low / (low - high), length = squared_length(*of.low, *of.high);
      for (const RingPoint* end : {of.low, of.high}) {
        const mpq_class part = end == of.low ? share : mpq_class(1 - share);
        const mpq_class distance = part * part * length;
        if (best.kind != ChainMend::Kind::none && distance >= least) continue;
        best = through(other, *end);
        least = distance;
      }
    }
    return best;
  }

  std::vector<Segment> segments_;
  std::vector<Event> events_;
  std::vector<std::uint32_t> line_, starting_;  ///< segments on the line, from below
  std::vector<std::pair<std::uint32_t, std::uint32_t>> beside_;
  bool touches_ = false;
};

/// Cuts edges into rings.
class RingWalk {
 public:
  /// `edges`: numbers of edges of the chain; at each point as many end as begin.
  RingWalk(const CellChain& chain, std::vector<std::uint32_t> edges)
      : chain_(chain), edges_(std::move(edges)), taken_(edges_.size()) {
    std::sort(edges_.begin(), edges_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return chain_[a].from != chain_[b].from ? chain_[a].from < chain_[b].from : a < b;
    });
  }

  /// Where several edges begin, a ring goes on with the first one from the way back:
  /// counterclockwise (`around_outside`) the rings of connected polygons touch themselves nowhere,
  /// clockwise each of their rings has one part of the inside on its left.
  std::vector<std::vector<std::uint32_t>> rings(bool around_outside) {
    std::vector<std::vector<std::uint32_t>> out;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (taken_[i]) continue;
      std::size_t at = i;
      out.emplace_back();
      do {
        out.back().push_back(edges_[at]);
        at = next(edges_[at], around_outside);
        taken_[at] = true;
      } while (at != i);
    }
    return out;
  }

 private:
  std::size_t next(std::uint32_t e, bool around_outside) const {
    const RingPoint &end = chain_[e].to, &back = chain_[e].from;
    const auto first = std::partition_point(edges_.begin(), edges_.end(),
                                            [&](std::uint32_t f) { return chain_[f].from < end; });
    std::size_t best = edges_.size();
    for (auto i = static_cast<std::size_t>(first - edges_.begin());
         i < edges_.size() && chain_[edges_[i]].from == end; ++i)
      if (!taken_[i] && (best == edges_.size() || before(end, back, chain_[edges_[i]].to,
                                                         chain_[edges_[best]].to, around_outside)))
        best = i;
    return best;
  }

  /// Whether a comes before b on the way around x from the direction of `back`.
  static bool before(const RingPoint& x, const RingPoint& back, const RingPoint& a,
                     const RingPoint& b, bool counterclockwise) {
    const Sign first = counterclockwise ? Sign::positive : Sign::negative;
    const auto part = [&](const RingPoint& y) {
      const Sign sign = turn(x, back, y);
      if (sign != Sign::zero) return sign == first ? 0 : 2;
      return (back < x) == (y < x) ? 3 : 1;
    };
    const int of_a = part(a), of_b = part(b);
    return of_a != of_b ? of_a < of_b : turn(x, a, b) == first;
  }

  const CellChain& chain_;
  std::vector<std::uint32_t> edges_;
  std::vector<bool> taken_;
};

mpq_class twice_area(const CellChain& chain, const std::vector<std::uint32_t>& ring) {
  mpq_class sum = 0;
  for (const std::uint32_t e : ring) {
    const auto &a = chain[e].from, &b = chain[e].to;
    sum += mpq_class(a[0]) * mpq_class(b[1]) - mpq_class(a[1]) * mpq_class(b[0]);
  }
  return sum;
}

std::vector<std::uint32_t> all_edges(const CellChain& chain) {
  std::vector<std::uint32_t> all(chain.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// Cuts a ring where it goes through a point again: calls body(ring) for rings that do not.
template <class Body>
void each_simple_ring(const CellChain& chain, const std::vector<std::uint32_t>& ring,
                      const Body& body) {
  std::vector<std::uint32_t> path;
  std::map<RingPoint, std::size_t> place;
  for (const std::uint32_t e : ring) {
    place[chain[e].from] = path.size();
    path.push_back(e);
    const auto again = place.find(chain[e].to);
    if (again == place.end()) continue;
    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(again->second);
    const std::vector<std::uint32_t> part(begin, path.end());
    body(part);
    for (const std::uint32_t f : part) place.erase(chain[f].from);
    path.resize(path.size() - part.size());
  }
}

/// Edges by length, of equal ones by their ends.
struct EdgeRank {
  mpq_class length;
  RingPoint low, high;
  EdgeRank(const RingPoint& a, const RingPoint& b)
      : length(squared_length(a, b)), low(std::min(a, b)), high(std::max(a, b)) {}
  bool operator<(const EdgeRank& o) const {
    return length != o.length ? length < o.length : std::pair(low, high) < std::pair(o.low, o.high);
  }
};

/// Shrinks a ring that rounding turned over: its longest edge goes through the nearest of its
/// corners from which both ends are nearer than they are to each other. A ring without such a
/// corner, a few units in the last place wide, loses its shortest edge.
ChainMend shrink(const CellChain& chain, const std::vector<std::uint32_t>& ring) {
  const auto rank = [&](std::uint32_t e) { return EdgeRank(chain[e].from, chain[e].to); };
  const auto [least, most] =
      std::minmax_element(ring.begin(), ring.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
  const RingPoint &a = chain[*most].from, &b = chain[*most].to;
  const EdgeRank longest(a, b);
  ChainMend best;
  mpq_class nearest;
  for (const std::uint32_t e : ring) {
    const RingPoint& x = chain[e].from;
    if (x == a || x == b || !(EdgeRank(a, x) < longest) || !(EdgeRank(x, b) < longest)) continue;
    const mpq_class distance = abs(twice_area(a, b, x));
    if (best.kind != ChainMend::Kind::none && distance >= nearest) continue;
    best = {ChainMend::Kind::through, a, b, x};
    nearest = distance;
  }
  if (best.kind != ChainMend::Kind::none) return best;
  const RingPoint &c = chain[*least].from, &d = chain[*least].to;
  return {ChainMend::Kind::merge, c, d, std::min(c, d)};
}

bool strictly_convex(const CellRing& ring) {
  const auto& p = ring.points;
  const std::size_t n = p.size();
  unsigned reversals = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto &a = p[i], &b = p[i + 1 < n ? i + 1 : 0], &c = p[(i + 2) % n];
    if (turn(a, b, c) != Sign::positive) return false;
    reversals += (a < b) != (b < c) ? 1 : 0;
  }
  return reversals == 2;
}

}  // namespace

CellChain chain_of(const std::vector<CellPolygon>& polygons) {
  CellChain chain;
  for (const CellPolygon& polygon : polygons)
    for (const CellRing& ring : polygon)
      for (std::size_t i = 0, n = ring.points.size(); i < n; ++i)
        chain.push_back({ring.points[i], ring.points[i + 1 < n ? i + 1 : 0], ring.across[i]});
  return chain;
}

void cancel_opposite(CellChain& chain) {
  const auto key = [](const ChainEdge& e) { return std::minmax(e.from, e.to); };
  std::stable_sort(chain.begin(), chain.end(),
                   [&](const ChainEdge& a, const ChainEdge& b) { return key(a) < key(b); });
  CellChain kept;
  for (std::size_t i = 0, next = 0; i < chain.size(); i = next) {
    std::ptrdiff_t forward = 0;
    for (; next < chain.size() && key(chain[next]) == key(chain[i]); ++next)
      forward += chain[next].from < chain[next].to ? 1 : -1;
    if (chain[i].from == chain[i].to) continue;
    for (std::size_t k = i; k < next && forward != 0; ++k) {
      if ((chain[k].from < chain[k].to) != (forward > 0)) continue;
      kept.push_back(chain[k]);
      forward += forward > 0 ? -1 : 1;
    }
  }
  chain = std::move(kept);
}

ChainMend next_mend(CellChain& chain) {
  cancel_opposite(chain);
  ChainSweep sweep(chain);
  const ChainMend mend = sweep.run();
  if (mend.kind != ChainMend::Kind::none || sweep.turns_once()) return mend;
  std::vector<std::uint32_t> least;
  mpq_class area;
  for (const auto& ring : RingWalk(chain, all_edges(chain)).rings(false))
    each_simple_ring(chain, ring, [&](const std::vector<std::uint32_t>& part) {
      if (std::all_of(part.begin(), part.end(), [&](auto e) { return sweep.left(e) == 1; })) return;
      const mpq_class of_part = abs(twice_area(chain, part));
      if (!least.empty() && of_part >= area) return;
      least = part;
      area = of_part;
    });
  return shrink(chain, least);
}

std::vector<CellPolygon> polygons_of(const CellChain& chain) {
  ChainSweep sweep(chain);
  sweep.run();
  DisjointSets parts(chain.size());
  parts.clear(0, chain.size());
  for (const auto& ring : RingWalk(chain, all_edges(chain)).rings(false))
    for (const std::uint32_t e : ring) parts.join(ring[0], e);
  for (const auto& [a, b] : sweep.beside()) parts.join(a, b);
  std::vector<std::vector<std::uint32_t>> edges(chain.size());
  for (std::uint32_t e = 0; e < chain.size(); ++e) edges[parts.root(e)].push_back(e);
  std::vector<CellPolygon> polygons;
  for (auto& part : edges) {
    if (part.empty()) continue;
    CellPolygon polygon(1);
    for (const auto& ring : RingWalk(chain, std::move(part)).rings(true)) {
      CellRing points;
      for (const std::uint32_t e : ring) {
        points.points.push_back(chain[e].from);
        points.across.push_back(chain[e].across);
      }
      add_ring(
          std::move(points), [&] { return sgn(twice_area(chain, ring)) > 0; }, polygon);
    }
    polygons.push_back(std::move(polygon));
  }
  sort_rings(polygons);
  return polygons;
}

bool sound(const std::vector<CellPolygon>& polygons) {
  if (polygons.empty()) return true;
  if (polygons.size() == 1 && polygons[0].size() == 1 && strictly_convex(polygons[0][0]))
    return true;
  CellChain chain = chain_of(polygons);
  const std::size_t edges = chain.size();
  cancel_opposite(chain);
  ChainSweep sweep(chain);
  if (chain.size() != edges || sweep.run().kind != ChainMend::Kind::none || !sweep.turns_once())
    return false;
  if (!sweep.touches()) return true;
  const std::vector<CellPolygon> again = polygons_of(chain);
  return std::equal(again.begin(), again.end(), polygons.begin(), polygons.end(),
                    [](const CellPolygon& a, const CellPolygon& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const CellRing& r, const CellRing& s) { return r.points == s.points; });
  });
}

}  // namespace cullhull::internal
