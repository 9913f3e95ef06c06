// Which evaluator of the live model made a value, and which one `--estimator auto` takes.
#pragma once

#include <string>
#include <string_view>

#include "sunbeam/material.h"

namespace sunbeam {

// exact: ExactRest where single values are asked for, ExactBsdf where a renderer asks.
enum class Estimator { automatic, pfmc, exact };

// As written in tables and reports.
constexpr const char* name_of(Estimator estimator) {
  if (estimator == Estimator::automatic) return "auto";
  return estimator == Estimator::pfmc ? "pfmc-unidirectional" : "exact-quadrature";
}

// From the command line's "auto", "pfmc" or "exact".
constexpr Estimator estimator_of(std::string_view option) {
  if (option == "auto") return Estimator::automatic;
  return option == "exact" ? Estimator::exact : Estimator::pfmc;
}

struct EstimatorChoice {
  Estimator estimator;  // never automatic
  std::string reason;   // why auto takes it; one line
};

// For single values.
EstimatorChoice automatic_for_eval(const Material& material);
// For a renderer, which needs thousands of values a millisecond.
EstimatorChoice automatic_for_render(const Material& material);

// What `wanted` stands for in a renderer. Throws Error naming the key and what is allowed if it is exact and
// the material has no fast exact evaluator.
Estimator estimator_for_render(Estimator wanted, const Material& material);

}  // namespace sunbeam
