#include <fmt/format.h>

#include "bake/blocks/parts.h"
#include "bake/cli/commands.h"
#include "bake/cli/finish.h"
#include "bake/jobs/bake.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {

int run_merge(const MergeOptions& options) {
  require_table_extension(options.output);
  Parts parts(options.parts);
  const BakeIdentity& identity = parts.identity();
  const Recipe recipe = parse_recipe(identity.recipe, "recipe of " + options.parts.front());
  const bool is_factored = identity.encoding == name_of(Encoding::factored);
  const auto job = make_job(recipe, is_factored ? Encoding::factored : Encoding::dense, identity.seed);
  parts.require_whole(*job);
  require_writable(options.output);
  FinishedBake table(recipe, *job, parts);
  const bool good =
      measure_error(table, recipe, kCheckPoints, options.threads, progress_form(options.progress));
  save(table, options.output);
  const auto encodings = encodings_of(recipe);
  if (good || identity.encoding == name_of(encodings.back())) return 0;
  fmt::print(
      stderr,
      "{}: misses the recipe's tolerances, and a bake in one go would go on to encoding \"{}\": bake the "
      "parts again with --set table.encoding={}\n",
      options.output, name_of(encodings.back()), name_of(encodings.back()));
  return 1;
}

}  // namespace sunbeam
