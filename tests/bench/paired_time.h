// Time of eval against that of the yardstick, in turns, so that their ratio holds on a busy machine too.
#pragma once

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "sunbeam/bsdf.h"
#include "sunbeam/detail/warp.h"
#include "tests/bench/account.h"
#include "tests/bench/yardstick.h"

namespace sunbeam {

struct PairedTime {
  double ns, yardstick_ns;  // a call
  double ratio;
};

class Stopwatch {
 public:
  explicit Stopwatch(int rounds) : rounds_(rounds) {
    Rng rng(1, 0);
    for (auto& [wo, wi] : pairs_) {
      wo = sample_cosine({rng.uniform(), rng.uniform()});
      wi = sample_cosine({rng.uniform(), rng.uniform()});
    }
  }

  // Medians over the rounds.
  PairedTime time_eval(const Bsdf& bsdf) const {
    std::vector<double> ns, yardstick, ratio;
    for (int round = 0; round < rounds_; ++round) {
      yardstick.push_back(yardstick_ns());
      ns.push_back(eval_ns(bsdf));
      ratio.push_back(ns.back() / yardstick.back());
    }
    return {median(ns), median(yardstick), median(ratio)};
  }

 private:
  struct Pair {
    Vec3 wo, wi;
  };

  // Every pass runs twice; the first warms the caches up.
  template <class Call>
  static double pass_ns(Call call) {
    double seconds = 0;
    for (int pass = 0; pass < 2; ++pass) {
      const double start = thread_seconds();
      for (std::size_t k = 0; k < kPairs; ++k) benchmark::DoNotOptimize(call(k));
      seconds = thread_seconds() - start;
    }
    return 1e9 * seconds / kPairs;
  }

  double yardstick_ns() const {
    return pass_ns([&](std::size_t k) { return yardstick_(k); });
  }

  double eval_ns(const Bsdf& bsdf) const {
    Rng rng(2, 0);
    return pass_ns([&](std::size_t k) { return bsdf.eval(pairs_[k].wo, pairs_[k].wi, rng); });
  }

  static constexpr std::size_t kPairs = 4096;

  int rounds_;
  Yardstick yardstick_;
  std::array<Pair, kPairs> pairs_;
};

}  // namespace sunbeam
