// This is what a factored table says of each wavelength of a layered film at one film thickness and base IOR,
// in the symbols of sunbeam/detail/factors.h: the film's powers in closed form, and A and `returned` by
// quadrature over the facets, whose arrays bake/factored/facets/crossing.h and returning.h make.
#pragma once

#include <span>
#include <vector>

#include "sunbeam/detail/film_curves.h"
#include "sunbeam/detail/quadrature.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

class LayeredWaves {
 public:
  // `material` is that of the table with the film thickness and the base IOR of the point, which lie in the
  // grid. Its absorption is of no matter. The table must outlive this.
  LayeredWaves(const Table& table, const Material& material);

  std::size_t size() const { return waves_.size(); }

  // Returns what the film reflects from outside, folded.
  Rgb reflectance(double cosine) const;
  // Writes it at each wavelength.
  void reflectance(double cosine, std::span<double> values) const;

  // Holds how light of one direction meets facets: what the film lets through at nodes of a quadrature over
  // facets.
  struct Passage {
    std::vector<double> transmittance;  // (node, wavelength)
    std::vector<double> crossing;       // (optical_depth, node); empty for a smooth film, which has one node
    std::vector<double> weight;         // of a node
    double per_pigment_cosine = 0;      // 1 / m~
  };
  // Prepares a direction above the horizon; phi lies in [0, pi/2] and is of no matter for an isotropic film.
  Passage passage(double cosine, double phi) const;

  // Writes A of each wavelength under a pigment of this optical depth at 510 nm.
  void arriving(const Passage& w, double optical_depth, std::span<double> share) const;

  // Returns `returned` of a wavelength under such a pigment; path "sum".
  double returned(std::size_t k, double optical_depth) const;

 private:
  struct Nodes;
  void take_crossing(const NdArray& crossing);
  void take_returns();
  void let_pass(double cosine, double* transmittance) const;
  void add_nodes(const Axis& ranks, std::span<const double> cosines, std::span<const double> crossing,
                 Passage& w) const;

  const Table& table_;
  const Wavelengths& waves_;
  Material material_;
  FilmCurves curves_;
  GaussRule rule_;
  std::vector<int> every_wavelength_;
  std::vector<double> crossing_;       // (theta, phi, optical_depth, facet_rank)
  std::vector<double> reflectance_;    // from below: (node, wavelength)
  std::vector<Stencil> return_place_;  // of the nodes on facet_rank
  std::vector<double> return_weight_;
};

}  // namespace v1
}  // namespace sunbeam
