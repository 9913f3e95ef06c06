#include "runtime/src/rest/textured_media.h"

namespace sunbeam {
inline namespace v1 {

Color4 mean_absorption(const Wavelengths& w) {
  Rgb sum, total;
  for (std::size_t k = 0; k < w.size(); ++k) {
    sum += w.absorption[k] * w.weight[k];
    total += w.weight[k];
  }
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = std::max(sum[c] / total[c], 0.0);
  Color4 lanes = to_color4(result);
  lanes[3] = static_cast<float>(mean(result));
  return lanes;
}

TexturedMedia::TexturedMedia(const Table& table, Arithmetic arithmetic)
    : film(table.factors.wavelengths, table.material.exterior_ior, table.material.film_ior,
           film_kernels(arithmetic)),
      total(FilmWavelengths(table.factors.wavelengths).total_weight),
      absorption(mean_absorption(table.factors.wavelengths)) {}

}  // namespace v1
}  // namespace sunbeam
