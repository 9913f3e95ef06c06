// Look-ups of bound and textured tables of every kind at seeded random directions, a line each: the table,
// what was looked up and its numbers. Builds of the runtime must agree on them (lookups_test.py). Run:
// build/release/bin/lookups_fast [--time]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "sunbeam/detail/warp.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "sunbeam/textured_table.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr int kPairs = 200, kTimedPairs = 4096, kTimedCalls = 100000, kTimedRuns = 40;

struct Pair {
  Vec3 wo, wi;
  Parameters at;  // within the grid of synthetic tables
};

std::vector<Pair> random_pairs(int count) {
  Rng rng(1, 0);
  const auto direction = [&] { return sample_cosine({rng.uniform(), rng.uniform()}); };
  std::vector<Pair> pairs;
  for (int k = 0; k < count; ++k) {
    const Vec3 wo = direction(), wi = direction();
    pairs.push_back(
        {wo,
         wi,
         {lerp(rng.uniform(), 200, 400), lerp(rng.uniform(), 1.4, 1.5), lerp(rng.uniform(), 0, 0.1)}});
  }
  return pairs;
}

struct Named {
  std::string name;
  Table table;
};

std::vector<Named> tables() {
  using test::small_factored_table;
  const Roughness rough(0.3), anisotropic(0.3, 0.1);
  return {{"smooth", small_factored_table(0, AbsorptionPath::sum)},
          {"isotropic", small_factored_table(rough, AbsorptionPath::sum)},
          {"product", small_factored_table(rough, AbsorptionPath::product)},
          {"anisotropic", small_factored_table(anisotropic, AbsorptionPath::sum)},
          {"anisotropic product", small_factored_table(anisotropic, AbsorptionPath::product)},
          {"dense", test::small_table()},
          {"dense anisotropic", test::small_anisotropic_table()},
          {"dense full", test::small_full_table()}};
}

Table golden() { return load_table_exr(SUNBEAM_SOURCE_DIR "/tables/golden/preview.exr"); }

void print(const std::string& name, const char* what, const Vec3& v) {
  std::printf("%s %s: %.9g %.9g %.9g\n", name.c_str(), what, v.x, v.y, v.z);
}
void print(const std::string& name, const char* what, const Rgb& c) {
  print(name, what, Vec3{c.r, c.g, c.b});
}
void print(const std::string& name, const char* what, double x) {
  std::printf("%s %s: %.9g\n", name.c_str(), what, x);
}

void look_up(const std::string& name, const Bsdf& bsdf, const Pair& pair, Rng& rng) {
  const EvalAndSample both = bsdf.eval_and_sample(pair.wo, pair.wi, rng);
  print(name, "f", both.eval.f);
  print(name, "pdf", both.eval.pdf);
  const BsdfSample sample = both.sample.value_or(BsdfSample{});
  print(name, "wi", sample.wi);
  print(name, "throughput", sample.throughput);
  print(name, "mis_pdf", sample.mis_pdf);
}

void look_up_bound(const std::string& name, const TableBsdf& bsdf, const std::vector<Pair>& pairs) {
  Rng rng(2, 0);
  for (const Pair& pair : pairs) look_up(name, bsdf, pair, rng);
  std::vector<Vec3> wi;
  for (const Pair& pair : pairs) wi.push_back(pair.wi);
  std::vector<Rgb> f(wi.size());
  bsdf.eval(pairs[0].wo, wi, f);
  for (const Rgb& value : f) print(name, "f of many", value);
}

void print_all() {
  const auto pairs = random_pairs(kPairs);
  const Table table = golden();
  look_up_bound("golden bound", table.bind(Parameters::of(table.material)), pairs);
  for (const auto& [name, table] : tables()) {
    look_up_bound(name + " bound", table.bind({250, 1.45, 0.1}, {.outside = OutsideGrid::clamp}), pairs);
    const TexturedTable textured(table);
    Rng rng(3, 0);
    for (const Pair& pair : pairs) look_up(name + " textured", textured.at(pair.at), pair, rng);
  }
}

// Processor time, the least of a few runs.
void time(const char* name, const std::function<double(const Pair&)>& call) {
  const auto pairs = random_pairs(kTimedPairs);
  double least = 1e9, sum = 0;
  for (int run = 0; run < kTimedRuns; ++run) {
    const std::clock_t begin = std::clock();
    for (int k = 0; k < kTimedCalls; ++k) sum += call(pairs[k % kTimedPairs]);
    least = std::min(least, 1e9 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kTimedCalls);
  }
  std::printf("%-26s %6.1f ns%s\n", name, least, sum == 0 ? " of nothing" : "");
}

void time_all() {
  const Table table = golden();
  const TableBsdf bound = table.bind(Parameters::of(table.material));
  const TexturedTable textured(test::small_factored_table());
  Rng rng(4, 0);
  time("bound eval_pdf", [&](const Pair& pair) { return bound.eval_pdf(pair.wo, pair.wi).pdf; });
  time("bound eval_and_sample",
       [&](const Pair& pair) { return bound.eval_and_sample(pair.wo, pair.wi, rng).eval.pdf; });
  time("textured eval_pdf",
       [&](const Pair& pair) { return textured.at(pair.at).eval_pdf(pair.wo, pair.wi).pdf; });
}

}  // namespace
}  // namespace sunbeam

int main(int count, char** arguments) {
  if (count > 1 && std::strcmp(arguments[1], "--time") == 0)
    sunbeam::time_all();
  else
    sunbeam::print_all();
}
