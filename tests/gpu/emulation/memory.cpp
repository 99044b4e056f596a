#include "memory.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>

#include "device.hpp"
#include "emulation.hpp"
#include "races.hpp"

namespace emulation {
namespace {

constexpr std::size_t page = 4096, alignment = 256;
constexpr unsigned char fresh = 0xCB, fresh_pinned = 0xDA;
/// Larger ones are filled at their ends only.
constexpr std::size_t most_filled = std::size_t{1} << 28, filled_ends = std::size_t{1} << 20;

/// One key a device; -1: this processor or kernel has none, and the host's accesses go unnoticed.
int key_of(int device) {
  static std::map<int, int> keys;
  const auto [at, inserted] = keys.try_emplace(device, -1);
  if (inserted) at->second = pkey_alloc(0, PKEY_DISABLE_ACCESS);
  return at->second;
}

struct Region {
  char* map = nullptr;
  std::size_t map_bytes = 0, bytes = 0;
  int device = 0;
  bool ready = true;

  char* body() const { return map + page; }
  std::size_t body_bytes() const { return map_bytes - 2 * page; }
};

std::map<std::uintptr_t, Region>& regions() {
  static std::map<std::uintptr_t, Region> all;
  return all;
}
std::map<std::uintptr_t, std::size_t>& pinned() {
  static std::map<std::uintptr_t, std::size_t> all;
  return all;
}

std::uintptr_t address(const void* p) { return reinterpret_cast<std::uintptr_t>(p); }

void protect(const Region& region, int rights) {
  const int key = key_of(region.device);
  if (key > 0)
    (void)pkey_mprotect(region.body(), region.body_bytes(), rights, key);
  else
    (void)mprotect(region.body(), region.body_bytes(), rights);
}

bool all_fresh(const char* begin, const char* end) {
  return std::all_of(begin, end, [](char c) { return static_cast<unsigned char>(c) == fresh; });
}

const std::map<std::uintptr_t, Region>::value_type* find(const void* p) {
  auto at = regions().upper_bound(address(p));
  if (at == regions().begin()) return nullptr;
  --at;
  const std::size_t bytes = std::max<std::size_t>(at->second.bytes, 1);
  return address(p) < at->first + bytes ? &*at : nullptr;
}

/// The addresses stay taken, so that a use after the end faults.
void close(char* map, std::size_t bytes) {
  (void)mmap(map, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
}

}  // namespace

DeviceAccess::DeviceAccess(int device) : device_(device) {
  const int key = key_of(device);
  if (key <= 0) return;
  before_ = static_cast<unsigned>(pkey_get(key));
  (void)pkey_set(key, 0);
}

DeviceAccess::~DeviceAccess() {
  const int key = key_of(device_);
  if (key > 0) (void)pkey_set(key, before_);
}

void* allocate_device(std::size_t bytes, int device, bool ready) {
  if (!may_allocate(bytes)) return nullptr;
  Region region;
  region.bytes = bytes;
  region.device = device;
  region.ready = ready;
  region.map_bytes = (bytes + page - 1) / page * page + 2 * page;
  static std::size_t arena_used = 0;
  if (region.map_bytes > device_arena_bytes - arena_used)
    violation("the addresses of device memory, none of which is used twice, are used up");
  region.map = device_arena() + arena_used;
  arena_used += region.map_bytes;
  // As near to the guard page behind as the alignment of device memory allows.
  char* begin = region.body() + (region.body_bytes() - bytes) / alignment * alignment;
  protect(region, PROT_READ | PROT_WRITE);
  {
    const DeviceAccess access(device);
    const std::size_t body = region.body_bytes(), ends = body > most_filled ? filled_ends : body;
    std::memset(region.body(), fresh, ends);
    std::memset(region.body() + body - ends, fresh, ends);
  }
  if (!ready) protect(region, PROT_NONE);
  regions()[address(begin)] = region;
  count_allocation(static_cast<std::ptrdiff_t>(bytes));
  return begin;
}

void make_ready(void* memory) {
  Region& region = regions().at(address(memory));
  if (!region.ready) protect(region, PROT_READ | PROT_WRITE);
  region.ready = true;
}

void release_device(void* memory) {
  const auto at = regions().find(address(memory));
  if (at == regions().end()) violation("freeing what is no allocation");
  const Region region = at->second;
  {
    const DeviceAccess access(region.device);
    const char* begin = static_cast<const char*>(memory);
    if (!all_fresh(region.body(), begin)) violation("a write before an allocation");
    if (!all_fresh(begin + region.bytes, region.body() + region.body_bytes()))
      violation("a write behind an allocation");
  }
  close(region.map, region.map_bytes);
  forget_accesses(region.map, region.map_bytes);
  count_allocation(-static_cast<std::ptrdiff_t>(region.bytes));
  regions().erase(at);
}

std::optional<Allocation> device_allocation(const void* p) {
  const auto* found = find(p);
  if (found == nullptr) return std::nullopt;
  return Allocation{reinterpret_cast<char*>(found->first), found->second.bytes,
                    found->second.device};
}

void require_device_range(const void* p, std::size_t bytes, const char* doing) {
  const auto* found = find(p);
  if (found == nullptr) violation(std::string(doing) + ": no device memory");
  if (address(p) + bytes > found->first + found->second.bytes)
    violation(std::string(doing) + " goes beyond an allocation");
}

void* allocate_pinned(std::size_t bytes) {
  const std::size_t body = (bytes + page - 1) / page * page;
  void* map =
      mmap(nullptr, body + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (map == MAP_FAILED) return nullptr;
  auto* begin = static_cast<char*>(map);
  close(begin + body, page);
  std::memset(begin, fresh_pinned, body);
  begin += (body - bytes) / 64 * 64;
  pinned()[address(begin)] = bytes;
  return begin;
}

void release_pinned(void* memory) {
  const auto at = pinned().find(address(memory));
  if (at == pinned().end()) violation("freeing pinned memory that is none");
  char* map = reinterpret_cast<char*>(at->first / page * page);
  close(map, (at->second + page - 1) / page * page);
  pinned().erase(at);
}

bool is_pinned(const void* p) {
  auto at = pinned().upper_bound(address(p));
  if (at == pinned().begin()) return false;
  --at;
  return address(p) < at->first + at->second;
}

}  // namespace emulation
