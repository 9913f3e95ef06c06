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

// Stores the figures of `sunbeam verify TABLE --points 250` in the table.
void measure_error(const Recipe& recipe, int threads, Table& table) {
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
  fmt::print(stderr, "error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points\n",
             report.error.median, report.error.p99, report.noise_floor.median, kVerifyPoints);
}

}  // namespace

int run_bake(const BakeOptions& options) {
  require_table_extension(options.output);
  const Recipe recipe = load_recipe(options.recipe, options.overrides);
  require_reasonable_size(recipe);
  require_writable(options.output);

  std::size_t nodes = 1;
  for (const Axis& axis : recipe.grid) nodes *= axis.size();
  fmt::print(stderr, "{}: {} parameter nodes, {} x {} cosines, {} azimuths, values by {}\n", options.recipe,
             nodes, recipe.table.angles, recipe.table.angles, recipe.table.azimuths,
             name_of(recipe.accuracy.estimator));
  SweepSettings settings;
  settings.seed = options.seed;
  settings.threads = options.threads;
  settings.on_progress = Progress("bake", "nodes", static_cast<double>(nodes));
  Table table = bake_table(recipe, settings);
  measure_error(recipe, options.threads, table);

  const std::string bytes = table_bytes(table, options.output);
  write_file_atomically(options.output, bytes);
  fmt::print(stderr, "{}: {} bytes, {} walks of {}\n", options.output, bytes.size(), table.info.at("samples"),
             table.info.at("estimator"));
  return 0;
}

}  // namespace sunbeam
