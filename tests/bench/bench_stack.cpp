// The general stack on one core: what the bidirectional estimator gains over the unidirectional one in a
// scattering pigment, and what following light over many facets costs.
//
//   build/release/bin/bench_stack [--benchmark_format=json]
//
// Each benchmark alternates between the two things it compares. Times are of the thread; efficiency is
// 1 / (variance x seconds), of the mean over channels.
#include <benchmark/benchmark.h>

#include "bake/live/pfmc.h"
#include "bake/optics/spectrum.h"
#include "tests/bench/account.h"

namespace sunbeam {
namespace {

constexpr double kOpticalThickness[] = {0.1, 0.3, 1, 3, 5};
constexpr double kMeanCosine[] = {0, 0.5, 0.9, 0.95, 0.99};
constexpr double kRoughness[] = {0.05, 0.1, 0.3, 0.6, 1};

const Vec3 kWo = spherical_direction(40 * kPi / 180, 0);
const Vec3 kWi = spherical_direction(60 * kPi / 180, 120 * kPi / 180);

struct Pair {
  Account first, second;
};

template <class First, class Second>
Pair alternate(benchmark::State& state, First first, Second second) {
  Pair pair;
  Rng rng(1, 0);
  for (auto _ : state) {
    const double seconds = pair.first.run(200, [&] { return mean(first(rng)); });
    state.SetIterationTime(seconds + pair.second.run(200, [&] { return mean(second(rng)); }));
  }
  return pair;
}

void report(benchmark::State& state, const Pair& pair, const char* first, const char* second) {
  const auto put = [&](const std::string& name, const Account& account) {
    state.counters[name + "_ns"] = account.ns();
    state.counters[name + "_sd"] = std::sqrt(account.variance()) / account.mean();
    state.counters[name + "_mean"] = account.mean();
  };
  put(first, pair.first);
  put(second, pair.second);
  state.counters["time_ratio"] = pair.second.ns() / pair.first.ns();
  state.counters["efficiency_ratio"] = pair.second.efficiency() / pair.first.efficiency();
}

// A white scattering pigment under a film of roughness 0.2 over a base of albedo 0.5.
Material pigment(double optical_thickness, double g) {
  Material m;
  m.roughness = 0.2;
  m.absorption_per_nm = 0;
  m.albedo = Rgb(0.5);
  m.scattering_per_nm = optical_thickness / m.pigment_thickness_nm;
  m.anisotropy = g;
  return m;
}

void slab(benchmark::State& state) {
  const Pfmc model(pigment(kOpticalThickness[state.range(0)], kMeanCosine[state.range(1)]));
  const auto by = [&](Technique technique) {
    return [&model, technique](Rng& rng) { return model.estimate_rest(kWo, kWi, rng, technique); };
  };
  report(state, alternate(state, by(Technique::unidirectional), by(Technique::bidirectional)), "uni", "bi");
}
BENCHMARK(slab)
    ->ArgsProduct({{0, 1, 2, 3, 4}, {0, 1, 2, 3, 4}})
    ->ArgNames({"thickness", "g"})
    ->UseManualTime();

void facets(benchmark::State& state) {
  Material single;
  single.roughness = kRoughness[state.range(0)];
  single.absorption_per_nm = 0.05;
  single.albedo = {0.9, 0.8, 0.6};
  Material multiple = single;
  multiple.microfacet = Microfacet::multiple;
  const Spectrum spectrum =
      state.range(1) == 0 ? Spectrum() : Spectrum(Illuminant::d65, ColorSpace::acescg, 2000);
  const Pfmc first(single, spectrum.wavelengths(single)), second(multiple, spectrum.wavelengths(multiple));
  const auto by = [&](const Pfmc& model) {
    return [&](Rng& rng) { return model.estimate_rest(kWo, kWi, rng); };
  };
  report(state, alternate(state, by(first), by(second)), "single", "multiple");
}
BENCHMARK(facets)->ArgsProduct({{0, 1, 2, 3, 4}, {0, 1}})->ArgNames({"roughness", "full"})->UseManualTime();

}  // namespace
}  // namespace sunbeam

BENCHMARK_MAIN();
