// This job makes the dense encoding of a scattering pigment by adding and doubling
// (live/adding_doubling/slab_films.h). A task is one film thickness at one base IOR, with all absorptions;
// the tasks of a base IOR share what is solved.
#pragma once

#include "bake/blocks/job.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

// Makes the job, which `recipe` must outlive.
std::unique_ptr<BakeJob> solved_job(const Recipe& recipe, std::uint64_t seed);

}  // namespace sunbeam
