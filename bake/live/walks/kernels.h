// This file gives access to the walks compiled for each instruction set, and chooses one for this processor.
//
// The kernel_*.cpp are compiled once for each instruction set, with SUNBEAM_ARCH its name.
#pragma once

#include "bake/live/walks/layers.h"

namespace sunbeam::walk {

// The first three add estimates of rest, 1/sr per wavelength, to sums (see unidirectional.h, bidirectional.h;
// of the base part alone: facets_walk.h); wi and wo are cosines. None allocates memory. All instruction sets
// give the same bits.
struct Kernels {
  const char* name;
  void (*unidirectional)(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                         double* sums);
  void (*bidirectional)(const Layers& layers, double wi, double wo, Rng& rng, double* sums);
  void (*multiple_facets)(const Layers& layers, double wi, const double* wo, int exits, Rng& rng,
                          double* sums);
  // Adds an estimate of the share of light at the base that comes back to it; see facets_walk.h.
  void (*returns)(const Layers& layers, Rng& rng, double* sums);
  // Writes the film's reflectance at one cosine and all wavelengths, up to kMostWavelengths numbers.
  void (*reflectances)(const FilmSide& film, const FilmPhases& phases, double cosine, double* r);
  // Does power[j] *= exp(-tau[j] length), j < count; reads kMostWavelengths of tau.
  void (*attenuate)(const double* tau, double length, int count, double* power);

  const Kernels* layered;  // those of layered films; walks under single clear ones are compiled without them
};

// Writes the powers at one cosine and all wavelengths, for light on this side of the film. `reverse` is left
// out for a film that is not layered: there it is the reflectance.
void film_powers(const Kernels& kernels, const FilmSide& film, const FilmPhases& phases, Side side,
                 double cosine, FilmPowers& powers);

// These need only what every processor of this kind has (x86-64: SSE2; ARM: NEON).
extern const Kernels kBaselineKernels;
#ifdef SUNBEAM_AVX2_KERNELS
extern const Kernels kAvx2Kernels;
#endif

// Returns the fastest that this processor runs, or the baseline if SUNBEAM_KERNELS asks for it
// (sunbeam/detail/processor.h).
const Kernels& best_kernels();

}  // namespace sunbeam::walk
