#include "bake/live/estimator.h"

#include <fmt/format.h>

#include "bake/live/adding_doubling/slab_solver.h"
#include "bake/live/exact/exact_bsdf.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// What stands against quadrature, as "key 'K': found V; ...allows W"; empty if nothing does.
std::string obstacle_to_quadrature(const Material& material) {
  if (material.scatters())
    return fmt::format("key 'scattering_per_nm': found {:g}; the exact evaluator allows 0",
                       material.scattering_per_nm);
  if (material.has_multiple_facets())
    return "key 'microfacet': found multiple; the exact evaluator allows single";
  return "";
}

// The same against ExactBsdf.
std::string obstacle(const Material& material) {
  if (const std::string reason = obstacle_to_quadrature(material); !reason.empty()) return reason;
  if (material.absorption_path != AbsorptionPath::sum)
    return fmt::format("key 'absorption_path': found {}; the exact evaluator of a renderer allows {}",
                       to_string(material.absorption_path), to_string(AbsorptionPath::sum));
  if (!material.roughness.is_isotropic())
    return fmt::format(
        "key 'roughness': found {}; the exact evaluator of a renderer allows an isotropic film",
        to_string(material.roughness));
  return fmt::format(
      "key 'film_thickness_nm': found {:g}; the exact evaluator of a renderer allows 0 to {:g} for a rough "
      "film",
      material.film_thickness_nm, ExactBsdf::kThickestRoughNm);
}

}  // namespace

EstimatorChoice automatic_for_eval(const Material& material) {
  if (const std::string reason = obstacle_to_quadrature(material); !reason.empty())
    return {material.scatters() ? Estimator::bidirectional : Estimator::pfmc, reason};
  return {Estimator::exact, "the rest is known by quadrature, without noise"};
}

EstimatorChoice automatic_for_render(const Material& material) {
  if (!ExactBsdf::is_valid_for(material))
    return {material.scatters() ? Estimator::bidirectional : Estimator::pfmc, obstacle(material)};
  return {Estimator::exact, "absorption_path = sum makes the rest a product of functions of one cosine"};
}

Estimator estimator_for_eval(Estimator wanted, const Material& material) {
  if (wanted == Estimator::automatic) return automatic_for_eval(material).estimator;
  if (wanted == Estimator::exact)
    if (const std::string reason = obstacle_to_quadrature(material); !reason.empty()) throw Error(reason);
  return wanted;
}

Estimator estimator_for_render(Estimator wanted, const Material& material) {
  if (wanted == Estimator::automatic) return automatic_for_render(material).estimator;
  if (wanted == Estimator::exact && !ExactBsdf::is_valid_for(material)) throw Error(obstacle(material));
  return wanted;
}

Estimator estimator_for_truth(Estimator wanted, const Material& material) {
  if (wanted == Estimator::exact && SlabSolver::solves(material)) return wanted;
  return estimator_for_eval(wanted, material);
}

}  // namespace sunbeam
