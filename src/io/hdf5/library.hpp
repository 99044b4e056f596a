// Calls of libhdf5: loaded when the first file needs it, its handles, its lock, its silence.
// Linked, it would bring some thirty libraries (curl, LDAP, Kerberos) into every start of the
// program: 60 ms of loading, and 27 MB of addresses, for a format that few runs read.
#pragma once

#if CULLHULL_HAVE_HDF5
#define H5_USE_110_API 1  // later versions keep what 1.10 had under it
#include <hdf5.h>

#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include "cullhull/error.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "parallel/threads/fork_guard.hpp"

namespace cullhull::internal {

// clang-format off
#define CULLHULL_HDF5_FUNCTIONS(X) \
  X(H5Dclose) \
  X(H5Dget_chunk_storage_size) \
  X(H5Dget_create_plist) \
  X(H5Dget_space) \
  X(H5Dget_space_status) \
  X(H5Dget_type) \
  X(H5Dopen2) \
  X(H5Dread) \
  X(H5Eclear2) \
  X(H5Eget_auto2) \
  X(H5Eset_auto2) \
  X(H5Ewalk2) \
  X(H5Fclose) \
  X(H5Fopen) \
  X(H5Ovisit) \
  X(H5Pclose) \
  X(H5Pcreate) \
  X(H5Pfill_value_defined) \
  X(H5Pget_chunk) \
  X(H5Pget_external_count) \
  X(H5Pget_fill_time) \
  X(H5Pget_layout) \
  X(H5Pset_chunk_cache) \
  X(H5Sclose) \
  X(H5Screate_simple) \
  X(H5Sget_simple_extent_dims) \
  X(H5Sget_simple_extent_ndims) \
  X(H5Sselect_hyperslab) \
  X(H5Tclose) \
  X(H5Tget_class) \
  X(H5Tget_fields) \
  X(H5Tget_sign) \
  X(H5Tget_size) \
  X(H5dont_atexit) \
  X(H5open)
// clang-format on
// In two steps: some of the names are macros, for the version of a function.
#define CULLHULL_HDF5_NAME(f) #f
#define CULLHULL_HDF5_MEMBER(f) decltype(&::f) f;
#define CULLHULL_HDF5_FIND(f) f = reinterpret_cast<decltype(f)>(symbol(CULLHULL_HDF5_NAME(f)));

/// The library's functions, as members of their names.
class Hdf5Library {
 public:
  CULLHULL_HDF5_FUNCTIONS(CULLHULL_HDF5_MEMBER)

  /// Throws Error{io} where the library is not installed.
  Hdf5Library() : library_(system::open_library(CULLHULL_HDF5_LIBRARY)) {
    if (library_ == nullptr)
      throw Error(ErrorCode::io, "HDF5 is read by ", CULLHULL_HDF5_LIBRARY,
                  ", which cannot be loaded: is it installed?");
    CULLHULL_HDF5_FUNCTIONS(CULLHULL_HDF5_FIND)
    // Before all else. Opening a corrupt file leaves something open in libhdf5 1.10, which would
    // complain of it on standard error when the process ends. What a caller leaves open itself is
    // not closed then.
    H5dont_atexit();
    H5open();
  }
  /// A number that the library sets as it starts: of a type, or of a class of properties.
  hid_t number(const char* name) const { return *static_cast<const hid_t*>(symbol(name)); }

 private:
  void* symbol(const char* name) const {
    void* found = system::find_symbol(library_, name);
    if (found == nullptr) throw Error(ErrorCode::io, CULLHULL_HDF5_LIBRARY, " has no ", name);
    return found;
  }
  void* library_;
};

/// H5F_ACC_RDONLY, whose macro calls the library by name.
inline constexpr unsigned read_only = 0;

inline const Hdf5Library& h5() {
  static const Hdf5Library& library = *new Hdf5Library;  // stays loaded
  return library;
}

#undef CULLHULL_HDF5_FIND
#undef CULLHULL_HDF5_MEMBER
#undef CULLHULL_HDF5_NAME
#undef CULLHULL_HDF5_FUNCTIONS

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

/// What this thread has libhdf5 read; null while it does not call it.
inline const char*& read_by_libhdf5() {
  static thread_local const char* name = nullptr;
  return name;
}

/// Held by the thread that calls libhdf5; libhdf5's own state is in the middle of something then,
/// too.
inline std::mutex& hdf5_mutex() {
  static std::mutex& one = *new std::mutex;
  return one;
}
inline const ForkGuard hdf5_guard(
    ForkGuard::Order::outer, [] { hdf5_mutex().lock(); }, [] { hdf5_mutex().unlock(); });

/// While it lives, this thread alone calls libhdf5 and nothing is printed on standard error.
class Quiet {
 public:
  /// `name`: of the file, for describe_library_fault(); it outlives the call.
  explicit Quiet(const std::string& name) : lock_(hdf5_mutex()) {
    read_by_libhdf5() = name.c_str();
    h5().H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    h5().H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() {
    h5().H5Eclear2(H5E_DEFAULT);  // libhdf5 frees what it says of an error no earlier, not even
                                  // when the thread ends
    h5().H5Eset_auto2(H5E_DEFAULT, print_, data_);
    read_by_libhdf5() = nullptr;
  }

 private:
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
  h5().H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, text);
  for (char* c = text; *c != 0; ++c)  // it quotes names, which a damaged file makes of any bytes
    if (*c < ' ' || *c > '~') *c = '?';
  return text[0] == 0 ? "" : " (libhdf5: " + std::string(text) + ")";
}

}  // namespace cullhull::internal
#endif
