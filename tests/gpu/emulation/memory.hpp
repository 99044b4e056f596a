// The memories of the emulated devices, and pinned memory: blocks between guard pages, filled with
// garbage, never handed out twice, each device's out of reach of the host and of other devices,
// which fault when they touch it.
#pragma once

#include <cstddef>
#include <optional>

namespace emulation {

/// What keeps a device's memory out of reach.
enum class Guard {
  keys,   ///< a protection key a device: for each thread by itself; some processors have them
  pages,  ///< the rights of its pages: within reach of all threads while one may touch it
  off,    ///< nothing
};

/// CULLHULL_DEVICE_GUARD says it: keys, pages or off; unset it is keys where there are some, else
/// pages. A process that asks for keys where there are none ends with status 77.
Guard guard();

/// While one lives, this thread may touch the device's memory. They may be nested.
class DeviceAccess {
 public:
  explicit DeviceAccess(int device);
  ~DeviceAccess();
  DeviceAccess(const DeviceAccess&) = delete;
  DeviceAccess& operator=(const DeviceAccess&) = delete;

 private:
  int device_;
  unsigned before_ = 0;
};

struct Allocation {
  char* begin = nullptr;
  std::size_t bytes = 0;
  int device = 0;
};

/// Null: the device is full, or the test wants this one to fail. Not `ready`: a fault to touch
/// before make_ready, as memory of a stream is before the stream comes to its allocation.
void* allocate_device(std::size_t bytes, int device, bool ready);
void make_ready(void* memory);
/// Checks what lies around the block; its addresses are never used again.
void release_device(void* memory);
/// The allocation that holds this address, if one does.
std::optional<Allocation> device_allocation(const void* address);
/// A violation unless [address, address + bytes) lies in one allocation.
void require_device_range(const void* address, std::size_t bytes, const char* doing);

void* allocate_pinned(std::size_t bytes);
void release_pinned(void* memory);
bool is_pinned(const void* address);

}  // namespace emulation
