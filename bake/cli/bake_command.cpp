#include <fmt/format.h>

#include "bake/cli/commands.h"
#include "bake/cli/progress.h"
#include "bake/recipe.h"
#include "bake/sweep.h"
#include "bake/verify.h"
#include "sunbeam/core/file.h"
#include "sunbeam/core/text.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

constexpr int kVerifyPoints = 250;

// Stores the figures of `sunbeam verify TABLE --points 250` in the table. True if within the tolerances.
bool measure_error(const Recipe& recipe, int threads, Table& table) {
  VerifySettings settings;
  settings.points = kVerifyPoints;
  settings.truth = default_truth(recipe);
  settings.threads = threads;
  settings.tolerance_median = recipe.accuracy.tolerance_median;
  settings.tolerance_p99 = recipe.accuracy.tolerance_p99;
  settings.on_progress = Progress("verify", "points", kVerifyPoints);
  const VerifyReport report = verify(table, settings);
  for (const auto& [name, value] : figures(report)) table.info["error." + name] = to_text(value);
  table.info["error.truth"] = report.truth;
  fmt::print(stderr, "error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points by {}\n",
             report.error.median, report.error.p99, report.noise_floor.median, kVerifyPoints, report.truth);
  return within_tolerance(report, settings);
}

void announce(const BakeOptions& options, const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    fmt::print(stderr, "{}: factored, {} cosines, {} base IORs, {} absorptions, values by shared walks\n",
               options.recipe, recipe.table.angles, recipe.grid[1].size(), recipe.grid[2].size());
    return;
  }
  fmt::print(stderr, "{}: dense, {} parameter nodes, {} x {} cosines, {} azimuths, values by {}\n",
             options.recipe, recipe.grid[0].size() * recipe.grid[1].size() * recipe.grid[2].size(),
             recipe.table.angles, recipe.table.angles, recipe.table.azimuths, dense_method(recipe));
}

Table bake_and_measure(const BakeOptions& options, const Recipe& recipe) {
  const auto encodings = encodings_of(recipe);
  for (const Encoding encoding : encodings) require_reasonable_size(recipe, encoding);
  for (const Encoding encoding : encodings) {
    announce(options, recipe, encoding);
    SweepSettings settings;
    settings.seed = options.seed;
    settings.threads = options.threads;
    settings.on_progress = Progress("bake", "%", 100);
    Table table = bake_table(recipe, encoding, settings);
    const bool good = measure_error(recipe, options.threads, table);
    if (encodings.size() > 1)
      fmt::print(stderr, "encoding auto: {} {} the tolerances (median {:g}, p99 {:g})\n", name_of(encoding),
                 good ? "is the smallest that meets" : "misses", recipe.accuracy.tolerance_median,
                 recipe.accuracy.tolerance_p99);
    if (good || encoding == encodings.back()) return table;
  }
  return {};
}

}  // namespace

int run_bake(const BakeOptions& options) {
  require_table_extension(options.output);
  const Recipe recipe = load_recipe(options.recipe, options.overrides);
  require_writable(options.output);
  const Table table = bake_and_measure(options, recipe);
  const std::string bytes = table_bytes(table, options.output);
  write_file_atomically(options.output, bytes);
  fmt::print(stderr, "{}: {}, {} bytes, {} walks of {}\n", options.output, table.info.at("encoding"),
             bytes.size(), table.info.at("samples"), table.info.at("estimator"));
  return 0;
}

}  // namespace sunbeam
