#include "bake/live/pfmc.h"

namespace sunbeam {
namespace {

constexpr std::size_t kChunk = 32;  // directions that share one walk; their sums are on the stack

}  // namespace

Pfmc::Pfmc(const Material& material, const Wavelengths& wavelengths, const walk::Kernels& kernels)
    : layers_(material, wavelengths),
      general_(material),
      family_(family_of(material)),
      weight_{},
      importance_{},
      ggx_(material.roughness),
      kernels_(layers_.is_layered() ? kernels.layered : &kernels) {
  double sum = 0;
  for (int k = 0; k < layers_.count; ++k) {
    weight_[k] = wavelengths.weight[k];
    importance_[k] = mean(transform(weight_[k], [](double w) { return std::abs(w); }));
    sum += importance_[k];
  }
  for (int k = 0; k < layers_.count; ++k) importance_[k] /= sum;
  if (family_ == Family::facets) forecast_visits();
}

// Packets seldom come in where light passes few facets; the general walk looks for these.
Pfmc::Family Pfmc::family_of(const Material& material) {
  const bool reflects_totally = critical_cosine(ThinFilm::of(material)) > 0 && !material.is_smooth();
  if (reflects_totally) return Family::general;
  if (material.is_plain()) return Family::plain;
  return !material.scatters() && material.roughness.is_isotropic() ? Family::facets : Family::general;
}

// Noise here is harmless: estimates correct it.
void Pfmc::forecast_visits() {
  constexpr int kPackets = 200;
  Rng rng(1, 0);
  Powers returns{};
  for (int i = 0; i < kPackets; ++i) kernels_->returns(layers_, rng, returns.data());
  for (int k = 0; k < layers_.count; ++k) {
    layers_.visits[k] = 1 / std::max(1 - returns[k] / kPackets, 0.01);
    layers_.later_visits[k] = layers_.visits[k] * std::exp(-3 * layers_.tau[k]);  // obliquely up and down
  }
}

Pfmc Pfmc::at(std::span<const Pick> picks) const {
  Pfmc other(*this);
  other.layers_.pick(layers_, picks.size(), [&](std::size_t k) { return picks[k].wavelength; });
  for (std::size_t k = 0; k < picks.size(); ++k) {
    other.weight_[k] = picks[k].factor * weight_[picks[k].wavelength];
    other.importance_[k] = 1.0 / static_cast<double>(picks.size());
  }
  return other;
}

Rgb Pfmc::fold(const double* values) const {
  Rgb sum;
  for (int k = 0; k < layers_.count; ++k) sum += values[k] * weight_[k];
  return sum;
}

FilmPowers Pfmc::film_at(sunbeam::Side side, double cosine) const {
  FilmPowers powers;
  cosine = std::clamp(cosine, 0.0, 1.0);
  if (layers_.is_layered()) {
    layers_.curves->at(side, cosine, layers_.phases.numbers(), powers);
    return powers;
  }
  const walk::FilmSide& film = side == sunbeam::Side::outside ? layers_.film : layers_.film_below;
  const walk::FilmPackets<double> lanes(film, layers_.phases, cosine);
  lanes.reflectances([&](int k, double r) {
    powers.reflectance[k] = r;
    powers.transmittance[k] = 1 - r;
  });
  return powers;
}

Rgb Pfmc::film_reflectance(double cos_exterior) const {
  return fold(film_at(sunbeam::Side::outside, cos_exterior).reflectance.data());
}

Rgb Pfmc::first(const Vec3& wo, const Vec3& wi) const {
  if (layers_.is_smooth() || wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection(wo, wi, h) * film_reflectance(dot(wo, h));
}

Rgb Pfmc::dirac(const Vec3& wo) const { return layers_.is_smooth() ? film_reflectance(wo.z) : Rgb(); }

double Pfmc::reflect_chance(double cos_exterior) const {
  return layers_.entry_chance(importance_.data(), film_at(sunbeam::Side::outside, cos_exterior));
}

double Pfmc::leaving_shape(double cos_exterior) const {
  if (family_ != Family::plain) return cos_exterior;
  const double below2 = 1 - square(layers_.index_ratio) * (1 - square(cos_exterior));
  if (below2 <= 0) return 0;
  const FilmPowers film = film_at(sunbeam::Side::outside, cos_exterior);
  const double passes = layers_.mean_transmittance(importance_.data(), film);
  return passes * layers_.open_guide.density(below2) * cos_exterior;
}

double Pfmc::first_pdf(const Vec3& wo, const Vec3& wi) const {
  if (layers_.is_smooth() || wo.z <= 0 || wi.z <= 0) return 0;
  const Vec3 h = normalize(wo + wi);
  const double escapes = general_.multiple ? ggx_.g2_over_g1(wo, wi) : 1;
  return ggx_.reflection_pdf(wo, h) * reflect_chance(dot(wo, h)) * escapes;
}

Rgb Pfmc::estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng, Technique technique) const {
  Rgb sum;
  add_rest(wi, {&wo, 1}, rng, {&sum, 1}, technique);
  return sum;
}

void Pfmc::add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums,
                    Technique technique) const {
  if (wi.z <= 0) return;
  if (layers_.opaque && !general_.multiple) return;
  if (family_ != Family::plain) return add_general_rest(wi, wo, rng, sums, technique);
  const std::size_t chunk = technique == Technique::unidirectional ? kChunk : 1;
  for (std::size_t first = 0; first < wo.size(); first += chunk) {
    const std::size_t exits = std::min(chunk, wo.size() - first);
    double cosines[kChunk], values[kChunk * kMostWavelengths];
    for (std::size_t k = 0; k < exits; ++k) cosines[k] = wo[first + k].z > 0 ? wo[first + k].z : 1;
    std::fill_n(values, exits * layers_.count, 0.0);
    if (technique == Technique::unidirectional)
      kernels_->unidirectional(layers_, wi.z, cosines, static_cast<int>(exits), rng, values);
    else
      kernels_->bidirectional(layers_, wi.z, cosines[0], rng, values);
    for (std::size_t k = 0; k < exits; ++k)
      if (wo[first + k].z > 0) sums[first + k] += fold(values + k * layers_.count);
  }
}

walk::GeneralWalk Pfmc::general_walk(walk::Carrying carrying) const {
  return {layers_, general_, importance_.data(), *kernels_, carrying};
}

void Pfmc::add_general_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums,
                            Technique technique) const {
  const walk::GeneralWalk walks = general_walk(walk::Carrying::power);
  constexpr std::size_t kMost = walk::GeneralWalk::kMostExits;
  for (std::size_t first = 0; first < wo.size(); first += kMost) {
    const std::size_t exits = std::min(kMost, wo.size() - first);
    Vec3 open[walk::GeneralWalk::kMostExits];
    double values[walk::GeneralWalk::kMostExits * kMostWavelengths];
    for (std::size_t k = 0; k < exits; ++k) open[k] = wo[first + k].z > 0 ? wo[first + k] : Vec3{0, 0, 1};
    std::fill_n(values, exits * layers_.count, 0.0);
    if (layers_.opaque)
      walks.add_facets(wi, open, static_cast<int>(exits), rng, values);
    else if (family_ == Family::facets)
      add_facets_rest(wi, open, static_cast<int>(exits), rng, values);
    else if (technique == Technique::unidirectional)
      walks.add_unidirectional(wi, open, static_cast<int>(exits), rng, values);
    else
      walks.add_bidirectional(wi, open, static_cast<int>(exits), rng, values);
    for (std::size_t k = 0; k < exits; ++k)
      if (wo[first + k].z > 0) sums[first + k] += fold(values + k * layers_.count);
  }
}

void Pfmc::add_facets_rest(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* values) const {
  double cosines[walk::GeneralWalk::kMostExits];
  for (int k = 0; k < exits; ++k) cosines[k] = wo[k].z;
  kernels_->multiple_facets(layers_, wi.z, cosines, exits, rng, values);
  general_walk(walk::Carrying::power).add_facets(wi, wo, exits, rng, values);
}

std::optional<BsdfSample> Pfmc::sample_general(const Vec3& wo, Rng& rng, const Pfmc& below) const {
  Powers power;
  const walk::GeneralSample s = below.general_walk(walk::Carrying::power).sample(wo, power, rng);
  if (s.is_lost) return {};
  if (s.is_first)
    return BsdfSample{s.wi, film_reflectance(s.facet_cosine) * s.weight, layers_.is_smooth(), 0};
  return BsdfSample{s.wi, below.fold(power.data()), false, 0};
}

// Reciprocity of the chances turns leaving along wi into entering there, as for powers.
double Pfmc::estimate_general_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  double density = 0;
  const walk::GeneralWalk chances = general_walk(walk::Carrying::chance);
  if (general_.slab.scatters())
    chances.add_bidirectional(wo, &wi, 1, rng, &density);
  else
    chances.add_unidirectional(wo, &wi, 1, rng, &density);
  return density * wi.z;
}

std::optional<BsdfSample> Pfmc::sample(const Vec3& wo, Rng& rng, const Pfmc& below) const {
  if (wo.z <= 0) return {};
  return family_ == Family::plain ? sample_plain(wo, rng, below) : sample_general(wo, rng, below);
}

double Pfmc::estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng, const Pfmc& below) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  if (family_ == Family::plain) return estimate_plain_pdf(wo, wi, rng, below);
  return below.first_pdf(wo, wi) + below.estimate_general_pdf(wo, wi, rng);
}

}  // namespace sunbeam
