#include "bake/cli/finish.h"

#include <fmt/format.h>

#include <filesystem>

namespace sunbeam {

VerifyReport measure_error(FinishedBake& table, int points, int threads, ProgressForm form) {
  VerifyReport report = table.measure_error(points, threads, Progress("verify", "points", points, form));
  fmt::print(stderr, "error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points by {}\n",
             report.error.median, report.error.p99, report.noise_floor.median, points, report.truth);
  return report;
}

void save(const FinishedBake& table, const std::string& path) {
  table.save(path);
  const auto& info = table.info();
  fmt::print(stderr, "{}: {}, {} bytes, {} walks of {}\n", path, info.at("encoding"),
             std::filesystem::file_size(path), info.at("samples"), info.at("estimator"));
}

int verdict(const std::string& path, const Recipe& recipe, const VerifyReport& report,
            const std::string& advice) {
  const VerifySettings settings = verify_settings_of(recipe);
  if (within_tolerance(report, settings)) return 0;
  fmt::print(stderr, "{}: misses the recipe's tolerances: {}{}\n", path, missed_limits(report, settings),
             advice);
  return 1;
}

}  // namespace sunbeam
