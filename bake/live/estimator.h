// This file names the evaluator of the live model that made a value, and says which one `--estimator auto`
// takes.
#pragma once

#include <string>
#include <string_view>

#include "bake/live/pfmc.h"
#include "sunbeam/material.h"

namespace sunbeam {

// Names an evaluator. pfmc is the unidirectional one; exact is ExactRest where single values are asked for,
// ExactBsdf where a renderer asks.
enum class Estimator { automatic, pfmc, bidirectional, exact };

// Returns the name that tables and reports use.
constexpr const char* name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::automatic:
      return "auto";
    case Estimator::pfmc:
      return "pfmc-unidirectional";
    case Estimator::bidirectional:
      return "pfmc-bidirectional";
    case Estimator::exact:
      return "exact-quadrature";
  }
  return "";
}

// Reads the command line's "auto", "pfmc", "bidirectional" or "exact".
constexpr Estimator estimator_of(std::string_view option) {
  if (option == "auto") return Estimator::automatic;
  if (option == "bidirectional") return Estimator::bidirectional;
  return option == "exact" ? Estimator::exact : Estimator::pfmc;
}

constexpr Technique technique_of(Estimator estimator) {
  return estimator == Estimator::bidirectional ? Technique::bidirectional : Technique::unidirectional;
}

struct EstimatorChoice {
  Estimator estimator;  // never automatic
  std::string reason;   // why auto takes it; one line
};

// Returns the choice for single values.
EstimatorChoice automatic_for_eval(const Material& material);
// Returns the choice for a renderer, which needs thousands of values a millisecond.
EstimatorChoice automatic_for_render(const Material& material);

// These return what `wanted` stands for. All throw Error naming the key and what is allowed if it is exact
// and the material has no (fast) exact evaluator.
Estimator estimator_for_eval(Estimator wanted, const Material& material);
Estimator estimator_for_render(Estimator wanted, const Material& material);
// Returns the estimator that a table's errors are measured with. exact is allowed also where adding and
// doubling solve the material (live/adding_doubling/slab_solver.h).
Estimator estimator_for_truth(Estimator wanted, const Material& material);

}  // namespace sunbeam
