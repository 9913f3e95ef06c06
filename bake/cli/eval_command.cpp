#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <sstream>

#include "bake/check/eval_csv.h"
#include "bake/cli/commands.h"
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

// What made the values, for standard error; empty for a table, which says so itself.
std::string evaluate_recipe(const EvalOptions& options, const PointsSettings& settings, std::istream& csv,
                            const std::string& name) {
  const Recipe recipe = load_recipe(options.source, options.overrides);
  const auto used = evaluate_points_live(recipe.material, recipe.spectrum, csv, name, settings, std::cout);
  return settings.quantity == Quantity::film ? "" : fmt::format("{}", fmt::join(used, ", "));
}

std::string evaluate(const EvalOptions& options, std::istream& csv, const std::string& name) {
  const PointsSettings settings{parse_quantity(options.quantity), options.samples, options.seed,
                                estimator_of(options.estimator)};
  if (!is_table(options.source)) return evaluate_recipe(options, settings, csv, name);
  if (settings.estimator != Estimator::automatic)
    throw Error(options.source + ": --estimator is for a recipe, not a table");
  if (!options.overrides.empty()) throw Error(options.source + ": --set changes a recipe, not a table");
  evaluate_points_table(load_table(options.source), csv, name, settings, std::cout);
  return "";
}

}  // namespace

int run_eval(const EvalOptions& options) {
  std::ios::sync_with_stdio(false);
  std::string estimator;
  if (options.points == "-") {
    estimator = evaluate(options, std::cin, "standard input");
  } else {
    std::istringstream file(read_file(options.points));
    estimator = evaluate(options, file, options.points);
  }
  if (!std::cout.flush()) throw Error("standard output: cannot write");
  if (!estimator.empty()) fmt::print(stderr, "estimator: {}\n", estimator);
  return 0;
}

}  // namespace sunbeam
