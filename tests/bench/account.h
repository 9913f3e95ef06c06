// What calls cost and how far they scatter, for benchmarks that compare estimators in one run.
#pragma once

#include <time.h>

#include <algorithm>
#include <vector>

namespace sunbeam {

inline double thread_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Calls, their time and their spread.
struct Account {
  double calls = 0, seconds = 0, sum = 0, sum_of_squares = 0;

  template <class Call>
  double run(int count, Call call) {
    const double start = thread_seconds();
    for (int i = 0; i < count; ++i) {
      const double value = call();
      sum += value;
      sum_of_squares += value * value;
    }
    calls += count;
    const double taken = thread_seconds() - start;
    seconds += taken;
    return taken;
  }
  double mean() const { return sum / calls; }
  double variance() const { return (sum_of_squares - sum * mean()) / (calls - 1); }
  double ns() const { return 1e9 * seconds / calls; }
  double efficiency() const { return 1 / (variance() * seconds / calls); }
};

}  // namespace sunbeam
