// Nanoseconds per call of a table bound to one parameter point, of the live model at the same point, by walks
// and exactly, and of Lambert, over the same random directions; and of one plain look-up, the yardstick of
// docs/measured/performance.md. Run:
// build/release/bin/bench_runtime
#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

#include "bake/jobs/bake.h"
#include "bake/live/exact/exact_bsdf.h"
#include "bake/live/live_bsdf.h"
#include "bake/recipe/recipe.h"
#include "runtime/tracer/lambert.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "sunbeam/textured_table.h"
#include "tests/bench/yardstick.h"

namespace sunbeam {
namespace {

constexpr std::size_t kPairs = 4096;

struct Pair {
  Vec3 wo, wi;
};

std::vector<Pair> random_pairs() {
  Rng rng(1, 0);
  std::vector<Pair> pairs(kPairs);
  for (Pair& pair : pairs)
    pair = {sample_cosine({rng.uniform(), rng.uniform()}), sample_cosine({rng.uniform(), rng.uniform()})};
  return pairs;
}

const Table& table() {
  static const Table loaded = load_table_exr(SUNBEAM_SOURCE_DIR "/tables/golden/preview.exr");
  return loaded;
}

// Dense tables of any content as large as baked ones: of plain materials, and of those with azimuth.
const Bsdf& dense_bsdf(const std::string& material, const std::string& table) {
  static std::map<std::string, TableBsdf> bound;
  const auto known = bound.find(material);
  if (known != bound.end()) return known->second;
  const Recipe recipe = parse_recipe("[material]\n" + material +
                                         "\n[spectrum]\nmode = \"full\"\n[table]\nencoding = \"dense\"\n" +
                                         table + "\n[accuracy]\nnoise = 1",
                                     "dense");
  const Table baked = bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}});
  return bound.try_emplace(material, baked, Parameters::of(baked.material)).first->second;
}
const Bsdf& dense_plain() { return dense_bsdf("roughness = 0.1", "angles = 12"); }
const Bsdf& dense_scattering() { return dense_bsdf("scattering_per_nm = 0.5", "angles = 10\nazimuths = 7"); }
const Bsdf& dense_anisotropic() { return dense_bsdf("roughness = [0.1, 0.3]", "angles = 10\nazimuths = 8"); }

// A mirror of ten layers over a diffuse base, whose colours change fast with both directions.
const Table& mirror() {
  static const Table baked =
      bake_table(parse_recipe("[material]\nfilm_periods = 5\nroughness = 0.1\n"
                              "[[material.film]]\nthickness_nm = 60.0\nior = \"titania\"\n"
                              "[[material.film]]\nthickness_nm = 95.0\nior = \"silica\"\n"
                              "[grid]\nfilm_thickness_nm = [600.0, 900.0]\n[spectrum]\nmode = \"full\"\n",
                              "mirror"),
                 {.seed = 1, .threads = 0, .on_progress = {}});
  return baked;
}

const Bsdf& layered_bsdf() {
  static const TableBsdf bsdf(mirror(), Parameters::of(mirror().material));
  return bsdf;
}

const Bsdf& table_bsdf() {
  static const TableBsdf bsdf(table(), Parameters::of(table().material));
  return bsdf;
}

// At the wavelengths of the table's own recipe.
Wavelengths wavelengths() {
  return parse_stored_recipe(table().info.at("recipe"), "recipe").spectrum.wavelengths(table().material);
}

const Bsdf& live_bsdf() {
  static const LiveBsdf bsdf(table().material, wavelengths());
  return bsdf;
}

const Bsdf& exact_bsdf() {
  static const ExactBsdf bsdf(table().material, wavelengths());
  return bsdf;
}

const Bsdf& lambert_bsdf() {
  static const Lambert bsdf(Rgb(0.5));
  return bsdf;
}

// Calls of random pairs, one after the other.
template <class Call>
void time_pairs(benchmark::State& state, Call call) {
  const auto pairs = random_pairs();
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(call(pairs[k++ % kPairs]));
}

void eval(benchmark::State& state, const Bsdf& bsdf) {
  Rng rng(2, 0);
  time_pairs(state, [&](const Pair& pair) { return bsdf.eval(pair.wo, pair.wi, rng); });
}

void mis_pdf(benchmark::State& state, const Bsdf& bsdf) {
  time_pairs(state, [&](const Pair& pair) { return bsdf.mis_pdf(pair.wo, pair.wi); });
}

void sample(benchmark::State& state, const Bsdf& bsdf) {
  Rng rng(3, 0);
  time_pairs(state, [&](const Pair& pair) { return bsdf.sample(pair.wo, rng); });
}

// Of the default recipe: the golden table has no grid of three parameters.
const TexturedTable& textured_table() {
  static const TexturedTable textured(
      bake_table(load_recipe(SUNBEAM_SOURCE_DIR "/tables/recipes/sunbeam.toml", {"accuracy.noise=0.03"}),
                 {.seed = 1, .threads = 0, .on_progress = {}}));
  return textured;
}

std::vector<Parameters> random_parameters() {
  Rng rng(4, 0);
  std::vector<Parameters> parameters(kPairs);
  for (Parameters& at : parameters) at = {1500 * rng.uniform(), 1 + rng.uniform(), 1.5 * rng.uniform()};
  return parameters;
}

// Other parameters at every call, located in the grid.
void textured_eval_pdf(benchmark::State& state) {
  const TexturedTable& textured = textured_table();
  const auto pairs = random_pairs();
  const auto parameters = random_parameters();
  std::size_t k = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[k % kPairs];
    benchmark::DoNotOptimize(textured.at(parameters[k++ % kPairs]).eval_pdf(pair.wo, pair.wi));
  }
}

void textured_layered(benchmark::State& state) {
  static const TexturedTable textured(mirror());
  const auto pairs = random_pairs();
  Rng rng(4, 0);
  std::vector<Parameters> parameters(kPairs, Parameters::of(mirror().material));
  for (Parameters& at : parameters) at.film_thickness_nm = lerp(rng.uniform(), 600, 900);
  std::size_t k = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[k % kPairs];
    benchmark::DoNotOptimize(textured.at(parameters[k++ % kPairs]).eval_pdf(pair.wo, pair.wi));
  }
}

void textured_sample(benchmark::State& state) {
  const TexturedTable& textured = textured_table();
  const auto pairs = random_pairs();
  const auto parameters = random_parameters();
  Rng rng(5, 0);
  std::size_t k = 0;
  for (auto _ : state) {
    const Vec3& wo = pairs[k % kPairs].wo;
    benchmark::DoNotOptimize(textured.at(parameters[k++ % kPairs]).sample(wo, rng));
  }
}

// Kinds without a fast path, over a few nodes of the parameters.
const TexturedTable& textured_table(const std::vector<std::string>& overrides) {
  static std::map<std::string, TexturedTable> cache;
  std::vector<std::string> all = {"accuracy.noise=0.1", "grid.film_thickness_nm={from=0, to=1500, count=5}",
                                  "grid.base_ior={from=1, to=2, count=4}",
                                  "grid.absorption_per_nm={from=0, to=1.5, count=4}"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  const Recipe recipe = load_recipe(SUNBEAM_SOURCE_DIR "/tables/recipes/sunbeam.toml", all);
  if (!cache.count(recipe.text))
    cache.try_emplace(recipe.text, bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}}));
  return cache.at(recipe.text);
}

void textured_kind(benchmark::State& state, const std::vector<std::string>& overrides) {
  const TexturedTable& textured = textured_table(overrides);
  const auto pairs = random_pairs();
  const auto parameters = random_parameters();
  std::size_t k = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[k % kPairs];
    benchmark::DoNotOptimize(textured.at(parameters[k++ % kPairs]).eval_pdf(pair.wo, pair.wi));
  }
}
const std::vector<std::string> kTexturedProduct = {"material.absorption_path=product"},
                               kTexturedAnisotropic = {"material.roughness=[0.1, 0.3]"},
                               kTexturedDense = {"table.encoding=dense"},
                               kTexturedSlab = {"table.encoding=dense", "material.scattering_per_nm=0.5",
                                                "table.azimuths=7"};

// Both of one pair at once, and the values of 256 lights for one viewer, a light.
void bound_eval_pdf(benchmark::State& state) {
  const auto& bsdf = static_cast<const TableBsdf&>(table_bsdf());
  time_pairs(state, [&](const Pair& pair) { return bsdf.eval_pdf(pair.wo, pair.wi); });
}

// A light and a sample of one viewer, as a path tracer wants them.
void bound_eval_and_sample(benchmark::State& state) {
  const Bsdf& bsdf = table_bsdf();
  Rng rng(1, 0);
  time_pairs(state, [&](const Pair& pair) { return bsdf.eval_and_sample(pair.wo, pair.wi, rng); });
}

void bound_eval_span(benchmark::State& state) {
  constexpr std::size_t kLights = 256;
  const auto& bsdf = static_cast<const TableBsdf&>(table_bsdf());
  const auto pairs = random_pairs();
  std::vector<Vec3> wi;
  for (std::size_t k = 0; k < kLights; ++k) wi.push_back(pairs[k].wi);
  std::vector<Rgb> f(kLights);
  std::size_t k = 0;
  for (auto _ : state) {
    bsdf.eval(pairs[k++ % kPairs].wo, wi, f);
    benchmark::DoNotOptimize(f.data());
    benchmark::ClobberMemory();
  }
  state.counters["ns_a_light"] = benchmark::Counter(
      kLights * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void bind(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(table().bind(Parameters::of(table().material)));
}

void load(benchmark::State& state) {
  const std::string path = SUNBEAM_SOURCE_DIR "/tables/golden/preview.exr";
  for (auto _ : state) benchmark::DoNotOptimize(load_table_exr(path));
}

void yardstick(benchmark::State& state) {
  const Yardstick look_up;
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(look_up(k++));
}

BENCHMARK(yardstick);
BENCHMARK_CAPTURE(eval, lambert, lambert_bsdf());
BENCHMARK_CAPTURE(eval, table, table_bsdf());
BENCHMARK_CAPTURE(eval, layered, layered_bsdf());
BENCHMARK_CAPTURE(eval, dense_plain, dense_plain());
BENCHMARK_CAPTURE(eval, dense_scattering, dense_scattering());
BENCHMARK_CAPTURE(eval, dense_anisotropic, dense_anisotropic());
BENCHMARK_CAPTURE(eval, exact, exact_bsdf());
BENCHMARK_CAPTURE(eval, live, live_bsdf());
BENCHMARK_CAPTURE(mis_pdf, lambert, lambert_bsdf());
BENCHMARK_CAPTURE(mis_pdf, table, table_bsdf());
BENCHMARK_CAPTURE(mis_pdf, exact, exact_bsdf());
BENCHMARK_CAPTURE(mis_pdf, live, live_bsdf());
BENCHMARK_CAPTURE(sample, lambert, lambert_bsdf());
BENCHMARK_CAPTURE(sample, table, table_bsdf());
BENCHMARK_CAPTURE(sample, layered, layered_bsdf());
BENCHMARK_CAPTURE(sample, dense_plain, dense_plain());
BENCHMARK_CAPTURE(sample, dense_scattering, dense_scattering());
BENCHMARK_CAPTURE(sample, exact, exact_bsdf());
BENCHMARK_CAPTURE(sample, live, live_bsdf());
BENCHMARK(bound_eval_pdf);
BENCHMARK(bound_eval_and_sample);
BENCHMARK(bound_eval_span);
BENCHMARK(bind);
BENCHMARK(load);
BENCHMARK(textured_eval_pdf);
BENCHMARK(textured_layered);
BENCHMARK(textured_sample);
BENCHMARK_CAPTURE(textured_kind, product, kTexturedProduct);
BENCHMARK_CAPTURE(textured_kind, anisotropic, kTexturedAnisotropic);
BENCHMARK_CAPTURE(textured_kind, dense, kTexturedDense);
BENCHMARK_CAPTURE(textured_kind, slab, kTexturedSlab);

}  // namespace
}  // namespace sunbeam

BENCHMARK_MAIN();
