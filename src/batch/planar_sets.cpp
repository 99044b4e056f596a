#include "batch/batch_maker.hpp"

namespace cullhull::internal {
namespace {

/// Appends `count` items; returns the first of them.
template <class Vector>
auto* extend(Vector& to, std::size_t count) {
  const std::size_t size = to.size();
  to.resize(size + count);
  return to.data() + size;
}

template <class T>
void end_list(Lists<T>& lists) {
  lists.offsets.push_back(lists.items.size());
}

}  // namespace

bool PlanarSets::append(const PointView& set, HullBatch& to) {
  if (!polygon_.find(set)) return false;
  const std::size_t planes = to.facet_planes.size();
  PlanarMeasures measures;
  if (!polygon_.measure(set, extend(to.facet_planes, 3 * polygon_.size()), measures)) {
    to.facet_planes.resize(planes);
    return false;
  }
  write(set, measures, to);
  return true;
}

void PlanarSets::write(const PointView& set, const PlanarMeasures& measures, HullBatch& to) const {
  const std::size_t h = polygon_.size();
  to.point_counts.push_back(set.count);
  to.affine_dimensions.push_back(2);
  to.volumes.push_back(measures.volume);
  to.areas.push_back(measures.area);
  to.centroids.insert(to.centroids.end(), measures.centroid, measures.centroid + 2);
  polygon_.write_vertices(extend(to.vertices.items, h));
  end_list(to.vertices);

  to.facet_starts.push_back(to.facet_starts.back() + h);
  std::uint64_t facets_at = to.facets.items.size(), across_at = to.facet_neighbours.items.size();
  for (std::size_t i = 0; i < h; ++i) {
    to.facets.offsets.push_back(facets_at += 2);
    to.facet_neighbours.offsets.push_back(across_at += 2);
  }
  polygon_.write_lists(extend(to.simplices.items, 2 * h),
                       extend(to.simplex_neighbours.items, 2 * h), extend(to.facets.items, 2 * h),
                       extend(to.facet_neighbours.items, 2 * h));
  std::uint32_t* const number = extend(to.simplex_facets.items, h);
  for (std::size_t i = 0; i < h; ++i) number[i] = static_cast<std::uint32_t>(i);
  end_list(to.simplices);
  end_list(to.simplex_neighbours);
  end_list(to.simplex_facets);
}

}  // namespace cullhull::internal
