#include "runtime/src/film/film_spectrum.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "runtime/src/film/film_kernels.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/processor.h"

namespace sunbeam {
inline namespace v1 {
namespace {

double with_12_bits(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & ~((1ULL << 41) - 1));
}

// m_1 = (n1 c1)^2, negative where the wave is evanescent in the film.
double film_cosine_term(const FilmMedia& media, double cosine) {
  const double n0 = media.exterior_ior, n1 = media.film_ior;
  return (n1 - n0) * (n1 + n0) + square(n0 * cosine);
}

// X / m_1 and the like as in film_spectrum.h, for one cosine with an evanescent wave.
struct EvanescentFilm {
  EvanescentFilm(const FilmMedia& media, double cosine) {
    const double n0 = media.exterior_ior, n1 = media.film_ior, n2 = media.base_ior;
    const double m1 = -film_cosine_term(media, cosine), q0 = n0 * cosine;
    const double q2_squared = (n2 - n0) * (n2 + n0) + square(q0);
    if (q2_squared <= 0 || cosine <= 1e-9) return;  // half_t = 0
    const double q2 = std::sqrt(q2_squared), beta_squared = square(n0) - square(q0);
    path = media.thickness_nm * std::sqrt(m1);
    half_t = 2 * q0 * q2;
    sum_s = square(q0 + q2);
    sum_p = square(n2 * cosine + n0 * q2 / n2);
    x_s = (n1 - n0) * (n1 + n0) * (n1 - n2) * (n1 + n2) / m1;
    x_p = x_s * (1 - beta_squared * (1 / square(n1) + 1 / square(n0))) *
          (1 - beta_squared * (1 / square(n1) + 1 / square(n2)));
  }

  // `per` = 2 / wavelength.
  double transmittance(double per) const {
    const double s = square(std::sinh(std::min(kPi * path * per, 300.0)));  // as good as opaque, no overflow
    return half_t / (sum_s + x_s * s) + half_t / (sum_p + x_p * s);
  }

  double path = 0, half_t = 0, sum_s = 1, sum_p = 1, x_s = 0, x_p = 0;
};

FloatRgb fold_evanescent(const FilmWavelengths& w, const FilmMedia& media, double cosine) {
  const EvanescentFilm film(media, cosine);
  Rgb sum(w.total_weight.r, w.total_weight.g, w.total_weight.b);
  for (std::size_t k = 0; k < w.count; ++k)
    sum += -film.transmittance(double{w.per_high[k]} + w.per_low[k]) *
           Rgb(w.weight[0][k], w.weight[1][k], w.weight[2][k]);
  return {static_cast<float>(sum.r), static_cast<float>(sum.g), static_cast<float>(sum.b)};
}

}  // namespace

FilmWavelengths::FilmWavelengths(const Wavelengths& wavelengths)
    : per_high{}, per_low{}, weight{}, count(wavelengths.size()) {
  if (count < 1 || count > kMostWavelengths)
    throw Error("a film spectrum of " + std::to_string(count) + " wavelengths; allowed are 1 to " +
                std::to_string(kMostWavelengths));
  padded = (count + kPadding - 1) / kPadding * kPadding;
  Rgb total;
  for (std::size_t k = 0; k < padded; ++k) {
    const double per = 2 / wavelengths.nm[std::min(k, count - 1)], high = with_12_bits(per);
    per_high[k] = static_cast<float>(high);
    per_low[k] = static_cast<float>(per - high);
    if (k >= count) continue;
    for (int c = 0; c < 3; ++c) weight[c][k] = static_cast<float>(wavelengths.weight[k][c]);
    total += wavelengths.weight[k];
  }
  total_weight = {static_cast<float>(total.r), static_cast<float>(total.g), static_cast<float>(total.b)};
}

std::span<const FilmKernels* const> supported_film_kernels() {
#ifdef SUNBEAM_X86_FILM_KERNELS
  static const FilmKernels* const kernels[] = {&kBaselineFilmKernels, &kAvx2FilmKernels, &kAvx512FilmKernels};
  static const std::size_t count = [] {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return 1;
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")
               ? 3
               : 2;
  }();
  return {kernels, count};
#else
  static const FilmKernels* const kernels[] = {&kBaselineFilmKernels};
  return kernels;
#endif
}

const FilmKernels& film_kernels(Arithmetic arithmetic) {
  static const FilmKernels& best =
      baseline_is_forced() ? kBaselineFilmKernels : *supported_film_kernels().back();
  return arithmetic == Arithmetic::fastest ? best : kBaselineFilmKernels;
}

FilmSpectrum::FilmSpectrum(const Wavelengths& wavelengths, double exterior_ior, double film_ior,
                           const FilmKernels& kernels)
    : wavelengths_(wavelengths), exterior_ior_(exterior_ior), film_ior_(film_ior), kernels_(&kernels) {}

void FilmSpectrum::fold(double thickness_nm, double base_ior, std::span<const float> cosines,
                        FloatRgb* rgb) const noexcept {
  const FilmMedia media{exterior_ior_, film_ior_, base_ior, thickness_nm};
  kernels_->fold(wavelengths_, media, cosines.data(), cosines.size(), rgb);
  if (film_ior_ >= exterior_ior_) return;
  for (std::size_t i = 0; i < cosines.size(); ++i)
    if (film_cosine_term(media, cosines[i]) < 0) rgb[i] = fold_evanescent(wavelengths_, media, cosines[i]);
}

void FilmSpectrum::powers(double thickness_nm, double base_ior, float cosine,
                          float* transmittance) const noexcept {
  const FilmMedia media{exterior_ior_, film_ior_, base_ior, thickness_nm};
  if (film_cosine_term(media, cosine) >= 0)
    return kernels_->transmittances(wavelengths_, media, cosine, transmittance);
  const EvanescentFilm film(media, cosine);
  for (std::size_t k = 0; k < wavelengths_.padded; ++k)
    transmittance[k] =
        static_cast<float>(film.transmittance(double{wavelengths_.per_high[k]} + wavelengths_.per_low[k]));
}

}  // namespace v1
}  // namespace sunbeam
