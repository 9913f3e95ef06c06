// Guides the unidirectional light below the film to the exits. A peaked phase function makes an exit see a
// walk only where the walk travels about along it, and chance seldom leads there.
//
// Every event therefore splits the walk: one half goes on as the phase function or the base has it, the other
// along an exit with the phase function's spread about it. The balance heuristic weighs both: by the density
// that is wanted over the sum of the two that draw, so no weight exceeds one. Most halves that are guided
// carry next to nothing, but an exit sees much of the few that carry some: worth() tells roulette.
#pragma once

#include "bake/live/general/facets_part.h"

namespace sunbeam::walk {

class ExitGuide {
 public:
  // The directions of the exits that are open must outlive this.
  ExitGuide(const Slab& slab, const ExitPath* exits, int count) : slab_(slab), exits_(exits), count_(count) {
    if (std::abs(slab.g) < kLeastPeak) return;
    for (int k = 0; k < count; ++k) open_ += exits[k].is_open;
  }

  // Returns whether events split the walk.
  bool is_on() const { return open_ > 0; }

  // Draws a travel about an exit.
  Vec3 sample(Rng& rng) const {
    int left = std::min(static_cast<int>(rng.uniform() * open_), open_ - 1), k = 0;
    while (!exits_[k].is_open || left-- > 0) ++k;
    return slab_.sample_phase(exits_[k].up, rng);
  }

  // Returns the density of sample() at a travel, 1/sr.
  double density(const Vec3& travel) const {
    double sum = 0;
    for (int k = 0; k < count_; ++k)
      if (exits_[k].is_open) sum += slab_.phase(dot(travel, exits_[k].up));
    return sum / open_;
  }

  // Returns how much more the exits see of light with this travel than of light without any preferred one; at
  // least 1.
  double worth(const Vec3& travel) const { return is_on() ? std::max(1.0, 4 * kPi * density(travel)) : 1; }

 private:
  static constexpr double kLeastPeak = 0.7;  // |g|; a lower peak is met by chance

  const Slab& slab_;
  const ExitPath* exits_;
  int count_, open_ = 0;
};

}  // namespace sunbeam::walk
