// Random calls on the emulated device, in either precision.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "agreement/random_seeds.hpp"
#include "cullhull/array.hpp"
#include "emulation.hpp"
#include "tests/gpu/device.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::testing {

/// `Work` has run_as<Real>().
template <class Work>
class RandomWork {
 public:
  explicit RandomWork(std::uint64_t seed) : random_(seed), seed_(seed) {}

  void run() {
    emulation::settings() = {};
    emulation::restart(seed_);
    auto& work = static_cast<Work&>(*this);
    if (one_in(2))
      work.template run_as<float>();
    else
      work.template run_as<double>();
    emulation::settings() = {};
  }

 protected:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }

  /// Orders of work and failures of the device's and of pinned memory. `allocations`: of the
  /// device, among which one may fail; `pinned`: likewise.
  void choose_failures(std::uint64_t allocations, std::uint64_t pinned) {
    emulation::Settings& s = emulation::settings();
    const emulation::Order orders[] = {emulation::Order::late, emulation::Order::shuffled,
                                       emulation::Order::at_once};
    s.order = orders[below(3)];
    s.pools = !one_in(4);
    if (one_in(4)) s.failing_allocation = 1 + static_cast<long>(below(allocations));
    if (one_in(6)) s.failing_allocations_from = 1 + static_cast<long>(below(allocations));
    if (one_in(8)) s.failing_pinned_from = 1 + static_cast<long>(below(pinned));
    if (one_in(4)) keep_memory(0);  // pinned memory is made anew
  }

  /// Rows, columns or the first columns of wider records, on a device and one of three streams.
  template <class T>
  struct Laid {
    Laid(RandomWork& work, const std::vector<T>& rows, unsigned d)
        : n(rows.size() / d),
          extra(work.one_in(2) ? 0 : work.below(3)),
          columns(work.one_in(4)),
          there(memory(rows, d)),
          which(work.below(3)) {
      const cudaStream_t streams[] = {own, nullptr, cudaStreamPerThread};
      view = columns ? DevicePointView::column_major(there.template data<T>(), n, d, streams[which])
                     : DevicePointView::row_major(there.template data<T>(), n, d, streams[which]);
      if (!columns) view.point_stride = static_cast<std::ptrdiff_t>((d + extra) * sizeof(T));
    }
    std::vector<T> memory(const std::vector<T>& rows, unsigned d) const {
      if (columns) return testing_support::transposed(rows, d);
      std::vector<T> records(n * (d + extra));
      for (std::size_t i = 0; i < n; ++i)
        std::copy_n(rows.data() + i * d, d, records.data() + i * (d + extra));
      return records;
    }

    std::size_t n, extra;
    bool columns;
    OnDevice there;
    Stream own;
    std::uint64_t which;  ///< of the streams; 0: its own, which is of the current device
    DevicePointView view;
  };

  std::mt19937_64 random_;
  std::uint64_t seed_;
};

}  // namespace cullhull::testing
