#include "runtime/src/lookup/bound_values.h"

#include "runtime/src/fit/bound_fit.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kAlbedoBins = 32;
constexpr int kRestAzimuths = 8;  // of an anisotropic factored table, in a quadrant

double even_cosine(int node) { return static_cast<double>(node) / (BoundValues::kFilmCosines - 1); }

ColorNodes folded_film(const BoundWaves& waves) {
  std::vector<float> cosines;
  for (int k = 0; k < BoundValues::kFilmCosines; ++k) cosines.push_back(static_cast<float>(even_cosine(k)));
  const std::vector<FloatRgb> folded = waves.reflectance(cosines);
  ColorNodes nodes(folded.size());
  for (std::size_t k = 0; k < folded.size(); ++k)
    nodes.set(k, Color4{folded[k].r, folded[k].g, folded[k].b, 0});
  return nodes;
}

ColorNodes interpolated_film(const NdArray& reflectance, const Material& material, const ColorMatrix& to) {
  ColorNodes nodes(BoundValues::kFilmCosines);
  for (int k = 0; k < BoundValues::kFilmCosines; ++k) {
    const std::array at{material.film_thickness_nm, material.base_ior, even_cosine(k)};
    nodes.set(static_cast<std::size_t>(k), to_color4(to * reflectance.interpolate(at)));
  }
  return nodes;
}

}  // namespace

BoundValues::BoundValues(const Table& table, const Material& material_at, const BindOptions& options)
    : material(material_at),
      symmetry(table.symmetry),
      to(rgb_to_rgb(table.color_space(), options.color_space.value_or(table.color_space()))) {
  if (!table.is_factored()) {
    other.emplace<DenseRest>(table, material);
    film = interpolated_film(table.film_reflectance, material, to);
    return;
  }
  const BoundWaves waves(table, material, film_kernels(options.arithmetic), to);
  film = folded_film(waves);
  if (symmetry == Symmetry::isotropic)
    separable = fit_isotropic(waves);
  else
    other = fit_anisotropic(waves);
  if (const auto known = table.info.find("noise"); known != table.info.end())
    parse_number(known->second, noise);
}

Rgb BoundValues::other_rest(const Vec3& wo, const Vec3& wi) const {
  if (const auto* factored = std::get_if<AnisotropicSeparable>(&other)) return to_rgb(factored->rest(wo, wi));
  return to * std::get<DenseRest>(other).rest(Parameters(), wo, wi);
}

std::size_t BoundValues::bytes() const {
  std::size_t nodes = separable.scales.size() + separable.ratios.size(), others = film.bytes();
  if (const auto* factored = std::get_if<AnisotropicSeparable>(&other))
    nodes += factored->scales.size() + factored->ratios.size();
  if (const auto* dense = std::get_if<DenseRest>(&other)) others += dense->bytes();
  return nodes * sizeof(Color4) + others;
}

Rgb BoundValues::film_reflectance(double cosine) const {
  return to_rgb(film.at(EvenPosition(static_cast<float>(std::clamp(cosine, 0.0, 1.0)), kFilmCosines)));
}

void BoundValues::visit_azimuth_mean(const Vec3& wo,
                                     const std::function<void(const OfCosine&)>& visit) const {
  if (const auto* dense = std::get_if<DenseRest>(&other)) {
    const DenseRest::AzimuthMean mean_rest(*dense, Parameters(), wo);
    return visit([&](double cos_i) { return to * mean_rest(cos_i); });
  }
  if (is_separable())
    return visit([&](double cos_i) {
      return to_rgb(separable.rest(static_cast<float>(wo.z), static_cast<float>(cos_i)));
    });
  visit([&](double cos_i) {
    Rgb sum;
    for (int a = 0; a < kRestAzimuths; ++a)
      sum += other_rest(wo, direction_from_cosine(cos_i, kPi / 2 * (a + 0.5) / kRestAzimuths));
    return sum / kRestAzimuths;
  });
}

// By midpoints in the unit square of visible normals, which turns the integral into a mean of R G2/G1.
Rgb BoundValues::first_albedo(const Vec3& wo, int nodes) const {
  if (material.is_smooth()) return film_reflectance(wo.z);
  const Ggx normals(material.roughness);
  Rgb sum;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const double turn = kPi * (j + 0.5) / nodes;  // roots at both ends of the height become smooth
      const Vec3 h = normals.sample_visible(wo, {(i + 0.5) / nodes, (1 - std::cos(turn)) / 2});
      const Vec3 wi = reflect(wo, h);
      if (wi.z > 0)
        sum += film_reflectance(dot(wo, h)) * (normals.g2_over_g1(wo, wi) * kPi / 2 * std::sin(turn));
    }
  return sum / (nodes * nodes);
}

// By four-point Gauss-Legendre in each bin of cos(theta_i).
Rgb BoundValues::rest_albedo(const Vec3& wo) const {
  constexpr double kNode[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  constexpr double kWeight[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
  Rgb total;
  if (wo.z <= 0) return total;
  visit_azimuth_mean(wo, [&](const OfCosine& mean_rest) {
    for (int bin = 0; bin < kAlbedoBins; ++bin)
      for (int g = 0; g < 4; ++g) {
        const double cos_i = (bin + kNode[g]) / kAlbedoBins;
        total += mean_rest(cos_i) * (kWeight[g] * cos_i * 2 * kPi / kAlbedoBins);
      }
  });
  return total;
}

}  // namespace v1
}  // namespace sunbeam
