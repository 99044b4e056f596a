#include "call.hpp"

#include <hwy/cache_control.h>
#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "cullhull/device_points.hpp"

namespace binding {

namespace nb = nanobind;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::Options;

namespace {

constexpr std::chrono::milliseconds signal_interval{50};

/// Messages from the working thread to the waiting one.
class Mailbox {
 public:
  struct News {
    std::vector<std::pair<std::string, double>> reports;
    bool done = false;
  };

  /// Keeps only the last of several reports of a phase that were not fetched yet.
  void report(const char* phase, double share) {
    {
      const std::lock_guard lock(mutex_);
      if (!news_.reports.empty() && news_.reports.back().first == phase)
        news_.reports.back().second = share;
      else
        news_.reports.emplace_back(phase, share);
    }
    changed_.notify_one();
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    news_.done = true;
    changed_.notify_one();
  }
  News wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, signal_interval,
                      [this] { return news_.done || !news_.reports.empty(); });
    return {std::exchange(news_.reports, {}), news_.done};
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  News news_;
};

/// Runs the caller's Python code, if there is any: progress callbacks and signal handlers.
void attend(const Mailbox::News& news, const nb::object& progress) {
  for (const auto& [phase, share] : news.reports) progress(phase, share);
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// The GIL given back for as long as this lives. Where several threads make calls they take turns
/// at `held_`, awake for some microseconds, before they ask Python for it, whose own way is to
/// sleep until it is free and to wake up on a core that others need. Calls of 100 points in space
/// by eight threads on two cores so have 1.7 times the throughput of one thread, by Python's
/// way 1.4 (0.75 and 0.4 where a cache line takes 200 ns from core to core instead of 40).
class GilRelease {
 public:
  GilRelease() : state_(PyEval_SaveThread()) {
    held_.store(false, std::memory_order_relaxed);
    away_.fetch_add(1, std::memory_order_relaxed);
  }
  GilRelease(const GilRelease&) = delete;
  GilRelease& operator=(const GilRelease&) = delete;
  ~GilRelease() {
    static const unsigned cores = std::thread::hardware_concurrency();
    const bool crowded = away_.load(std::memory_order_relaxed) >= cores;
    // As often as it takes some 10 us; after that its holder does something else with it.
    for (int left = crowded ? 20 : 200; left > 0; --left) {
      if (!held_.load(std::memory_order_relaxed) &&
          !held_.exchange(true, std::memory_order_relaxed))
        break;
      if (crowded)
        std::this_thread::yield();
      else
        hwy::Pause();
    }
    away_.fetch_sub(1, std::memory_order_relaxed);
    PyEval_RestoreThread(state_);
    held_.store(true, std::memory_order_relaxed);
  }

 private:
  inline static std::atomic<bool> held_ = false;  ///< by a thread that was here before
  inline static std::atomic<unsigned> away_ = 0;  ///< threads that are here
  PyThreadState* state_;
};

/// Runs on this thread, and checks for signals wherever the library polls.
void run_and_poll(const Settings& settings, const std::function<void(const Options&)>& work) {
  using Clock = std::chrono::steady_clock;
  std::stop_source stop;
  std::optional<nb::python_error> interruption;
  Clock::time_point next = Clock::now() + signal_interval;
  Options options = settings.options;
  options.stop = stop.get_token();
  options.poll = [&] {
    if (Clock::now() < next || interruption) return;
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) {
      interruption.emplace();
      stop.request_stop();
    }
    next = Clock::now() + signal_interval;
  };
  try {
    const GilRelease release;
    work(options);
  } catch (...) {
    if (!interruption) throw;  // otherwise it is the effect of the stop
  }
  if (interruption) throw std::move(*interruption);
}

void run_on_thread(const Settings& settings, const std::function<void(const Options&)>& work) {
  std::stop_source stop;
  Mailbox mailbox;
  std::exception_ptr failure;
  std::optional<nb::python_error> interruption;
  Options options = settings.options;
  options.stop = stop.get_token();
  // The current device is a property of each thread; the caller's is meant. `auto` must not start
  // the driver: the planner does if it wants a device.
  if (options.device < 0 && options.backend == cullhull::Backend::cuda)
    options.device = cullhull::current_cuda_device();
  else if (options.device < 0 && options.backend == cullhull::Backend::automatic)
    options.device = cullhull::chosen_cuda_device();
  if (settings.shows_progress())
    options.progress = [&mailbox](const char* phase, double share) {
      mailbox.report(phase, share);
    };
  {
    const nb::gil_scoped_release release;
    std::jthread worker([&] {
      try {
        work(options);
      } catch (...) {
        failure = std::current_exception();
      }
      mailbox.finish();
    });
    for (bool done = false; !done;) {
      const Mailbox::News news = mailbox.wait();
      done = news.done;
      if (interruption) continue;  // it was asked to stop
      const nb::gil_scoped_acquire acquire;
      try {
        attend(news, settings.progress);
      } catch (nb::python_error& e) {
        interruption.emplace(std::move(e));
        stop.request_stop();
      }
    }
  }
  if (interruption) throw std::move(*interruption);
  if (failure) std::rethrow_exception(failure);
}

cullhull::Backend backend_of(const std::string& name) {
  if (name == "auto") return cullhull::Backend::automatic;
  if (name == "cpu") return cullhull::Backend::cpu;
  if (name == "cuda") return cullhull::Backend::cuda;
  throw nb::value_error(("backend must be 'auto', 'cpu' or 'cuda', not '" + name + "'").c_str());
}

cullhull::CullMethod method_of(const std::string& name) {
  if (name == "auto") return cullhull::CullMethod::automatic;
  if (name == "gauge") return cullhull::CullMethod::gauge;
  if (name == "pseudo-hull") return cullhull::CullMethod::pseudo_hull;
  if (name == "none") return cullhull::CullMethod::none;
  throw nb::value_error(
      ("cull must be 'auto', 'gauge', 'pseudo-hull' or 'none', not '" + name + "'").c_str());
}

const char* class_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument:
      return "InvalidArgument";
    case ErrorCode::not_finite:
      return "NotFinite";
    case ErrorCode::bad_file:
      return "BadFile";
    case ErrorCode::io:
      return "FileError";
    case ErrorCode::out_of_budget:
      return "OutOfBudget";
    case ErrorCode::backend_unavailable:
      return "BackendUnavailable";
    case ErrorCode::cancelled:
      return "Cancelled";
    default:
      return "InternalError";
  }
}

void translate(const std::exception_ptr& e, void*) {
  try {
    std::rethrow_exception(e);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("cullhull._errors").attr(class_of(error.code()));
    PyErr_SetString(type.ptr(), error.what());
  }
}

// A callback may refer to an object that holds these settings (a traceback, say), so the garbage
// collector must see it.
int visit_progress(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (nb::inst_ready(self)) Py_VISIT(nb::inst_ptr<Settings>(self)->progress.ptr());
  return 0;
}
int clear_progress(PyObject* self) {
  nb::inst_ptr<Settings>(self)->progress = nb::none();
  return 0;
}
PyType_Slot settings_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(visit_progress)},
                                {Py_tp_clear, reinterpret_cast<void*>(clear_progress)},
                                {0, nullptr}};

}  // namespace

const Settings& settings_or_default(const Settings* settings) {
  static const Settings* const as_a_rule = new Settings{};  // never freed: Python may have ended
  return settings != nullptr ? *settings : *as_a_rule;
}

void run(const Settings* given, Length length, const std::function<void(const Options&)>& work) {
  const Settings& settings = settings_or_default(given);
  if (length == Length::long_ || settings.shows_progress()) {
    run_on_thread(settings, work);
  } else if (length == Length::moderate) {
    run_and_poll(settings, work);
  } else if (length == Length::tiny) {
    work(settings.options);
  } else {
    const GilRelease release;
    work(settings.options);
  }
}

// Starting a thread takes some 50 us, on a busy machine milliseconds; with these bounds that is at
// most some hundredths of the time that points of a ball or a sphere take.
Length length_of(const cullhull::PointView& points) noexcept {
  const std::uint32_t d = points.dimension;
  const std::uint64_t n = points.count;
  if (d <= 3 ? n <= 500 : d == 4 && n <= 50) return Length::brief;
  const std::uint64_t bound = d <= 3   ? 200'000
                              : d == 4 ? 20'000
                              : d == 5 ? 2'000
                              : d <= 8 ? 50
                                       : 16;
  return n <= bound ? Length::moderate : Length::long_;
}

Length length_of_hull(const cullhull::PointView& points) noexcept {
  const std::uint64_t few = points.dimension == 2 ? 100 : points.dimension == 3 ? 20 : 0;
  return points.count <= few ? Length::tiny : length_of(points);
}

Length length_of(const cullhull::PointView& points, std::uint64_t simplices) noexcept {
  if (points.dimension > 4 || simplices > 100'000) return Length::long_;
  if (simplices <= 1'000 && points.count <= 500) return Length::brief;
  return points.count <= 100'000 ? Length::moderate : Length::long_;
}

void bind_call(nb::module_& m) {
  nb::register_exception_translator(translate);
  nb::class_<Settings>(m, "Settings", "How to compute; no setting changes a result.",
                       nb::type_slots(settings_slots))
      .def(
          "__init__",
          [](Settings* self, const std::string& backend, const std::string& cull, unsigned threads,
             std::uint64_t memory_budget, nb::object progress) {
    new (self) Settings{};
    self->options.backend = backend_of(backend);
    self->options.cull = method_of(cull);
    self->options.threads = threads;
    self->options.memory_budget = memory_budget;
    self->progress = std::move(progress);
          },
          nb::arg("backend") = "auto", nb::arg("cull") = "auto", nb::arg("threads") = 0,
          nb::arg("memory_budget") = 0, nb::arg("progress").none() = nb::none());
}

}  // namespace binding
