// Selects code compiled for a scalar type or a dimension from a value known only at run time.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Whether all calls are in the plane, of doubles and without weights, as in the smaller module of
/// bindings/js: nothing else is linked then.
#ifdef CULLHULL_PLANE_ONLY
inline constexpr bool plane_only = true;
#else
inline constexpr bool plane_only = false;
#endif

/// Returns body(T()), T being the C++ type that `type` names.
template <class Body>
decltype(auto) with_scalar(ScalarType type, const Body& body) {
  if constexpr (plane_only) return body(double());
  switch (type) {
    case ScalarType::f32:
      return body(float());
    case ScalarType::f64:
      return body(double());
    case ScalarType::i8:
      return body(std::int8_t());
    case ScalarType::u8:
      return body(std::uint8_t());
    case ScalarType::i16:
      return body(std::int16_t());
    case ScalarType::u16:
      return body(std::uint16_t());
    case ScalarType::i32:
      return body(std::int32_t());
    case ScalarType::u32:
      break;
  }
  return body(std::uint32_t());
}

/// Returns body(std::integral_constant<unsigned, D>()), D being d if low <= d <= high and
/// `otherwise` if not. `otherwise` is usually 0 and selects code that reads the dimension at run
/// time.
template <unsigned low, unsigned high, unsigned otherwise, class Body>
decltype(auto) with_dimension(unsigned d, const Body& body) {
  if constexpr (low > high) {
    return body(std::integral_constant<unsigned, otherwise>());
  } else {
    if (d == low) return body(std::integral_constant<unsigned, low>());
    return with_dimension<low + 1, high, otherwise>(d, body);
  }
}

}  // namespace cullhull::internal
