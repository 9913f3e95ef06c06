#include "bake/cli/finish.h"

#include <fmt/format.h>

#include <filesystem>

namespace sunbeam {

bool measure_error(FinishedBake& table, const Recipe& recipe, int points, int threads, ProgressForm form) {
  const VerifyReport report =
      table.measure_error(points, threads, Progress("verify", "points", points, form));
  fmt::print(stderr, "error median {:.3g} p99 {:.3g} (noise floor {:.3g}), measured at {} points by {}\n",
             report.error.median, report.error.p99, report.noise_floor.median, points, report.truth);
  return within_tolerance(report, verify_settings_of(recipe));
}

void save(const FinishedBake& table, const std::string& path) {
  table.save(path);
  const auto& info = table.info();
  fmt::print(stderr, "{}: {}, {} bytes, {} walks of {}\n", path, info.at("encoding"),
             std::filesystem::file_size(path), info.at("samples"), info.at("estimator"));
}

}  // namespace sunbeam
