#include "bake/recipe/attributes.h"

#include "bake/base/version.h"

namespace sunbeam {

std::map<std::string, std::string> info_of(const Recipe& recipe, Encoding encoding, std::uint64_t seed,
                                           std::uint64_t walks, const char* estimator) {
  std::map<std::string, std::string> info{{"recipe", recipe.text},        {"recipe_hash", recipe.hash},
                                          {"seed", std::to_string(seed)}, {"samples", std::to_string(walks)},
                                          {"estimator", estimator},       {"tool_version", kToolVersion},
                                          {"encoding", name_of(encoding)}};
  info.merge(recipe.spectrum.attributes());
  return info;
}

}  // namespace sunbeam
