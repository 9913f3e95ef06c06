#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam {
inline namespace v1 {

const FilmKernels kAvx2FilmKernels = film_kernels<Floats8>("avx2");

}  // namespace v1
}  // namespace sunbeam
