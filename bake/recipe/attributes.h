// This file makes the attributes by which a table describes the bake that made it.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "bake/recipe/recipe.h"

namespace sunbeam {

// Returns the attributes of a table but for its measured error.
std::map<std::string, std::string> info_of(const Recipe& recipe, Encoding encoding, std::uint64_t seed,
                                           std::uint64_t walks, const char* estimator);

}  // namespace sunbeam
