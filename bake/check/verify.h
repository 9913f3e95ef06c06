// This file holds a table against the live model at random held-out parameters. It says how far off the table
// is and how much of that is noise.
//
// Point k draws its own parameters (uniform over each axis' physical range) and wi (uniform in cosine, theta
// <= 89 degrees; for an anisotropic table also in azimuth) from random stream k. Its error is
//     Int |f_table - f_live| cos_o dwo / max(Int |f_live| cos_o dwo, 0.002),   f = first (non-Dirac) + rest,
// mean over channels of the folded colour, by importance sampling with the table's own density. f_table is
// what renderers call: `eval` of the table bound to the parameters, and beside it `eval` of the textured
// table. The live values are noisy, which biases an L1 error upwards; noise_floor is the same figure with the
// table replaced by a second, independent live run of equal cost. Each point spends as many walks as a pilot
// says a floor of a third of the median tolerance takes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bake/live/estimator.h"
#include "bake/recipe/recipe.h"
#include "sunbeam/detail/table_view.h"
#include "sunbeam/table.h"

namespace sunbeam {

struct VerifySettings {
  int points = 1000;
  std::uint64_t seed = 2024;
  int threads = 0;                    // 0: all
  Estimator truth = Estimator::pfmc;  // exact has no noise, and its floor is 0
  double tolerance_median = 0.01;
  double tolerance_p99 = 0.05;
  std::function<void(double fraction)> on_progress;
};

struct VerifyPoint {
  Parameters parameters;
  double cos_i = 0, phi_i = 0;  // of wi
  double error = 0;             // of TableBsdf, bound to the parameters
  double textured_error = 0;    // of TexturedTable at the parameters
  double rest_error = 0;        // of TableBsdf::rest alone
  double noise_floor = 0;
  double dirac_error = 0;  // |R_table - R|, largest channel
  double albedo = 0;       // of the table, Dirac included, largest channel
  double energy = 0;       // share of the light that the table returns, Dirac included; see energy
  double reciprocity = 0;  // max |f(i,o) - f(o,i)| / max(|f(i,o)|, |f(o,i)|, 0.002/pi)
};

// Returns a quantile of one value or more: the smallest that at least a share q of all values do not exceed.
double quantile(std::vector<double> values, double q);

struct Quantiles {
  double median, p95, p99, max;
};

struct VerifyReport {
  std::vector<VerifyPoint> points;
  Quantiles error, textured_error, rest_error, noise_floor;
  double dirac_error_p99 = 0, energy_max = 0, reciprocity_max = 0;
  // The largest share of the light that the table returns: at most 1 of a passive surface. It is energy_max
  // but for a fold with negative weights, which lets a channel be above 1: there it is the luminance, or the
  // channel as a share of the most that reflectances up to 1 fold to, whichever is larger.
  double energy = 0;
  std::string truth;  // the estimator the table was held against
};

// Returns what a table of this recipe is held against unless told otherwise. These are walks, and where the
// pigment scatters those of the recipe; where the tolerance is finer than walks can show in useful time it is
// the exact evaluator.
Estimator default_truth(const Recipe& recipe);

// Returns settings with the tolerances of the recipe and its default truth; points, seed and threads keep
// their defaults.
VerifySettings verify_settings_of(const Recipe& recipe);

// Measures the error of a table at random points. Throws Error if the recipe in the table cannot be read, or
// naming the key if truth is exact and the material has no exact evaluator.
VerifyReport verify(const TableView& table, const VerifySettings& settings);

// Holds a figure of a report and the most that a good table may have.
struct Limit {
  const char* figure;
  double found, allowed;

  bool holds() const { return found <= allowed; }  // not a number holds nothing
};

// Returns the limits of median, p99 and energy. Median and p99 may be as large as the tolerances. Energy may
// be above 1 by the error that the table states: by error_max, of which one channel may have all, but not by
// more than the tolerance of p99; and by the 0.001 to which albedos are tabulated.
std::vector<Limit> limits(const VerifyReport& report, const VerifySettings& settings);

// Says whether all limits hold.
bool within_tolerance(const VerifyReport& report, const VerifySettings& settings);

// Returns the largest found / allowed of the limits: the smaller, the better the table.
double worst_share(const VerifyReport& report, const VerifySettings& settings);

// Returns "error_p99 0.08 (allowed 0.05)".
std::string to_string(const Limit& limit);

// Lists the limits that do not hold.
std::string missed_limits(const VerifyReport& report, const VerifySettings& settings);

// Returns the figures by their JSON names: error_median, error_p95, ..., points.
std::vector<std::pair<std::string, double>> figures(const VerifyReport& report);

}  // namespace sunbeam
