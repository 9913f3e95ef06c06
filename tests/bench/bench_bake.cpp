// What a bake of a whole grid costs: against node-by-node PFMC at the same noise, as the grid grows, by
// threads, in memory; and what a preview costs.
//
//   build/release/bin/bench_bake --json out/bake.json
//
// Node-by-node PFMC of a grid of that size takes days, so it is run for some rows (one wi of one parameter
// node) drawn at random, and their mean cost stands for all.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bake/blocks/run.h"
#include "bake/dense/walked_job.h"
#include "bake/jobs/bake.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/file.h"
#include "tests/bench/account.h"
#include "tests/bench/child_process.h"

namespace sunbeam {
namespace {

using Json = nlohmann::json;
using Overrides = std::vector<std::string>;

const std::string kRecipes = SUNBEAM_SOURCE_DIR "/tables/recipes/";

struct Settings {
  int thicknesses = 64, iors = 16, absorptions = 16;
  int rows = 48;            // of node-by-node PFMC
  int rounds = 5;           // of --part threads
  double megabytes = 6600;  // uncompressed: more than 4 GiB as a file
  std::string folder = ".";
};

std::string range(const char* key, double from, double to, int count) {
  return fmt::format("grid.{}={{from={}, to={}, count={}}}", key, from, to, count);
}

Recipe grid_of(const std::string& recipe, Overrides overrides, int thicknesses, const Settings& s) {
  const double most = recipe == "slab" ? 0.002 : 1.5;
  overrides.insert(overrides.end(),
                   {"accuracy.noise=0.002", range("film_thickness_nm", 0, 1500, thicknesses),
                    range("base_ior", 1, 2, s.iors), range("absorption_per_nm", 0, most, s.absorptions)});
  return load_recipe(kRecipes + recipe + ".toml", overrides);
}

double process_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Cost {
  double seconds, cpu_seconds;
};

// Of all tasks of the recipe's bake, values made and kept.
Cost bake_cost(const Recipe& recipe, int threads) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu = process_cpu_seconds();
  const auto job = make_job(recipe, encodings_of(recipe).front(), 1);
  BlocksInMemory blocks(job->tasks());
  run_tasks(*job, {0, job->tasks()}, blocks, {threads, {}, {}});
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          process_cpu_seconds() - cpu};
}

// CPU seconds of node-by-node PFMC, from some rows of it.
double plain_cpu_seconds(const Recipe& recipe, int rows) {
  const auto job = walked_job(recipe, 1);
  Rng rng(1, 0);
  const double start = process_cpu_seconds();
  for (int k = 0; k < rows; ++k)
    job->run(static_cast<std::size_t>(rng.uniform() * static_cast<double>(job->tasks())));
  return (process_cpu_seconds() - start) / rows * static_cast<double>(job->tasks());
}

struct Family {
  std::string name, recipe;
  Overrides overrides;
};

const std::vector<Family> kFamilies = {{"sum", "sunbeam", {}},
                                       {"product", "sunbeam", {"material.absorption_path=product"}},
                                       {"scattering slab", "slab", {}}};

Json measure_grid(const Settings& s) {
  Json result;
  for (const Family& f : kFamilies) {
    const Recipe recipe = grid_of(f.recipe, f.overrides, s.thicknesses, s);
    const Cost ours = bake_cost(recipe, 0);
    const double plain = plain_cpu_seconds(recipe, s.rows);
    result[f.name] = {{"seconds", ours.seconds},
                      {"cpu_seconds", ours.cpu_seconds},
                      {"plain_cpu_seconds", plain},
                      {"plain_over_ours", plain / ours.cpu_seconds}};
    fmt::print("{} x {} x {}, {}: {:.1f} s, {:.1f} CPU s; node by node {:.3g} CPU s, {:.0f} times as many\n",
               s.thicknesses, s.iors, s.absorptions, f.name, ours.seconds, ours.cpu_seconds, plain,
               plain / ours.cpu_seconds);
  }
  return result;
}

Json measure_growth(const Settings& s) {
  Json result;
  for (const Family& f : kFamilies) {
    const double small = bake_cost(grid_of(f.recipe, f.overrides, s.thicknesses / 8, s), 0).cpu_seconds;
    const double large = bake_cost(grid_of(f.recipe, f.overrides, s.thicknesses, s), 0).cpu_seconds;
    result[f.name] = {{"cpu_seconds_of_an_eighth", small}, {"ratio", large / small}};
    fmt::print("8 x the thickness nodes, {}: {:.2f} x the CPU time ({:.1f} to {:.1f} s)\n", f.name,
               large / small, small, large);
  }
  return result;
}

// Turn by turn, the median of the ratios.
Json measure_threads(const Settings& s) {
  Json result;
  for (const Family& f : kFamilies) {
    const Recipe recipe = grid_of(f.recipe, f.overrides, s.thicknesses, s);
    std::vector<double> speedups;
    for (int round = 0; round < s.rounds; ++round) {
      const double two = bake_cost(recipe, 2).seconds, one = bake_cost(recipe, 1).seconds;
      speedups.push_back(one / two);
    }
    result[f.name] = speedups;
    fmt::print("two threads against one, {}: {:.2f} times as fast ({} rounds: {:.2f})\n", f.name,
               median(speedups), s.rounds, fmt::join(speedups, ", "));
  }
  return result;
}

Json measure_preview(const Settings& s) {
  const std::string table = s.folder + "/preview.exr";
  const ChildTime time =
      run_child({SUNBEAM_COMMAND, "bake", kRecipes + "sunbeam.toml", "--preview", "-o", table});
  fmt::print("preview of the default recipe: {:.2f} s\n", time.seconds);
  return {{"seconds", time.seconds}};
}

// A table of about so many megabytes, baked by the command: the slab in single precision, which compresses
// badly.
Json measure_memory(const Settings& s) {
  const std::string table = s.folder + "/large.exr";
  constexpr int kThicknesses = 512, kIors = 16;
  constexpr double kNodeBytes = 12.0 * 12 * 7 * 12;  // cosines, azimuths, three floats
  const int absorptions =
      static_cast<int>(std::ceil(s.megabytes * 1e6 / (kNodeBytes * kThicknesses * kIors)));
  const ChildTime time =
      run_child({SUNBEAM_COMMAND, "bake", kRecipes + "slab.toml", "-o", table, "--set",
                 "table.precision=float", "--set", range("film_thickness_nm", 0, 1500, kThicknesses), "--set",
                 range("base_ior", 1, 2, kIors), "--set", range("absorption_per_nm", 0, 0.002, absorptions)});
  const double bytes = static_cast<double>(std::filesystem::file_size(table));
  std::filesystem::remove(table);
  fmt::print("a table of {:.0f} MB: at most {:.0f} MB resident, {:.0f} s, {:.0f} CPU s\n", bytes / 1e6,
             time.most_resident / 1e6, time.seconds, time.cpu_seconds);
  return {{"bytes", bytes}, {"resident_bytes", time.most_resident}, {"seconds", time.seconds}};
}

int run(int argc, char** argv) {
  Settings s;
  std::string json, part = "quick";
  bool quick = false;
  CLI::App app("What a bake of a whole grid costs.");
  app.add_option("--part", part, "grid, growth, threads, preview, memory; quick: all but memory");
  app.add_option("--json", json, "Write the figures to this file");
  app.add_option("--folder", s.folder, "For tables, which are removed");
  app.add_option("--megabytes", s.megabytes, "Of the table of --part memory, uncompressed");
  app.add_flag("--small", quick, "A small grid, to see that it works");
  CLI11_PARSE(app, argc, argv);
  if (quick) s = {16, 2, 2, 4, 1, s.megabytes, s.folder};
  Json result;
  const auto wants = [&](const char* name) {
    return part == name || (part == "quick" && std::string(name) != "memory");
  };
  if (wants("grid")) result["grid"] = measure_grid(s);
  if (wants("growth")) result["growth"] = measure_growth(s);
  if (wants("threads")) result["threads"] = measure_threads(s);
  if (wants("preview")) result["preview"] = measure_preview(s);
  if (wants("memory")) result["memory"] = measure_memory(s);
  if (!json.empty()) write_file_atomically(json, result.dump(2) + "\n");
  return 0;
}

}  // namespace
}  // namespace sunbeam

int main(int argc, char** argv) {
  try {
    return sunbeam::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_bake: error: {}\n", error.what());
    return 2;
  }
}
