#include "bake/jobs/plan.h"

#include <fmt/format.h>

#include "bake/base/error_floor.h"
#include "bake/dense/solved_job.h"
#include "bake/jobs/bake.h"
#include "sunbeam/detail/text.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {
namespace {

constexpr int kProbes = 5;
constexpr int kViewers = 4, kDirections = 64;
constexpr double kShareOfAnAxis = 0.5;  // of the error allowed: those of several axes add up
constexpr int kMostRounds = 12;         // halvings of an interval
constexpr std::uint64_t kStream = 1000003;

std::string list_of(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + to_text(value);
  return text + "]";
}

Recipe with(const Recipe& recipe, const std::vector<std::string>& overrides) {
  return parse_recipe(recipe.text, recipe.name, overrides);
}

std::string grid_override(const Axis& axis) { return "grid." + axis.name + "=" + list_of(axis.nodes); }

// Middles of intervals in the axis' own coordinate.
std::vector<double> middles(const Axis& axis) {
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < axis.size(); ++k)
    result.push_back(spaced_nodes(axis.nodes[k], axis.nodes[k + 1], 3, axis.power, axis.origin)[1]);
  return result;
}

struct PlannedAxis {
  std::string name;
  std::size_t before, after;  // nodes
  double error;               // largest left in the middle of an interval
  bool limited;               // by size, cost or rounds
};

class Planner {
 public:
  Planner(const Recipe& recipe, const PlanSettings& settings)
      : settings_(settings),
        target_(kShareOfAnAxis * recipe.accuracy.interpolation),
        // The walks of a probe need not be better than what they are to show.
        recipe_(with(recipe, {fmt::format("accuracy.noise={}", std::max(recipe.accuracy.noise, target_))})),
        encoding_(encodings_of(recipe).front()),
        asked_noise_(recipe.accuracy.noise),
        has_noise_(encoding_ == Encoding::dense && !has_solution(recipe)) {
    Rng rng(settings.seed, kStream);
    for (int k = 0; k < kProbes; ++k) {
      std::array<double, 3> probe{};
      for (std::size_t a = 0; a < probe.size(); ++a)
        probe[a] = lerp(rng.uniform(), recipe.grid[a].low(), recipe.grid[a].high());
      probes_.push_back(probe);
    }
    for (int k = 0; k < kViewers; ++k) viewers_.push_back(to_hemisphere(rng));
    for (int k = 0; k < kDirections; ++k) directions_.push_back(to_hemisphere(rng));
  }

  Plan run() {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (recipe_.grid[axis].size() > 1 && !is_continuous(axis)) refine_parameter(axis);
    refine_count("angles", recipe_.table.angles, 1);
    if (recipe_.table.azimuths > 1)
      refine_count("azimuths", recipe_.table.azimuths, recipe_.material.roughness.is_isotropic() ? 1 : 4);
    return {with(recipe_, {fmt::format("accuracy.noise={}", asked_noise_), "accuracy.interpolation=0"}),
            summary_};
  }

 private:
  static Vec3 to_hemisphere(Rng& rng) {
    const double cosine = std::sqrt(lerp(rng.uniform(), 1e-3, 1));
    return direction_from_cosine(cosine, 2 * kPi * rng.uniform());
  }

  // The factored encoding knows fringe orders, whose nodes follow from the range of thicknesses.
  bool is_continuous(std::size_t axis) const { return encoding_ == Encoding::factored && axis == 0; }

  Table bake(const Recipe& recipe) const { return bake(recipe, settings_.seed); }
  Table bake(const Recipe& recipe, std::uint64_t seed) const {
    return bake_table(recipe, encoding_, {seed, settings_.threads, {}});
  }

  // The recipe at a probe, but for one axis.
  Recipe at_probe(const std::array<double, 3>& probe, std::size_t free_axis,
                  std::vector<std::string> overrides) const {
    for (std::size_t a = 0; a < probe.size(); ++a)
      if (a != free_axis)
        overrides.push_back(fmt::format("grid.{}=[{}]", recipe_.grid[a].name, to_text(probe[a])));
    return with(recipe_, overrides);
  }

  // L1 over directions, relative to what the skin reflects: the largest of all viewers.
  double difference(const Table& a, const Table& b, const Parameters& parameters) const {
    const TableBsdf fa(a, parameters, OutsideGrid::clamp), fb(b, parameters, OutsideGrid::clamp);
    double worst = 0;
    for (const Vec3& wo : viewers_) {
      double off = 0, all = 0;
      for (const Vec3& wi : directions_) {
        const Rgb fine = fb.rest(wo, wi);
        off += mean_abs(fa.rest(wo, wi) - fine) / kDirections;
        all += mean_abs(fine) / kDirections;
      }
      all += mean_abs(fb.film_reflectance(wo.z)) * kInvPi;
      worst = std::max(worst, off / std::max(all, kDarkestValue));
    }
    return worst;
  }

  void refine_parameter(std::size_t axis) {
    Axis nodes = recipe_.grid[axis];
    PlannedAxis report{nodes.name, nodes.size(), nodes.size(), 0, false};
    for (int round = 0; round < kMostRounds; ++round) {
      const auto errors = errors_between(axis, nodes);
      report.error = *std::max_element(errors.begin(), errors.end());
      if (settings_.on_step) settings_.on_step(report.name, nodes.size(), report.error);
      if (report.error <= target_) break;
      Axis finer = nodes;
      const auto between = middles(nodes);
      for (std::size_t k = 0; k < errors.size(); ++k)
        if (errors[k] > target_) finer.nodes.push_back(between[k]);
      std::sort(finer.nodes.begin(), finer.nodes.end());
      const Recipe next = with(recipe_, {grid_override(finer)});
      if ((report.limited = breaks_limits(next) || round + 1 == kMostRounds)) break;
      nodes = finer;
      recipe_ = next;
    }
    report.after = nodes.size();
    add(report);
  }

  // In the middle of each interval, the largest of all probes.
  std::vector<double> errors_between(std::size_t axis, const Axis& nodes) const {
    const auto between = middles(nodes);
    Axis finer = nodes;
    finer.nodes.insert(finer.nodes.end(), between.begin(), between.end());
    std::sort(finer.nodes.begin(), finer.nodes.end());
    std::vector<double> errors(between.size());
    for (const auto& probe : probes_) {
      const Table coarse = bake(at_probe(probe, axis, {grid_override(nodes)}));
      const Table fine = bake(at_probe(probe, axis, {grid_override(finer)}));
      for (std::size_t k = 0; k < between.size(); ++k) {
        auto at = probe;
        at[axis] = between[k];
        errors[k] = std::max(errors[k], difference(coarse, fine, {at[0], at[1], at[2]}));
      }
    }
    return errors;
  }

  // Of the key table.NAME. Rows of a table walk their own walks, so what those scatter sets a floor.
  void refine_count(const char* name, int count, int multiple) {
    PlannedAxis report{name, static_cast<std::size_t>(count), 0, 0, false};
    const auto set = [&](int n) { return fmt::format("table.{}={}", name, n); };
    for (int round = 0; round < kMostRounds; ++round) {
      report.error = 0;
      double noise = 0;
      for (const auto& probe : probes_) {
        const Parameters at{probe[0], probe[1], probe[2]};
        const Recipe recipe = at_probe(probe, 3, {set(count)});
        const Table coarse = bake(recipe);
        const Table fine = bake(at_probe(probe, 3, {set(2 * count)}));
        report.error = std::max(report.error, difference(coarse, fine, at));
        if (has_noise_) noise = std::max(noise, difference(coarse, bake(recipe, settings_.seed + 1), at));
      }
      if (settings_.on_step) settings_.on_step(name, static_cast<std::size_t>(count), report.error);
      if (report.error <= std::max(target_, noise)) break;
      const int more = (count + count / 2 + multiple - 1) / multiple * multiple;
      if ((report.limited = more > kMostDirectionNodes / 2 || breaks_limits(with(recipe_, {set(more)}))))
        break;
      count = more;
      recipe_ = with(recipe_, {set(more)});
    }
    report.after = static_cast<std::size_t>(count);
    add(report);
  }

  void add(const PlannedAxis& axis) {
    summary_ += fmt::format("{}{} {} -> {} nodes ({:.2g}{})", summary_.empty() ? "" : ", ", axis.name,
                            axis.before, axis.after, axis.error, axis.limited ? ", limited" : "");
  }

  bool breaks_limits(const Recipe& recipe) const {
    return bytes_of(recipe, encoding_) > recipe.limits.megabytes * 1e6 ||
           cpu_seconds_of(recipe, encoding_, settings_.seed) > recipe.limits.cpu_minutes * 60;
  }

  const PlanSettings& settings_;
  double target_;
  Recipe recipe_;
  Encoding encoding_;
  double asked_noise_;
  bool has_noise_;
  std::vector<std::array<double, 3>> probes_;
  std::vector<Vec3> viewers_, directions_;
  std::string summary_;
};

}  // namespace

Plan plan_bake(const Recipe& recipe, const PlanSettings& settings) {
  if (recipe.accuracy.interpolation == 0) return {recipe, {}};
  return Planner(recipe, settings).run();
}

Recipe preview_of(const Recipe& recipe) {
  constexpr std::array<std::size_t, 3> kMostNodes = {13, 8, 6};
  std::vector<std::string> overrides{"accuracy.interpolation=0", "accuracy.noise=0.005"};
  for (std::size_t a = 0; a < kMostNodes.size(); ++a) {
    Axis axis = recipe.grid[a];
    if (axis.size() <= kMostNodes[a]) continue;
    axis.nodes = spaced_nodes(axis.low(), axis.high(), kMostNodes[a], axis.power, axis.origin);
    overrides.push_back(grid_override(axis));
  }
  overrides.push_back(fmt::format("table.angles={}", std::min(recipe.table.angles, 10)));
  overrides.push_back(fmt::format("table.azimuths={}", std::min(recipe.table.azimuths, 8)));
  return with(recipe, overrides);
}

}  // namespace sunbeam
