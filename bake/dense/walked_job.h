// This job makes the dense encoding by random walks: PFMC at every node of (film thickness, base IOR,
// absorption) x directions. A task is one wi of one parameter node, with its own stop rule. A row's random
// numbers are the same at every parameter node, so that noise does not ripple along a slider.
#pragma once

#include "bake/blocks/job.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

// Makes the job, which `recipe` must outlive.
std::unique_ptr<BakeJob> walked_job(const Recipe& recipe, std::uint64_t seed);

}  // namespace sunbeam
