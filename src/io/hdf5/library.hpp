// Calls of libhdf5: its handles, its lock, its silence.
#pragma once

#if CULLHULL_HAVE_HDF5
#define H5_USE_110_API 1  // later versions keep what 1.10 had under it
#include <hdf5.h>

#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include "io/source.hpp"

namespace cullhull::internal {

/// What libhdf5 opened, closed in the end.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  herr_t (*close_)(hid_t) = nullptr;
};

/// While it lives, this thread alone calls libhdf5 and nothing is printed on standard error.
class Quiet {
 public:
  Quiet() : lock_(mutex()) {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  static std::mutex& mutex() {
    // Opening a corrupt file leaves something open in libhdf5 1.10, which would complain of it on
    // standard error when the process ends. What a caller leaves open itself is not closed then.
    static const herr_t never_at_exit = H5dont_atexit();
    static std::mutex one;
    static_cast<void>(never_at_exit);
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

extern "C" inline herr_t keep_first(unsigned, const H5E_error2_t* error, void* out) {
  char* const text = static_cast<char*>(out);
  if (text[0] == 0 && error->desc != nullptr) std::strncpy(text, error->desc, 127);
  return 0;
}

/// " (libhdf5: ...)", of the innermost function that failed in the last call.
inline std::string reason() {
  char text[128] = {};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, text);
  return text[0] == 0 ? "" : " (libhdf5: " + display_name(text) + ")";
}

}  // namespace cullhull::internal
#endif
