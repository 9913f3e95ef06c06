#include <fmt/format.h>

#include "bake/blocks/parts.h"
#include "bake/cli/commands.h"
#include "bake/cli/finish.h"
#include "bake/cli/separate_files.h"
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

Encoding encoding_of(const BakeIdentity& identity, const std::string& path) {
  for (const Encoding encoding : {Encoding::factored, Encoding::dense})
    if (identity.encoding == name_of(encoding)) return encoding;
  throw Error(
      fmt::format("{}: its header has encoding '{:.40}'; allowed: factored, dense", path, identity.encoding));
}

}  // namespace

int run_merge(const MergeOptions& options) {
  require_table_extension(options.output);
  require_separate(options.parts, {options.output});
  Parts parts(options.parts);
  const BakeIdentity& identity = parts.identity();
  const Recipe recipe = parse_recipe(identity.recipe, "recipe of " + options.parts.front());
  const Encoding encoding = encoding_of(identity, options.parts.front());
  require_reasonable_size(recipe, encoding);
  const auto job = make_job(recipe, encoding, identity.seed);
  parts.require_whole(*job);
  require_writable(options.output);
  FinishedBake table(recipe, *job, parts);
  const VerifyReport report =
      measure_error(table, kCheckPoints, options.threads, progress_form(options.progress));
  save(table, options.output);
  return verdict(options.output, recipe, report, advice(recipe, identity.encoding));
}

}  // namespace sunbeam
