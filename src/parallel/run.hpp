// What the options of one call come to: handed to every stage.
#pragma once

#include <cstdint>

#include "parallel/control.hpp"
#include "parallel/memory.hpp"
#include "parallel/parallel.hpp"

namespace cullhull::internal {

/// Views the options, which must outlive it.
struct Run {
  explicit Run(const Options& o)
      : options(o),
        control(o),
        threads(resolve_threads(o.threads)),
        budget(resolve_budget(o.memory_budget)) {}

  const Options& options;
  Control control;
  unsigned threads;
  std::uint64_t budget;  ///< bytes
};

}  // namespace cullhull::internal
