#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam {

const FilmKernels kBaselineFilmKernels = film_kernels<Floats4>("baseline");

}  // namespace sunbeam
