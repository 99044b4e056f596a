// In the place of Thrust's fancy iterators: what the stand-ins of CUB ask of them.
#pragma once

#include <cstddef>

namespace thrust {

template <class T>
struct counting_iterator {
  T first;
  T operator[](std::size_t i) const { return static_cast<T>(first + i); }
};
template <class T>
counting_iterator<T> make_counting_iterator(T first) {
  return {first};
}

template <class In, class Map>
struct transform_iterator {
  In in;
  Map map;
  auto operator[](std::size_t i) const { return map(in[i]); }
};
template <class In, class Map>
transform_iterator<In, Map> make_transform_iterator(In in, Map map) {
  return {in, map};
}

}  // namespace thrust
