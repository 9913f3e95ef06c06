// Progress on stderr: a bar that redraws itself on a terminal, a plain line every tenth otherwise.
#pragma once

#include <chrono>
#include <string>

namespace sunbeam {

class Progress {
 public:
  // `unit` and `total` give the rate: "nodes", 1280 shows nodes a second.
  Progress(std::string what, std::string unit, double total);
  void operator()(double fraction) { show(fraction, total_ * fraction); }
  // Where the total is not known: `done` of the units so far.
  void show(double fraction, double done);

 private:
  std::string line(double fraction, double done) const;

  std::string what_, unit_;
  double total_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_;
  int tenths_ = 0;
};

}  // namespace sunbeam
