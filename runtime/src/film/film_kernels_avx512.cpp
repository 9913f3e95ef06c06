#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam {

const FilmKernels kAvx512FilmKernels = film_kernels<Floats16>("avx512");

}  // namespace sunbeam
