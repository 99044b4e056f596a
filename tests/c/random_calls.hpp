// Calls of the C interface in an order that bytes choose: right ones, and those with freed handles,
// NULL, wrong sizes, points that are no numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include "bindings/c/cullhull.h"

namespace random_calls {

class Calls {
 public:
  Calls(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  ~Calls() {
    for (cullhull_hull* h : hulls_) cullhull_hull_free(h);
    for (cullhull_batch* h : batches_) cullhull_batch_free(h);
    for (cullhull_query* h : queries_) cullhull_query_free(h);
    for (cullhull_state* h : states_) cullhull_state_free(h);
    for (cullhull_stream* h : streams_) cullhull_stream_free(h);
    for (cullhull_triangulation* h : triangulations_) cullhull_triangulation_free(h);
    for (cullhull_locator* h : locators_) cullhull_locator_free(h);
    for (cullhull_voronoi* h : diagrams_) cullhull_voronoi_free(h);
  }
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;

  /// Makes calls until the bytes are used up, at most `most`; how many it made.
  std::size_t run(std::size_t most) {
    std::size_t made = 0;
    for (; made < most && at_ < size_; ++made) step();
    return made;
  }
  std::size_t failures() const { return failures_; }

 private:
  unsigned byte() { return at_ < size_ ? data_[at_++] : 0; }

  /// One of the handles so far, which may be freed, or NULL.
  template <class Handle>
  Handle* one(const std::vector<Handle*>& all) {
    const unsigned b = byte();
    return all.empty() || b % 16 == 0 ? nullptr : all[b % all.size()];
  }

  template <class Handle>
  void keep(std::vector<Handle*>& all, cullhull_status status, Handle*& made) {
    check(status);
    if ((status == CULLHULL_OK) != (made != nullptr)) fail("a status and a handle disagree");
    if (made == nullptr) return;
    if (all.size() < 12) {
      all.push_back(made);
    } else {  // in the place of another, which ends
      Handle*& place = all[byte() % all.size()];
      end(place);
      place = made;
    }
  }
  static void end(cullhull_hull* h) { cullhull_hull_free(h); }
  static void end(cullhull_batch* h) { cullhull_batch_free(h); }
  static void end(cullhull_query* h) { cullhull_query_free(h); }
  static void end(cullhull_state* h) { cullhull_state_free(h); }
  static void end(cullhull_stream* h) { cullhull_stream_free(h); }
  static void end(cullhull_triangulation* h) { cullhull_triangulation_free(h); }
  static void end(cullhull_locator* h) { cullhull_locator_free(h); }
  static void end(cullhull_voronoi* h) { cullhull_voronoi_free(h); }

  [[noreturn]] static void fail(const char* what) {
    std::fprintf(stderr, "%s: %s\n", what, cullhull_last_error());
    std::abort();
  }
  void check(cullhull_status status) {
    if (status == CULLHULL_OK) return;
    ++failures_;
    if (status < 0 || status > CULLHULL_INTERNAL) fail("no such status");
    if (status == CULLHULL_INTERNAL || status == CULLHULL_OUT_OF_MEMORY) fail("not expected here");
    const char* line = cullhull_last_error();
    if (*line == '\0' || std::strchr(line, '\n') != nullptr) fail("no line tells what failed");
  }

  cullhull_points points() {
    const unsigned b = byte(), n = byte() % 24;
    cullhull_points p{};
    p.size = sizeof p;
    p.dimension = b % 32 == 31 ? b / 32 : b % 4 == 3 ? 2 : b % 4 == 2 ? 4 : 3;
    p.count = n;
    coordinates_.resize(std::size_t{n} * p.dimension + 1);
    for (double& x : coordinates_) {
      const unsigned v = byte();
      x = v % 5;
      if (v == 250) x = std::numeric_limits<double>::quiet_NaN();
      if (v == 251) x = 1e300;
    }
    p.data = coordinates_.data();
    if (b == 100) p.data = nullptr;
    if (b == 101) p.size = 3;
    if (b == 102) p.type = 99;
    if (b == 103) p.size = sizeof(std::size_t);  // all fields are zero
    if (b % 32 == 5) p.type = CULLHULL_U8;       // fewer bytes than there are
    return p;
  }

  cullhull_options* options() {
    const unsigned b = byte();
    if (b % 4 == 0) return nullptr;
    options_ = {};
    options_.size = b == 255 ? 1 : sizeof options_;
    options_.threads = 1 + b % 2;
    options_.with_coordinates = (b >> 2) & 1;
    options_.furthest_site = b % 32 == 9;
    options_.cull = b == 254 ? 17 : static_cast<int>(b % 4);
    options_.backend = b == 253 ? -1 : CULLHULL_BACKEND_CPU;
    if (b % 64 == 33) options_.cancelled = [](void*) { return 1; };
    if (b % 64 == 34) options_.progress = [](void*, const char*, double) -> int { throw 1; };
    return &options_;
  }

  void read(cullhull_status status, const cullhull_array& a) {
    check(status);
    if (status != CULLHULL_OK) return;
    const std::size_t item = a.type == CULLHULL_U64 || a.type == CULLHULL_F64 ? 8 : 4;
    unsigned char sum = 0;  // every byte can be read
    for (std::size_t i = 0; i < a.count * a.columns * item; ++i)
      sum = static_cast<unsigned char>(sum + static_cast<const unsigned char*>(a.data)[i]);
    sum_ = sum;
  }

  void step() {
    cullhull_array array{};
    switch (byte() % 32) {
      case 0:
      case 1: {
        cullhull_hull* made = nullptr;
        const cullhull_points p = points();
        keep(hulls_, cullhull_hull_new(&p, options(), &made), made);
        return;
      }
      case 2:
        end(one(hulls_));
        return;
      case 3:
      case 4: {
        const cullhull_hull* h = one(hulls_);
        read(cullhull_hull_get(h, static_cast<int>(byte() % 13) - 1, &array), array);
        return;
      }
      case 5: {
        cullhull_hull_info info{};
        info.size = byte() % 8 == 0 ? 0 : sizeof info;
        check(cullhull_hull_get_info(one(hulls_), &info));
        return;
      }
      case 6: {
        std::uint64_t *ids = nullptr, count = 0;
        const cullhull_points p = points();
        check(byte() % 2 == 0 ? cullhull_extreme_points(&p, options(), &ids, &count)
                              : cullhull_cull(&p, options(), &ids, &count));
        cullhull_free(ids);
        return;
      }
      case 7: {
        cullhull_certificate proof{};
        proof.size = sizeof proof;
        const cullhull_points p = points();
        const cullhull_hull* h = one(hulls_);
        check(cullhull_hull_certify(h, byte() % 4 == 0 ? nullptr : &p, options(), &proof));
        return;
      }
      case 8: {
        cullhull_batch* made = nullptr;
        const cullhull_points p = points();
        const std::uint64_t offsets[3] = {0, byte() % 12, byte() % 24};
        keep(batches_, cullhull_batch_new(&p, offsets, byte() % 3, options(), &made), made);
        return;
      }
      case 9:
        end(one(batches_));
        return;
      case 10: {
        const cullhull_batch* b = one(batches_);
        read(cullhull_batch_get(b, static_cast<int>(byte() % 10) - 1, &array), array);
        return;
      }
      case 11: {
        cullhull_hull* made = nullptr;
        const cullhull_batch* b = one(batches_);
        keep(hulls_, cullhull_batch_hull(b, byte() % 3, &made), made);
        return;
      }
      case 12: {
        cullhull_query* made = nullptr;
        const cullhull_points p = points();
        const cullhull_hull* h = one(hulls_);
        keep(queries_, cullhull_query_new(h, byte() % 2 ? nullptr : &p, options(), &made), made);
        return;
      }
      case 13:
        end(one(queries_));
        return;
      case 14: {
        std::int8_t sides[24];
        const cullhull_points p = points();
        check(cullhull_query_sides(one(queries_), &p, options(), sides));
        return;
      }
      case 15: {
        std::uint64_t ids[24];
        const cullhull_points p = points();
        check(cullhull_query_supports(one(queries_), &p, options(), ids));
        return;
      }
      case 16: {
        double distances[24] = {};
        const cullhull_points p = points();
        double* vertices = nullptr;
        std::uint64_t count = 0;
        if (byte() % 2 == 0)
          check(cullhull_query_signed_distances(one(queries_), &p, options(), distances));
        else
          check(cullhull_intersect_halfspaces(&p, byte() % 4 == 0 ? distances : nullptr, options(),
                                              &vertices, &count));
        cullhull_free(vertices);
        return;
      }
      case 17:
      case 18: {
        cullhull_state* made = nullptr;
        const cullhull_points p = points();
        keep(states_, cullhull_state_new(&p, byte() % 64, options(), &made), made);
        return;
      }
      case 19:
        end(one(states_));
        return;
      case 20: {
        cullhull_state *state = one(states_), *other = one(states_);
        check(cullhull_state_merge(state, other, options()));
        return;
      }
      case 21: {
        std::uint8_t* bytes = nullptr;
        std::uint64_t size = 0;
        cullhull_state* made = nullptr;
        check(cullhull_state_save(one(states_), &bytes, &size));
        if (size > 0 && byte() % 4 == 0) bytes[byte() % size] ^= 1;
        keep(states_, cullhull_state_load(bytes, size, &made), made);
        cullhull_free(bytes);
        return;
      }
      case 22: {
        cullhull_points held{};
        held.size = sizeof held;
        check(cullhull_state_get(one(states_), &array, &held));
        read(CULLHULL_OK, array);
        return;
      }
      case 23: {
        cullhull_hull* made = nullptr;
        const cullhull_state* state = one(states_);
        keep(hulls_, cullhull_state_hull(state, options(), &made), made);
        return;
      }
      case 24: {
        cullhull_stream* made = nullptr;
        keep(streams_, cullhull_stream_new(options(), &made), made);
        return;
      }
      case 25: {
        const cullhull_points p = points();
        check(cullhull_stream_push(one(streams_), &p, byte()));
        return;
      }
      case 26: {
        cullhull_state* state = nullptr;
        cullhull_hull* hull = nullptr;
        cullhull_stream* stream = one(streams_);
        if (byte() % 4 == 0)
          end(stream);
        else if (byte() % 2 == 0)
          keep(states_, cullhull_stream_state(stream, &state), state);
        else
          keep(hulls_, cullhull_stream_hull(stream, &hull), hull);
        return;
      }
      case 27: {
        cullhull_triangulation* made = nullptr;
        const cullhull_points p = points();
        const double weights[24] = {1, 0, 3};
        const double* w = byte() % 3 == 0 ? weights : nullptr;
        keep(triangulations_, cullhull_triangulation_new(&p, w, options(), &made), made);
        return;
      }
      case 28: {
        cullhull_triangulation* t = one(triangulations_);
        if (byte() % 4 == 0)
          end(t);
        else
          read(cullhull_triangulation_get(t, static_cast<int>(byte() % 9) - 1, &array), array);
        return;
      }
      case 29: {
        const cullhull_points p = points();
        cullhull_certificate proof{};
        proof.size = byte() % 8 == 0 ? sizeof(std::size_t) : sizeof proof;
        check(cullhull_triangulation_certify(one(triangulations_), &p, nullptr, options(), &proof));
        return;
      }
      case 30: {
        const cullhull_points p = points();
        cullhull_locator* made = nullptr;
        cullhull_locator* held = one(locators_);
        std::uint32_t cells[24];
        double parts[24 * 5];
        const unsigned what = byte() % 8;
        if (what == 0)
          end(held);
        else if (what < 4)
          keep(locators_, cullhull_locator_new(one(triangulations_), &p, nullptr, options(), &made),
               made);
        else if (what < 6)
          check(cullhull_locator_find(held, &p, options(), cells, what == 4 ? parts : nullptr));
        else
          check(cullhull_locator_nearest(held, &p, options(), cells));
        return;
      }
      default: {
        const cullhull_points p = points();
        cullhull_voronoi* made = nullptr;
        cullhull_voronoi* held = one(diagrams_);
        const unsigned what = byte() % 8;
        if (what == 0)
          end(held);
        else if (what < 4)
          keep(diagrams_, cullhull_voronoi_new(one(triangulations_), &p, nullptr, options(), &made),
               made);
        else
          read(cullhull_voronoi_get(held, static_cast<int>(byte() % 10) - 1, &array), array);
        return;
      }
    }
  }

  const std::uint8_t* data_;
  std::size_t size_, at_ = 0, failures_ = 0;
  volatile unsigned char sum_ = 0;
  std::vector<double> coordinates_;
  cullhull_options options_{};
  std::vector<cullhull_hull*> hulls_;
  std::vector<cullhull_batch*> batches_;
  std::vector<cullhull_query*> queries_;
  std::vector<cullhull_state*> states_;
  std::vector<cullhull_stream*> streams_;
  std::vector<cullhull_triangulation*> triangulations_;
  std::vector<cullhull_locator*> locators_;
  std::vector<cullhull_voronoi*> diagrams_;
};

}  // namespace random_calls
