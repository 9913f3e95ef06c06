// The rest of films over a scattering pigment (slab_solver.h) at all thicknesses and absorptions of one base
// IOR.
//
// At one wavelength the film acts by its fringe order x = 2 n1 d / lambda alone, the pigment by its depth t.
// What both send back is even and smooth in x and in sqrt(t), so a large grid need not solve every
// (thickness, wavelength, absorption): it solves nodes in equal steps of x and sqrt(t), as many a fringe as
// the film asks for, and interpolates with degree 7. Small grids are solved directly, whichever is cheaper.
// The base's albedo comes last (SlabSolver::Response::base), so that spectra of it cost nothing.
// Against direct solutions: tests/accuracy/dense/slab_films_test.cpp.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/live/adding_doubling/even_samples.h"
#include "bake/live/adding_doubling/slab_solver.h"

namespace sunbeam {

class SlabFilms {
 public:
  // Nodes, all of the table: which of them a process evaluates changes no bit of a value.
  struct Grid {
    std::vector<double> film_thickness_nm, absorption_per_nm;
    std::vector<double> cosine, azimuth;  // outside, > 0; between wi and wo
  };
  // Calls task(k) for every k below `count`, in any order, perhaps on many threads.
  using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t k)>& task)>;

  // Of `material` all but the grid's parameters counts; SlabSolver must solve it.
  SlabFilms(const Material& material, const Wavelengths& wavelengths, Grid grid);

  // Solves what rest() needs at thickness nodes `first` to before `last`. Not beside itself or rest().
  void prepare(std::size_t first, std::size_t last, const ForEach& for_each);

  // Rest, 1/sr, over (cosine of wi, cosine of wo, azimuth). Any number of threads at a time. Throws Error if
  // the thickness was not prepared.
  void rest(std::size_t thickness, std::size_t absorption, std::span<Rgb> values) const;
  std::size_t cells() const { return grid_.cosine.size() * grid_.cosine.size() * grid_.azimuth.size(); }

  // How many responses of the solver all thicknesses take.
  std::size_t responses() const;

 private:
  // What is solved: Response at some orders x and roots of depths.
  struct Nodes {
    EvenSamples order, root_depth;
    std::size_t pair(std::size_t o, std::size_t d) const { return o * root_depth.size() + d; }
  };

  Nodes choose_nodes() const;
  double root_depth(std::size_t absorption, std::size_t wavelength) const;
  template <class Visit>
  void each_pair(const Nodes& nodes, std::size_t first, std::size_t last, Visit visit) const;
  std::vector<bool> needed(const Nodes& nodes, std::size_t first, std::size_t last) const;
  double cost(const Nodes& nodes) const;
  std::vector<double> flatten(const SlabSolver::Response& response) const;

  Grid grid_;
  Wavelengths wavelengths_;
  double film_ior_, pigment_thickness_nm_;
  SlabSolver solver_;
  std::vector<std::vector<double>> cos_;  // of mode times azimuth
  Nodes nodes_;
  // By Nodes::pair(); empty if not solved. Slab by (pair of cosines, azimuth), arrived by cosine, returned.
  std::vector<std::vector<double>> response_;
};

}  // namespace sunbeam
