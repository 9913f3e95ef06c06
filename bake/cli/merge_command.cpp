#include <fmt/format.h>

#include "bake/blocks/parts.h"
#include "bake/cli/commands.h"
#include "bake/cli/finish.h"
#include "bake/jobs/bake.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {

namespace {

// What to do about a table that misses its tolerances.
std::string advice(const Recipe& recipe, const std::string& encoding) {
  const std::string last = name_of(encodings_of(recipe).back());
  if (encoding == last) return "";
  return fmt::format(
      "; a bake in one go would also try encoding \"{0}\": bake the parts again with --set "
      "table.encoding={0}",
      last);
}

}  // namespace

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
  const VerifyReport report =
      measure_error(table, kCheckPoints, options.threads, progress_form(options.progress));
  save(table, options.output);
  return verdict(options.output, recipe, report, advice(recipe, identity.encoding));
}

}  // namespace sunbeam
