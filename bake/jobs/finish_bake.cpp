#include "bake/jobs/finish_bake.h"

#include "bake/jobs/bake.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {

FinishedBake::FinishedBake(const Recipe& recipe, const BakeJob& job, const Blocks& blocks)
    : recipe_(recipe), table_(job.table(blocks)), cells_(job.cells(blocks)) {}

VerifyReport FinishedBake::measure_error(int points, int threads,
                                         std::function<void(double fraction)> on_progress) {
  VerifySettings settings = verify_settings_of(recipe_);
  settings.points = points;
  settings.threads = threads;
  settings.on_progress = std::move(on_progress);
  VerifyReport report = cells_ ? verify(table_, *cells_, settings) : verify(table_, settings);
  for (const auto& [name, value] : figures(report)) table_.info["error." + name] = to_text(value);
  table_.info["error.truth"] = report.truth;
  return report;
}

void FinishedBake::save(const std::string& path) const {
  if (cells_ && extension(path) == ".exr")
    save_table_exr(table_, *cells_, path);
  else
    save_table(cells_ ? whole_table(table_, *cells_) : table_, path);
}

}  // namespace sunbeam
