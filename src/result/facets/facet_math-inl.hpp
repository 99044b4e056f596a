// Arithmetic for the plane of a simplex facet and its share of the measures. The same source is
// compiled for numbers and for vectors, since the bits, and so the order of operations, are part of
// the canonical result. Include it inside a namespace that has `cofactors`, root, absolute and
// greater_of: once for doubles (facet_math.hpp) and once for each instruction set
// (facet_lanes-inl.hpp). CULLHULL_MATH is the functions' inline specifier.

template <unsigned K, class V>
CULLHULL_MATH V square_of(const V (&v)[K]) {
  V sum = v[0] * v[0];
  for (unsigned c = 1; c < K; ++c) sum = sum + v[c] * v[c];
  return sum;
}

/// The largest absolute value of a coordinate.
template <unsigned K, class V>
CULLHULL_MATH V largest_of(const V (&v)[K]) {
  V most = absolute(v[0]);
  for (unsigned c = 1; c < K; ++c) most = greater_of(most, absolute(v[c]));
  return most;
}

template <unsigned K, class V>
CULLHULL_MATH void edges_of(const V (&corner)[K][K], V (&edge)[K - 1][K]) {
  for (unsigned i = 1; i < K; ++i)
    for (unsigned c = 0; c < K; ++c) edge[i - 1][c] = corner[i][c] - corner[0][c];
}

/// The sum of the corners' differences from the origin.
template <unsigned K, class V>
CULLHULL_MATH void sum_of_corners(const V (&corner)[K][K], const V (&origin)[K], V (&sum)[K]) {
  for (unsigned c = 0; c < K; ++c) {
    V all = 0;
    for (unsigned j = 0; j < K; ++j) all = all + (corner[j][c] - origin[c]);
    sum[c] = all;
  }
}

/// Numbers of the simplex formed by a facet and the origin: K! times its volume, K! (K + 1) times
/// its moments about the origin, and the largest absolute coordinate of corner 0 minus the origin.
template <unsigned K, class V>
struct FacetMoments {
  V volume, moment[K], reach;
};
template <unsigned K, class V>
CULLHULL_MATH FacetMoments<K, V> moments_of(const V (&normal)[K], const V (&corner)[K],
                                            const V (&origin)[K], const V (&sum)[K]) {
  FacetMoments<K, V> out;
  V step[K];
  for (unsigned c = 0; c < K; ++c) step[c] = corner[c] - origin[c];
  V volume = 0;
  for (unsigned c = 0; c < K; ++c) volume = volume + normal[c] * step[c];
  out.volume = volume;
  for (unsigned c = 0; c < K; ++c) out.moment[c] = volume * sum[c];
  out.reach = largest_of<K>(step);
  return out;
}

/// Unit normal and offset of a facet's plane, from a normal of this length and a corner. The offset
/// is in the corner's units.
template <unsigned K, class V>
CULLHULL_MATH void plane_of(const V (&normal)[K], V length, const V (&corner)[K],
                            V (&plane)[K + 1]) {
  V offset = 0;
  for (unsigned c = 0; c < K; ++c) {
    plane[c] = normal[c] / length;
    offset = offset - plane[c] * corner[c];
  }
  plane[K] = offset;
}
