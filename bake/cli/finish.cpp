#include "bake/cli/finish.h"

#include <fmt/format.h>

#include <filesystem>

#include "bake/cli/console.h"

namespace sunbeam {

VerifyReport measure_error(FinishedBake& table, int points, int threads, ProgressForm form) {
  VerifyReport report = table.measure_error(points, threads, Progress("verify", "points", points, form));
  message("error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points by {}",
          report.error.median, report.error.p99, report.noise_floor.median, points, report.truth);
  return report;
}

void save(const FinishedBake& table, const std::string& path) {
  table.save(path);
  const auto& info = table.info();
  std::error_code no_file;  // but a device or a FIFO
  const auto bytes = std::filesystem::file_size(path, no_file);
  const std::string& walks = info.at("samples");
  message("{}: {}{}, {} {}", path, info.at("encoding"), no_file ? "" : fmt::format(", {} bytes", bytes),
          walks == "0" ? "values by" : walks + " walks of", info.at("estimator"));
}

int verdict(const std::string& path, const Recipe& recipe, const VerifyReport& report,
            const std::string& advice) {
  const VerifySettings settings = verify_settings_of(recipe);
  if (within_tolerance(report, settings)) return 0;
  message("{}: misses the recipe's tolerances: {}{}", path, missed_limits(report, settings), advice);
  return 1;
}

}  // namespace sunbeam
