#include "bake/jobs/bake.h"

#include <fmt/format.h>

#include "bake/blocks/run.h"
#include "bake/dense/film_axes.h"
#include "bake/dense/nodes.h"
#include "bake/dense/solved_job.h"
#include "bake/dense/walked_job.h"
#include "bake/factored/axes.h"
#include "bake/factored/job.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

double cells_of(const std::vector<Axis>& axes) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  return cells;
}

double bytes_of(const ArrayShape& array) {
  return static_cast<double>(array.cells() * array.channels() *
                             (array.precision() == Precision::half_float ? 2 : 4));
}

}  // namespace

double bytes_of(const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    const FactorShapes factors = factor_shapes(recipe);
    double bytes = 0;
    for (const ArrayShape* array :
         {&factors.arrival, &factors.returned, &factors.exchange, &factors.facet_cosine, &factors.crossing,
          &factors.return_cosine, &factors.returning})
      bytes += bytes_of(*array);
    return bytes;
  }
  const double value = recipe.table.precision == Precision::half_float ? 2 : 4;
  const double films = recipe.material.is_smooth() && !is_layered(recipe) ? 1 : 2;
  return (3 * value + 4) * cells_of(rest_axes(recipe)) + films * 3 * 4 * cells_of(film_axes(recipe));
}

std::vector<Encoding> encodings_of(const Recipe& recipe) {
  if (recipe.table.encoding != Encoding::automatic) return {recipe.table.encoding};
  if (!has_factors(recipe.material)) return {Encoding::dense};
  if (recipe.grid[1].size() > 1 && reaches_below(recipe)) return {Encoding::factored};
  if (!has_factored_depths(recipe)) return {Encoding::dense};
  const bool is_small = bytes_of(recipe, Encoding::factored) < bytes_of(recipe, Encoding::dense);
  if (is_small || is_layered(recipe))  // what facets do takes no walks
    return {Encoding::factored, Encoding::dense};
  return {Encoding::dense, Encoding::factored};
}

void require_reasonable_size(const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    factor_shapes(recipe);
    return;
  }
  constexpr double kMostCells = 1u << 31;  // three halves each: 13 GB
  const double rest = cells_of(rest_axes(recipe)), film = cells_of(film_axes(recipe));
  if (rest > kMostCells)
    throw Error(
        fmt::format("{}: [grid] and table.angles, table.azimuths ask for {:.3g} cells; allowed: up to {:.3g}",
                    recipe.name, rest, kMostCells));
  if (film > kMostCells)
    throw Error(fmt::format(
        "{}: grid.film_thickness_nm and grid.base_ior ask for {:.3g} film cells; allowed: up to {:.3g}",
        recipe.name, film, kMostCells));
}

std::unique_ptr<BakeJob> make_job(const Recipe& recipe, Encoding encoding, std::uint64_t seed) {
  if (encoding == Encoding::factored)
    return is_layered(recipe) ? layered_job(recipe, seed) : factored_job(recipe, seed);
  return is_solved(recipe) ? solved_job(recipe, seed) : walked_job(recipe, seed);
}

Table bake_table(const Recipe& recipe, Encoding encoding, const BakeSettings& settings) {
  const auto job = make_job(recipe, encoding, settings.seed);
  BlocksInMemory blocks(job->tasks());
  TaskSettings run{settings.threads, {}, {}};
  if (settings.on_progress)
    run.on_progress = [&](const BakeProgress& p) { settings.on_progress(p.fraction); };
  run_tasks(*job, {0, job->tasks()}, blocks, run);
  std::optional<Table> room;
  return job->table(blocks).whole(room);
}

Table bake_table(const Recipe& recipe, const BakeSettings& settings) {
  return bake_table(recipe, encodings_of(recipe).front(), settings);
}

}  // namespace sunbeam
