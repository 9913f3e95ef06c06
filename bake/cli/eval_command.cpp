#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>

#include "bake/check/eval_csv.h"
#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/separate_files.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

Quantity parse_quantity(const std::string& name) {
  return name == "albedo" ? Quantity::albedo : name == "film" ? Quantity::film : Quantity::brdf;
}

bool is_table(const std::string& path) { return extension(path) == ".exr" || extension(path) == ".vdb"; }

PointsReport evaluate(const EvalOptions& options, const Csv& csv) {
  const PointsSettings settings{parse_quantity(options.quantity), options.samples, options.seed,
                                estimator_of(options.estimator)};
  if (!is_table(options.source)) {
    const Recipe recipe = load_recipe(options.source, options.overrides);
    return evaluate_points_live(recipe.material, recipe.spectrum, csv, settings, std::cout);
  }
  if (settings.estimator != Estimator::automatic)
    throw Error(options.source + ": --estimator is for a recipe, not a table");
  if (!options.overrides.empty()) throw Error(options.source + ": --set changes a recipe, not a table");
  return evaluate_points_table(load_table(options.source), csv, settings, std::cout);
}

Csv read_points(const std::string& path) {
  if (path != "-") return parse_csv(read_text(path), path);
  const std::string name = "standard input";
  return parse_csv(utf8_text(read_stream(std::cin, name), name), name);
}

// What made the values, and which columns had no part in it.
void print_report(const PointsReport& report, Quantity quantity) {
  if (!report.estimators.empty() && quantity != Quantity::film)
    message("estimator: {}", fmt::join(report.estimators, ", "));
  if (!report.unused_columns.empty()) message("carried through: {}", fmt::join(report.unused_columns, ", "));
}

}  // namespace

int run_eval(const EvalOptions& options) {
  require_separate({options.source, options.points}, {});
  std::ios::sync_with_stdio(false);
  std::cout.exceptions(std::ios::badbit);  // ends the work when nobody reads it
  try {
    const PointsReport report = evaluate(options, read_points(options.points));
    std::cout.flush();
    print_report(report, parse_quantity(options.quantity));
  } catch (const std::ios::failure&) {
    fail_output();
  }
  return 0;
}

}  // namespace sunbeam
