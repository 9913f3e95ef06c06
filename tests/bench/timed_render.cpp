#include "tests/bench/timed_render.h"

#include "runtime/tracer/camera.h"
#include "runtime/tracer/flush_denormals.h"
#include "tests/bench/account.h"

namespace sunbeam {
namespace {

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

Run run_of(const RenderResult& result, int spp) {
  const RenderStats& stats = result.stats;
  return {.seconds = stats.cpu_seconds - stats.build_cpu_seconds,
          .paths = static_cast<double>(stats.samples),
          .rays = static_cast<double>(stats.rays),
          .vertices = static_cast<double>(stats.vertices),
          .mean = mean_of(result.mean.rgb),
          .variance = spp * mean_of(result.variance.rgb)};
}

}  // namespace

std::string scene_path(const std::string& name) {
  return std::string(SUNBEAM_SOURCE_DIR) + "/tables/scenes/" + name + ".toml";
}

Prepared::Prepared(const std::string& name, const std::string& mode, const Effort& effort,
                   Estimator estimator, const std::function<void(Scene&)>& change)
    : effort_(effort), scene_(load_scene(scene_path(name))) {
  if (change) change(scene_);
  materials_.emplace(scene_, scene_path(name), mode, estimator);
}

Run Prepared::render_with(int round, bool first_hits) const {
  return run_of(render(scene_, materials_->bsdfs(),
                       {.width = effort_.width,
                        .height = effort_.height,
                        .spp = effort_.spp,
                        .threads = 1,
                        .seed = static_cast<std::uint64_t>(round),
                        .first_hits = first_hits}),
                effort_.spp);
}

Run trace_bare(const EmbreeCeiling& ceiling, const Scene& scene, const Effort& effort, int round) {
  const FlushDenormals flush;
  const Camera camera(scene.camera, effort.width, effort.height);
  Rng rng(static_cast<std::uint64_t>(round), 0);
  EmbreeCeiling::Counts counts;
  const double start = thread_seconds();
  for (int y = 0; y < effort.height; ++y)
    for (int x = 0; x < effort.width; ++x)
      for (int k = 0; k < effort.spp; ++k) {
        const double dx = rng.uniform(), dy = rng.uniform();
        ceiling.trace(camera.ray(x + dx, y + dy, {}).direction, rng, counts);
      }
  Run run{.seconds = thread_seconds() - start, .rays = static_cast<double>(counts.rays)};
  run.paths = static_cast<double>(effort.width) * effort.height * effort.spp;
  run.mean = counts.radiance / run.paths;
  return run;
}

std::vector<Runs> in_turns(int rounds, const std::vector<Variant>& variants) {
  std::vector<Runs> all(variants.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < variants.size(); ++i) all[i].push_back(variants[i](round));
  return all;
}

double rays_per_path(const Run& run) { return run.rays / run.paths; }
double vertices_per_path(const Run& run) { return run.vertices / run.paths; }
double mean_radiance(const Run& run) { return run.mean; }
double path_seconds(const Run& run) { return run.seconds / run.paths; }
double vertex_seconds(const Run& run) { return run.seconds / run.vertices; }

double mean_of(const Runs& runs, Value value) {
  double sum = 0;
  for (const Run& run : runs) sum += value(run);
  return sum / static_cast<double>(runs.size());
}

double best_ns(const Runs& runs, Value seconds) {
  double best = seconds(runs[0]);
  for (const Run& run : runs) best = std::min(best, seconds(run));
  return 1e9 * best;
}

double ratio(const Runs& runs, const Runs& reference, Value value) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < runs.size(); ++i) ratios.push_back(value(runs[i]) / value(reference[i]));
  return median(ratios);
}

double relative_variance(const Runs& runs) {
  return mean_of(runs, [](const Run& run) { return run.variance; }) / square(mean_of(runs, mean_radiance));
}

}  // namespace sunbeam
