#include "bake/jobs/finish_bake.h"

#include <fmt/format.h>

#include <filesystem>

#include "bake/check/verify.h"
#include "bake/jobs/bake.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {

FinishedBake::FinishedBake(const Recipe& recipe, const BakeJob& job, const Blocks& blocks)
    : recipe_(recipe), table_(job.table(blocks)), cells_(job.cells(blocks)) {}

bool FinishedBake::measure_error(int points, int threads, ProgressForm form) {
  VerifySettings settings;
  settings.points = points;
  settings.truth = default_truth(recipe_);
  settings.threads = threads;
  settings.tolerance_median = recipe_.accuracy.tolerance_median;
  settings.tolerance_p99 = recipe_.accuracy.tolerance_p99;
  settings.on_progress = Progress("verify", "points", points, form);
  const VerifyReport report = cells_ ? verify(table_, *cells_, settings) : verify(table_, settings);
  for (const auto& [name, value] : figures(report)) table_.info["error." + name] = to_text(value);
  table_.info["error.truth"] = report.truth;
  fmt::print(stderr, "error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points by {}\n",
             report.error.median, report.error.p99, report.noise_floor.median, points, report.truth);
  return within_tolerance(report, settings);
}

void FinishedBake::save(const std::string& path) const {
  if (cells_ && extension(path) == ".exr")
    save_table_exr(table_, *cells_, path);
  else
    save_table(cells_ ? whole_table(table_, *cells_) : table_, path);
  fmt::print(stderr, "{}: {}, {} bytes, {} walks of {}\n", path, table_.info.at("encoding"),
             std::filesystem::file_size(path), table_.info.at("samples"), table_.info.at("estimator"));
}

}  // namespace sunbeam
