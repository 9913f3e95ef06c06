// The film's reflectance at all wavelengths, folded into RGB: one cosine, three at once, a long list, for
// each instruction set that this machine has; and T of each wavelength. `each` is the time per cosine.
//
//   build/release/bin/bench_film [--benchmark_format=json]
//
// Calls depend on no earlier one: the time is that between calls, not from a call to its result. "_latency"
// is the latter: each cosine follows from the last result.
#include <benchmark/benchmark.h>

#include <string>

#include "runtime/src/film/film_kernels.h"

namespace sunbeam {
namespace {

constexpr std::size_t kList = 256;

Wavelengths evenly_spaced(std::size_t count) {
  Wavelengths w;
  for (std::size_t k = 0; k < count; ++k) {
    w.nm.push_back(400 + 300 * (static_cast<double>(k) + 0.5) / static_cast<double>(count));
    w.weight.push_back(Rgb(1 / static_cast<double>(count)));
  }
  return w;
}

std::vector<float> cosines() {
  std::vector<float> list;
  for (std::size_t i = 0; i < kList; ++i) list.push_back((static_cast<float>(i) + 0.5f) / kList);
  return list;
}

void count_each(benchmark::State& state, std::size_t cosines_of_each_call) {
  state.counters["each"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(cosines_of_each_call),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void fold(benchmark::State& state, const FilmKernels* kernels, std::size_t wavelengths, std::size_t at_once) {
  const FilmSpectrum film(evenly_spaced(wavelengths), 1, 1.56, *kernels);
  const std::vector<float> list = cosines();
  std::vector<FloatRgb> rgb(kList);
  std::size_t first = 0;
  for (auto _ : state) {
    film.fold(300 + static_cast<double>(first), 1.5, {&list[first], at_once}, rgb.data());
    benchmark::DoNotOptimize(rgb.data());
    benchmark::ClobberMemory();
    if (++first + at_once > kList) first = 0;
  }
  count_each(state, at_once);
}

void fold_latency(benchmark::State& state, const FilmKernels* kernels, std::size_t wavelengths) {
  const FilmSpectrum film(evenly_spaced(wavelengths), 1, 1.56, *kernels);
  float cosine = 0.5f;
  FloatRgb rgb;
  for (auto _ : state) {
    film.fold(300, 1.5, {&cosine, 1}, &rgb);
    cosine = 0.5f + 0.1f * rgb.r;
  }
  benchmark::DoNotOptimize(cosine);
  count_each(state, 1);
}

void powers(benchmark::State& state, const FilmKernels* kernels, std::size_t wavelengths) {
  const FilmSpectrum film(evenly_spaced(wavelengths), 1, 1.56, *kernels);
  const std::vector<float> list = cosines();
  float transmittance[kMostWavelengths];
  std::size_t i = 0;
  for (auto _ : state) {
    film.powers(300 + static_cast<double>(i), 1.5, list[i], transmittance);
    benchmark::DoNotOptimize(transmittance);
    benchmark::ClobberMemory();
    if (++i == kList) i = 0;
  }
  count_each(state, 1);
}

void register_for(const FilmKernels* kernels, std::size_t wavelengths) {
  const std::string name = std::string(kernels->name) + "/" + std::to_string(wavelengths) + "_wavelengths/";
  for (const std::size_t at_once : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{4}, kList})
    benchmark::RegisterBenchmark((name + "fold_" + std::to_string(at_once)).c_str(), fold, kernels,
                                 wavelengths, at_once);
  benchmark::RegisterBenchmark((name + "fold_1_latency").c_str(), fold_latency, kernels, wavelengths);
  benchmark::RegisterBenchmark((name + "powers").c_str(), powers, kernels, wavelengths);
}

}  // namespace
}  // namespace sunbeam

int main(int argc, char** argv) {
  for (const sunbeam::FilmKernels* kernels : sunbeam::supported_film_kernels())
    for (const std::size_t wavelengths : {3, 20}) sunbeam::register_for(kernels, wavelengths);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
