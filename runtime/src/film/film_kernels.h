// This file gives access to the hot part of FilmSpectrum, which is compiled for each instruction set.
#pragma once

#include <cstddef>
#include <span>

#include "runtime/src/film/film_spectrum.h"

namespace sunbeam {
inline namespace v1 {

struct FilmMedia {
  double exterior_ior, film_ior, base_ior, thickness_nm;
};

// Both take the film's wave at beta >= n1 as that at beta = n1: finite, but wrong for n1 < n0.
struct FilmKernels {
  const char* name;
  void (*fold)(const FilmWavelengths& wavelengths, const FilmMedia& media, const float* cosines,
               std::size_t count, FloatRgb* rgb);
  void (*transmittances)(const FilmWavelengths& wavelengths, const FilmMedia& media, float cosine,
                         float* transmittance);
};

// These need only what every processor of this kind has (x86-64: SSE2; ARM: NEON).
extern const FilmKernels kBaselineFilmKernels;
#ifdef SUNBEAM_X86_FILM_KERNELS
extern const FilmKernels kAvx2FilmKernels;
extern const FilmKernels kAvx512FilmKernels;
#endif

// Returns those that this processor runs, the fastest last.
std::span<const FilmKernels* const> supported_film_kernels();

}  // namespace v1
}  // namespace sunbeam
