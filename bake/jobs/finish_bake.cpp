#include "bake/jobs/finish_bake.h"

#include "sunbeam/detail/table_ranges.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {

FinishedBake::FinishedBake(const Recipe& recipe, const BakeJob& job, const Blocks& blocks)
    : recipe_(recipe), table_(job.table(blocks)) {
  require_in_ranges(table_.head());  // no reader would take it
}

VerifyReport FinishedBake::measure_error(int points, int threads,
                                         std::function<void(double fraction)> on_progress) {
  VerifySettings settings = verify_settings_of(recipe_);
  settings.points = points;
  settings.threads = threads;
  settings.on_progress = std::move(on_progress);
  VerifyReport report = verify(table_, settings);
  std::map<std::string, std::string> error{{"error.truth", report.truth}};
  for (const auto& [name, value] : figures(report)) error["error." + name] = to_text(value);
  table_.add_info(error);
  return report;
}

void FinishedBake::save(const std::string& path) const { save_table(table_, path); }

}  // namespace sunbeam
