// This file computes the rest of films over a scattering pigment (slab_solver.h), at all thicknesses and
// absorptions of one base IOR.
//
// At one wavelength the film acts by its fringe order x = 2 n1 d / lambda alone, the pigment by its depth t.
// What both send back is even and smooth in x and in sqrt(t), so a large grid need not solve every
// (thickness, wavelength, absorption): it solves nodes in equal steps of x and sqrt(t), as many a fringe as
// the film asks for, and interpolates with degree 7. Small grids are solved directly, whichever is cheaper.
// A layered film is solved at each thickness and wavelength, since its indices may depend on the latter.
// The base's albedo comes last (SlabSolver::Response::base), so that spectra of it cost nothing.
// tests/accuracy/dense/slab_films_test.cpp compares it with direct solutions.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/live/adding_doubling/even_samples.h"
#include "bake/live/adding_doubling/slab_solver.h"

namespace sunbeam {

class SlabFilms {
 public:
  // Holds all nodes of the table: which of them a process evaluates changes no bit of a value.
  struct Grid {
    std::vector<double> film_thickness_nm, absorption_per_nm;
    std::vector<double> cosine, azimuth;  // outside, > 0; between wi and wo
  };
  // Calls task(k) for every k below `count`, in any order, perhaps on many threads.
  using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t k)>& task)>;

  // Chooses what to solve. Of `material` all but the grid's parameters counts; SlabSolver must solve it.
  SlabFilms(const Material& material, const Wavelengths& wavelengths, Grid grid);

  // Solves what rest() needs at thickness nodes `first` to before `last`. It must not run beside itself or
  // rest().
  void prepare(std::size_t first, std::size_t last, const ForEach& for_each);

  // Writes the rest, 1/sr, over (cosine of wi, cosine of wo, azimuth). Any number of threads may call it at a
  // time. Throws Error if the thickness was not prepared.
  void rest(std::size_t thickness, std::size_t absorption, std::span<Rgb> values) const;
  std::size_t cells() const { return grid_.cosine.size() * grid_.cosine.size() * grid_.azimuth.size(); }

  // Returns how many responses of the solver all thicknesses take.
  std::size_t responses() const;

 private:
  // Says what is solved: Response at some orders x and roots of depths. The orders of a layered film are
  // numbers of (thickness, wavelength).
  struct Nodes {
    EvenSamples order, root_depth;
    std::size_t pair(std::size_t o, std::size_t d) const { return o * root_depth.size() + d; }
  };

  Nodes choose_nodes() const;
  std::vector<double> orders(std::size_t thickness) const;  // of each wavelength
  SlabSolver::Fringes fringes(std::span<const std::size_t> orders) const;
  double root_depth(std::size_t absorption, std::size_t wavelength) const;
  template <class Visit>
  void each_pair(const Nodes& nodes, std::size_t first, std::size_t last, Visit visit) const;
  std::vector<bool> needed(const Nodes& nodes, std::size_t first, std::size_t last) const;
  double cost(const Nodes& nodes) const;
  std::vector<double> flatten(const SlabSolver::Response& response) const;

  Grid grid_;
  Wavelengths wavelengths_;
  bool is_layered_;
  double film_ior_, pigment_thickness_nm_;
  SlabSolver solver_;
  std::vector<std::vector<double>> cos_;  // of mode times azimuth
  Nodes nodes_;
  // They are numbered by Nodes::pair() and empty if not solved. Each holds slab by (pair of cosines,
  // azimuth), arrived by cosine, and returned.
  std::vector<std::vector<double>> response_;
};

}  // namespace sunbeam
