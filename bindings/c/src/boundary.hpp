// What every function of the C interface does at the boundary: handles, errors as numbers and one
// line, structs that carry their size, options, views, borrowed arrays; what stands behind handles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "../cullhull.h"
#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/triangulation_query.hpp"
#include "cullhull/voronoi.hpp"

namespace cullhull::c {

/// Keeps the line for cullhull_last_error().
void keep_message(const char* text) noexcept;

[[noreturn]] void refuse(const char* message);

/// Runs what a function does; every exception becomes a status and a line.
cullhull_status report_exception() noexcept;  // within a handler
template <class F>
cullhull_status guarded(F&& f) noexcept {
  try {
    f();
    return CULLHULL_OK;
  } catch (...) {
    return report_exception();
  }
}

/// What a handle points to. Freed ones stay known for a while, so that a use of one is an error and
/// not a crash: `content` is gone, the box itself is returned after many others were freed.
struct Box {
  const char* kind = nullptr;  ///< the address of a name; nullptr: freed
  virtual ~Box() = default;
};
template <class Content>
struct BoxOf : Box {
  std::unique_ptr<Content> content;
};
void retire(std::unique_ptr<Box> box) noexcept;

/// cullhull_hull and others are names without a definition: pointers to boxes. `Kind<H>` has the
/// type of their content and their name.
template <class Handle>
struct Kind;

template <class Handle>
using ContentOf = typename Kind<Handle>::Content;

template <class Handle>
BoxOf<ContentOf<Handle>>* box_of(const Handle* handle) noexcept {
  Box* const box = reinterpret_cast<Box*>(const_cast<Handle*>(handle));
  const bool is_one = box != nullptr && box->kind == Kind<Handle>::name;
  return is_one ? static_cast<BoxOf<ContentOf<Handle>>*>(box) : nullptr;
}

template <class Handle>
ContentOf<Handle>& content(Handle* handle) {
  if (box_of(handle) == nullptr) refuse(Kind<Handle>::wrong);
  return *box_of(handle)->content;
}
template <class Handle>
const ContentOf<Handle>& content(const Handle* handle) {
  return content(const_cast<Handle*>(handle));
}

/// Gives the caller a handle; `made` is what its content is made of. `out` was checked by wants().
template <class Handle, class... Made>
void give(Handle** out, Made&&... made) {
  auto box = std::make_unique<BoxOf<ContentOf<Handle>>>();
  box->content.reset(new ContentOf<Handle>{std::forward<Made>(made)...});
  box->kind = Kind<Handle>::name;
  *out = reinterpret_cast<Handle*>(static_cast<Box*>(box.release()));
}

template <class Handle>
void end(Handle* handle) noexcept {
  auto* const box = box_of(handle);
  if (box == nullptr) return;
  box->kind = nullptr;
  box->content.reset();
  retire(std::unique_ptr<Box>(box));
}

/// A place for a result: not null. Pointers are cleared, so that an error leaves no old handle.
template <class T>
void wants(T* out) {
  if (out == nullptr) refuse("the place for the result is NULL");
  if constexpr (std::is_pointer_v<T>) *out = nullptr;
}

/// A struct of the caller's as this library knows it. What a newer header has beyond must be zero,
/// what an older one lacks is.
template <class T>
T known(const T* given, const char* wrong) {
  T own{};
  if (given == nullptr || given->size < sizeof(std::size_t) || given->size > 4096) refuse(wrong);
  std::memcpy(&own, given, std::min(given->size, sizeof(T)));
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (given->size > sizeof(T) &&
      std::any_of(bytes + sizeof(T), bytes + given->size, [](unsigned char b) { return b != 0; }))
    refuse("a struct has fields that this version of the library does not know");
  return own;
}

/// Fills a struct of the caller's as far as its size says; what only a newer header has is zero.
template <class T>
void fill(T* out, T own, const char* wrong) {
  if (out == nullptr || out->size < sizeof(std::size_t) || out->size > 4096) refuse(wrong);
  own.size = out->size;
  std::memset(static_cast<void*>(out), 0, own.size);
  std::memcpy(static_cast<void*>(out), &own, std::min(own.size, sizeof(T)));
}

PointView view(const cullhull_points* points);
cullhull_points points_of(const PointView& view);

/// The options of a call; callbacks ask `stop` to end it.
struct CallOptions {
  explicit CallOptions(const cullhull_options* given);
  Options options;
  bool furthest_site = false;
};

template <class T>
constexpr std::int32_t type_of() {
  if constexpr (std::is_same_v<T, double>) return CULLHULL_F64;
  if constexpr (std::is_same_v<T, std::int32_t>) return CULLHULL_I32;
  if constexpr (std::is_same_v<T, std::uint32_t>) return CULLHULL_U32;
  return CULLHULL_U64;
}

/// `items` as rows of `columns`.
template <class T>
cullhull_array rows(const T* items, std::size_t size, std::size_t columns = 1) {
  static const T none{};
  return {size == 0 ? &none : items, columns == 0 ? 0 : size / columns,
          static_cast<std::uint32_t>(columns), type_of<T>()};
}
template <class Items>
cullhull_array rows(const Items& items, std::size_t columns = 1) {
  return rows(items.data(), items.size(), columns);
}

/// Evenly spaced integers are not stored in a result: they are made when somebody asks for them.
/// Thread safe.
class Spread {
 public:
  template <class T>
  cullhull_array of(const EvenArray<T>& items) {
    if (items.step() == nullptr) return rows(items.data(), items.size());
    const std::lock_guard lock(mutex_);
    auto& made = std::get<std::map<Key, std::vector<T>>>(made_);
    const Key key{items.size(), *items.step()};
    const auto at = made.find(key);
    return rows(at != made.end()
                    ? at->second
                    : made.emplace(key, std::vector<T>(items.begin(), items.end())).first->second);
  }

 private:
  using Key = std::pair<std::size_t, std::uint64_t>;
  std::mutex mutex_;
  std::tuple<std::map<Key, std::vector<std::uint64_t>>, std::map<Key, std::vector<std::uint32_t>>>
      made_;
};

struct HullContent {
  Hull hull;
  mutable Spread spread{};
};
struct BatchContent {
  HullBatch batch;
  mutable Spread spread{};
};
struct VoronoiContent {
  Voronoi voronoi;
  mutable Spread spread{};
};

#define CULLHULL_KIND(handle, type)                                                     \
  template <>                                                                           \
  struct Kind<cullhull_##handle> {                                                      \
    using Content = type;                                                               \
    static constexpr char name[] = #handle;                                             \
    static constexpr char wrong[] = "the " #handle " is NULL, freed or another handle"; \
  };

CULLHULL_KIND(hull, HullContent)
CULLHULL_KIND(batch, BatchContent)
CULLHULL_KIND(query, HullQuery)
CULLHULL_KIND(state, HullState)
CULLHULL_KIND(stream, HullStream)
CULLHULL_KIND(triangulation, Triangulation)
CULLHULL_KIND(locator, TriangulationQuery)
CULLHULL_KIND(voronoi, VoronoiContent)

#undef CULLHULL_KIND

void fill(cullhull_certificate* out, const Certificate& certificate);

/// `count` items as memory of the caller's.
void* handed_over(const void* items, std::size_t bytes);

}  // namespace cullhull::c
