// This file describes the film by integrals over its facets: quadrature sums up what walks draw at random.
//
// Over a base without azimuth light below the film is known by its polar cosine alone: an anisotropic film
// acts on it by the mean over the azimuth of what comes from below, which is that over all turns of its
// facets. A function of the cosine is known by its values at the nodes of a CosineBasis, so the film is a
// matrix (reflection from below) and vectors (crossings). Powers are per wavelength, three at once.
#pragma once

#include <array>
#include <vector>

#include "bake/live/exact/cosine_basis.h"
#include "bake/live/exact/dense.h"
#include "bake/live/exact/facet_rings.h"
#include "bake/live/exact/film_sides.h"
#include "bake/live/film/facet_turns.h"
#include "bake/live/film/geometry.h"

namespace sunbeam {

// Holds numbers of nodes. The defaults give the errors that docs/theory/live.md states; tests double them.
struct ExactResolution {
  int per_panel = 10;  // of a panel of the cosine basis, at most 24
  int normals = 24;    // facets: polar angle of the normal,
  int cosines = 12;    //         a panel of the direction's cosine with it, at most 24,
  int azimuths = 16;   //         the direction's azimuth about it
  int visible = 28;    // normals visible from one direction: polar, and 3/4 of it a panel of azimuths
                       // (of a layered film: around half a ring of facets, and 3 times it the rings)
};

// Describes a way through the film to the base, whatever the wavelength unless the film is layered.
struct CrossingNode {
  double facet_cosine;  // outside
  double cosine;        // below, as the light arrives at the base
  double share;         // of the power if the film lets all through
  Rgb passing;          // of a layered film: the transmittance, or its part of an integral over rough facets
};

class FilmIntegrals {
 public:
  // Takes three wavelengths.
  FilmIntegrals(const Material& material, const Wavelengths& three, const ExactResolution& resolution);

  const CosineBasis& basis() const { return basis_; }
  // False if facets bend light, so that crossings() is a quadrature over many cosines.
  bool has_single_crossing() const { return !geometry_.has_glossy_crossing(); }

  // Returns the ways of light along w, unless the film is layered for all wavelengths not shorter than those
  // of this object; there are none under total reflection or over an opaque base. p_t(w -> m) dm is share
  // times transmittance() at m.z = cosine.
  std::vector<CrossingNode> crossings(const Vec3& w) const;
  Rgb transmittance(const CrossingNode& crossing) const {
    return film_.is_layered() ? crossing.passing : power(crossing.facet_cosine).transmittance;
  }

  Rgb facet_reflectance(double facet_cosine) const { return power(facet_cosine).reflectance; }
  // Returns the directional albedo of the first surface, a smooth film's Dirac included.
  Rgb first_albedo(const Vec3& w) const;

  // Returns B, one symmetric matrix a wavelength: f^T B g = Int Int f(m.z) m.z f_below(m, m') m'.z g(m'.z) dm
  // dm'.
  std::array<Matrix, 3> reflection() const;

  // Returns t with t^T f = Int (n0/n2)^2 w.z p_t(w -> m) f(m.z) dm dw, the power that leaves the film
  // altogether when the base sends the radiance f up.
  std::array<Vector, 3> exit(const std::array<Matrix, 3>& reflection) const;

 private:
  // Holds one direction on each side of an event at a facet: the cosines of both with the macro normal.
  struct Meeting {
    double cosine, partner;
    Rgb weight;
  };
  enum class Event { reflection_below, crossing };

  static sunbeam::Side side_of(Event event) {
    return event == Event::crossing ? sunbeam::Side::outside : sunbeam::Side::inside;
  }
  // Returns the film's powers for light from outside.
  FilmPower power(double facet_cosine) const { return film_.at(sunbeam::Side::outside, facet_cosine); }
  double phase(sunbeam::Side side, double cosine) const;
  int visible_nodes() const;
  Vec3 turned(const Vec3& w) const;
  FacetRings rings(const Vec3& w) const;
  int oscillation_panels(sunbeam::Side side, double low, double high) const;
  template <class F>
  void visit_oscillations(sunbeam::Side side, double low, double high, F visit) const;
  template <class F>
  void visit_smooth_film(F visit) const;
  std::vector<Rgb> moments(Event event, double low, double high) const;
  template <class F>
  void visit_visible(const Vec3& w, bool only_mirrored, F visit) const;
  template <class F>
  void visit_facets(Event event, F visit) const;
  template <class F>
  void visit_azimuths(Event event, double theta, const std::vector<FacetTurns::Turn>& turns, double cosine,
                      const Rgb& weight, F visit) const;
  double shadowed(Event event, const std::vector<FacetTurns::Turn>& turns, const Vec3& w,
                  const Vec3& partner) const;
  double wider() const { return std::max(material_.roughness.u, material_.roughness.v); }

  Material material_;
  ExactResolution resolution_;
  FilmGeometry geometry_;
  FilmSides film_;
  double index_ratio_;  // n0 / n2 if facets bend light, else 1
  CosineBasis basis_;
  GaussInterpolation cosine_panel_;
  GaussRule fine_, film_panel_, normals_, azimuths_, visible_, visible_azimuths_;
  FacetRings::Rules rings_;
  FacetTurns turns_;
};

}  // namespace sunbeam
