// Tables of one material side by side: what Sunbeam bakes against plain ones filled from the exact evaluator.
// Error, bytes and time of each, and how evenly Sunbeam's own draws directions.
//
//   build/release/bin/bench_tables [--json FILE] [--quick]
//
// The material is one point of tables/recipes/sunbeam.toml. --quick measures little, to see that all of it
// runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bake/jobs/bake.h"
#include "bake/live/exact/exact_bsdf.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/table_io.h"
#include "tests/bench/merl_table.h"
#include "tests/bench/paired_time.h"
#include "tests/bench/sample_weights.h"
#include "tests/bench/table_error.h"
#include "tests/bench/uniform_table.h"

namespace sunbeam {
namespace {

constexpr const char* kRecipe = SUNBEAM_SOURCE_DIR "/tables/recipes/sunbeam.toml";
constexpr Parameters kPoint{.film_thickness_nm = 400, .base_ior = 1.5, .absorption_per_nm = 0.7};
constexpr double kSampleAngle = 60;  // degrees, of wo

using Overrides = std::vector<std::string>;

struct Effort {
  std::size_t probes, directions;
  int rounds, materials, draws;
  Overrides whole_grid;  // of the table whose samples are drawn
};

const Effort kFull{400, 256, 41, 24, 50000, {}};
const Effort kQuick{40,
                    64,
                    3,
                    4,
                    1000,
                    {"grid.film_thickness_nm=[0.0, 1000.0]", "grid.base_ior=[1.0, 2.0]",
                     "grid.absorption_per_nm=[0.0, 1.5]", "table.angles=4", "accuracy.noise=0.05"}};

// One table of the comparison.
struct Source {
  std::string name, family;
  const Bsdf& bsdf;
  std::size_t bytes;
};

Overrides at_the_point(Overrides overrides) {
  for (std::size_t k = 0; k < kParameterNames.size(); ++k)
    overrides.push_back(fmt::format("grid.{}=[{:.17g}]", kParameterNames[k], kPoint.values()[k]));
  return overrides;
}

// What Sunbeam bakes of the one point.
struct Baked {
  explicit Baked(const Overrides& overrides)
      : table(bake_table(load_recipe(kRecipe, at_the_point(overrides)), {})), bsdf(table, kPoint) {}
  Source source(const std::string& name) const {
    return {name, "sunbeam", bsdf, table_exr_bytes(table).size()};
  }

  Table table;
  TableBsdf bsdf;
};

struct Tables {
  explicit Tables(const Bsdf& truth);
  std::deque<Baked> baked;  // sources refer to these
  std::deque<UniformTable> uniform;
  MerlTable merl;
  std::vector<Source> sources;
};

// Another encoding is one more line: a name and what it changes in the recipe.
const std::vector<std::pair<std::string, Overrides>> kBaked = {
    {"factored", {"table.encoding=\"factored\""}},
    {"dense", {"table.encoding=\"dense\"", "accuracy.noise=0.002"}},
};

constexpr HalfGrid::Nodes kUniform[] = {
    {16, 16, 16}, {32, 32, 32}, {64, 64, 64}, {128, 128, 64}, {128, 128, 128}};

Tables::Tables(const Bsdf& truth) : merl(truth) {
  for (const auto& [name, overrides] : kBaked) sources.push_back(baked.emplace_back(overrides).source(name));
  for (const auto holds : {UniformTable::Holds::f, UniformTable::Holds::f_cos_cos})
    for (const auto& nodes : kUniform) {
      const char* family = holds == UniformTable::Holds::f ? "uniform f" : "uniform f cos cos";
      const auto& table = uniform.emplace_back(truth, nodes, holds);
      sources.push_back(
          {fmt::format("{} {}x{}x{}", family, nodes[0], nodes[1], nodes[2]), family, table, table.bytes()});
    }
  sources.push_back({"MERL 90x90x180", "MERL", merl, merl.bytes()});
}

// Order statistic: the smallest value that at least a share q of all values do not exceed.
double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size()))) - 1];
}

nlohmann::ordered_json json_of(const Parameters& parameters) {
  nlohmann::ordered_json json;
  for (std::size_t k = 0; k < kParameterNames.size(); ++k) json[kParameterNames[k]] = parameters.values()[k];
  return json;
}

nlohmann::ordered_json measure(const Source& source, const std::vector<Probe>& probes,
                               const Stopwatch& stopwatch) {
  std::vector<double> errors;
  Rng rng(3, 0);
  for (const Probe& probe : probes) errors.push_back(error_of(source.bsdf, probe, rng));
  std::sort(errors.begin(), errors.end());
  const PairedTime time = stopwatch.time_eval(source.bsdf);
  return {{"name", source.name},
          {"family", source.family},
          {"bytes", source.bytes},
          {"error_median", quantile(errors, 0.5)},
          {"error_p99", quantile(errors, 0.99)},
          {"eval_ns", time.ns},
          {"yardstick_ns", time.yardstick_ns},
          {"eval_ratio", time.ratio}};
}

nlohmann::ordered_json compare_tables(const Effort& effort) {
  const Recipe recipe = load_recipe(kRecipe);
  const Material material = kPoint.applied_to(recipe.material);
  const ExactBsdf exact(material, recipe.spectrum.wavelengths(material));
  std::vector<Probe> probes;
  Rng rng(4, 0);
  for (std::size_t k = 0; k < effort.probes; ++k) probes.push_back(draw_probe(exact, effort.directions, rng));
  const Tables tables(exact);
  const Stopwatch stopwatch(effort.rounds);
  nlohmann::ordered_json rows;
  for (const Source& source : tables.sources) rows.push_back(measure(source, probes, stopwatch));
  return rows;
}

nlohmann::ordered_json weigh_samples(const Effort& effort) {
  const Recipe recipe = load_recipe(kRecipe, effort.whole_grid);
  const Table table = bake_table(recipe, {});
  const Vec3 wo = spherical_direction(kSampleAngle * kPi / 180, 0);
  Rng rng(5, 0);
  const auto points = materials_of(recipe, effort.materials, rng);
  std::vector<double> deviations;
  for (const Parameters& point : points)
    deviations.push_back(throughput_deviation(TableBsdf(table, point), wo, effort.draws, rng));
  const auto worst = std::max_element(deviations.begin(), deviations.end());
  return {{"theta_o_deg", kSampleAngle},
          {"materials", points.size()},
          {"draws", effort.draws},
          {"deviation_mean", std::accumulate(deviations.begin(), deviations.end(), 0.0) /
                                 static_cast<double>(deviations.size())},
          {"deviation_worst", *worst},
          {"worst_material", json_of(points[static_cast<std::size_t>(worst - deviations.begin())])}};
}

double median_of(const nlohmann::ordered_json& rows, const char* key) {
  std::vector<double> values;
  for (const auto& row : rows) values.push_back(row[key].get<double>());
  return median(values);
}

nlohmann::ordered_json run(const Effort& effort) {
  nlohmann::ordered_json report;
  report["material"] = json_of(kPoint);
  report["wi"] = effort.probes;
  report["directions"] = effort.directions;
  report["half_conversion"] = HalfGrid::has_f16c() ? "F16C" : "Imath";
  report["tables"] = compare_tables(effort);
  report["yardstick_ns"] = median_of(report["tables"], "yardstick_ns");
  report["sample"] = weigh_samples(effort);
  return report;
}

void print(const nlohmann::ordered_json& report) {
  fmt::print("{:<30}{:>12}{:>12}{:>12}{:>10}{:>15}\n", "table", "bytes", "median", "p99", "eval ns",
             "of yardstick");
  for (const auto& row : report["tables"])
    fmt::print("{:<30}{:>12}{:>10.3f} %{:>10.3f} %{:>10.1f}{:>15.2f}\n", row["name"].get<std::string>(),
               row["bytes"].get<std::size_t>(), 100 * row["error_median"].get<double>(),
               100 * row["error_p99"].get<double>(), row["eval_ns"].get<double>(),
               row["eval_ratio"].get<double>());
  fmt::print("yardstick {:.2f} ns by {}\n", report["yardstick_ns"].get<double>(),
             report["half_conversion"].get<std::string>());
  const auto& sample = report["sample"];
  fmt::print("deviation of throughput at {} degrees, {} materials: mean {:.3f}, worst {:.3f}\n",
             sample["theta_o_deg"].get<double>(), sample["materials"].get<std::size_t>(),
             sample["deviation_mean"].get<double>(), sample["deviation_worst"].get<double>());
}

void save(const nlohmann::ordered_json& report, const std::string& path) {
  std::ofstream file(path);
  file << report.dump(2) << '\n';
  file.close();
  if (!file) throw Error(path + ": cannot be written");
}

}  // namespace
}  // namespace sunbeam

int main(int argc, char** argv) {
  CLI::App app("Tables of one material side by side: error, bytes, time");
  std::string json;
  bool quick = false;
  app.add_option("--json", json, "write the figures to this file");
  app.add_flag("--quick", quick, "measure little");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto report = sunbeam::run(quick ? sunbeam::kQuick : sunbeam::kFull);
    sunbeam::print(report);
    if (!json.empty()) sunbeam::save(report, json);
  } catch (const sunbeam::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
