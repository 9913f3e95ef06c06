#include "sunbeam/spectral_bsdf.h"

#include <algorithm>

#include "runtime/src/fit/bound_waves.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

template <class T>
T between(double t, const T& a, const T& b) {
  return a + t * (b - a);
}

// Adds a wavelength between the stored ones `a` and `b`, at a share t of the way.
void add_between(const Wavelengths& stored, std::size_t a, std::size_t b, double t, Wavelengths& to) {
  to.nm.push_back(lerp(t, stored.nm[a], stored.nm[b]));
  to.albedo.push_back(lerp(t, stored.albedo[a], stored.albedo[b]));
  to.absorption.push_back(lerp(t, stored.absorption[a], stored.absorption[b]));
  to.weight.emplace_back(0);
  if (!stored.base_index.empty())
    to.base_index.push_back(between(t, stored.base_index[a], stored.base_index[b]));
  if (stored.layers.empty()) return;
  std::vector<FilmLayer> layers = stored.layers[a];
  for (std::size_t j = 0; j < layers.size(); ++j)
    layers[j].index = between(t, layers[j].index, stored.layers[b][j].index);
  to.layers.push_back(std::move(layers));
}

// The stored wavelengths by their length.
std::vector<std::size_t> ascending(const Wavelengths& stored) {
  std::vector<std::size_t> order(stored.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return stored.nm[a] < stored.nm[b]; });
  return order;
}

Wavelengths interpolated(const Table& table, std::span<const double> nm) {
  const Interval range = spectral_range(table);
  if (nm.empty() || nm.size() > kMostWavelengths)
    throw Error("wavelengths: found " + std::to_string(nm.size()) + "; allowed: 1 to " +
                std::to_string(kMostWavelengths));
  const Wavelengths& stored = table.factors.wavelengths;
  const auto order = ascending(stored);
  Wavelengths result;
  result.film_periods = stored.film_periods;
  for (const double x : nm) {
    if (!(x >= range.low && x <= range.high))
      throw Error("wavelength: found " + to_text(x) + " nm; the table holds " + to_text(range.low) + " to " +
                  to_text(range.high) + " nm");
    std::size_t k = 0;
    while (k + 2 < order.size() && x > stored.nm[order[k + 1]]) ++k;
    const std::size_t a = order[k], b = order[std::min(k + 1, order.size() - 1)];
    const double step = stored.nm[b] - stored.nm[a];
    add_between(stored, a, b, step > 0 ? (x - stored.nm[a]) / step : 0, result);
  }
  return result;
}

Table at_wavelengths(const Table& table, std::span<const double> nm) {
  Wavelengths wavelengths = interpolated(table, nm);
  Table result = table;
  result.factors.wavelengths = std::move(wavelengths);
  return result;
}

}  // namespace

struct SpectralData {
  SpectralData(const Table& given, const Parameters& parameters, std::span<const double> nm,
               const BindOptions& options)
      : table(at_wavelengths(given, nm)),
        directions(given, parameters, {.outside = options.outside, .arithmetic = options.arithmetic}),
        waves(table, directions.material(), film_kernels(options.arithmetic),
              rgb_to_rgb(ColorSpace::rec709, ColorSpace::rec709)),
        normals(directions.material().roughness) {}

  std::size_t size() const { return table.factors.wavelengths.size(); }
  bool is_smooth() const { return directions.material().is_smooth(); }

  // The azimuth folded into a quadrant, which symmetric films allow.
  BoundWaves::Direction direction(const Vec3& w) const {
    return waves.direction(w.z, std::atan2(std::abs(w.y), std::abs(w.x)));
  }

  Table table;  // the waves refer to it
  TableBsdf directions;
  BoundWaves waves;
  Ggx normals;
};

Interval spectral_range(const Table& table) {
  if (!table.is_factored())
    throw Error(
        "spectral look-ups: the table is dense and holds colours alone; bake it with encoding 'factored'");
  const auto [low, high] =
      std::minmax_element(table.factors.wavelengths.nm.begin(), table.factors.wavelengths.nm.end());
  return {*low, *high};
}

SpectralBsdf::SpectralBsdf(const Table& table, const Parameters& parameters,
                           std::span<const double> wavelengths_nm, const BindOptions& options)
    : data_(std::make_shared<SpectralData>(table, parameters, wavelengths_nm, options)) {}

std::size_t SpectralBsdf::size() const { return data_->size(); }

void SpectralBsdf::eval(const Vec3& wo, const Vec3& wi, std::span<double> f) const {
  std::fill_n(f.begin(), size(), 0.0);
  if (wo.z <= 0 || wi.z <= 0) return;
  const SpectralData& data = *data_;
  data.waves.rest(data.waves.row(data.direction(wi)), data.direction(wo), f);
  if (data.is_smooth()) return;
  const Vec3 h = normalize(wo + wi);
  std::array<double, kMostWavelengths> reflectance;
  data.waves.reflectance(std::min(dot(wo, h), 1.0), reflectance);
  const double lobe = data.normals.reflection(wo, wi, h);
  for (std::size_t k = 0; k < size(); ++k) f[k] += lobe * reflectance[k];
}

double SpectralBsdf::pdf(const Vec3& wo, const Vec3& wi) const { return data_->directions.pdf(wo, wi); }

void SpectralBsdf::dirac(const Vec3& wo, std::span<double> weight) const {
  std::fill_n(weight.begin(), size(), 0.0);
  if (data_->is_smooth() && wo.z > 0) data_->waves.reflectance(std::min(wo.z, 1.0), weight);
}

std::optional<SpectralBsdf::Sample> SpectralBsdf::sample(const Vec3& wo, const Random3& u,
                                                         std::span<double> throughput) const {
  const auto drawn = data_->directions.sample(wo, u);
  if (!drawn) return {};
  if (drawn->is_dirac) {
    dirac(wo, throughput);
    const double per_chance = 1 / data_->directions.dirac_chance(wo);
    for (std::size_t k = 0; k < size(); ++k) throughput[k] *= per_chance;
    return Sample{drawn->wi, true, 0};
  }
  eval(wo, drawn->wi, throughput);
  for (std::size_t k = 0; k < size(); ++k) throughput[k] *= drawn->wi.z / drawn->mis_pdf;
  return Sample{drawn->wi, false, drawn->mis_pdf};
}

}  // namespace v1
}  // namespace sunbeam
