// HullState: the extreme points of a set, as a value that can be merged and stored.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/stream.hpp"
#include "geometry/gather.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/dispatch.hpp"
#include "result/vertex_coordinates.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull {

using namespace internal;

HullState::HullState() = default;

HullState::HullState(std::uint32_t dimension, ScalarType scalar)
    : dimension_(dimension), scalar_(scalar) {
  require_dimension(dimension);
}

HullState::HullState(const PointView& points, std::uint64_t first_id, const Options& options) {
  HullStream stream(options);
  stream.push(points, first_id);
  *this = stream.state();
}

HullState::HullState(const Hull& hull)
    : dimension_(hull.dimension), scalar_(hull.scalar), seen_(hull.point_count) {
  OwnVertices own(hull);
  ids_ = std::move(own.ids);
  // Every coordinate came from a number of this type, so that converting it back is exact.
  const std::size_t size = scalar_size(scalar_);
  rows_.resize(own.rows.size() * size);
  with_scalar(scalar_, [&](auto v) {
    for (std::size_t i = 0; i < own.rows.size(); ++i) {
      v = static_cast<decltype(v)>(own.rows[i]);
      std::memcpy(rows_.data() + i * size, &v, size);
    }
  });
}

PointView HullState::points() const noexcept {
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(scalar_));
  return {rows_.data(), scalar_, dimension_, ids_.size(), size * dimension_, size};
}

namespace {

constexpr int most_decimals = 15, most_places = 100, most_bits = 50;

double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;  // exact up to 10^22
  return power;
}

/// As HullState has them: -1 and 0 where there is none.
struct GridOfStates {
  int decimals = -1, places = -1, bits = 0;
};

GridOfStates grid_of(const HullState& s) { return {s.decimals(), s.places(), s.bits()}; }

/// Multiples of 10^0 are multiples of 2^0, too.
int places_of(const HullState& s) { return s.decimals() == 0 ? 0 : s.places(); }

/// Binary places that a number needs are its decimals, too: 1/4 is 0.25.
int decimals_of(const HullState& s) { return s.decimals() >= 0 ? s.decimals() : s.places(); }

/// The bits of a state's numbers in units of a decimal grid that contains it.
int bits_on(const HullState& s, int decimals) {
  double most = 0;
  const double unit = power_of_ten(decimals);
  if (s.bits() > 0) {
    const double own = s.decimals() >= 0 ? power_of_ten(s.decimals()) : std::ldexp(1, s.places());
    most = std::ldexp(unit / own, s.bits());
  } else {
    const PointView points = s.points();
    for (std::uint64_t i = 0; i < points.count; ++i)
      for (std::uint32_t j = 0; j < points.dimension; ++j)
        most = std::max(most, std::abs(points.at(i, j)) * unit);
  }
  return most <= 1 ? 1 : most > 0x1p100 ? 101 : static_cast<int>(std::ceil(std::log2(most)));
}

[[noreturn]] void refuse_grids(int decimals) {
  throw Error(ErrorCode::invalid_argument, "states of different grids: one is of numbers with ",
              decimals,
              " decimals, and no grid of at most 50 bits contains those of the other; compute the "
              "hull from the files themselves");
}

/// The grid of the union, as it is of the files that the states were computed from
/// (cullhull/placement.hpp): binary if both are, otherwise decimal; none if a state has none, where
/// doubles are compared as they are. Throws Error{invalid_argument} if those of a decimal grid
/// would be rounded.
GridOfStates common_grid(const HullState& a, const HullState& b) {
  if (a.point_count() == 0) return grid_of(b);
  if (b.point_count() == 0) return grid_of(a);
  if (a.decimals() <= 0 && b.decimals() <= 0) {
    GridOfStates out;
    if (places_of(a) < 0 || places_of(b) < 0) return out;
    const int places = std::max(places_of(a), places_of(b));
    const auto bits = [&](const HullState& s) {
      return s.bits() == 0 ? 0 : s.bits() + places - places_of(s);
    };
    if (std::max(bits(a), bits(b)) > most_bits) return out;
    (places == 0 ? out.decimals : out.places) = places;
    if (bits(a) > 0 && bits(b) > 0) out.bits = std::max(bits(a), bits(b));
    return out;
  }
  GridOfStates out;
  out.decimals = std::max(decimals_of(a), decimals_of(b));
  const int bits = std::max(bits_on(a, out.decimals), bits_on(b, out.decimals));
  if (std::min(decimals_of(a), decimals_of(b)) < 0 || out.decimals > most_decimals ||
      bits > most_bits)
    refuse_grids(std::max(a.decimals(), b.decimals()));
  if (a.bits() > 0 && b.bits() > 0) out.bits = bits;
  return out;
}

}  // namespace

void HullState::merge(const HullState& other, const Options& options) {
  if (other.dimension_ == 0) return;
  if (dimension_ != 0 && dimension_ != other.dimension_)
    throw Error(ErrorCode::invalid_argument, "a state of dimension ", other.dimension_,
                " cannot be merged into one of dimension ", dimension_);
  const GridOfStates grid = common_grid(*this, other);
  if (grid.decimals > 0 && seen_ > 0 && other.seen_ > 0) {
    HullState merged = *this, numbers = other;
    merged.to_grid(grid.decimals);
    numbers.to_grid(grid.decimals);
    merged.merge(numbers, options);
    merged.to_world(grid.decimals, grid.bits);
    *this = std::move(merged);
    return;
  }
  const ScalarType scalar = common_scalar(scalar_, seen_, other.scalar_, other.seen_);
  if (seen_ == 0) {
    const bool known = dimension_ != 0;
    *this = other;
    if (known) scalar_ = scalar;
    return;
  }
  NumberedPoints mine = StateParts::points(*this), theirs = StateParts::points(other);
  if (other.seen_ > 0) {
    if (scalar != mine.scalar) mine.widen();
    if (scalar != theirs.scalar) theirs.widen();
    mine.append(theirs);
    keep_extreme(mine, options);
  }
  const std::uint64_t seen = seen_ + other.seen_;
  *this = StateParts::state(mine, seen);
  decimals_ = static_cast<std::int8_t>(grid.decimals);
  places_ = static_cast<std::int8_t>(grid.places);
  bits_ = static_cast<std::int8_t>(grid.bits);
}

namespace {

/// Rows of doubles: of(coordinate) for each coordinate.
template <class Of>
std::vector<std::byte> rows_of(const PointView& points, const Of& of) {
  std::vector<std::byte> rows(points.count * points.dimension * sizeof(double));
  std::byte* out = rows.data();
  for (std::uint64_t i = 0; i < points.count; ++i)
    for (std::uint32_t j = 0; j < points.dimension; ++j, out += sizeof(double)) {
      const double x = of(points.at(i, j));
      std::memcpy(out, &x, sizeof x);
    }
  return rows;
}

}  // namespace

void HullState::to_world(int decimals, int bits) {
  if (decimals < 0 || decimals > most_decimals)
    throw Error(ErrorCode::invalid_argument, "a grid has 0 to 15 decimals");
  rows_ = rows_of(points(), [p = power_of_ten(decimals)](double x) { return x / p; });
  scalar_ = ScalarType::f64;
  decimals_ = static_cast<std::int8_t>(decimals);
  places_ = -1;
  bits_ = static_cast<std::int8_t>(std::clamp(bits, 0, most_bits));
}

void HullState::to_grid() {
  if (decimals_ < 0) return;
  rows_ = rows_of(points(), [p = power_of_ten(decimals_)](double x) { return std::round(x * p); });
  scalar_ = ScalarType::f64;
  decimals_ = -1;
  bits_ = 0;
}

void HullState::to_grid(int decimals) {
  if (seen_ == 0) {
    decimals_ = places_ = -1;
    bits_ = 0;
    return;
  }
  if (decimals_of(*this) < 0 || decimals < decimals_of(*this) || decimals > most_decimals ||
      bits_on(*this, decimals) > most_bits)
    refuse_grids(decimals);
  // Integers below 2^50, whether the coordinates are rounded or, on a binary grid, exact.
  const double finer = power_of_ten(decimals - decimals_of(*this));
  rows_ = rows_of(points(), [&, p = power_of_ten(decimals_of(*this))](double x) {
    return std::round(x * p) * finer;
  });
  scalar_ = ScalarType::f64;
  decimals_ = places_ = -1;
  bits_ = 0;
}

void HullState::set_binary_grid(int places, int bits) {
  if (places < 0 || places > most_places)
    throw Error(ErrorCode::invalid_argument, "a binary grid has 0 to 100 places");
  rows_ = rows_of(points(), [](double x) { return x; });
  scalar_ = ScalarType::f64;
  decimals_ = -1;
  places_ = static_cast<std::int8_t>(places);
  bits_ = static_cast<std::int8_t>(std::clamp(bits, 0, most_bits));
}

void HullState::shift_ids(std::uint64_t offset) {
  if (!ids_.empty() && ids_.back() + offset < offset)
    throw Error(ErrorCode::invalid_argument, "ids of the points exceed 2^64");
  for (std::uint64_t& id : ids_) id += offset;
}

Hull HullState::hull(const Options& options) const {
  if (dimension_ == 0)
    throw Error(ErrorCode::invalid_argument,
                "a state without points has no dimension: say HullState(dimension)");
  Hull hull = convex_hull(points(), options);
  hull.rename([&](std::uint64_t place) { return ids_[place]; });
  hull.point_count = seen_;
  return hull;
}

// ------------------------------------------------------------------------------- as bytes

namespace {

constexpr char magic[8] = {'\x93', 'C', 'U', 'L', 'L', 'H', 'S', '\n'};
/// 1 has no places and bits.
constexpr std::uint32_t state_version = 2;

/// The header, which precedes ids and coordinates. All numbers are little-endian.
struct Head {
  char magic[8];
  std::uint32_t version, dimension;
  std::uint32_t scalar;
  std::uint32_t grid;  ///< a byte each: 1 + decimals, 1 + places, bits; 0: no such grid, unknown
  std::uint64_t seen, count;

  Head turned() const {
    Head head{{},
              little_endian(version),
              little_endian(dimension),
              little_endian(scalar),
              little_endian(grid),
              little_endian(seen),
              little_endian(count)};
    std::memcpy(head.magic, magic, sizeof magic);
    return head;
  }
};
static_assert(sizeof(Head) == 40);

/// FNV-1a on words of 8 bytes, with a rotation that also spreads high bits. Each step is a
/// bijection of the word, so a single changed word is always detected. `size` is a multiple of 8.
std::uint64_t checksum(const std::byte* data, std::size_t size) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (std::size_t i = 0; i < size; i += 8)
    sum = std::rotl((sum ^ load_little_endian<std::uint64_t>(data + i)) * 0x100000001b3ULL, 29);
  return sum;
}

std::size_t padded(std::size_t bytes) { return (bytes + 7) / 8 * 8; }

[[noreturn]] void bad_state(const std::string& why) {
  throw Error(ErrorCode::bad_file, "hull state: ", why);
}

}  // namespace

std::vector<std::byte> HullState::to_bytes() const {
  const std::size_t ids = ids_.size() * sizeof(std::uint64_t), rows = rows_.size();
  std::vector<std::byte> bytes(sizeof(Head) + ids + padded(rows) + 8);
  Head head{{},
            places_ >= 0 || bits_ > 0 ? state_version : 1,
            dimension_,
            static_cast<std::uint32_t>(scalar_),
            static_cast<std::uint32_t>((decimals_ + 1) | (places_ + 1) << 8 | bits_ << 16),
            seen_,
            ids_.size()};
  std::memcpy(head.magic, magic, sizeof magic);
  head = head.turned();
  std::byte* const at = bytes.data() + sizeof head;
  std::memcpy(bytes.data(), &head, sizeof head);
  if (ids > 0) std::memcpy(at, ids_.data(), ids);
  if (rows > 0) std::memcpy(at + ids, rows_.data(), rows);
  little_endian_items(at, ids, sizeof ids_[0]);
  little_endian_items(at + ids, rows, scalar_size(scalar_));
  const std::uint64_t sum = little_endian(checksum(bytes.data(), bytes.size() - 8));
  std::memcpy(bytes.data() + bytes.size() - 8, &sum, 8);
  return bytes;
}

HullState HullState::from_bytes(std::span<const std::byte> bytes) {
  Head head;
  if (bytes.size() < sizeof head + 8) bad_state("too short to be one");
  std::memcpy(&head, bytes.data(), sizeof head);
  head = head.turned();
  if (std::memcmp(head.magic, magic, sizeof magic) != 0) bad_state("does not begin as one does");
  if (head.version != 1 && head.version != state_version)
    bad_state("version " + std::to_string(head.version) + "; this program reads versions 1 and " +
              std::to_string(state_version));
  if (head.scalar > static_cast<std::uint32_t>(ScalarType::u32))
    bad_state("unknown scalar type " + std::to_string(head.scalar));
  const int decimals = static_cast<int>(head.grid & 255) - 1;
  const int places = static_cast<int>(head.grid >> 8 & 255) - 1;
  const int bits = static_cast<int>(head.grid >> 16);
  if (decimals > most_decimals || places > most_places || bits > most_bits ||
      (decimals >= 0 && places >= 0) || (bits > 0 && decimals < 0 && places < 0) ||
      (head.version == 1 && head.grid > 255) ||
      (head.grid > 0 && head.scalar != static_cast<std::uint32_t>(ScalarType::f64)))
    bad_state("unknown grid " + std::to_string(head.grid));
  HullState state;
  state.dimension_ = head.dimension;
  state.decimals_ = static_cast<std::int8_t>(decimals);
  state.places_ = static_cast<std::int8_t>(places);
  state.bits_ = static_cast<std::int8_t>(bits);
  state.scalar_ = static_cast<ScalarType>(head.scalar);
  state.seen_ = head.seen;
  const std::uint64_t row = std::uint64_t{head.dimension} * scalar_size(state.scalar_);
  // Compared by division, as a header can hold any number and products could overflow.
  const std::uint64_t room = bytes.size() - sizeof head - 8;
  if (head.count > room / (row + 8) ||
      sizeof head + 8 + head.count * 8 + padded(head.count * row) != bytes.size())
    bad_state(std::to_string(head.count) + " points of dimension " +
              std::to_string(head.dimension) + " do not fit its " + std::to_string(bytes.size()) +
              " bytes");
  const auto sum = load_little_endian<std::uint64_t>(bytes.data() + bytes.size() - 8);
  if (sum != checksum(bytes.data(), bytes.size() - 8)) bad_state("its check sum is wrong");
  if (head.count > head.seen || (head.seen > 0 && (head.count == 0 || head.dimension == 0)))
    bad_state(std::to_string(head.count) + " extreme points of " + std::to_string(head.seen));
  state.ids_.resize(head.count);
  state.rows_.resize(head.count * row);
  const std::byte* at = bytes.data() + sizeof head;
  if (head.count > 0) {
    std::memcpy(state.ids_.data(), at, head.count * 8);
    std::memcpy(state.rows_.data(), at + head.count * 8, head.count * row);
    little_endian_items(state.ids_.data(), head.count * 8, 8);
    little_endian_items(state.rows_.data(), head.count * row, scalar_size(state.scalar_));
  }
  const auto descends = [](std::uint64_t a, std::uint64_t b) { return a >= b; };
  if (std::adjacent_find(state.ids_.begin(), state.ids_.end(), descends) != state.ids_.end())
    bad_state("its ids do not ascend");
  const PointView points = state.points();
  for (std::uint64_t i = 0; i < points.count; ++i)
    for (std::uint32_t j = 0; j < points.dimension; ++j)
      if (!std::isfinite(points.at(i, j)))
        bad_state("point " + std::to_string(state.ids_[i]) + " is not finite");
  return state;
}

}  // namespace cullhull
