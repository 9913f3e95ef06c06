#include "bake/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace sunbeam {
namespace {

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

Progress::Progress(std::string what, std::string unit, double total)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

std::string Progress::line(double fraction, double done) const {
  const double elapsed = seconds_between(start_, std::chrono::steady_clock::now());
  const double left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
  return fmt::format("{} {:3.0f} %  {:.4g} {}/s  {:.0f} s left", what_, 100 * fraction,
                     done / std::max(elapsed, 1e-9), unit_, left);
}

void Progress::show(double fraction, double done) {
  const auto now = std::chrono::steady_clock::now();
  const bool finished = fraction >= 1;
  if (terminal_) {
    if (!finished && seconds_between(last_, now) < 0.1) return;
    last_ = now;
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(fraction * kWidth);
    fmt::print(stderr, "\r[{}{}] {}\x1b[K{}", std::string(filled, '#'), std::string(kWidth - filled, '.'),
               line(fraction, done), finished ? "\n" : "");
    std::fflush(stderr);
  } else if (static_cast<int>(fraction * 10) > tenths_) {
    tenths_ = static_cast<int>(fraction * 10);
    fmt::print(stderr, "{}\n", line(fraction, done));
  }
}

}  // namespace sunbeam
