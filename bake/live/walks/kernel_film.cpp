#include "bake/live/walks/film_packets.h"
#include "bake/live/walks/kernels.h"

namespace sunbeam::walk {

template <class Arch>
SUNBEAM_FLATTEN void reflectances(const FilmSide& film, const FilmPhases& phases, double cosine, double* r) {
  const FilmPackets<Batch<Arch>> lanes(film, phases, cosine);
  for (int j = 0; j < phases.count; j += Arch::kWidth)
    lanes.reflectance_at(Batch<Arch>::load(&phases.k[j])).store(r + j);
}
template void reflectances<SUNBEAM_ARCH>(const FilmSide&, const FilmPhases&, double, double*);

template <class Arch>
SUNBEAM_FLATTEN void attenuate(const double* tau, double length, int count, double* power) {
  using Batch = walk::Batch<Arch>;
  constexpr int kSize = Arch::kWidth;
  const auto attenuated = [&](const double* p, int j) {
    return Batch::load(p) * exp_negative(Batch::load(tau + j) * Batch(-length));
  };
  int j = 0;
  for (; j + kSize <= count; j += kSize) attenuated(power + j, j).store(power + j);
  if (j == count) return;
  double last[kSize]{};
  for (int k = 0; j + k < count; ++k) last[k] = power[j + k];
  attenuated(last, j).store(last);
  for (int k = 0; j + k < count; ++k) power[j + k] = last[k];
}
template void attenuate<SUNBEAM_ARCH>(const double*, double, int, double*);

}  // namespace sunbeam::walk
