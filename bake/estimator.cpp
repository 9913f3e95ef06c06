#include "bake/estimator.h"

#include <fmt/format.h>

#include "bake/live/exact_bsdf.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// What stands against ExactBsdf, as "key 'K': found V; ...allows W".
std::string obstacle(const Material& material) {
  if (material.absorption_path != AbsorptionPath::sum)
    return fmt::format("key 'absorption_path': found {}; the exact evaluator of a renderer allows {}",
                       to_string(material.absorption_path), to_string(AbsorptionPath::sum));
  return fmt::format(
      "key 'film_thickness_nm': found {:g}; the exact evaluator of a renderer allows 0 to {:g} for a rough "
      "film",
      material.film_thickness_nm, ExactBsdf::kThickestRoughNm);
}

}  // namespace

EstimatorChoice automatic_for_eval(const Material&) {
  return {Estimator::exact, "without a scattering layer the rest is known by quadrature, without noise"};
}

EstimatorChoice automatic_for_render(const Material& material) {
  if (!ExactBsdf::is_valid_for(material)) return {Estimator::pfmc, obstacle(material)};
  return {Estimator::exact, "absorption_path = sum makes the rest a product of functions of one cosine"};
}

Estimator estimator_for_render(Estimator wanted, const Material& material) {
  if (wanted == Estimator::automatic) return automatic_for_render(material).estimator;
  if (wanted == Estimator::exact && !ExactBsdf::is_valid_for(material)) throw Error(obstacle(material));
  return wanted;
}

}  // namespace sunbeam
