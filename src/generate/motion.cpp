// Moving point sets: a motion maps the points of a shape at rest to their positions at any time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "generate/rotation.hpp"
#include "parallel/int128.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/parallel.hpp"
namespace cullhull {

namespace {

using internal::mix64;
using internal::RandomStream;
using internal::Rotation;
using internal::rotation_by;

/// Rotates x about a centre in the plane of two neighbouring axes.
void rotate(const Rotation& rotation, std::uint32_t axis, const std::vector<double>& centre,
            double* x) {
  const double u = x[axis] - centre[axis], v = x[axis + 1] - centre[axis + 1];
  x[axis] = centre[axis] + (rotation.cosine * u - rotation.sine * v);
  x[axis + 1] = centre[axis + 1] + (rotation.sine * u + rotation.cosine * v);
}

/// A piece of the breaking body of the motion `fracture`: the points nearest to its seed.
struct Piece {
  std::vector<double> seed, velocity;
  double turns = 0;  ///< turns about the seed in the first two axes, in total
};

}  // namespace

struct MovingPoints::Impl {
  using Move = void (Impl::*)(double time, std::uint64_t point, double* x) const;
  struct Entry {
    Shape motion;
    Move move;  ///< moves x from its position at rest; null: teleport
    std::uint32_t min_dimension = 1;
    void (Impl::*prepare)() = nullptr;
  };
  static const std::vector<Entry>& entries();

  std::uint64_t count = 0, frames = 0, seed = 0;
  std::uint32_t dimension = 0;
  std::vector<double> rest;
  std::vector<double> centre;  ///< centre of the bounding box
  double extent = 1;           ///< longest edge of the bounding box
  const Entry* entry = nullptr;
  std::vector<Piece> pieces;
  std::vector<std::uint8_t> piece_of;

  const double* at_rest(std::uint64_t point) const { return rest.data() + point * dimension; }

  /// Computes the centre and the extent of the points at rest.
  void measure() {
    centre.assign(dimension, 0);
    extent = 0;
    for (std::uint32_t j = 0; j < dimension && count > 0; ++j) {
      double low = rest[j], high = rest[j];
      for (std::uint64_t i = 1; i < count; ++i) {
        low = std::min(low, at_rest(i)[j]);
        high = std::max(high, at_rest(i)[j]);
      }
      centre[j] = (low + high) / 2;
      extent = std::max(extent, high - low);
    }
    if (extent == 0) extent = 1;
  }

  // Turns each point by an angle that is proportional to time and to the point's coordinate on the
  // last axis (in 2D: its distance from the centre), at most 3/4 of a turn between the two ends.
  void twist(double time, std::uint64_t, double* x) const {
    double along = x[dimension - 1] - centre[dimension - 1];
    if (dimension == 2) {
      const double u = x[0] - centre[0], v = x[1] - centre[1];
      along = std::sqrt(u * u + v * v);
    }
    rotate(rotation_by(0.75 * time * along / extent), 0, centre, x);
  }

  void spin(double time, std::uint64_t, double* x) const {
    double share = 1;
    for (std::uint32_t j = 0; j + 1 < dimension; ++j, share *= 0.61803398874989485)
      rotate(rotation_by(time * share), j, centre, x);
  }

  void wave(double time, std::uint64_t, double* x) const {
    const double height = rotation_by(2 * (x[0] - centre[0]) / extent - 2 * time).sine -
                          rotation_by(2 * (x[0] - centre[0]) / extent).sine;
    x[dimension - 1] += 0.15 * extent * height;
  }

  void explode(double time, std::uint64_t point, double* x) const {
    const double speed = RandomStream(seed, mix64(point)).exponential();
    for (std::uint32_t j = 0; j < dimension; ++j) x[j] += (x[j] - centre[j]) * speed * time;
  }

  /// Draws 24 pieces of the motion `fracture` and assigns each point to the nearest seed.
  void prepare_pieces() {
    constexpr std::size_t number = 24;
    RandomStream random(seed, ~std::uint64_t{1});
    pieces.resize(number);
    for (Piece& piece : pieces) {
      const double* p = count > 0 ? at_rest(random.bits() % count) : centre.data();
      piece.seed.assign(p, p + dimension);
      piece.velocity.resize(dimension);
      const double speed = 0.3 + random.unit();
      for (std::uint32_t j = 0; j < dimension; ++j)
        piece.velocity[j] = speed * (p[j] - centre[j]) + 0.2 * extent * random.symmetric();
      piece.turns = 0.5 * random.symmetric();
    }
    piece_of.resize(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < number; ++k) {
        double square = 0;
        for (std::uint32_t j = 0; j < dimension; ++j) {
          const double v = at_rest(i)[j] - pieces[k].seed[j];
          square += v * v;
        }
        if (square >= nearest) continue;
        nearest = square;
        piece_of[i] = static_cast<std::uint8_t>(k);
      }
    }
  }

  // The pieces fly apart, turn, and fall along the last axis.
  void fracture(double time, std::uint64_t point, double* x) const {
    const Piece& piece = pieces[piece_of[point]];
    if (dimension >= 2) rotate(rotation_by(piece.turns * time), 0, piece.seed, x);
    for (std::uint32_t j = 0; j < dimension; ++j) x[j] += piece.velocity[j] * time;
    x[dimension - 1] -= 0.5 * extent * time * time;
  }

  /// Permutes the points at random in every frame, so that hardly any point is near its position in
  /// the frame before.
  void teleport(std::uint64_t index, double* out) const {
    if (count == 0) return;
    RandomStream random(mix64(seed), index);
    const std::uint64_t shift = random.bits() % count;
    std::uint64_t step = 0;
    do {
      step = 1 + random.bits() % count;
    } while (std::gcd(step, count) != 1);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t from = internal::multiply_add_modulo(step, i, shift, count);
      std::copy_n(at_rest(from), dimension, out + i * dimension);
    }
  }
};

const std::vector<MovingPoints::Impl::Entry>& MovingPoints::Impl::entries() {
  static const std::vector<Entry> table = {
      {{"twist", "turned about the centre, the more the farther along the last axis"},
       &Impl::twist,
       2},
      {{"fracture", "24 pieces fly apart, turn and fall"},
       &Impl::fracture,
       1,
       &Impl::prepare_pieces},
      {{"wave", "a wave runs along the first axis and lifts along the last"}, &Impl::wave},
      {{"spin", "rigid rotation in the planes of neighbouring axes"}, &Impl::spin, 2},
      {{"explode", "every point flies outward at a speed of its own"}, &Impl::explode},
      {{"teleport", "in every frame each point takes the place of another"}, nullptr},
  };
  return table;
}

std::vector<Shape> MovingPoints::list() {
  std::vector<Shape> result;
  for (const Impl::Entry& entry : Impl::entries()) result.push_back(entry.motion);
  return result;
}

const std::vector<Shape>& motions() {
  static const std::vector<Shape> list = MovingPoints::list();
  return list;
}

MovingPoints::MovingPoints(std::string_view shape, std::string_view motion, std::uint64_t count,
                           std::uint32_t dimension, std::uint64_t frames, std::uint64_t seed)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  for (const Impl::Entry& entry : Impl::entries())
    if (motion == entry.motion.name) m.entry = &entry;
  if (m.entry == nullptr) {
    std::string known;
    for (const Shape& s : motions()) known += std::string(" ") + s.name;
    throw Error(ErrorCode::invalid_argument, "unknown motion '", motion, "'; known:", known);
  }
  if (dimension < m.entry->min_dimension)
    throw Error(ErrorCode::invalid_argument, "motion '", motion, "' needs dimension ",
                m.entry->min_dimension, " or more");
  m.count = count;
  m.dimension = dimension;
  m.frames = frames;
  m.seed = seed;
  m.rest = generate(shape, count, dimension, seed);
  m.measure();
  if (m.entry->prepare != nullptr) (m.*m.entry->prepare)();
}

MovingPoints::MovingPoints(MovingPoints&&) noexcept = default;
MovingPoints& MovingPoints::operator=(MovingPoints&&) noexcept = default;
MovingPoints::~MovingPoints() = default;

void MovingPoints::frame(std::uint64_t index, double* out, const stop_token& stop) const {
  const Impl& m = *impl_;
  if (m.entry->move == nullptr) {
    m.teleport(index, out);
    return;
  }
  const double time =
      m.frames > 1 ? static_cast<double>(index) / static_cast<double>(m.frames - 1) : 0;
  internal::for_each_chunk(m.count, 4096, internal::resolve_threads(0),
                           [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    for (std::uint64_t i = begin; i < end; ++i) {
      double* x = out + i * m.dimension;
      std::copy_n(m.at_rest(i), m.dimension, x);
      (m.*m.entry->move)(time, i, x);
    }
  });
}

}  // namespace cullhull
