// Makes the array `returned` of a factored table, which sunbeam/detail/factors.h stores and
// runtime/src/fit/wave_field.h looks up: light that leaves the base and is sent back to it by the film. The
// legs it walks are those that exchange.h makes chains of.
#pragma once

#include "bake/blocks/job.h"
#include "bake/factored/legs.h"
#include "bake/factored/shared_inputs.h"

namespace sunbeam {

// Returns how many strata over the base's cosine the recipe's accuracy.noise asks for. The walks that this
// took and the noise go to `summary`.
std::size_t strata_of_returns(const SharedInputs& bake, const LegFilm& film, const FilmLegs& legs,
                              BlockSummary& summary);

// Calls visit(leg, what the film reflects at each of `orders`) for the returns of all replicates.
template <class Visit>
void visit_returns(const SharedInputs& bake, const LegFilm& film, const Axis& orders, BlockSummary& summary,
                   Visit visit) {
  const FilmLegs legs(film.material);
  FringePowers powers = film.powers(Side::inside, orders);
  const std::size_t up = strata_of_returns(bake, film, legs, summary);
  for (std::size_t r = 0; r < kReplicates; ++r)
    legs.visit_returns(up, bake.rng_of_returns(r), [&](Leg leg) {
      powers.at(leg.facet_cosine);
      leg.weight /= kReplicates;
      visit(leg, powers.reflectance);
      ++summary.walks;
    });
}

// Makes the values at one base IOR, at (depth, order).
Block walk_returned(const SharedInputs& bake, std::size_t ior);

// Puts the values of such a block into `array`.
void add_returned(std::size_t ior, const std::string& bytes, NdArray& array);

}  // namespace sunbeam
