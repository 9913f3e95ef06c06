// The command `sunbeam`. Parses the command line and translates errors into exit codes, nothing else:
// 0 success, 1 a check failed, 2 bad input or an operation that could not be done.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>
#include <new>
#include <sstream>
#include <tuple>

#include "bake/base/version.h"
#include "bake/blocks/journal.h"
#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/validators.h"
#include "runtime/config/config.h"
#include "runtime/tracer/scales.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/read_limit.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/processor.h"
#include "sunbeam/detail/text.h"

namespace {

using namespace sunbeam;

constexpr std::uint64_t kMostThreads = 1024;
constexpr std::uint64_t kMostSamples = 1000000000000000;
constexpr std::uint64_t kAnySeed = std::numeric_limits<std::uint64_t>::max();

CLI::App* add_command(CLI::App& app, const char* name, const char* what, const char* example) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer(std::string("Example:\n  ") + example);
  return command;
}

void add_threads(CLI::App* command, int& threads) {
  command->add_option("--threads", threads, "Threads; 0 uses all")->check(whole_number(0, kMostThreads));
}

void add_overrides(CLI::App* command, std::vector<std::string>& overrides) {
  command
      ->add_option("--set", overrides,
                   "Override a key of the file: section.key=value, material[0].albedo=0.2")
      ->expected(1)
      ->take_all();
}

void add_progress(CLI::App* command, std::string& form) {
  command->add_option("--progress", form, "On stderr; json: a line a second, for logs")
      ->check(CLI::IsMember({"text", "json"}));
}

void add_max_memory(CLI::App* command) {
  command
      ->add_option_function<double>(
          "--max-memory", [](const double& gb) { set_read_limit(static_cast<std::uint64_t>(gb * 1e9)); },
          "GB that the contents of a file may take; default: 1 and four times the file")
      ->check(number(1, 1e6));
}

// "K/N" with 1 <= K <= N.
std::pair<int, int> shard_of_text(const std::string& text) {
  constexpr int kMostShards = BakeIdentity::kMostShards;
  const auto numbers = split(text, '/');
  double shard = 0, shards = 0;
  if (numbers.size() != 2 || !parse_number(numbers[0], shard) || !parse_number(numbers[1], shards) ||
      !(shard >= 1 && shard <= shards && shards <= kMostShards) || shard != std::floor(shard) ||
      shards != std::floor(shards))
    throw Error(fmt::format("--shard: found '{}'; allowed: K/N with K from 1 to N, and N up to {}", text,
                            kMostShards));
  return {static_cast<int>(shard), static_cast<int>(shards)};
}

void add_bake(CLI::App& app, BakeOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "bake", "Bake a recipe into a table (.exr or .vdb)",
                  "sunbeam bake tables/recipes/sunbeam.toml -o skin.exr --set material.albedo=0.5");
  command->add_option("recipe", o.recipe, "Recipe (TOML)")->required()->check(file_path());
  command->add_option("-o,--output", o.output, "Table to write; the extension chooses the form")
      ->required()
      ->check(file_path());
  add_overrides(command, o.overrides);
  add_threads(command, o.threads);
  command->add_option("--seed", o.seed, "Random seed")->check(whole_number(0, kAnySeed));
  command->add_flag("--resume", o.resume, "Continue the bake in OUTPUT.work, if there is one");
  CLI::Option* preview = command->add_flag("--preview", o.preview, "A coarse table in seconds");
  command
      ->add_option_function<std::string>(
          "--shard", [&o](const std::string& text) { std::tie(o.shard, o.shards) = shard_of_text(text); },
          "K/N: bake the K-th of N parts, for sunbeam merge")
      ->excludes(preview);
  add_progress(command, o.progress);
  add_max_memory(command);
  command->callback([&] { exit_code = run_bake(o); });
}

void add_merge(CLI::App& app, MergeOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "merge", "Join the parts of a bake into a table (.exr or .vdb)",
                  "sunbeam bake RECIPE --shard 1/2 -o 1.part; sunbeam bake RECIPE --shard 2/2 "
                  "-o 2.part; sunbeam merge 1.part 2.part -o skin.exr");
  command->add_option("parts", o.parts, "Parts, in any order")->required()->check(file_path());
  command->add_option("-o,--output", o.output, "Table to write; the extension chooses the form")
      ->required()
      ->check(file_path());
  add_threads(command, o.threads);
  add_progress(command, o.progress);
  add_max_memory(command);
  command->callback([&] { exit_code = run_merge(o); });
}

void add_info(CLI::App& app, InfoOptions& o, int& exit_code) {
  CLI::App* command = add_command(app, "info", "Show what a table holds, or how a recipe is evaluated live",
                                  "sunbeam info skin.exr --json");
  command->add_option("source", o.source, "Table (.exr, .vdb) or recipe (.toml)")
      ->required()
      ->check(file_path());
  command->add_flag("--json", o.json, "As JSON");
  add_max_memory(command);
  command->callback([&] { exit_code = run_info(o); });
}

void add_eval(CLI::App& app, EvalOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "eval", "Evaluate a recipe (live) or a table at the rows of a CSV file",
                  "echo 'theta_i_deg,theta_o_deg,phi_deg\n  30,30,180' | "
                  "sunbeam eval tables/recipes/sunbeam.toml --points -");
  command->add_option("source", o.source, "Recipe (.toml) or table (.exr, .vdb)")
      ->required()
      ->check(file_path());
  command->add_option("--points", o.points, "CSV file, or - for standard input")
      ->required()
      ->check(file_path());
  command->add_option("--quantity", o.quantity, "What to evaluate")
      ->check(CLI::IsMember({"brdf", "albedo", "film"}));
  command
      ->add_option("--estimator", o.estimator,
                   "Evaluator of a recipe's rest and albedo; auto: see sunbeam info RECIPE")
      ->check(CLI::IsMember({"auto", "pfmc", "bidirectional", "exact"}));
  add_overrides(command, o.overrides);
  command
      ->add_option("--samples", o.samples,
                   "Estimates a row of PFMC and of pdf; one of PFMC's is the mean of 16 walks")
      ->check(whole_number(2, kMostSamples));
  command->add_option("--seed", o.seed, "Random seed; row k uses stream k")->check(whole_number(0, kAnySeed));
  add_max_memory(command);
  command->callback([&] { exit_code = run_eval(o); });
}

void add_verify(CLI::App& app, VerifyOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "verify", "Hold a table against live evaluation at random held-out points",
                  "sunbeam verify skin.exr --json report.json --html report.html");
  command->add_option("table", o.table, "Table (.exr or .vdb)")->required()->check(file_path());
  command->add_option("--points", o.points, "Random points")->check(whole_number(1, 100000000));
  command->add_option("--truth", o.truth, "What to hold it against")
      ->check(CLI::IsMember({"pfmc", "bidirectional", "exact"}));
  command->add_option("--json", o.json, "Write the figures to this file")->check(file_path());
  command->add_option("--html", o.html, "Write a report with charts and pictures to this file (.html)")
      ->check(file_path());
  add_threads(command, o.threads);
  command->add_option("--seed", o.seed, "Random seed; point k uses stream k")
      ->check(whole_number(0, kAnySeed));
  add_max_memory(command);
  command->callback([&] { exit_code = run_verify(o); });
}

void add_plot(CLI::App& app, PlotOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "plot", "Draw one picture of a table",
                  "sunbeam plot skin.exr --what sphere -o sphere.png --film-thickness-nm 350");
  command->add_option("table", o.table, "Table (.exr or .vdb)")->required()->check(file_path());
  command->add_option("-o,--output", o.output, "Picture to write: .png for slice and sphere, .svg for charts")
      ->required()
      ->check(file_path());
  command->add_option("--what", o.what, "What to draw")
      ->required()
      ->check(CLI::IsMember({"polar", "slice", "sphere", "reflectance"}));
  command->add_option("--film-thickness-nm", o.film_thickness_nm, "Film thickness; default: the table's own")
      ->check(any_number());
  command->add_option("--base-ior", o.base_ior, "Index below the film; default: the table's own")
      ->check(any_number());
  command->add_option("--absorption-per-nm", o.absorption_per_nm, "Absorption; default: the table's own")
      ->check(any_number());
  command->add_option("--theta-i", o.theta_i_deg, "Angle of the light, degrees, for polar; default: 30")
      ->check(any_number());
  add_max_memory(command);
  command->callback([&] { exit_code = run_plot(o); });
}

void add_render(CLI::App& app, RenderOptions& o, int& exit_code) {
  CLI::App* command =
      add_command(app, "render", "Render a scene with a table, with the live model, or diffuse",
                  "sunbeam render tables/scenes/sphere.toml -o sphere.exr --size 960x540 --spp 64");
  command->add_option("scene", o.scene, "Scene (TOML)")->required()->check(file_path());
  command->add_option("-o,--output", o.output, "Image to write (.exr); a .png goes beside it")
      ->required()
      ->check(file_path());
  command->add_option("--material", o.material, "Skin material")
      ->check(CLI::IsMember({"table", "live", "diffuse"}));
  command->add_option("--estimator", o.estimator, "Evaluator of --material live; auto: exact where it can")
      ->check(CLI::IsMember({"auto", "pfmc", "bidirectional", "exact"}));
  command->add_option("--table", o.table, "Table to use in place of the scene's own")->check(file_path());
  command->add_option("--size", o.size, "WIDTHxHEIGHT in pixels");
  command->add_option("--spp", o.samples_per_pixel, "Samples per pixel; the most with --time or --noise")
      ->check(whole_number(1, 1 << 24));
  command->add_option("--time", o.time, "Stop after this long: 10s, 500ms, 2m, 1h");
  command->add_option("--noise", o.noise, "Stop where the relative standard error is this small: 0.02")
      ->check(number(1e-6, 1));
  command->add_option("--crop", o.crop, "X0,Y0,X1,Y1: render only these pixels, x from X0 to X1 - 1");
  command->add_flag("--watch{2}", o.watch_seconds, "Write the picture so far every 2 s, --watch=5: every 5 s")
      ->check(number(0.01, 1e6));
  command->add_flag("--aovs", o.aovs, "Add layers: albedo, normals, depth, film thickness");
  command->add_option("--resume", o.resume, "Picture of the same scene to go on from")->check(file_path());
  add_overrides(command, o.overrides);
  add_threads(command, o.threads);
  command->add_option("--seed", o.seed, "Random seed")->check(whole_number(0, kAnySeed));
  command->add_option("--stats", o.stats, "Write timing and counts to this JSON file")->check(file_path());
  add_max_memory(command);
  command->callback([&] { exit_code = run_render(o); });
}

void add_compare(CLI::App& app, CompareOptions& o, int& exit_code) {
  CLI::App* command = add_command(app, "compare", "Measure how far a rendered image is from a reference",
                                  "sunbeam compare table.exr live.exr --max-bias-z 4 --png flip.png");
  command->add_option("test", o.test, "Image to judge (.exr, .png)")->required()->check(file_path());
  command->add_option("reference", o.reference, "Image to hold it against (.exr, .png)")
      ->required()
      ->check(file_path());
  command->add_option("--png", o.png, "Write FLIP of every pixel to this picture (.png): black 0, yellow 1")
      ->check(file_path());
  command->add_flag("--json", o.json, "As JSON");
  command->add_option("--pixels-per-degree", o.pixels_per_degree, "Of the observer of FLIP; default: 67")
      ->check(number(1, kMostPixelsPerDegree));
  const auto add_limit = [&](const char* name, std::optional<double>& most, const char* what) {
    command->add_option(name, most, what)->check(number(0, std::numeric_limits<double>::max()));
  };
  add_limit("--max-rmse", o.max_rmse, "Exit with 1 if RMSE is above this");
  add_limit("--max-relmse", o.max_relmse, "Exit with 1 if relMSE is above this");
  add_limit("--max-flip", o.max_flip, "Exit with 1 if mean FLIP is above this");
  add_limit("--max-bias", o.max_bias, "Exit with 1 if the mean difference of a channel is above this");
  add_limit("--max-bias-z", o.max_bias_z, "The same in standard errors; needs the variance of both");
  add_max_memory(command);
  command->callback([&] { exit_code = run_compare(o); });
}

void add_texture(CLI::App& app, TextureOptions& o, int& exit_code) {
  CLI::App* command = add_command(app, "texture", "Write scales as a height map that tiles without a seam",
                                  "sunbeam texture -o scales.exr --pattern voronoi --columns 24 --rows 28");
  command->add_option("-o,--output", o.output, "Heights to write: .exr (float) or .png (16 bits)")
      ->required()
      ->check(file_path());
  command->add_option("--pattern", o.pattern, "Grid of the scales; snake, snake_head: over a whole girth")
      ->check(CLI::IsMember({"hexagonal", "voronoi", "snake", "snake_head"}));
  command->add_option("--columns", o.columns, "Scales across the tile")
      ->check(whole_number(1, kMaxScaleColumns));
  command->add_option("--rows", o.rows, "Rows of scales in the tile, an even number")
      ->check(whole_number(2, kMaxScaleColumns));
  command->add_option("--edge", o.edge, "Width of a scale's slope in scale widths; 0.5 is a dome")
      ->check(any_number());
  command->add_option("--jitter", o.jitter, "Disorder of voronoi scales: 0 is the hexagonal grid")
      ->check(any_number());
  command->add_option("--pixels-per-scale", o.pixels_per_scale, "Pixels to a scale width")
      ->check(whole_number(4, 256));
  command->add_option("--seed", o.seed, "Random seed of voronoi scales")->check(whole_number(0, kAnySeed));
  command->callback([&] { exit_code = run_texture(o); });
}

void add_mesh(CLI::App& app, MeshOptions& o, int& exit_code) {
  CLI::App* command = add_command(app, "mesh", "Write a built-in shape as a mesh",
                                  "sunbeam mesh snake -o snake.ply --turns 3");
  command->add_option("shape", o.shape, "Shape")
      ->required()
      ->check(CLI::IsMember({"snake", "torus", "sphere"}));
  command->add_option("-o,--output", o.output, "Mesh to write (.ply or .obj)")
      ->required()
      ->check(file_path());
  command
      ->add_option("--resolution", o.resolution, "Vertices around: the snake's body, the axis of the others")
      ->check(whole_number(16, 1024));
  command->add_option("--body-radius", o.body_radius, "Of the snake, where it is thickest")
      ->check(any_number());
  command->add_option("--turns", o.turns, "Of the snake's coil, 1 to 6")->check(any_number());
  command->add_option("--major-radius", o.major_radius, "Of the torus")->check(any_number());
  command->add_option("--minor-radius", o.minor_radius, "Of the torus")->check(any_number());
  command->add_option("--radius", o.radius, "Of the sphere")->check(any_number());
  command->callback([&] { exit_code = run_mesh(o); });
}

void refuse_unknown_option(const CLI::App& command, const std::string& argument) {
  const std::string option = argument.substr(0, argument.find('='));
  if (!option.starts_with("--")) return;
  // CLI11 would take it for the option without a value.
  if (argument == option + "=") throw Error(option + ": found ''; allowed: a value");
  if (command.get_option_no_throw(option)) return;
  std::vector<std::string> names;
  for (const CLI::Option* known : command.get_options())
    for (const auto& name : known->get_lnames()) names.push_back("--" + name);
  throw Error(fmt::format("'{}' is not an option; the nearest is '{}'", option, nearest(option, names)));
}

// CLI11 reports a missing argument before the typo that caused it; this names the typo.
void refuse_unknown(const CLI::App& app, int argc, char** argv) {
  if (argc < 2) return;
  const std::string first = argv[1];
  refuse_unknown_option(app, first);
  if (first.starts_with('-')) return;
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  const auto command =
      std::find_if(commands.begin(), commands.end(), [&](auto* c) { return c->get_name() == first; });
  if (command != commands.end()) {
    for (int k = 2; k < argc && argv[k] != std::string("--"); ++k) refuse_unknown_option(**command, argv[k]);
    return;
  }
  std::vector<std::string> names;
  for (const CLI::App* known : commands) names.push_back(known->get_name());
  throw Error(fmt::format("'{}' is not a command; the nearest is '{}'", first, nearest(first, names)));
}

int run(int argc, char** argv) {
  CLI::App app("Sunbeam: bakes iridescent layered materials into BRDF tables, proves and previews them.");
  app.set_version_flag("--version", std::string("sunbeam ") + kToolVersion);
  app.require_subcommand(1);
  app.footer(
      "Example:\n  sunbeam bake tables/recipes/quick.toml -o quick.exr\n"
      "`sunbeam COMMAND --help` shows the options of a command.");
  int exit_code = 0;
  BakeOptions bake;
  MergeOptions merge;
  InfoOptions info;
  EvalOptions eval;
  VerifyOptions verify;
  PlotOptions plot;
  RenderOptions render;
  CompareOptions compare;
  TextureOptions texture;
  MeshOptions mesh;
  add_bake(app, bake, exit_code);
  add_merge(app, merge, exit_code);
  add_info(app, info, exit_code);
  add_eval(app, eval, exit_code);
  add_verify(app, verify, exit_code);
  add_plot(app, plot, exit_code);
  add_render(app, render, exit_code);
  add_compare(app, compare, exit_code);
  add_texture(app, texture, exit_code);
  add_mesh(app, mesh, exit_code);
  refuse_unknown(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text, none;
    app.exit(help_or_version, text, none);
    write_output(text.view());
    return 0;
  } catch (const CLI::ParseError& error) {
    throw Error(
        fmt::format("{}; see sunbeam {}--help", error.what(), argc > 1 ? std::string(argv[1]) + " " : ""));
  }
  return exit_code;
}

void end_by(int signal) {
  remove_temporaries();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// What nohup and shells without job control have ignored stays so.
void clean_up_on_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM})
    if (std::signal(signal, end_by) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

int main(int argc, char** argv) {
  prepare_console();
  clean_up_on_signals();
  std::signal(SIGXFSZ, SIG_IGN);  // a full quota is an error to report, like a full disk
  try {
    baseline_is_forced();  // refuses a wrong SUNBEAM_KERNELS before any work
    const int exit_code = run(argc, argv);
    require_output_written();
    return exit_code;
  } catch (const Error& error) {
    message("sunbeam: error: {}", error.what());
  } catch (const std::bad_alloc&) {
    write_message("sunbeam: error: not enough memory\n");
  } catch (const std::exception& error) {
    message("sunbeam: error: {}", error.what());
  }
  return 2;
}
