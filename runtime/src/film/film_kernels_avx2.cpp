#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam::inline v1 {

const FilmKernels kAvx2FilmKernels = film_kernels<Floats8>("avx2");

}  // namespace sunbeam::inline v1
