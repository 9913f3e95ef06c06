// This file shows progress on stderr. On a terminal it is a bar that redraws itself, otherwise a plain line
// every tenth; for the log of a render farm it is a line of JSON every second.
#pragma once

#include <chrono>
#include <string>

#include "bake/blocks/run.h"

namespace sunbeam {

enum class ProgressForm { text, json };

// Returns the form that the option --progress names: "text" or "json".
inline ProgressForm progress_form(const std::string& name) {
  return name == "json" ? ProgressForm::json : ProgressForm::text;
}

class Progress {
 public:
  // Starts the clock. `unit` and `total` give the rate: "nodes", 1280 shows nodes a second.
  Progress(std::string what, std::string unit, double total, ProgressForm form = ProgressForm::text);
  void operator()(double fraction) { show(fraction, total_ * fraction); }
  // Shows the progress of a bake. What an earlier run had done counts as done, but not for the rate.
  void operator()(const BakeProgress& progress);
  // Shows the progress where the total is not known; `done` counts the units so far.
  void show(double fraction, double done);

 private:
  struct State {
    double fraction, done;
    double resumed = 0;       // of the fraction
    double worst_error = -1;  // none if negative
  };
  void show(const State& state);
  double seconds_left(const State& state) const;
  double per_second(const State& state) const;
  std::string line(const State& state) const;
  std::string json(const State& state) const;

  std::string what_, unit_;
  double total_;
  ProgressForm form_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_;
  int tenths_ = 0;
};

}  // namespace sunbeam
