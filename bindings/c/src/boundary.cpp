#include "boundary.hpp"

#include <array>
#include <cstdlib>
#include <deque>
#include <iterator>

namespace cullhull::c {
namespace {

thread_local std::array<char, 512> last_message{};

constexpr std::size_t most_retired = 1024;

struct Retired {
  std::mutex mutex;
  std::deque<std::unique_ptr<Box>> boxes;
};
Retired& retired() {
  static Retired* const all = new Retired;  // never destroyed: handles may be freed at exit
  return *all;
}

cullhull_status status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument:
      return CULLHULL_INVALID_ARGUMENT;
    case ErrorCode::not_finite:
      return CULLHULL_NOT_FINITE;
    case ErrorCode::bad_file:
    case ErrorCode::io:
      return CULLHULL_BAD_DATA;
    case ErrorCode::out_of_budget:
      return CULLHULL_OUT_OF_BUDGET;
    case ErrorCode::backend_unavailable:
      return CULLHULL_BACKEND_UNAVAILABLE;
    case ErrorCode::cancelled:
      return CULLHULL_CANCELLED;
    case ErrorCode::not_exact:
    case ErrorCode::internal:
      break;
  }
  return CULLHULL_INTERNAL;
}

cullhull_status failed(cullhull_status status, const char* text) noexcept {
  keep_message(text);
  return status;
}

}  // namespace

void keep_message(const char* text) noexcept {
  const std::size_t size = std::min(std::strlen(text), last_message.size() - 1);
  std::memcpy(last_message.data(), text, size);
  last_message[size] = '\0';
}

void refuse(const char* message) { throw Error(ErrorCode::invalid_argument, message); }

cullhull_status report_exception() noexcept {
  try {
    throw;
  } catch (const Error& e) {
    return failed(status_of(e.code()), e.what());
  } catch (const std::bad_alloc&) {
    return failed(CULLHULL_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& e) {
    return failed(CULLHULL_INTERNAL, e.what());
  } catch (...) {
    return failed(CULLHULL_INTERNAL, "an exception of an unknown type");
  }
}

void retire(std::unique_ptr<Box> box) noexcept try {
  std::unique_ptr<Box> oldest;
  const std::lock_guard lock(retired().mutex);
  retired().boxes.push_back(std::move(box));
  if (retired().boxes.size() <= most_retired) return;
  oldest = std::move(retired().boxes.front());
  retired().boxes.pop_front();
} catch (...) {  // no memory to remember it: it is returned at once
}

/// From cullhull_type to ScalarType and back: doubles come first there, floats here.
constexpr ScalarType exchanged(std::int32_t type) noexcept {
  return static_cast<ScalarType>(type <= 1 ? 1 - type : type);
}
static_assert(exchanged(CULLHULL_F32) == ScalarType::f32 &&
              exchanged(CULLHULL_F64) == ScalarType::f64 &&
              exchanged(CULLHULL_I8) == ScalarType::i8 &&
              exchanged(CULLHULL_U32) == ScalarType::u32);

PointView view(const cullhull_points* points) {
  const auto p = known(points, "points are NULL, or points->size is not sizeof(cullhull_points)");
  if (p.type < CULLHULL_F64 || p.type > CULLHULL_U32)
    refuse("points->type is no type of coordinates");
  const ScalarType scalar = exchanged(p.type);
  const auto item = static_cast<std::int64_t>(scalar_size(scalar));
  const bool packed = p.point_stride == 0 && p.coordinate_stride == 0;
  return {static_cast<const std::byte*>(p.data),
          scalar,
          p.dimension,
          p.count,
          static_cast<std::ptrdiff_t>(packed ? item * p.dimension : p.point_stride),
          static_cast<std::ptrdiff_t>(packed ? item : p.coordinate_stride)};
}

cullhull_points points_of(const PointView& view) {
  return {sizeof(cullhull_points),
          view.data,
          view.count,
          view.dimension,
          static_cast<std::int32_t>(exchanged(static_cast<std::int32_t>(view.scalar))),
          view.point_stride,
          view.coordinate_stride};
}

/// An exception of a callback, which may be written in C++, stops the call as well.
template <class Callback>
void ask(stop_source& source, const Callback& callback) noexcept {
  try {
    if (callback() != 0) source.request_stop();
  } catch (...) {
    source.request_stop();
  }
}

CallOptions::CallOptions(const cullhull_options* given) {
  if (given == nullptr) return;
  const auto o = known(given, "options->size is not sizeof(cullhull_options)");
  if (o.backend < CULLHULL_BACKEND_AUTO || o.backend > CULLHULL_BACKEND_CUDA)
    refuse("options->backend is none of cullhull_backend");
  if (o.cull < CULLHULL_CULL_AUTO || o.cull > CULLHULL_CULL_NONE)
    refuse("options->cull is none of cullhull_filter");
  options.threads = o.threads;
  options.memory_budget = o.memory_budget;
  options.backend = static_cast<Backend>(o.backend);
  options.cull = static_cast<CullMethod>(o.cull);
  options.with_coordinates = o.with_coordinates != 0;
  furthest_site = o.furthest_site != 0;
  if (o.progress == nullptr && o.cancelled == nullptr) return;
  stop_source source;
  options.stop = source.get_token();
  if (o.progress != nullptr)
    options.progress = [source, o](const char* phase, double share) mutable {
      ask(source, [&] { return o.progress(o.user, phase, share); });
    };
  if (o.cancelled != nullptr)
    options.poll = [source, o]() mutable { ask(source, [&] { return o.cancelled(o.user); }); };
}

void fill(cullhull_certificate* out, const Certificate& certificate) {
  cullhull_certificate own{};
  own.valid = certificate.valid ? 1 : 0;
  own.ridges_checked = certificate.ridges_checked;
  own.points_checked = certificate.points_checked;
  own.exact_decisions = certificate.exact_decisions;
  certificate.reason.copy(own.reason, sizeof own.reason - 1);
  fill(out, own, "certificate->size is not sizeof(cullhull_certificate)");
}

void* handed_over(const void* items, std::size_t bytes) {
  void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw std::bad_alloc();
  if (bytes > 0) std::memcpy(memory, items, bytes);
  return memory;
}

}  // namespace cullhull::c

using namespace cullhull::c;  // NOLINT: the functions of the header follow

const char* cullhull_last_error() { return last_message.data(); }

const char* cullhull_status_name(int status) {
  static const char* const names[] = {"ok",        "invalid_argument", "not_finite",
                                      "bad_data",  "out_of_budget",    "backend_unavailable",
                                      "cancelled", "out_of_memory",    "internal"};
  const auto i = static_cast<unsigned>(status);
  return i < std::size(names) ? names[i] : "unknown";
}

const char* cullhull_version() { return cullhull::version(); }

void cullhull_free(void* memory) { std::free(memory); }
