#include "machine.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/json/json_writer.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::bench {
namespace {

constexpr std::uint64_t mebibyte = 1U << 20;
/// The unit of work that one core reads or copies at a time.
constexpr std::uint64_t piece = 4 * mebibyte / sizeof(std::uint64_t);

/// Uses eight sums, so that additions do not wait for each other.
std::uint64_t sum_of(const std::uint64_t* p, std::uint64_t count) {
  std::uint64_t sum[8] = {};
  std::uint64_t i = 0;
  for (; i + 8 <= count; i += 8)
    for (unsigned k = 0; k < 8; ++k) sum[k] += p[i + k];
  for (; i < count; ++i) sum[0] += p[i];
  for (unsigned k = 1; k < 8; ++k) sum[0] += sum[k];
  return sum[0];
}

template <class Work>
double best_rate(unsigned passes, double bytes, const std::stop_token& stop, const Work& work) {
  double best = 0;
  for (unsigned pass = 0; pass < passes; ++pass) {
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::max(best, bytes / std::max(took.count(), 1e-9));
  }
  return best;
}

std::uint64_t default_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  const std::uint64_t memory =
      pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
                            : 1024 * mebibyte;
  return std::clamp(memory / 16, 16 * mebibyte, 512 * mebibyte);
}

/// Arrays to be read or copied.
class HostMemory {
 public:
  HostMemory(std::uint64_t bytes, bool two, unsigned cores)
      : words_(bytes / sizeof(std::uint64_t)), from_(words_), to_(two ? words_ : 0) {
    // First touch by the threads that use the pages later, approximately.
    internal::for_each_chunk(words_, piece, cores,
                             [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      std::fill(from_.get() + begin, from_.get() + end, begin);
      if (two) std::fill(to_.get() + begin, to_.get() + end, end);
    });
  }
  double bytes() const { return static_cast<double>(words_ * sizeof(std::uint64_t)); }
  void read(unsigned threads) const {
    static std::atomic<std::uint64_t> sink;  // keeps the compiler from removing the sums
    internal::for_each_chunk(words_, piece, threads,
                             [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      sink.store(sum_of(from_.get() + begin, end - begin), std::memory_order_relaxed);
    });
  }
  void copy(unsigned threads) {
    internal::for_each_chunk(words_, piece, threads,
                             [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      std::memcpy(to_.get() + begin, from_.get() + begin, (end - begin) * sizeof(std::uint64_t));
    });
  }

 private:
  std::uint64_t words_;
  internal::BigArray<std::uint64_t> from_, to_;
};

HostRates measure_host(const MachineSettings& settings, unsigned cores, const Progress& progress,
                       const std::stop_token& stop) {
  HostMemory memory(settings.bytes, true, cores);
  const double size = memory.bytes();
  const auto report = [&](double share) {
    if (progress) progress("host memory", share);
  };
  HostRates rates;
  report(0);
  rates.read_one = best_rate(settings.passes, size, stop, [&] { memory.read(1); });
  report(0.25);
  rates.copy_one = best_rate(settings.passes, 2 * size, stop, [&] { memory.copy(1); });
  report(0.5);
  rates.read_all = best_rate(settings.passes, size, stop, [&] { memory.read(cores); });
  report(0.75);
  rates.copy_all = best_rate(settings.passes, 2 * size, stop, [&] { memory.copy(cores); });
  report(1);
  return rates;
}

std::string row(const char* what, double rate) {
  return fmt::format("{:<34}{:>9.2f} GB/s\n", what, rate / 1e9);
}

}  // namespace

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  ::gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

MachineRates measure_machine(const MachineSettings& settings, const Progress& progress,
                             const std::stop_token& stop) {
  MachineSettings resolved = settings;
  if (resolved.bytes == 0) resolved.bytes = default_bytes();
  resolved.bytes = std::max<std::uint64_t>(resolved.bytes, mebibyte);
  MachineRates rates;
  rates.bytes = resolved.bytes;
  rates.cores = internal::resolve_threads(0);
  rates.date = date_now();
  rates.host = measure_host(resolved, rates.cores, progress, stop);
  rates.device = measure_device(resolved.bytes, resolved.passes, progress, stop, rates.no_device);
  return rates;
}

double read_bandwidth(unsigned threads, const std::stop_token& stop) {
  constexpr unsigned passes = 5;
  const HostMemory memory(default_bytes(), false, threads);
  return best_rate(passes, memory.bytes(), stop, [&] { memory.read(threads); });
}

std::string machine_table(const MachineRates& rates) {
  std::string text = fmt::format("cores                             {:>9}\n", rates.cores) +
                     row("host memory, read, one core", rates.host.read_one) +
                     row("host memory, read, all cores", rates.host.read_all) +
                     row("host memory, copy, one core", rates.host.copy_one) +
                     row("host memory, copy, all cores", rates.host.copy_all);
  if (rates.device)
    text += row("to the device, pinned memory", rates.device->link_pinned) +
            row("to the device, pageable memory", rates.device->link_pageable) +
            row("device memory, copy", rates.device->copy) +
            fmt::format("device  {}\n", rates.device->name);
  else
    text += fmt::format("device  none: {}\n", rates.no_device);
  return text + fmt::format(
                    "arrays of {} MiB, best of the passes; a copy counts reading and "
                    "writing; {}\n",
                    rates.bytes / mebibyte, rates.date);
}

std::string machine_json(const MachineRates& rates) {
  nlohmann::ordered_json json;
  json["suite"] = "machine";
  json["date"] = rates.date;
  json["cores"] = rates.cores;
  json["bytes"] = rates.bytes;
  json["host"] = {{"read_one_core_bytes_per_second", rates.host.read_one},
                  {"read_bytes_per_second", rates.host.read_all},
                  {"copy_one_core_bytes_per_second", rates.host.copy_one},
                  {"copy_bytes_per_second", rates.host.copy_all}};
  if (rates.device) {
    json["device"] = {{"name", rates.device->name},
                      {"link_bytes_per_second", rates.device->link_pinned},
                      {"link_pageable_bytes_per_second", rates.device->link_pageable},
                      {"copy_bytes_per_second", rates.device->copy}};
  } else {
    json["device"] = nullptr;
    json["no_device"] = rates.no_device;
  }
  return internal::json_document({"bench_machine_report", {}}, json);
}

std::string planner_constants(const MachineRates& rates) {
  nlohmann::ordered_json json;
  json["host_read_bytes_per_second"] = rates.host.read_all;
  json["host_copy_bytes_per_second"] = rates.host.copy_all;
  if (rates.device) {
    json["link_bytes_per_second"] = rates.device->link_pinned;
    json["device_copy_bytes_per_second"] = rates.device->copy;
  }
  json["cores"] = rates.cores;
  json["date"] = rates.date;
  return internal::json_document({"machine", {}}, json);
}

}  // namespace cullhull::bench
