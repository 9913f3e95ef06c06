// This file says how the facets visible from a direction are spread over the cosine c' that it makes with
// them. What light does at a facet depends on a film through c' alone, so this is all that a table of a
// layered film has to know of facets (sunbeam/detail/factors.h). Everything is by quadrature over rings
// (bake/live/exact/facet_rings.h).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/live/exact/facet_rings.h"

namespace sunbeam {

// Turns a density over an interval into the share of it that lies on one side, and back.
class ShareOfInterval {
 public:
  // `density` >= 0 is integrated by Simpson's rule in `cells` cells from `low` to `high`, which must hold
  // some of it.
  ShareOfInterval(double low, double high, int cells, const std::function<double(double x)>& density);

  // Returns the x from which up to `high` this share lies, 0 to 1.
  double above(double share) const;

 private:
  double low_, step_;
  std::vector<double> below_, density_;  // at the ends of cells; the first over the whole
};

// Gives the facets visible from one direction.
class VisibleFacets {
 public:
  // `w` is turned to azimuth 0 if the film is isotropic. `ratio` is n0 / n2 if facets bend light, else 1.
  VisibleFacets(const Vec3& w, const Roughness& roughness, double ratio);

  const Vec3& w() const { return w_; }
  const FacetRings& rings() const { return rings_; }

  // Returns the density of the facets over the ring's angle in rad.
  double density(double angle) const;

  // Returns c' at ranks (sunbeam/detail/factors.h).
  std::vector<double> cosines(std::span<const double> ranks) const;

 private:
  Vec3 w_;
  FacetRings rings_;
};

}  // namespace sunbeam
