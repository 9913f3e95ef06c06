// Speed of the path tracer, by the CPU clock of one thread, variants in turns so that their ratios hold on a
// busy machine.
//
//   build/release/bin/bench_render [--json FILE] [--part NAME ...] [--width 640 --height 360] [--quick]
//
// --quick measures little, to see that all of it runs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <deque>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "bake/jobs/bake.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table_io.h"
#include "tests/bench/child_process.h"
#include "tests/bench/timed_render.h"
#include "tests/support/scratch_folder.h"

namespace sunbeam {
namespace {

using Json = nlohmann::ordered_json;

const std::string kRecipe = SUNBEAM_SOURCE_DIR "/tables/recipes/sunbeam.toml";
constexpr int kNever = 10000;  // roulette

const Effort kQuick{.width = 64, .height = 36, .rounds = 2, .spp = 2, .baking = {"table.angles=4"}};

// --- the parts ---

// Lambert everywhere against bare Embree.
Json measure_ceiling(const Effort& effort) {
  Json rows;
  for (const std::string name : {"bench_sphere", "bench_torus"}) {
    Prepared ours(name, "diffuse", effort);
    const EmbreeCeiling ceiling(ours.scene(), static_cast<float>(ours.scene().diffuse_albedo.r));
    const auto runs = in_turns(effort.rounds, {std::ref(ours), [&](int round) {
                                                 return trace_bare(ceiling, ours.scene(), effort, round);
                                               }});
    rows.push_back({{"scene", name},
                    {"paths_per_second", 1e9 / best_ns(runs[0], path_seconds)},
                    {"bare_paths_per_second", 1e9 / best_ns(runs[1], path_seconds)},
                    {"ratio", ratio(runs[1], runs[0], path_seconds)},
                    {"rays_per_path", mean_of(runs[0], rays_per_path)},
                    {"bare_rays_per_path", mean_of(runs[1], rays_per_path)},
                    {"mean", mean_of(runs[0], mean_radiance)},
                    {"bare_mean", mean_of(runs[1], mean_radiance)}});
  }
  return rows;
}

// The scene's table everywhere against Lambert everywhere.
Json measure_table(const Effort& effort) {
  Json rows;
  for (const std::string name : {"bench_sphere", "bench_torus"}) {
    const auto without_roulette = [](Scene& scene) { scene.render.roulette_after = kNever; };
    const Prepared diffuse(name, "diffuse", effort), table(name, "table", effort);
    const Prepared long_diffuse(name, "diffuse", effort, Estimator::automatic, without_roulette),
        long_table(name, "table", effort, Estimator::automatic, without_roulette);
    const auto runs = in_turns(effort.rounds, {std::cref(diffuse), std::cref(table), std::cref(long_diffuse),
                                               std::cref(long_table)});
    rows.push_back({{"scene", name},
                    {"diffuse_ns_per_path", best_ns(runs[0], path_seconds)},
                    {"table_ns_per_path", best_ns(runs[1], path_seconds)},
                    {"path_ratio", ratio(runs[1], runs[0], path_seconds)},
                    {"diffuse_ns_per_vertex", best_ns(runs[2], vertex_seconds)},
                    {"table_ns_per_vertex", best_ns(runs[3], vertex_seconds)},
                    {"vertex_ratio", ratio(runs[3], runs[2], vertex_seconds)},
                    {"diffuse_vertices_per_path", mean_of(runs[2], vertices_per_path)},
                    {"table_vertices_per_path", mean_of(runs[3], vertices_per_path)}});
  }
  return rows;
}

// From the start of the command to the picture on disk, one sample a pixel, all cores.
Json measure_start(const Effort& effort) {
  const ScratchFolder scratch;
  Json rows;
  for (const std::string name : {"bench_sphere", "bench_torus"})
    for (const std::string material : {"diffuse", "table"}) {
      double seconds = 1e9, cpu_seconds = 1e9;
      for (int round = 0; round < effort.rounds; ++round) {
        const ChildTime time = run_child(
            {SUNBEAM_COMMAND, "render", scene_path(name), "-o", scratch.file("picture.exr"), "--spp", "1",
             "--size", fmt::format("{}x{}", effort.width, effort.height), "--material", material});
        seconds = std::min(seconds, time.seconds);
        cpu_seconds = std::min(cpu_seconds, time.cpu_seconds);
      }
      rows.push_back(
          {{"scene", name}, {"material", material}, {"seconds", seconds}, {"cpu_seconds", cpu_seconds}});
    }
  return rows;
}

// Film and pigment of the paper's Table 2.
constexpr double kFilm = 900, kBaseIor = 1, kAbsorption = 0.7;

void set_skins(Scene& scene, double absorption) {
  for (SceneMaterial& material : scene.materials) {
    if (material.type != SceneMaterial::Type::skin) continue;
    material.parameters = {ParameterField::of(kFilm), ParameterField::of(kBaseIor),
                           ParameterField::of(absorption)};
  }
}

void set_relief(Scene& scene, const std::optional<Relief>& relief) {
  for (SceneMaterial& material : scene.materials)
    if (material.type == SceneMaterial::Type::skin) material.relief = relief;
}

// With and without pigment; nothing else to look up.
void bake_both(const std::string& path, const Effort& effort) {
  std::vector<std::string> overrides = {fmt::format("grid.film_thickness_nm=[{}]", kFilm),
                                        fmt::format("grid.base_ior=[{:.1f}]", kBaseIor),
                                        fmt::format("grid.absorption_per_nm=[0.0, {}]", kAbsorption)};
  overrides.insert(overrides.end(), effort.baking.begin(), effort.baking.end());
  save_table_exr(bake_table(load_recipe(kRecipe, overrides), {}), path);
}

struct Look {
  std::string name, mode;
  double absorption;
  Estimator estimator = Estimator::automatic;
};

Json compare_looks(const std::string& scene, const Effort& effort, const std::vector<Look>& looks,
                   const std::function<void(Scene&, const Look&)>& change) {
  std::deque<Prepared> prepared;
  std::vector<Variant> variants;
  for (const Look& look : looks)
    variants.push_back(
        std::ref(prepared.emplace_back(scene, look.mode, effort, look.estimator, [&](Scene& s) {
          set_skins(s, look.absorption);
          change(s, look);
        })));
  const auto runs = in_turns(effort.rounds, variants);
  Json rows;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const double time = ratio(runs[i], runs[0], path_seconds);
    rows.push_back({{"scene", scene},
                    {"material", looks[i].name},
                    {"ns_per_path", best_ns(runs[i], path_seconds)},
                    {"mean", mean_of(runs[i], mean_radiance)},
                    {"relative_variance", relative_variance(runs[i])},
                    {"time_ratio", time},
                    {"equal_noise_ratio", time * relative_variance(runs[i]) / relative_variance(runs[0])}});
  }
  return rows;
}

Json measure_looks(const Effort& effort) {
  const ScratchFolder scratch;
  const std::string table = scratch.file("table.exr");
  bake_both(table, effort);
  const std::vector<Look> looks = {{"diffuse", "diffuse", 0},
                                   {"diffuse, scales", "diffuse", 0},
                                   {"live film", "live", 0, Estimator::pfmc},
                                   {"live film, pigment", "live", kAbsorption, Estimator::pfmc},
                                   {"table film", "table", 0},
                                   {"table film, pigment", "table", kAbsorption}};
  const std::optional<Relief> scales =
      load_scene(scene_path("snake"), {"material[0].scales.pattern=hexagonal"}).materials[0].relief;
  Json rows;
  for (const std::string scene : {"sphere", "torus", "snake"})
    for (const Json& row : compare_looks(scene, effort, looks, [&](Scene&s, const Look&look) {
           s.table = table;
           set_relief(s, look.name == "diffuse" ? std::nullopt : scales);
         }))
      rows.push_back(row);
  return rows;
}

Json measure_estimators(const Effort& effort) {
  const ScratchFolder scratch;
  const std::string table = scratch.file("table.exr");
  bake_both(table, effort);
  Json rows;
  for (const double absorption : {0.0, kAbsorption}) {
    const std::string suffix = absorption > 0 ? ", pigment" : "";
    const std::vector<Look> looks = {{"table" + suffix, "table", absorption},
                                     {"pfmc" + suffix, "live", absorption, Estimator::pfmc},
                                     {"bidirectional" + suffix, "live", absorption, Estimator::bidirectional},
                                     {"exact" + suffix, "live", absorption, Estimator::exact}};
    for (const Json& row :
         compare_looks("bench_sphere", effort, looks, [&](Scene&s, const Look&) { s.table = table; }))
      rows.push_back(row);
  }
  return rows;
}

// The first hits kept against not kept.
Json measure_aovs(const Effort& effort) {
  Json rows;
  for (const std::string material : {"diffuse", "table"}) {
    const Prepared prepared("bench_sphere", material, effort);
    const auto runs = in_turns(
        effort.rounds, {std::cref(prepared), [&](int round) { return prepared.render_with(round, true); }});
    rows.push_back({{"material", material},
                    {"ns_per_path", best_ns(runs[0], path_seconds)},
                    {"aovs_ns_per_path", best_ns(runs[1], path_seconds)},
                    {"ratio", ratio(runs[1], runs[0], path_seconds)}});
  }
  return rows;
}

// --- what is printed ---

struct Part {
  const char *name, *title;
  Json (*measure)(const Effort&);
};

const std::vector<Part> kParts = {
    {"ceiling", "Lambert against bare Embree", measure_ceiling},
    {"table", "The table against Lambert", measure_table},
    {"start", "From the start of `sunbeam render --spp 1` to the picture", measure_start},
    {"looks", "Materials", measure_looks},
    {"estimators", "Estimators of the live film", measure_estimators},
    {"aovs", "First hits", measure_aovs},
};

std::string cell(const Json& value) {
  return value.is_string() ? value.get<std::string>() : fmt::format("{:.4g}", value.get<double>());
}

// Markdown, a column a key.
void print(const Part& part, const Json& rows) {
  std::vector<std::string> keys;
  for (const auto& item : rows[0].items()) keys.push_back(item.key());
  fmt::print("### {}\n\n| {} |\n|{}\n", part.title, fmt::join(keys, " | "),
             fmt::join(std::vector<std::string>(keys.size(), "---|"), ""));
  for (const Json& row : rows) {
    for (const Json& value : row) fmt::print("| {} ", cell(value));
    fmt::print("|\n");
  }
  fmt::print("\n");
  std::fflush(stdout);
}

void save(const Json& report, const std::string& path) {
  std::ofstream file(path);
  file << report.dump(2) << '\n';
  file.close();
  if (!file) throw Error(path + ": cannot be written");
}

Json measure(const std::vector<std::string>& names, const Effort& effort) {
  Json report;
  report["width"] = effort.width;
  report["height"] = effort.height;
  report["spp"] = effort.spp;
  report["rounds"] = effort.rounds;
  for (const Part& part : kParts) {
    if (!names.empty() && std::find(names.begin(), names.end(), part.name) == names.end()) continue;
    report[part.name] = part.measure(effort);
    print(part, report[part.name]);
  }
  return report;
}

std::vector<std::string> part_names() {
  std::vector<std::string> names;
  for (const Part& part : kParts) names.push_back(part.name);
  return names;
}

}  // namespace
}  // namespace sunbeam

int main(int argc, char** argv) {
  using namespace sunbeam;
  CLI::App app("Speed of the path tracer");
  std::string json;
  std::vector<std::string> parts;
  std::optional<int> width, height, spp, rounds;
  bool quick = false;
  app.add_option("--json", json, "write the figures to this file");
  app.add_option("--part", parts, "measure only these")->check(CLI::IsMember(part_names()));
  app.add_option("--width", width, "pixels")->check(CLI::PositiveNumber);
  app.add_option("--height", height, "pixels")->check(CLI::PositiveNumber);
  app.add_option("--spp", spp, "samples a pixel in each round")->check(CLI::Range(2, 1 << 20));
  app.add_option("--rounds", rounds, "rounds")->check(CLI::PositiveNumber);
  app.add_flag("--quick", quick, "measure little");
  CLI11_PARSE(app, argc, argv);
  try {
    Effort effort = quick ? kQuick : Effort();
    effort.width = width.value_or(effort.width);
    effort.height = height.value_or(effort.height);
    effort.spp = spp.value_or(effort.spp);
    effort.rounds = rounds.value_or(effort.rounds);
    const Json report = measure(parts, effort);
    if (!json.empty()) save(report, json);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
