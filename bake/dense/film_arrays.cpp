#include "bake/dense/film_arrays.h"

#include "bake/dense/film_axes.h"
#include "bake/dense/film_colors.h"
#include "bake/live/film/geometry.h"

namespace sunbeam {
namespace {

// Nodes of F over the optical path, even in its cube root: linear to 1e-5 of a white base for |a| up to 4.
constexpr std::size_t kPathNodes = 2048;
constexpr double kLongestPath = 100;      // optical depths; F is constant beyond
constexpr std::size_t kNormalNodes = 48;  // quadrature over visible normals, each way
constexpr int kQuadrantAzimuths = 4;      // midpoints, of an anisotropic film

// Directions at this cosine: one for an isotropic film, else some of a quadrant; the other three are its
// mirror images.
std::vector<Vec3> directions_at(double cosine, const Roughness& roughness) {
  if (roughness.is_isotropic()) return {direction_from_cosine(cosine, 0)};
  std::vector<Vec3> directions;
  for (int a = 0; a < kQuadrantAzimuths; ++a)
    directions.push_back(direction_from_cosine(cosine, kPi / 2 * (a + 0.5) / kQuadrantAzimuths));
  return directions;
}

// How much of the light at cosine i, a mean over its azimuth, meets facets of cosine j and gets through, film
// aside: the mean transmittance of a rough film is this row times the film's transmittance at the cosines.
std::vector<double> crossing_weights(const Material& material, const Axis& cosines) {
  const FilmGeometry film(material);
  const std::size_t n = cosines.size();
  std::vector<double> weights(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto directions = directions_at(std::max(cosines.nodes[i], kLeastFilmCosine), material.roughness);
    for (const Vec3& w : directions)
      for (std::size_t k = 0; k < kNormalNodes * kNormalNodes; ++k) {
        const double u = (static_cast<double>(k % kNormalNodes) + 0.5) / kNormalNodes;
        const double v = (static_cast<double>(k / kNormalNodes) + 0.5) / kNormalNodes;
        const Vec3 h = film.visible_normal(w, {u, v});
        const auto inside = film.cross(w, h);
        if (!inside) continue;
        const Stencil at = cosines.stencil(dot(w, h));
        const double share =
            inside->share / static_cast<double>(kNormalNodes * kNormalNodes * directions.size());
        for (std::size_t j = 0; j < at.count; ++j) weights[i * n + at.node[j]] += share * at.weight[j];
      }
  }
  return weights;
}

Rgb weighted(const std::vector<Rgb>& transmittances, std::span<const double> weights) {
  Rgb sum;
  for (std::size_t j = 0; j < weights.size(); ++j) sum += weights[j] * transmittances[j];
  return sum;
}

// Polynomials between the nodes of a steep film may reach beyond.
Rgb within_shares(const Rgb& power) {
  return transform(power, [](double x) { return std::clamp(x, 0.0, 1.0); });
}

NdArray first_visit(const Recipe& recipe) {
  const Wavelengths w = recipe.spectrum.wavelengths(recipe.material);
  const Axis path{"optical_path", "1", spaced_nodes(0, kLongestPath, kPathNodes, 3), 3};
  NdArray result("first_visit", {path}, Precision::single_float);
  for (std::size_t i = 0; i < kPathNodes; ++i) {
    Rgb sum;
    for (std::size_t k = 0; k < w.size(); ++k)
      sum += w.weight[k] * (w.albedo[k] * std::exp(-w.absorption[k] * path.nodes[i]));
    result.set(i, sum);
  }
  return result;
}

}  // namespace

void bake_film(const Recipe& recipe, Table& table) {
  const auto axes = film_axes(recipe);
  const Axis &thickness = axes[0], &ior = axes[1], &cosine = axes[2];
  const Wavelengths wavelengths = recipe.spectrum.wavelengths(recipe.material);
  const bool layered = is_layered(recipe.material, wavelengths), rough = !recipe.material.is_smooth();
  if (recipe.spectrum.is_full()) table.first_visit = first_visit(recipe);
  table.film_reflectance = NdArray("film_reflectance", axes, Precision::single_float);
  if (rough || layered)
    table.film_transmittance = NdArray("film_transmittance", axes, Precision::single_float);

  for (std::size_t b = 0; b < ior.size(); ++b) {
    Material material = recipe.material;
    material.base_ior = ior.nodes[b];
    const auto weights = rough ? crossing_weights(material, cosine) : std::vector<double>();
    for (std::size_t a = 0; a < thickness.size(); ++a) {
      material.film_thickness_nm = thickness.nodes[a];
      const FilmColors film(material, wavelengths);
      const std::size_t row = a * table.film_reflectance.stride(0) + b * table.film_reflectance.stride(1);
      std::vector<Rgb> through;
      for (std::size_t c = 0; c < cosine.size(); ++c) {
        const FilmPower power = film.at(std::max(cosine.nodes[c], kLeastFilmCosine));
        table.film_reflectance.set(row + c, power.reflectance);
        through.push_back(layered ? power.transmittance : Rgb(1) - table.film_reflectance.get(row + c));
      }
      if (table.film_transmittance.empty()) continue;
      for (std::size_t c = 0; c < cosine.size(); ++c) {
        Rgb mean = through[c];
        if (rough) mean = weighted(through, std::span(weights).subspan(c * cosine.size(), cosine.size()));
        if (layered && !recipe.spectrum.is_full()) mean = within_shares(mean);
        table.film_transmittance.set(row + c, mean);
      }
    }
  }
}

}  // namespace sunbeam
