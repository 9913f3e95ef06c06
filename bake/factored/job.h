// These jobs make the values of the factored encoding (sunbeam/detail/factors.h). That of a single clear film
// takes random walks. It walks the
// legs of legs.h, each weighted with the film's powers at all fringe orders and the pigment's at all optical
// depths. The random numbers are the same at every base IOR, so that noise does not ripple along a slider.
//
// With path "sum" one leg in, one back and one out say all (arrival.h, returned.h); with "product"
// a walk is a chain of them (exchange.h).
#pragma once

#include "bake/blocks/job.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

// Makes the job, which `recipe` must outlive. The table's `noise` is the relative standard error of A A, root
// mean square over all cells.
std::unique_ptr<BakeJob> factored_job(const Recipe& recipe, std::uint64_t seed);

// Makes the same of a layered film. What facets do is by quadrature over their rings (facets/crossing.h,
// facets/returning.h), and only `exchange` is walked.
std::unique_ptr<BakeJob> layered_job(const Recipe& recipe, std::uint64_t seed);

}  // namespace sunbeam
