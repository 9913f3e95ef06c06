// Renders timed by the CPU clock of one thread, variants in turns, so that their ratios hold on a busy
// machine.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bake/scene/materials.h"
#include "runtime/tracer/render.h"
#include "tests/bench/embree_ceiling.h"

namespace sunbeam {

struct Effort {
  int width = 640, height = 360, rounds = 5, spp = 4;
  std::vector<std::string> baking = {};  // overrides
};

std::string scene_path(const std::string& name);

struct Run {
  double seconds = 0;  // of the thread, without building
  double paths = 0, rays = 0, vertices = 0;
  double mean = 0;      // of all pixels and channels
  double variance = 0;  // of one sample, mean over pixels and channels
};

// A scene of tables/scenes/ with its materials, ready to be rendered by one thread.
class Prepared {
 public:
  Prepared(const std::string& name, const std::string& mode, const Effort& effort,
           Estimator estimator = Estimator::automatic, const std::function<void(Scene&)>& change = {});
  Scene& scene() { return scene_; }
  Run operator()(int round) const { return render_with(round, false); }
  Run render_with(int round, bool first_hits) const;

 private:
  Effort effort_;
  Scene scene_;
  std::optional<SceneMaterials> materials_;
};

// The rays of `scene` and nothing else.
Run trace_bare(const EmbreeCeiling& ceiling, const Scene& scene, const Effort& effort, int round);

using Runs = std::vector<Run>;  // a round each
using Variant = std::function<Run(int round)>;
std::vector<Runs> in_turns(int rounds, const std::vector<Variant>& variants);

using Value = double (*)(const Run&);
double rays_per_path(const Run& run);
double vertices_per_path(const Run& run);
double mean_radiance(const Run& run);
double path_seconds(const Run& run);
double vertex_seconds(const Run& run);

double mean_of(const Runs& runs, Value value);
double best_ns(const Runs& runs, Value seconds);
// Of `runs` over `reference`, the median over rounds.
double ratio(const Runs& runs, const Runs& reference, Value value);
// Variance of a sample over the square of the picture's brightness.
double relative_variance(const Runs& runs);

}  // namespace sunbeam
