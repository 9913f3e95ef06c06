// Efficiency of the live estimators on one core, 1 / (variance x seconds), in the coated diffuse that other
// renderers have: d0 = 0, n1 = n2 = 1.5, refract, "sum" with optical depth 0.01, albedo 0.5, one channel.
//
//   build/release/bin/bench_live [--benchmark_format=json]
//
// Every benchmark alternates between the estimator and the plain scalar walk of tests/support, so that the
// ratio of their efficiencies holds on a busy machine too. Times are of the thread. `mean` includes the
// first-surface lobe of rough films; phi = 180 degrees is the mirror side.
#include <benchmark/benchmark.h>

#include <array>

#include "bake/live/exact/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "tests/bench/account.h"
#include "tests/support/materials.h"
#include "tests/support/plain_walk.h"

namespace sunbeam {
namespace {

using test::coated_diffuse;

constexpr double kWavelengthNm = 550;
constexpr double kRoughness[] = {0, 0.1, 0.3};
constexpr double kPairs[][3] = {{60, 30, 120}, {10, 45, 60}, {80, 20, 90}, {45, 43, 178}};  // wo, wi, phi

Wavelengths one_channel(const Material& m) { return Wavelengths::monochromatic(m, kWavelengthNm); }

void estimate(benchmark::State& state, Technique technique) {
  const Material material = coated_diffuse(kRoughness[state.range(0)]);
  const auto& pair = kPairs[state.range(1)];
  const Vec3 wo = spherical_direction(pair[0] * kPi / 180, 0);
  const Vec3 wi = spherical_direction(pair[1] * kPi / 180, pair[2] * kPi / 180);
  const Pfmc model(material, one_channel(material));
  const test::PlainWalk plain(material, Rgb(kWavelengthNm));
  const test::FacetedFilm plain_film(material, Rgb(kWavelengthNm));
  Account live, yardstick;
  Rng rng(1, 0), plain_rng(2, 0);
  for (auto _ : state) {
    state.SetIterationTime(live.run(
        1000, [&] { return model.first(wo, wi).g + model.estimate_rest(wo, wi, rng, technique).g; }));
    yardstick.run(
        300, [&] { return plain_film.first_surface(wo, wi).g + plain.estimate_rest(wo, wi, plain_rng).g; });
  }
  state.counters["mean"] = live.mean();
  state.counters["stderr"] = std::sqrt(live.variance() / live.calls);
  state.counters["variance"] = live.variance();
  state.counters["ns"] = live.ns();
  state.counters["efficiency"] = live.efficiency();
  state.counters["yardstick_ns"] = yardstick.ns();
  state.counters["yardstick_efficiency"] = yardstick.efficiency();
  state.counters["ratio"] = live.efficiency() / yardstick.efficiency();
}
void unidirectional(benchmark::State& state) { estimate(state, Technique::unidirectional); }
void bidirectional(benchmark::State& state) { estimate(state, Technique::bidirectional); }
BENCHMARK(unidirectional)
    ->ArgsProduct({{0, 1, 2}, {0, 1, 2, 3}})
    ->ArgNames({"roughness", "pair"})
    ->UseManualTime();
BENCHMARK(bidirectional)
    ->ArgsProduct({{0, 1, 2}, {0, 1, 2, 3}})
    ->ArgNames({"roughness", "pair"})
    ->UseManualTime();

// Directions drawn beforehand, so that only the call itself is timed.
const Vec3& next_direction() {
  static const auto directions = [] {
    std::array<Vec3, 1024> all;
    Rng rng(3, 0);
    for (Vec3& w : all) w = direction_from_cosine(0.1 + 0.9 * rng.uniform(), 2);
    return all;
  }();
  static std::size_t next = 0;
  return directions[next++ % directions.size()];
}

// A call of `call`, and in the same run one of the plain walk.
template <class Call>
void time_call(benchmark::State& state, const Material& material, Call call) {
  const test::PlainWalk plain(material, Rgb(kWavelengthNm));
  const Vec3 wo = spherical_direction(1, 0), wi = spherical_direction(0.5, 2);
  Account timed, yardstick;
  Rng rng(1, 0);
  for (auto _ : state) {
    state.SetIterationTime(timed.run(1000, call));
    yardstick.run(300, [&] { return plain.estimate_rest(wo, wi, rng).g; });
  }
  state.counters["ns"] = timed.ns();
  state.counters["yardstick_ns"] = yardstick.ns();
}

void sample(benchmark::State& state) {
  const Material material = coated_diffuse(kRoughness[state.range(0)]);
  const LiveBsdf bsdf(material, one_channel(material));
  const Vec3 wo = spherical_direction(1, 0);
  Rng rng(3, 0);
  double calls = 0, empty = 0;
  time_call(state, material, [&] {
    const auto sampled = bsdf.sample(wo, rng);
    ++calls;
    empty += !sampled;
    return sampled ? sampled->throughput.g : 0;
  });
  state.counters["empty"] = empty / calls;
}
BENCHMARK(sample)->Arg(0)->Arg(1)->Arg(2)->ArgName("roughness")->UseManualTime();

void deterministic_pdf(benchmark::State& state) {
  const Material material = coated_diffuse(kRoughness[state.range(0)]);
  const LiveBsdf bsdf(material, one_channel(material));
  const Vec3 wo = spherical_direction(1, 0);
  Rng rng(3, 0);
  time_call(state, material, [&] { return bsdf.mis_pdf(wo, next_direction()); });
}
BENCHMARK(deterministic_pdf)->Arg(0)->Arg(1)->Arg(2)->ArgName("roughness")->UseManualTime();

void exact_eval(benchmark::State& state) {
  const Material material = coated_diffuse(kRoughness[state.range(0)]);
  const ExactBsdf bsdf(material, one_channel(material));
  const Vec3 wo = spherical_direction(1, 0);
  Rng rng(3, 0);
  time_call(state, material, [&] { return bsdf.eval(wo, next_direction(), rng).g; });
}
BENCHMARK(exact_eval)->Arg(0)->Arg(1)->Arg(2)->ArgName("roughness")->UseManualTime();

void exact_sample(benchmark::State& state) {
  const Material material = coated_diffuse(kRoughness[state.range(0)]);
  const ExactBsdf bsdf(material, one_channel(material));
  const Vec3 wo = spherical_direction(1, 0);
  Rng rng(3, 0);
  time_call(state, material, [&] {
    const auto sampled = bsdf.sample(wo, rng);
    return sampled ? sampled->throughput.g : 0;
  });
}
BENCHMARK(exact_sample)->Arg(0)->Arg(1)->Arg(2)->ArgName("roughness")->UseManualTime();

}  // namespace
}  // namespace sunbeam

BENCHMARK_MAIN();
