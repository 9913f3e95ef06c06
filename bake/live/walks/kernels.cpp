#include "bake/live/walks/kernels.h"

#include "sunbeam/detail/processor.h"

namespace sunbeam::walk {

template <class Arch>
void unidirectional(const Layers& layers, double wi, const double* wo, int exits, Rng& rng, double* sums);
template <class Arch>
void bidirectional(const Layers& layers, double wi, double wo, Rng& rng, double* sums);
template <class Arch>
void multiple_facets(const Layers& layers, double wi, const double* wo, int exits, Rng& rng, double* sums);
template <class Arch>
void returns(const Layers& layers, Rng& rng, double* sums);
template <class Arch>
void reflectances(const FilmSide& film, const FilmPhases& phases, double cosine, double* r);
template <class Arch>
void attenuate(const double* tau, double length, int count, double* power);

namespace {

template <class Arch>
constexpr Kernels kernels_for(const char* name) {
  return {name,          unidirectional<Arch>, bidirectional<Arch>, multiple_facets<Arch>,
          returns<Arch>, reflectances<Arch>,   attenuate<Arch>};
}

}  // namespace

const Kernels kBaselineKernels = kernels_for<Baseline>("baseline");
#ifdef SUNBEAM_AVX2_KERNELS
const Kernels kAvx2Kernels = kernels_for<Avx2>("avx2");
#endif

void film_powers(const Kernels& kernels, const FilmSide& film, const FilmPhases& phases, Side side,
                 double cosine, FilmPowers& powers) {
  const std::size_t count = static_cast<std::size_t>(phases.count);
  if (phases.curves) return phases.curves->at(side, cosine, {phases.number.data(), count}, powers);
  kernels.reflectances(film, phases, cosine, powers.reflectance.data());
  for (std::size_t j = 0; j < count; ++j) powers.transmittance[j] = 1 - powers.reflectance[j];
}

const Kernels& best_kernels() {
#ifdef SUNBEAM_AVX2_KERNELS
  static const bool is_avx2 = __builtin_cpu_supports("avx2") && !baseline_is_forced();
  if (is_avx2) return kAvx2Kernels;
#endif
  return kBaselineKernels;
}

}  // namespace sunbeam::walk
