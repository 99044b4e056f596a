// Options of the calls that tests make.
#pragma once

#include "cullhull/options.hpp"

namespace cullhull::testing_support {

inline Options options_of(unsigned threads, CullMethod cull = CullMethod::automatic) {
  Options options;
  options.threads = threads;
  options.cull = cull;
  return options;
}

/// Options by which a stop has been requested before the call.
template <class AnyOptions = Options>
AnyOptions stopped() {
  stop_source source;
  source.request_stop();
  AnyOptions options;
  options.stop = source.get_token();
  return options;
}

}  // namespace cullhull::testing_support
