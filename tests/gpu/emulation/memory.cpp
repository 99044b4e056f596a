#include "memory.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <utility>

#include "device.hpp"
#include "emulation.hpp"
#include "races.hpp"

namespace emulation {
namespace {

constexpr std::size_t page = 4096, alignment = 256;
constexpr unsigned char fresh = 0xCB, fresh_pinned = 0xDA;
/// Larger ones are filled at their ends only.
constexpr std::size_t most_filled = std::size_t{1} << 28, filled_ends = std::size_t{1} << 20;

/// A key that no device has, to learn whether there are any.
bool has_keys() {
  const int key = pkey_alloc(0, 0);
  if (key > 0) (void)pkey_free(key);
  return key > 0;
}

Guard chosen_guard() {
  const char* const text = std::getenv("CULLHULL_DEVICE_GUARD");
  const std::string name = text == nullptr ? "" : text;
  const Guard guard = name == "off"                  ? Guard::off
                      : name == "pages"              ? Guard::pages
                      : name == "keys" || has_keys() ? Guard::keys
                                                     : Guard::pages;
  if (guard != Guard::off && !name.empty() && name != "pages" && name != "keys")
    violation("CULLHULL_DEVICE_GUARD is keys, pages or off, not " + name);
  if (guard == Guard::keys && !has_keys()) {
    std::fprintf(stderr, "emulation: this processor or kernel has no protection keys\n");
    std::_Exit(77);
  }
  static const char* const said[] = {"protection keys", "the rights of its pages", "nothing"};
  std::fprintf(stderr, "emulation: device memory is guarded by %s\n",
               said[static_cast<int>(guard)]);
  return guard;
}

int key_of(int device) {
  static std::map<int, int> keys;
  const auto [at, inserted] = keys.try_emplace(device, 0);
  if (inserted) at->second = pkey_alloc(0, PKEY_DISABLE_ACCESS);
  if (at->second <= 0) violation("more devices than protection keys");
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

/// How many accesses to each device are open, where pages are the guard.
std::map<int, int>& open_accesses() {
  static std::map<int, int> all;
  return all;
}

/// Gives the block's pages the rights that they have now.
void protect(const Region& region) {
  int rights = region.ready ? PROT_READ | PROT_WRITE : PROT_NONE;
  if (guard() == Guard::keys) {
    (void)pkey_mprotect(region.body(), region.body_bytes(), rights, key_of(region.device));
    return;
  }
  if (guard() == Guard::pages && open_accesses()[region.device] == 0) rights = PROT_NONE;
  (void)mprotect(region.body(), region.body_bytes(), rights);
}

void protect_all(int device) {
  for (const auto& [begin, region] : regions())
    if (region.device == device) protect(region);
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

Guard guard() {
  static const Guard chosen = chosen_guard();
  return chosen;
}

DeviceAccess::DeviceAccess(int device) : device_(device) {
  if (guard() == Guard::keys) {
    before_ = static_cast<unsigned>(pkey_get(key_of(device)));
    (void)pkey_set(key_of(device), 0);
  } else if (guard() == Guard::pages && ++open_accesses()[device] == 1) {
    protect_all(device);
  }
}

DeviceAccess::~DeviceAccess() {
  if (guard() == Guard::keys)
    (void)pkey_set(key_of(device_), before_);
  else if (guard() == Guard::pages && --open_accesses()[device_] == 0)
    protect_all(device_);
}

void* allocate_device(std::size_t bytes, int device, bool ready) {
  if (!may_allocate(bytes)) return nullptr;
  Region region;
  region.bytes = bytes;
  region.device = device;
  region.map_bytes = (bytes + page - 1) / page * page + 2 * page;
  static std::size_t arena_used = 0;
  if (region.map_bytes > device_arena_bytes - arena_used)
    violation("the addresses of device memory, none of which is used twice, are used up");
  region.map = device_arena() + arena_used;
  arena_used += region.map_bytes;
  // As near to the guard page behind as the alignment of device memory allows.
  char* begin = region.body() + (region.body_bytes() - bytes) / alignment * alignment;
  {
    const DeviceAccess access(device);
    region.ready = true;  // to be filled
    protect(region);
    const std::size_t body = region.body_bytes(), ends = body > most_filled ? filled_ends : body;
    std::memset(region.body(), fresh, ends);
    std::memset(region.body() + body - ends, fresh, ends);
  }
  region.ready = ready;
  protect(region);
  regions()[address(begin)] = region;
  count_allocation(static_cast<std::ptrdiff_t>(bytes));
  return begin;
}

void make_ready(void* memory) {
  Region& region = regions().at(address(memory));
  if (std::exchange(region.ready, true)) return;
  protect(region);
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
