// Progress on stderr: a bar that redraws itself on a terminal, a plain line every tenth otherwise.
#pragma once

#include <chrono>
#include <string>

namespace sunbeam {

class Progress {
 public:
  // `unit` and `total` give the rate: "nodes", 1280 shows nodes a second.
  Progress(std::string what, std::string unit, double total);
  void operator()(double fraction);

 private:
  std::string line(double fraction) const;

  std::string what_, unit_;
  double total_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_;
  int tenths_ = 0;
};

}  // namespace sunbeam
