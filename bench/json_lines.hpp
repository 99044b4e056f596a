// Figures as lines of JSON. Each is printed, and appended to a file, as soon as it is known: a
// program that is cut off has written everything that it measured.
#pragma once

#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "cullhull/error.hpp"

namespace cullhull::bench {

class JsonLines {
 public:
  /// `file`: appended to; empty: lines are only printed. Parts that would start more than `seconds`
  /// after this are left out.
  JsonLines(const std::string& file, double seconds) : seconds_(seconds) {
    if (file.empty()) return;
    out_.open(file, std::ios::app);
    if (!out_) throw Error(ErrorCode::io, file + ": cannot be written");
  }

  /// Measures a part: `work` returns its figures, which are added to `line`. A part for which there
  /// is no memory or no time left has the reason as "left_out", one that throws has an "error".
  template <class Work>
  void part(nlohmann::ordered_json line, Work&& work) {
    if (seconds_left() < 0) {
      line["left_out"] = "no time left";
    } else {
      try {
        line.update(std::forward<Work>(work)());
      } catch (const Error& e) {
        if (e.code() == ErrorCode::out_of_budget) {
          line["left_out"] = e.what();
        } else {
          line["error"] = e.what();
          failed_ = true;
        }
      } catch (const std::exception& e) {
        line["error"] = e.what();
        failed_ = true;
      }
    }
    line["at_seconds"] = seconds_ - seconds_left();
    const std::string text = line.dump();
    std::printf("%s\n", text.c_str());
    std::fflush(stdout);
    if (out_.is_open()) out_ << text << std::endl;
  }

  double seconds_left() const {
    return seconds_ - std::chrono::duration<double>(Clock::now() - start_).count();
  }
  /// Whether a part had an error, or fail() was called.
  bool failed() const { return failed_; }
  /// For figures that are reported although a result is wrong.
  void fail() { failed_ = true; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double seconds_;
  std::ofstream out_;
  bool failed_ = false;
};

}  // namespace cullhull::bench
