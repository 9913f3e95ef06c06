#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam::inline v1 {

const FilmKernels kAvx512FilmKernels = film_kernels<Floats16>("avx512");

}  // namespace sunbeam::inline v1
