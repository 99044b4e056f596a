#include <string>
#include <type_traits>
#include <utility>

#include "distributed/communicator.hpp"

namespace cullhull::internal {
namespace {

/// Broadcasts fields of a result: the same calls send on the root and receive on the other ranks,
/// so that both sides always match.
class Courier {
 public:
  Courier(Communicator& ranks, int root) : ranks_(ranks), root_(root) {}
  bool sends() const { return ranks_.rank() == root_; }

  /// One number.
  template <class T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    ranks_.broadcast(&v, sizeof v, root_);
  }
  /// A vector, array or string.
  template <class Items>
  void items(Items& list) {
    std::uint64_t count = list.size();
    value(count);
    ranks_.together([&] { list.resize(count); });
    ranks_.broadcast(list.data(), count * sizeof(typename Items::value_type), root_);
  }
  template <class T>
  void items(SharedArray<T>& list) {
    if (sends()) {
      std::uint64_t count = list.size();
      value(count);
      ranks_.together([] {});
      // broadcast() only reads the data on the root.
      ranks_.broadcast(const_cast<T*>(list.data()), count * sizeof(T), root_);
      return;
    }
    Array<T> received;
    items(received);
    list = SharedArray<T>(std::move(received));
  }
  template <class T>
  void items(EvenArray<T>& list) {
    bool even = list.step() != nullptr;
    value(even);
    if (even) {
      std::uint64_t count = list.size();
      T step = even && sends() ? *list.step() : T();
      value(count);
      value(step);
      if (!sends()) list = EvenArray<T>::of_step(count, step);
      return;
    }
    items(list.edit());
  }

 private:
  Communicator& ranks_;
  int root_;
};

void exchange(Courier& all, Statistics& s) {
  all.value(s.survivors);
  all.value(s.filter);
  all.items(s.cull_reason);
  all.value(s.backend);
  all.value(s.threads);
  all.value(s.cull_seconds);
  all.value(s.hull_seconds);
  all.value(s.compute_seconds);
  all.value(s.rung_counts);
}

}  // namespace

void broadcast(Communicator& ranks, int root, Hull& h) {
  Courier all(ranks, root);
  all.value(h.dimension);
  all.value(h.point_count);
  all.value(h.scalar);
  all.value(h.affine_dimension);
  all.items(h.vertices);
  all.items(h.simplices);
  bool shared = h.facets.items.shares(h.simplices);
  all.value(shared);
  all.items(h.facets.offsets);
  if (!shared)
    all.items(h.facets.items);
  else if (!all.sends())
    h.facets.items = h.simplices;
  all.items(h.facet_neighbours.offsets);
  all.items(h.facet_neighbours.items);
  all.items(h.facet_planes);
  all.items(h.simplex_neighbours);
  all.items(h.simplex_facets);
  all.value(h.volume);
  all.value(h.area);
  all.items(h.centroid);
  all.items(h.vertex_coordinates);
  exchange(all, h.statistics);
}

void broadcast(Communicator& ranks, int root, ExtremePoints& points) {
  Courier all(ranks, root);
  all.items(points.ids);
  all.value(points.affine_dimension);
  exchange(all, points.statistics);
}

void broadcast(Communicator& ranks, int root, std::vector<double>& numbers) {
  Courier(ranks, root).items(numbers);
}

}  // namespace cullhull::internal
