// Runs every fuzzer over its seeds, and over versions of them that were cut short or have one byte
// changed, without libFuzzer: replay_seeds CORPUS. A fuzzer that finds a fault aborts.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#define CULLHULL_FUZZER(name) extern "C" int fuzz_##name(const std::uint8_t*, std::size_t);
#include "fuzzers.inc"
#undef CULLHULL_FUZZER

namespace {

using Bytes = std::vector<std::uint8_t>;

struct Fuzzer {
  const char* name;
  int (*run)(const std::uint8_t*, std::size_t);
};

const Fuzzer fuzzers[] = {
#define CULLHULL_FUZZER(name) {#name, fuzz_##name},
#include "fuzzers.inc"
#undef CULLHULL_FUZZER
};

Bytes read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The seed, then cuts and changed bytes at places spread evenly over it.
std::vector<Bytes> versions(const Bytes& seed) {
  constexpr std::size_t places = 8;
  std::vector<Bytes> made{seed};
  for (std::size_t i = 0; i < places; ++i) {
    const std::size_t at = seed.size() * i / places;
    made.emplace_back(seed.begin(), seed.begin() + static_cast<std::ptrdiff_t>(at));
    if (at < seed.size()) {
      made.push_back(seed);
      made.back()[at] ^= static_cast<std::uint8_t>(1u << i);
    }
  }
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: replay_seeds CORPUS\n");
    return 2;
  }
  int without_seeds = 0;
  for (const Fuzzer& fuzzer : fuzzers) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / fuzzer.name;
    std::size_t seeds = 0, runs = 0;
    fuzzer.run(nullptr, 0);
    if (std::filesystem::exists(folder)) {
      for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        ++seeds;
        for (const Bytes& bytes : versions(read(entry.path()))) {
          fuzzer.run(bytes.data(), bytes.size());
          ++runs;
        }
      }
    }
    std::printf("%s: %zu seeds, %zu inputs\n", fuzzer.name, seeds, runs);
    std::fflush(stdout);
    if (seeds == 0) ++without_seeds;
  }
  if (without_seeds > 0) std::fprintf(stderr, "%d fuzzers have no seeds\n", without_seeds);
  return without_seeds > 0 ? 1 : 0;
}
