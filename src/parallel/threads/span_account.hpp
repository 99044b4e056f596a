// The account of spans: predicts what a call takes on P workers, on a machine that has fewer.
// Compiled with the build option CULLHULL_SPAN_ACCOUNT alone; without it nothing of it is left.
//
// While an account is kept, a parallel loop runs its chunks one after the other on the calling
// thread and times each. From these times it works out when P workers would be done that begin with
// contiguous parts and then steal, as the real ones do: the loop's span. What lies between the
// loops is one thread's, whatever P. The sum of both is the prediction.
//
// Example: 10 ms before a loop of 32 chunks of 1 ms each. One thread takes 42 ms, 16 workers 12 ms,
// and no number of workers less than 11 ms.
//
// The account knows nothing of memory bandwidth, nor of caches that workers share or do not share.
// Of locks it knows those that a LockSpan names: a loop's span is at least the time that one of
// them is held in all.
#pragma once

#ifdef CULLHULL_SPAN_ACCOUNT
#include <cstdint>
#include <functional>
#include <string>
#include <vector>
#endif

namespace cullhull::internal {

/// The place in the text that starts a loop. (clang 14 has no std::source_location.)
struct CodePlace {
#ifdef CULLHULL_SPAN_ACCOUNT
  const char* file;
  unsigned line;
  static constexpr CodePlace current(const char* file = __builtin_FILE(),
                                     unsigned line = __builtin_LINE()) {
    return {file, line};
  }
#else
  static constexpr CodePlace current() { return {}; }
#endif
};

/// Counts the time until its destruction as time in which `lock` is held.
class LockSpan {
 public:
#ifdef CULLHULL_SPAN_ACCOUNT
  explicit LockSpan(const void* lock);
  ~LockSpan();
  LockSpan(const LockSpan&) = delete;
  LockSpan& operator=(const LockSpan&) = delete;

 private:
  const void* lock_;
  double begin_;
#else
  explicit constexpr LockSpan(const void*) {}
#endif
};

#ifdef CULLHULL_SPAN_ACCOUNT

/// A loop of the text, or the stretch of one thread from one loop to the next.
struct SpanStretch {
  std::string name;  ///< file:line, or "file:line to file:line" from loop to loop
  bool serial = false;
  std::uint64_t calls = 0, chunks = 0;
  double work = 0;     ///< seconds of one thread
  double span = 0;     ///< seconds until P workers are done
  double longest = 0;  ///< seconds of the longest chunk
};

struct SpanAccount {
  double work = 0;       ///< seconds of one thread that does all that P workers would do
  double predicted = 0;  ///< seconds of P workers
  double serial = 0;     ///< of these, outside of loops
  std::vector<SpanStretch> stretches;  ///< longest span first
};

/// Calls work(), whose loops on this thread are counted for `workers`. Time is processor time.
SpanAccount account_of_spans(unsigned workers, const std::function<void()>& work);

/// Whether an account is kept on this thread.
bool counting_spans();
/// Whether this loop must be run by run_counted_loop(): an account is kept, and no counted loop
/// runs.
bool counts_loop();
/// Runs item(k) for each k below `count`, in order, as a loop of `workers`.
void run_counted_loop(std::uint64_t count, unsigned workers, const CodePlace& where,
                      const std::function<void(std::uint64_t)>& item);

#else

inline constexpr bool counting_spans() { return false; }

#endif

}  // namespace cullhull::internal
