#include "bake/check/verify.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>

#include "bake/base/parallel_tasks.h"
#include "bake/base/running_mean.h"
#include "bake/live/adding_doubling/slab_solver.h"
#include "bake/live/exact/exact.h"
#include "bake/live/pfmc.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"

namespace sunbeam {
namespace {

constexpr std::size_t kDirections = 64;  // wo a point
constexpr int kMostAttempts = 4096;      // to draw them
constexpr int kFirstPilot = 16;  // estimates that tell how many a live run needs; doubled until it can
constexpr int kPilotReach = 8;   // times as many
constexpr int kBatches = 16;
constexpr double kMostEstimates = 1 << 14;  // of a live run at a median tolerance of 1 %
constexpr double kFloorMargin = 0.85;       // of the floor promised is aimed at

constexpr double kAlbedoPrecision = 1e-3;  // of those that a table tabulates

double draw(const Axis& axis, Rng& rng) { return lerp(rng.uniform(), axis.low(), axis.high()); }

// Directions drawn from the table's own density for the viewer at wi (reciprocity makes the roles equal).
struct Directions {
  std::vector<Vec3> wo;
  std::vector<double> weight;  // cos / (pdf attempts)
};

Directions draw_directions(const TableBsdf& bsdf, const Vec3& wi, Rng& rng) {
  Directions result;
  int attempts = 0;
  // Dirac and lost draws count as attempts; they carry nothing of the non-Dirac integral.
  for (; attempts < kMostAttempts && result.wo.size() < kDirections; ++attempts) {
    const auto sample = bsdf.sample(wi, rng);
    if (!sample || sample->is_dirac) continue;
    result.wo.push_back(sample->wi);
    result.weight.push_back(sample->wi.z / bsdf.mis_pdf(wi, sample->wi));
  }
  for (double& weight : result.weight) weight /= attempts;
  return result;
}

// Rest at every direction by live walks, and the mean |difference| to expect from a second such run.
struct WalkedRest {
  std::vector<Rgb> value, expected_difference;
};

// Batches of walks tell the noise of their mean; for a normal one of variance v, E |difference| = 2 sqrt(v /
// pi).
WalkedRest walk_rest(const Pfmc& model, Technique technique, const Vec3& wi, const std::vector<Vec3>& wo,
                     int estimates, Rng& rng) {
  const int batch_estimates = estimates / kBatches;
  std::vector<RunningMean> cells(wo.size());
  for (int batch = 0; batch < kBatches; ++batch) {
    std::vector<Rgb> sums(wo.size());
    for (int k = 0; k < batch_estimates; ++k) model.add_rest(wi, wo, rng, sums, technique);
    for (std::size_t k = 0; k < wo.size(); ++k) cells[k].add(sums[k] / batch_estimates);
  }
  WalkedRest rest;
  for (const RunningMean& cell : cells) {
    rest.value.push_back(cell.mean_of(kBatches));
    rest.expected_difference.push_back(cell.standard_error(kBatches) * (2 / std::sqrt(kPi)));
  }
  return rest;
}

// VerifyPoint::energy. Weights of a fold may be negative, so that a channel of a passive surface may be above
// 1; luminance may not.
double energy_of(const Rgb& albedo, const Wavelengths& wavelengths, ColorSpace space) {
  Rgb most;
  for (const Rgb& weight : wavelengths.weight)
    most += transform(weight, [](double w) { return std::max(w, 0.0); });
  return std::max(max_component(albedo / most), luminance(albedo, space));
}

// What is prepared of table and live model at one parameter point.
struct Prepared {
  // What a table states of itself must not depend on the processor.
  Prepared(const Table& table, const Parameters& parameters, const Spectrum& spectrum, Estimator truth)
      : bsdf(table, parameters, {.arithmetic = Arithmetic::reproducible}),
        wavelengths(spectrum.wavelengths(bsdf.material())),
        model(bsdf.material(), wavelengths) {
    if (truth == Estimator::exact && !bsdf.material().scatters()) exact.emplace(bsdf.material(), wavelengths);
  }

  TableBsdf bsdf;
  Wavelengths wavelengths;
  Pfmc model;
  std::optional<ExactRest> exact;
};

// What all points of a table share.
struct SharedChecks {
  SharedChecks(const TableView& table, const VerifySettings& settings)
      : table(table),
        settings(settings),
        spectrum(parse_stored_recipe(table.head().info.at("recipe"), "recipe of the table").spectrum) {
    if (!table.is_in_memory()) return;
    textured.emplace(table.head(), BindOptions{.arithmetic = Arithmetic::reproducible});
    for (std::size_t k = 0; k < kParameterNames.size(); ++k)
      if (table.parameter_axis(k).size() > 1) return;
    prepared =
        std::make_shared<Prepared>(table.head(),
                                   Parameters{table.parameter_axis(0).low(), table.parameter_axis(1).low(),
                                              table.parameter_axis(2).low()},
                                   spectrum, settings.truth);
  }

  const TableView& table;
  const VerifySettings& settings;
  Spectrum spectrum;
  std::optional<TexturedTable> textured;     // of a table in memory
  std::shared_ptr<const Prepared> prepared;  // of one that holds a single parameter point
};

class PointCheck {
 public:
  PointCheck(const SharedChecks& shared, std::uint64_t index)
      : settings_(shared.settings),
        rng_(shared.settings.seed, index),
        color_space_(shared.spectrum.color_space()),
        textured_(shared.textured),
        prepared_(shared.prepared) {
    const TableView& table = shared.table;
    point_.parameters = {draw(table.parameter_axis(0), rng_), draw(table.parameter_axis(1), rng_),
                         draw(table.parameter_axis(2), rng_)};
    point_.cos_i = lerp(rng_.uniform(), std::cos(89 * kPi / 180), 1);
    if (table.head().symmetry == Symmetry::anisotropic) point_.phi_i = 2 * kPi * rng_.uniform();
    wi_ = direction_from_cosine(point_.cos_i, point_.phi_i);
    std::optional<Table> room;
    if (!prepared_) prepare(table.around(point_.parameters, room), shared.spectrum);
  }

  VerifyPoint run() {
    directions_ = draw_directions(bsdf(), wi_, rng_);
    measure_errors(settings_.truth == Estimator::exact ? exact_rest() : walked_rest());
    point_.dirac_error =
        max_component(transform(bsdf().film_reflectance(wi_.z) - prepared_->model.film_reflectance(wi_.z),
                                [](double x) { return std::abs(x); }));
    const Rgb albedo = bsdf().albedo(wi_);
    point_.albedo = max_component(albedo);
    point_.energy = energy_of(albedo, prepared_->wavelengths, color_space_);
    return point_;
  }

 private:
  void prepare(const Table& table, const Spectrum& spectrum) {
    prepared_ = std::make_shared<Prepared>(table, point_.parameters, spectrum, settings_.truth);
    if (!textured_) textured_.emplace(table, BindOptions{.arithmetic = Arithmetic::reproducible});
  }
  const TableBsdf& bsdf() const { return prepared_->bsdf; }

  // The number of walks follows the floor that a pilot expects, not that of the runs themselves: stopping at
  // runs that happen to agree would report one that is too low.
  std::vector<Rgb> walked_rest() {
    const int estimates = estimates_needed();
    const auto walk = [&](int count) {
      return walk_rest(prepared_->model, technique_of(settings_.truth), wi_, directions_.wo, count, rng_);
    };
    const std::vector<Rgb> live = walk(estimates).value;
    auto difference = walk(estimates).value;
    for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = live[k] - difference[k];
    point_.noise_floor = weighted(difference) / denominator(live);
    return live;
  }

  int estimates_needed() {
    const double most = kMostEstimates * square(0.01 / settings_.tolerance_median);
    for (int pilot = kFirstPilot;; pilot *= 2) {
      const WalkedRest rest =
          walk_rest(prepared_->model, technique_of(settings_.truth), wi_, directions_.wo, pilot, rng_);
      const double floor = weighted(rest.expected_difference) / denominator(rest.value);
      const double needed = pilot * square(floor / (kFloorMargin * settings_.tolerance_median / 3));
      const double reach = std::min<double>(kPilotReach * pilot, most);
      if (needed <= reach || reach == most)
        return kBatches * static_cast<int>(std::ceil(std::clamp(needed, 1.0, most) / kBatches));
    }
  }

  std::vector<Rgb> exact_rest() const {
    if (!prepared_->exact) return solved_rest();
    return prepared_->exact->rest(directions_.wo, wi_);
  }

  std::vector<Rgb> solved_rest() const {
    std::vector<double> cosines{wi_.z};
    for (const Vec3& wo : directions_.wo) cosines.push_back(wo.z);
    SlabSolver solver(bsdf().material(), cosines);
    const double depth = bsdf().material().optical_depth();
    for (const double relative : prepared_->wavelengths.absorption) solver.add_depth(depth * relative);
    const auto rest =
        SlabSolver::Film(solver, point_.parameters.film_thickness_nm, prepared_->wavelengths).rest(depth);
    std::vector<Rgb> live;
    for (std::size_t k = 0; k < directions_.wo.size(); ++k)
      live.push_back(rest.at(k + 1, 0, azimuth(directions_.wo[k]) - point_.phi_i));
    return live;
  }

  // Int |value| cos dwo.
  double weighted(const std::vector<Rgb>& values) const {
    double total = 0;
    for (std::size_t k = 0; k < values.size(); ++k) total += directions_.weight[k] * mean_abs(values[k]);
    return total;
  }

  double denominator(const std::vector<Rgb>& live) const {
    double total = 0;
    for (std::size_t k = 0; k < live.size(); ++k)
      total += directions_.weight[k] * mean_abs(prepared_->model.first(directions_.wo[k], wi_) + live[k]);
    return std::max(total, kDarkestAlbedo);
  }

  void measure_errors(const std::vector<Rgb>& live) {
    const TexturedTable::At textured = textured_->at(point_.parameters);
    double bound_sum = 0, textured_sum = 0, rest = 0, rest_total = 0;
    for (std::size_t k = 0; k < live.size(); ++k) {
      const Vec3& wo = directions_.wo[k];
      const double weight = directions_.weight[k];
      const Rgb f = prepared_->model.first(wo, wi_) + live[k];
      bound_sum += weight * mean_abs(bsdf().eval_pdf(wo, wi_).f - f);
      textured_sum += weight * mean_abs(textured.eval_pdf(wo, wi_).f - f);
      rest += weight * mean_abs(bsdf().rest(wo, wi_) - live[k]);
      rest_total += weight * mean_abs(live[k]);
      check_reciprocity(wo);
    }
    point_.error = bound_sum / denominator(live);
    point_.textured_error = textured_sum / denominator(live);
    point_.rest_error = rest / std::max(rest_total, kDarkestAlbedo);
  }

  void check_reciprocity(const Vec3& wo) {
    const Rgb forward = bsdf().eval(wo, wi_, rng_), backward = bsdf().eval(wi_, wo, rng_);
    for (int c = 0; c < 3; ++c) {
      const double scale = std::max({std::abs(forward[c]), std::abs(backward[c]), kDarkestValue});
      point_.reciprocity = std::max(point_.reciprocity, std::abs(forward[c] - backward[c]) / scale);
    }
  }

  const VerifySettings& settings_;
  Rng rng_;
  ColorSpace color_space_;
  VerifyPoint point_;
  Vec3 wi_;
  std::optional<TexturedTable> textured_;
  std::shared_ptr<const Prepared> prepared_;
  Directions directions_;
};

template <class Member>
Quantiles quantiles(const std::vector<VerifyPoint>& points, Member member) {
  std::vector<double> values;
  for (const auto& point : points) values.push_back(point.*member);
  return {quantile(values, 0.5), quantile(values, 0.95), quantile(values, 0.99), quantile(values, 1)};
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Estimator default_truth(const Recipe& recipe) {
  constexpr double kFinestByWalks = 0.005;  // finer, PFMC would take hours to show
  if ((ExactRest::is_valid_for(recipe.material) || SlabSolver::solves(recipe.material)) &&
      recipe.accuracy.tolerance_median < kFinestByWalks)
    return Estimator::exact;
  return recipe.material.scatters() ? recipe.accuracy.estimator : Estimator::pfmc;
}

VerifySettings verify_settings_of(const Recipe& recipe) {
  VerifySettings settings;
  settings.truth = default_truth(recipe);
  settings.tolerance_median = recipe.accuracy.tolerance_median;
  settings.tolerance_p99 = recipe.accuracy.tolerance_p99;
  return settings;
}

VerifyReport verify(const TableView& table, const VerifySettings& settings) {
  estimator_for_truth(settings.truth, table.head().material);  // throws if it has none
  const SharedChecks shared(table, settings);
  VerifyReport report;
  report.truth = name_of(settings.truth);
  report.points.resize(static_cast<std::size_t>(settings.points));
  run_parallel_tasks(report.points.size(), settings.threads, settings.on_progress,
                     [&](std::size_t k) { report.points[k] = PointCheck(shared, k).run(); });
  report.error = quantiles(report.points, &VerifyPoint::error);
  report.textured_error = quantiles(report.points, &VerifyPoint::textured_error);
  report.rest_error = quantiles(report.points, &VerifyPoint::rest_error);
  report.noise_floor = quantiles(report.points, &VerifyPoint::noise_floor);
  report.dirac_error_p99 = quantiles(report.points, &VerifyPoint::dirac_error).p99;
  report.energy_max = quantiles(report.points, &VerifyPoint::albedo).max;
  report.energy = quantiles(report.points, &VerifyPoint::energy).max;
  report.reciprocity_max = quantiles(report.points, &VerifyPoint::reciprocity).max;
  return report;
}

std::vector<Limit> limits(const VerifyReport& report, const VerifySettings& settings) {
  constexpr double kChannels = 3;  // the error is their mean
  const double stated = std::min(kChannels * report.error.max, settings.tolerance_p99);
  return {{"error_median", report.error.median, settings.tolerance_median},
          {"error_p99", report.error.p99, settings.tolerance_p99},
          {"energy", report.energy, 1 + std::max(stated, kAlbedoPrecision)}};
}

bool within_tolerance(const VerifyReport& report, const VerifySettings& settings) {
  const auto all = limits(report, settings);
  return std::all_of(all.begin(), all.end(), [](const Limit& limit) { return limit.holds(); });
}

double worst_share(const VerifyReport& report, const VerifySettings& settings) {
  double worst = 0;
  for (const Limit& limit : limits(report, settings)) {
    if (std::isnan(limit.found)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, limit.found / limit.allowed);
  }
  return worst;
}

std::string to_string(const Limit& limit) {
  return fmt::format("{} {:.4g} (allowed {:g})", limit.figure, limit.found, limit.allowed);
}

std::string missed_limits(const VerifyReport& report, const VerifySettings& settings) {
  std::vector<std::string> missed;
  for (const Limit& limit : limits(report, settings))
    if (!limit.holds()) missed.push_back(to_string(limit));
  return fmt::format("{}", fmt::join(missed, ", "));
}

std::vector<std::pair<std::string, double>> figures(const VerifyReport& report) {
  return {{"error_median", report.error.median},
          {"error_p95", report.error.p95},
          {"error_p99", report.error.p99},
          {"error_max", report.error.max},
          {"error_textured_median", report.textured_error.median},
          {"error_textured_p95", report.textured_error.p95},
          {"error_textured_p99", report.textured_error.p99},
          {"error_textured_max", report.textured_error.max},
          {"rest_error_median", report.rest_error.median},
          {"rest_error_p99", report.rest_error.p99},
          {"noise_floor", report.noise_floor.median},
          {"noise_floor_p99", report.noise_floor.p99},
          {"dirac_error_p99", report.dirac_error_p99},
          {"energy_max", report.energy_max},
          {"reciprocity_max", report.reciprocity_max},
          {"points", static_cast<double>(report.points.size())}};
}

}  // namespace sunbeam
