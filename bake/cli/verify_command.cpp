#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bake/check/verify.h"
#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/json_text.h"
#include "bake/cli/progress.h"
#include "bake/cli/separate_files.h"
#include "bake/recipe/recipe.h"
#include "bake/report/html_report.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

constexpr std::size_t kWorstPoints = 5;

void print_worst(const VerifyReport& report) {
  auto points = report.points;
  const std::size_t count = std::min(kWorstPoints, points.size());
  std::partial_sort(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), points.end(),
                    [](const auto& a, const auto& b) { return a.error > b.error; });
  out("worst points: film_thickness_nm  base_ior  absorption_per_nm  theta_i_deg  phi_i_deg     error  "
      "noise_floor\n");
  for (std::size_t k = 0; k < count; ++k) {
    const VerifyPoint& p = points[k];
    out("              {:>17.2f} {:>9.4f} {:>18.4f} {:>12.2f} {:>10.2f} {:>9.5f} {:>12.5f}\n",
        p.parameters.film_thickness_nm, p.parameters.base_ior, p.parameters.absorption_per_nm,
        std::acos(p.cos_i) * 180 / kPi, p.phi_i * 180 / kPi, p.error, p.noise_floor);
  }
}

std::string report_json(const VerifyReport& report) {
  nlohmann::ordered_json json;
  for (const auto& [name, value] : figures(report)) json[name] = value;
  json["points"] = report.points.size();
  json["truth"] = report.truth;
  return json_text(json) + "\n";
}

// In single quotes where a shell would read more than a word.
std::string shell_word(const std::string& text) {
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("._-/+,:@%", c); };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string command_of(const VerifyOptions& options) {
  const std::string truth = options.truth.empty() ? "" : " --truth " + options.truth;
  return fmt::format("sunbeam verify {} --points {} --seed {}{} --html {}", shell_word(options.table),
                     options.points, options.seed, truth, shell_word(options.html));
}

void require_html_extension(const std::string& path) {
  if (!path.empty() && extension(path) != ".html")
    throw Error(fmt::format("{}: extension is '{}'; allowed for --html: .html", path, extension(path)));
}

void write_html(const VerifyOptions& options, const Table& table, const Recipe& recipe,
                const VerifySettings& settings, const VerifyReport& report) {
  const std::filesystem::path path = options.table;
  std::error_code no_file;  // but a FIFO
  std::uintmax_t bytes = file_size(path, no_file);
  if (no_file) bytes = table_bytes(table, options.table).size();
  const ReportSource source = {
      table, recipe, settings, report, path.filename().string(), bytes, command_of(options)};
  write_file_atomically(options.html, html_report(source));
}

Estimator truth_of(const VerifyOptions& options, const Recipe& recipe) {
  try {
    return estimator_for_truth(estimator_of(options.truth), recipe.material);
  } catch (const Error& error) {
    throw Error(options.table + ": " + error.what());
  }
}

}  // namespace

int run_verify(const VerifyOptions& options) {
  require_html_extension(options.html);
  require_separate({options.table}, {options.json, options.html});
  const Table table = load_table(options.table);
  const Recipe recipe = parse_stored_recipe(table.info.at("recipe"), options.table + ": recipe");
  for (const std::string& path : {options.json, options.html})
    if (!path.empty()) require_writable(path);
  VerifySettings settings = verify_settings_of(recipe);
  settings.points = options.points;
  settings.seed = options.seed;
  settings.threads = options.threads;
  if (!options.truth.empty()) settings.truth = truth_of(options, recipe);
  settings.on_progress = Progress("verify", "points", options.points);
  const VerifyReport report = verify(table, settings);

  out("truth                   {}\n", report.truth);
  for (const auto& [name, value] : figures(report)) out("{:<24}{:.6g}\n", name, value);
  print_worst(report);
  if (!options.json.empty()) write_file_atomically(options.json, report_json(report));
  if (!options.html.empty()) write_html(options, table, recipe, settings, report);

  const bool passed = within_tolerance(report, settings);
  std::vector<std::string> verdicts;
  for (const Limit& limit : limits(report, settings)) verdicts.push_back(to_string(limit));
  out("{}: {}\n", passed ? "PASS" : "FAIL", fmt::join(verdicts, ", "));
  return passed ? 0 : 1;
}

}  // namespace sunbeam
