#include "bake/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include "bake/cli/console.h"

namespace sunbeam {
namespace {

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

Progress::Progress(std::string what, std::string unit, double total, ProgressForm form)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      form_(form),
      terminal_(::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

void Progress::operator()(const BakeProgress& p) {
  show({p.fraction, static_cast<double>(p.done), p.resumed, p.worst_error});
}

void Progress::show(double fraction, double done) { show(State{fraction, done}); }

double Progress::seconds_left(const State& s) const {
  const double elapsed = seconds_between(start_, std::chrono::steady_clock::now());
  return s.fraction > s.resumed ? elapsed * (1 - s.fraction) / (s.fraction - s.resumed) : 0;
}

double Progress::per_second(const State& s) const {
  const double elapsed = seconds_between(start_, std::chrono::steady_clock::now());
  const double here = s.fraction > 0 ? (s.fraction - s.resumed) / s.fraction : 1;
  return s.done * here / std::max(elapsed, 1e-9);
}

std::string Progress::line(const State& s) const {
  std::string text = fmt::format("{} {:3.0f} %  {:.4g} {}/s  {:.0f} s left", what_, 100 * s.fraction,
                                 per_second(s), unit_, seconds_left(s));
  if (s.worst_error >= 0) text += fmt::format("  worst cell {:.2g} %", 100 * s.worst_error);
  return text;
}

std::string Progress::json(const State& s) const {
  std::string text =
      fmt::format(R"({{"phase": "{}", "fraction": {:.4f}, "done": {:.0f}, "total": {:.0f}, "unit": "{}", )"
                  R"("per_second": {:.4g}, "seconds_left": {:.1f})",
                  what_, s.fraction, s.done, total_, unit_, per_second(s), seconds_left(s));
  if (s.worst_error >= 0) text += fmt::format(R"(, "worst_error": {:.3g})", s.worst_error);
  return text + "}";
}

void Progress::show(const State& s) {
  const auto now = std::chrono::steady_clock::now();
  const bool finished = s.fraction >= 1;
  const double pause = seconds_between(last_, now);
  if (form_ == ProgressForm::json) {
    if (!finished && pause < 1) return;
    last_ = now;
    message_line(json(s));
  } else if (terminal_) {
    if (!finished && pause < 0.1) return;
    last_ = now;
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(s.fraction * kWidth);
    write_message(fmt::format("\r[{}{}] {}\x1b[K{}", std::string(filled, '#'),
                              std::string(kWidth - filled, '.'), line(s), finished ? "\n" : ""));
  } else if (static_cast<int>(s.fraction * 10) > tenths_) {
    tenths_ = static_cast<int>(s.fraction * 10);
    message_line(line(s));
  }
}

}  // namespace sunbeam
