#include "runtime/src/film/make_film_kernels.h"

namespace sunbeam {
inline namespace v1 {

const FilmKernels kAvx512FilmKernels = film_kernels<Floats16>("avx512");

}  // namespace v1
}  // namespace sunbeam
