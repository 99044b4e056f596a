#include "constrained/half_edges.hpp"

#include <algorithm>

namespace cullhull::internal::inline constrained {

HalfEdges::HalfEdges(const Triangulation& t, const Array<std::uint32_t>& place,
                     std::uint32_t vertices)
    : out_(vertices) {
  std::fill(out_.begin(), out_.end(), none);
  const auto count = static_cast<std::uint32_t>(t.size());
  Array<std::uint32_t> half(3 * std::size_t{count});  // by the corner opposite to it
  for (std::uint32_t c = 0; c < count; ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint32_t o = t.neighbours_of(c)[j];
      if (o != no_cell && o < c) {
        const auto back = t.neighbours_of(o);
        const auto slot = std::find(back.begin(), back.end(), c) - back.begin();
        half[3 * std::size_t{c} + j] = twin(half[3 * std::size_t{o} + static_cast<unsigned>(slot)]);
        continue;
      }
      half[3 * std::size_t{c} + j] = size();
      origin_.push_back(place[t.cell(c)[(j + 1) % 3]]);
      origin_.push_back(place[t.cell(c)[(j + 2) % 3]]);
    }
  next_.assign(origin_.size(), none);
  for (std::uint32_t c = 0; c < count; ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint32_t h = half[3 * std::size_t{c} + j];
      next_[h] = half[3 * std::size_t{c} + (j + 1) % 3];
      out_[origin_[h]] = h;
    }
}

void HalfEdges::flip(std::uint32_t edge) {
  const std::uint32_t h = 2 * edge, g = h + 1;
  const std::uint32_t h1 = next_[h], h2 = next_[h1], g1 = next_[g], g2 = next_[g1];
  const std::uint32_t u = origin_[h], v = origin_[g];
  if (out_[u] == h) out_[u] = g1;
  if (out_[v] == g) out_[v] = h1;
  origin_[h] = origin_[g2];
  origin_[g] = origin_[h2];
  next_[h] = h2;
  next_[h2] = g1;
  next_[g1] = h;
  next_[g] = g2;
  next_[g2] = h1;
  next_[h1] = g;
}

}  // namespace cullhull::internal::inline constrained
