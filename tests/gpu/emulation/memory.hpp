// The memories of the emulated devices, and pinned memory: blocks between guard pages, filled with
// garbage, never handed out twice, each device's behind a protection key of its own, so that the
// host and other devices fault when they touch it.
#pragma once

#include <cstddef>
#include <optional>

namespace emulation {

/// While one lives, this thread may touch the device's memory.
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
