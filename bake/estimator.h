// Which evaluator of the live model made a value.
#pragma once

#include <string_view>

namespace sunbeam {

enum class Estimator { pfmc, exact };

// As written in tables and reports.
constexpr const char* name_of(Estimator estimator) {
  return estimator == Estimator::pfmc ? "pfmc-unidirectional" : "exact-quadrature";
}

// From the command line's "pfmc" or "exact".
constexpr Estimator estimator_of(std::string_view option) {
  return option == "exact" ? Estimator::exact : Estimator::pfmc;
}

}  // namespace sunbeam
