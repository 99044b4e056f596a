// A hull that was accepted must be safe to index, as certify() and the writers do.
#include "cullhull/hull.hpp"
#include "fuzz/read_points.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

template <class T, class Items>
void check_lists(const cullhull::Lists<T, Items>& lists, std::uint64_t limit) {
  require(!lists.offsets.empty() && lists.offsets.front() == 0 &&
          lists.offsets.back() == lists.items.size());
  for (std::size_t i = 0; i < lists.size(); ++i) require(lists.offsets[i] <= lists.offsets[i + 1]);
  for (const T item : lists.items) require(item < limit);
}

void check(const cullhull::Hull& h) {
  const auto k = static_cast<std::size_t>(h.affine_dimension > 0 ? h.affine_dimension : 0);
  require(h.dimension >= 1 && h.affine_dimension >= -1 && k <= h.dimension);
  for (const std::uint64_t id : h.vertices) require(id < h.point_count);
  check_lists(h.facets, h.point_count);
  check_lists(h.facet_neighbours, h.facet_count());
  require(h.facet_neighbours.size() == h.facet_count());
  require(h.facet_planes.size() == h.facet_count() * (std::size_t{h.dimension} + 1));
  require(h.simplices.size() == h.simplex_count() * k);
  require(h.simplex_neighbours.size() == h.simplex_count() * k);
  for (const std::uint64_t id : h.simplices) require(id < h.point_count);
  for (const std::uint32_t s : h.simplex_neighbours) require(s < h.simplex_count());
  for (const std::uint32_t f : h.simplex_facets) require(f < h.facet_count());
  require(h.centroid.empty() || h.centroid.size() == h.dimension);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<char> bytes(data, data + size);
  try {
    check(cullhull::internal::read_hull_json({"input", bytes.data(), bytes.size()}));
  } catch (const cullhull::Error& error) {
    cullhull::fuzz::check_refusal(error);
  }
  return 0;
}
