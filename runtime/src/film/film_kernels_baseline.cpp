#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam {
inline namespace v1 {

const FilmKernels kBaselineFilmKernels = film_kernels<Floats4>("baseline");

}  // namespace v1
}  // namespace sunbeam
