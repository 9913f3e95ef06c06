#include "bake/live/walks/kernels.h"

#include "sunbeam/detail/processor.h"

namespace sunbeam::walk {

template <class Arch, bool kLayered>
void unidirectional(const Layers& layers, double wi, const double* wo, int exits, Rng& rng, double* sums);
template <class Arch, bool kLayered>
void bidirectional(const Layers& layers, double wi, double wo, Rng& rng, double* sums);
template <class Arch, bool kLayered>
void multiple_facets(const Layers& layers, double wi, const double* wo, int exits, Rng& rng, double* sums);
template <class Arch, bool kLayered>
void returns(const Layers& layers, Rng& rng, double* sums);
template <class Arch>
void reflectances(const FilmSide& film, const FilmPhases& phases, double cosine, double* r);
template <class Arch>
void attenuate(const double* tau, double length, int count, double* power);

namespace {

template <class Arch, bool kLayered>
constexpr Kernels kernels_for(const char* name, const Kernels* layered) {
  return {name,
          unidirectional<Arch, kLayered>,
          bidirectional<Arch, kLayered>,
          multiple_facets<Arch, kLayered>,
          returns<Arch, kLayered>,
          reflectances<Arch>,
          attenuate<Arch>,
          layered};
}

constexpr Kernels kLayeredBaseline = kernels_for<Baseline, true>("baseline", nullptr);
#ifdef SUNBEAM_AVX2_KERNELS
constexpr Kernels kLayeredAvx2 = kernels_for<Avx2, true>("avx2", nullptr);
#endif

}  // namespace

const Kernels kBaselineKernels = kernels_for<Baseline, false>("baseline", &kLayeredBaseline);
#ifdef SUNBEAM_AVX2_KERNELS
const Kernels kAvx2Kernels = kernels_for<Avx2, false>("avx2", &kLayeredAvx2);
#endif

void film_powers(const Kernels& kernels, const FilmSide& film, const FilmPhases& phases, Side side,
                 double cosine, FilmPowers& powers) {
  if (phases.curves) return phases.curves->at(side, cosine, phases.numbers(), powers);
  kernels.reflectances(film, phases, cosine, powers.reflectance.data());
  for (int j = 0; j < phases.count; ++j) powers.transmittance[j] = 1 - powers.reflectance[j];
}

const Kernels& best_kernels() {
#ifdef SUNBEAM_AVX2_KERNELS
  static const bool is_avx2 = __builtin_cpu_supports("avx2") && !baseline_is_forced();
  if (is_avx2) return kAvx2Kernels;
#endif
  return kBaselineKernels;
}

}  // namespace sunbeam::walk
