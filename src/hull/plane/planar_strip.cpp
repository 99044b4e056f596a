#include "hull/plane/planar_strip.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "hull/plane/planar_chains.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t discard_from = 1U << 14, probe_size = 1U << 9, sample_size = 1U << 16;

struct SampleChains {
  std::vector<Entry> sample, lower, upper;
};

/// Hull of `size` rows spread evenly, each at a pseudo-random place in its interval, so that a
/// period in the input's order cannot hide points.
SampleChains chains_of_sample(const PlanarSource& source, const Box& box, std::uint32_t size,
                              const Control& control) {
  const KeyMap map(box.low[0], box.high[0]);
  std::vector<Entry> entries(size);
  XorShift random;
  for (std::uint32_t i = 0; i < size; ++i) {
    const std::uint64_t stretch = source.count() / size;
    Entry& e = entries[i];
    e = source.entry(
        static_cast<std::uint32_t>(i * stretch + (random.next() >> 32) * stretch / (1ULL << 32)));
    e.key = map.key(e.x);
  }
  const auto [first, last] = std::minmax_element(entries.begin(), entries.end(), before);
  ChainBuilder chains({*first, *last}, Turn(), control);
  chains.add(entries.data(), size, 32);
  return {std::move(entries),
          {chains.lower(), chains.lower() + chains.lower_count()},
          {chains.upper(), chains.upper() + chains.upper_count()}};
}

/// Whether the point is a copy of a corner, with a higher row.
bool copies_corner(double x, double y, std::uint32_t row, const Corners& corners) {
  for (unsigned i = 0; i < 4; ++i)
    if (x == corners[i].x && y == corners[i].y) return row > corners[i].row;
  return false;
}

/// Rows that are outside of the strip and of the quadrilateral of the four corners (points may
/// crowd at the ends of the strip) and are no copies of the corners. With a third of a million
/// points clamped to a square's corners, the last two tests reduce a hull's time from 114 to 77 ms.
std::vector<std::uint32_t> outside(const PlanarSource& source, const Strip& strip,
                                   const Corners& corners, const Quadrilateral& middle,
                                   const Run& run) {
  constexpr std::uint32_t block = PlanarSource::block;
  std::vector<std::vector<std::uint32_t>> kept(chunk_count(source.count(), light_grain));
  run.each_chunk(source.count(), light_grain,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    double room[2 * block];
    std::uint32_t list[block];
    for (std::uint64_t b = begin; b < end; b += block) {
      const std::uint64_t n = std::min<std::uint64_t>(block, end - b);
      const double* p = source.rows(b, b + n, room);
      std::size_t k = 0;
      for (std::uint64_t i = 0; i < n; ++i) {
        list[k] = static_cast<std::uint32_t>(b + i);
        k += !strip.contains(p[2 * i], p[2 * i + 1]);
      }
      std::size_t left = 0;
      for (std::size_t j = 0; j < k; ++j) {
        const std::uint32_t row = list[j];
        const double* q = p + 2 * (row - b);
        if (!middle.contains(q[0], q[1]) && !copies_corner(q[0], q[1], row, corners))
          list[left++] = row;
      }
      kept[c].insert(kept[c].end(), list, list + left);
    }
  });
  std::vector<std::uint32_t> rows;
  for (const auto& list : kept) rows.insert(rows.end(), list.begin(), list.end());
  return rows;
}

}  // namespace

std::vector<Strip::Corner> Strip::gather(const std::vector<Entry>& chain) const {
  std::vector<Corner> out;
  for (const Entry& e : chain) {
    const Corner c{(e.x - low_[0]) * scale_[0], (e.y - low_[1]) * scale_[1]};
    // Leaves out vertical pieces: of points with equal u the inner one counts, which is the later
    // at the left end and the earlier at the right end. Between the ends vertical pieces arise only
    // from rounding.
    if (!out.empty() && out.back().u == c.u) {
      if (out.size() == 1) out.back().v = c.v;
      continue;
    }
    out.push_back(c);
  }
  return out;
}

bool Strip::build(const Box& box, const std::vector<Entry>& lower,
                  const std::vector<Entry>& upper) {
  for (unsigned j = 0; j < 2; ++j) {
    const double range = box.high[j] - box.low[j];
    if (!(range > 0x1p-900 && range < 0x1p900)) return false;
    low_[j] = box.low[j];
    scale_[j] = std::ldexp(1.0, -std::ilogb(range) - 1);
  }
  const std::vector<Corner> below = gather(lower), over = gather(upper);
  if (below.size() < 2 || over.size() < 2) return false;
  left_ = below.front().u;
  right_ = below.back().u;
  const double range = right_ - left_;
  if (!(range >= 0x1p-10)) return false;
  per_unit_ = buckets / range;
  const double width = range / buckets;
  std::size_t l = 0, u = 0;
  for (unsigned i = 0; i < buckets; ++i) {
    // The bucket of u is (u - left) * per_unit, truncated. Its two roundings, those of the next
    // lines and that of u itself come to less than 8 * buckets * 2^-53 widths plus 2^-52; a width
    // is at least 2^-20, so 2^-10 widths more on either side cover them.
    const double u0 = std::max(left_, left_ + (i - 0x1p-10) * width);
    const double u1 = std::min(right_, left_ + (i + 1 + 0x1p-10) * width);
    // A chain's height at u is off by 12 * 2^-53 at most (five roundings of a term below 2, one of
    // a sum below 2), and the rounded chain's height at u is within 2^-53 of the true chain's
    // within 2^-53 of u. The true lower chain is convex, the upper concave, so between two such
    // places each has its extreme height at one of them.
    constexpr double margin = 0x1p-48;
    cells_[i].floor = std::max(height(below, l, u0), height(below, l, u1)) + margin;
    cells_[i].ceiling = std::min(height(over, u, u0), height(over, u, u1)) - margin;
  }
  return true;
}

/// The chain's height at u. Moves `from` to the piece that contains u; u decreases by at most a
/// bucket between calls.
double Strip::height(const std::vector<Corner>& chain, std::size_t& from, double u) {
  while (from > 0 && chain[from].u > u) --from;
  while (from + 2 < chain.size() && chain[from + 1].u < u) ++from;
  const Corner &a = chain[from], &b = chain[from + 1];
  return a.v + (b.v - a.v) * ((u - a.u) / (b.u - a.u));
}

std::vector<std::uint32_t> discard_inner(const PlanarSource& source, const Box& box,
                                         const Corners& corners, const Run& run) {
  const std::uint32_t n = source.count();
  if (n < discard_from) return {};
  // Efron 1965: the share of points outside a sample's hull is about the share of the sample that
  // are its vertices. A sample of 512 shows at little cost where most points are extreme.
  SampleChains chains;
  for (const std::uint32_t m : {probe_size, std::min(sample_size, n / 32)}) {
    chains = chains_of_sample(source, box, m, run.control);
    if (chains.lower.size() + chains.upper.size() > m / 2) return {};
  }
  const auto strip = std::make_unique<Strip>();
  if (!strip->build(box, chains.lower, chains.upper)) return {};
  const Quadrilateral middle({&corners[0], &corners[1], &corners[2], &corners[3]}, box);
  // Along straight edges a sample's hull has few vertices although most points are on it.
  const auto dropped =
      std::count_if(chains.sample.begin(), chains.sample.end(), [&](const Entry& e) {
        return strip->contains(e.x, e.y) || middle.contains(e.x, e.y) ||
               copies_corner(e.x, e.y, e.row, corners);
      });
  if (2 * static_cast<std::size_t>(dropped) < chains.sample.size()) return {};
  return outside(source, *strip, corners, middle, run);
}

}  // namespace cullhull::internal
