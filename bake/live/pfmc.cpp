#include "bake/live/pfmc.h"

namespace sunbeam {
namespace {

using Lane = walk::Events<double>;

constexpr std::size_t kChunk = 32;  // directions that share one walk; their sums are on the stack

// A direction at this cosine, its azimuth uniform.
Vec3 any_azimuth(double cosine, Rng& rng) {
  const double turn = 2 * rng.uniform() - 1, sine = std::sqrt(std::max(0.0, 1 - square(cosine)));
  const double x = walk::cos_half_turn(std::abs(turn));
  return {sine * x, std::copysign(sine * std::sqrt(std::max(0.0, 1 - square(x))), turn), cosine};
}

// The facet in w's frame, on either side of the plane of w and the macro normal.
Vec3 facet_normal(const Vec3& w, const Lane::Normal& facet, Rng& rng) {
  const double across2 = 1 - square(facet.along) - square(facet.cos_h);
  const double across = std::copysign(std::sqrt(std::max(0.0, across2)), rng.uniform() - 0.5);
  const double sine = std::sqrt(w.x * w.x + w.y * w.y);
  const double x = sine > 0 ? w.x / sine : 1, y = sine > 0 ? w.y / sine : 0;
  return {x * facet.along - y * across, y * facet.along + x * across, facet.cos_h};
}

}  // namespace

Pfmc::Pfmc(const Material& material, const Wavelengths& wavelengths, const walk::Kernels& kernels)
    : layers_(material, wavelengths),
      stack_(material),
      family_(family_of(material)),
      weight_{},
      importance_{},
      ggx_(material.roughness),
      kernels_(&kernels) {
  double sum = 0;
  for (int k = 0; k < layers_.count; ++k) {
    weight_[k] = wavelengths.weight[k];
    importance_[k] = mean(transform(weight_[k], [](double w) { return std::abs(w); }));
    sum += importance_[k];
  }
  for (int k = 0; k < layers_.count; ++k) importance_[k] /= sum;
  if (family_ == Family::facets) forecast_visits();
}

Pfmc::Family Pfmc::family_of(const Material& material) {
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

double Pfmc::mean_power(const Powers& powers) const {
  double sum = 0;
  for (int k = 0; k < layers_.count; ++k) sum += importance_[k] * powers[k];
  return std::clamp(sum, 0.0, 1.0);
}

Pfmc::Powers Pfmc::reflectances(const walk::FilmSide& film, double cosine) const {
  Powers powers;
  const walk::FilmPackets<double> lanes(film, layers_.phases, std::clamp(cosine, 0.0, 1.0));
  lanes.reflectances([&](int k, double r) { powers[k] = r; });
  return powers;
}

Rgb Pfmc::film_reflectance(double cos_exterior) const {
  return fold(reflectances(layers_.film, cos_exterior).data());
}

Rgb Pfmc::first(const Vec3& wo, const Vec3& wi) const {
  if (layers_.is_smooth() || wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection(wo, wi, h) * film_reflectance(dot(wo, h));
}

Rgb Pfmc::dirac(const Vec3& wo) const { return layers_.is_smooth() ? film_reflectance(wo.z) : Rgb(); }

double Pfmc::mean_reflectance(double cos_exterior) const {
  return mean_power(reflectances(layers_.film, cos_exterior));
}

double Pfmc::reflect_chance(double cos_exterior) const {
  return layers_.entry_chance(mean_reflectance(cos_exterior));
}

double Pfmc::leaving_shape(double cos_exterior) const {
  if (family_ != Family::plain) return cos_exterior;
  const double below2 = 1 - square(layers_.index_ratio) * (1 - square(cos_exterior));
  if (below2 <= 0) return 0;
  return (1 - mean_reflectance(cos_exterior)) * layers_.open_guide.density(below2) * cos_exterior;
}

double Pfmc::first_pdf(const Vec3& wo, const Vec3& wi) const {
  if (layers_.is_smooth() || wo.z <= 0 || wi.z <= 0) return 0;
  const Vec3 h = normalize(wo + wi);
  const double escapes = stack_.multiple ? ggx_.g2_over_g1(wo, wi) : 1;
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
  if (family_ != Family::plain) return add_stack_rest(wi, wo, rng, sums, technique);
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

walk::Stack Pfmc::stack(walk::Carrying carrying) const {
  return {layers_, stack_, importance_.data(), *kernels_, carrying};
}

void Pfmc::add_stack_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums,
                          Technique technique) const {
  const walk::Stack stack = this->stack(walk::Carrying::power);
  constexpr std::size_t kMost = walk::Stack::kMostExits;
  for (std::size_t first = 0; first < wo.size(); first += kMost) {
    const std::size_t exits = std::min(kMost, wo.size() - first);
    Vec3 open[walk::Stack::kMostExits];
    double values[walk::Stack::kMostExits * kMostWavelengths];
    for (std::size_t k = 0; k < exits; ++k) open[k] = wo[first + k].z > 0 ? wo[first + k] : Vec3{0, 0, 1};
    std::fill_n(values, exits * layers_.count, 0.0);
    if (family_ == Family::facets)
      add_facets_rest(wi, open, static_cast<int>(exits), rng, values);
    else if (technique == Technique::unidirectional)
      stack.add_unidirectional(wi, open, static_cast<int>(exits), rng, values);
    else
      stack.add_bidirectional(wi, open, static_cast<int>(exits), rng, values);
    for (std::size_t k = 0; k < exits; ++k)
      if (wo[first + k].z > 0) sums[first + k] += fold(values + k * layers_.count);
  }
}

void Pfmc::add_facets_rest(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* values) const {
  double cosines[walk::Stack::kMostExits];
  for (int k = 0; k < exits; ++k) cosines[k] = wo[k].z;
  kernels_->multiple_facets(layers_, wi.z, cosines, exits, rng, values);
  stack(walk::Carrying::power).add_facets(wi, wo, exits, rng, values);
}

std::optional<BsdfSample> Pfmc::sample_stack(const Vec3& wo, Rng& rng, const Pfmc& below) const {
  Powers power;
  const walk::StackSample s = below.stack(walk::Carrying::power).sample(wo, power, rng);
  if (s.is_lost) return {};
  if (s.is_first)
    return BsdfSample{s.wi, film_reflectance(s.facet_cosine) * s.weight, layers_.is_smooth(), 0};
  return BsdfSample{s.wi, below.fold(power.data()), false, 0};
}

// Reciprocity of the chances turns leaving along wi into entering there, as for powers.
double Pfmc::estimate_stack_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  double density = 0;
  const walk::Stack chances = stack(walk::Carrying::chance);
  if (stack_.slab.scatters())
    chances.add_bidirectional(wo, &wi, 1, rng, &density);
  else
    chances.add_unidirectional(wo, &wi, 1, rng, &density);
  return density * wi.z;
}

std::optional<BsdfSample> Pfmc::sample(const Vec3& wo, Rng& rng, const Pfmc& below) const {
  if (wo.z <= 0) return {};
  if (family_ != Family::plain) return sample_stack(wo, rng, below);
  const Lane events(layers_);
  const auto facet = events.meet(wo.z, rng);
  const Powers power = reflectances(layers_.film, facet.cosine);
  const double reflect_chance = layers_.entry_chance(mean_power(power));
  if (rng.uniform() < reflect_chance) {
    const auto up = events.mirror(wo.z, facet);
    if (up.weight == 0) return {};
    return BsdfSample{reflect(wo, facet_normal(wo, facet, rng)),
                      fold(power.data()) * (up.weight / reflect_chance), layers_.is_smooth(), 0};
  }
  const auto crossing = events.cross(wo.z, facet, layers_.index_ratio);
  if (crossing.weight == 0) return {};
  const double share = crossing.weight / (1 - reflect_chance);
  Powers entered = &below == this ? power : below.reflectances(layers_.film, facet.cosine);
  for (int k = 0; k < below.layers_.count; ++k) entered[k] = (1 - entered[k]) * share;
  return below.sample_below(crossing.cosine, entered, rng);
}

// A walk that reaches the base at `cosine`.
std::optional<BsdfSample> Pfmc::sample_below(double cosine, Powers& throughput, Rng& rng) const {
  const Lane events(layers_);
  for (;;) {
    const auto up = events.leave_base(layers_.open_guide, rng);
    const double path = layers_.product ? 1 / (cosine * up.cosine) : 1 / cosine + 1 / up.cosine;
    for (int k = 0; k < layers_.count; ++k) throughput[k] *= layers_.albedo[k] * up.share;
    events.attenuate(path, throughput);

    const auto facet = events.meet(up.cosine, rng);
    const Powers power = reflectances(layers_.film_below, facet.cosine);
    const double reflect_chance = mean_power(power);
    if (rng.uniform() >= reflect_chance) {
      const auto out = events.cross(up.cosine, facet, 1 / layers_.index_ratio);
      if (out.weight == 0) return {};
      const double share = out.weight / (1 - reflect_chance);
      for (int k = 0; k < layers_.count; ++k) throughput[k] *= (1 - power[k]) * share;
      return BsdfSample{any_azimuth(out.cosine, rng), fold(throughput.data()), false, 0};
    }
    const auto down = events.mirror(up.cosine, facet);
    if (down.weight == 0) return {};
    for (int k = 0; k < layers_.count; ++k) throughput[k] *= power[k] * (down.weight / reflect_chance);
    cosine = down.cosine;
  }
}

// Density that a walk on its way up leaves along wi, over that of the direction inside, which is returned in
// `cosine`.
double Pfmc::leave_pdf(const Vec3& wi, Rng& rng, double& cosine) const {
  const Lane events(layers_);
  const auto facet = events.meet(wi.z, rng);
  const auto crossing = events.cross(wi.z, facet, layers_.index_ratio);
  cosine = crossing.cosine;
  if (crossing.weight == 0) return 0;
  const double pass_chance = 1 - mean_reflectance(facet.cosine);
  if (!layers_.bends) return pass_chance;
  const double solid_angles = square(layers_.index_ratio) * wi.z / cosine;
  return pass_chance * solid_angles * events.g1_ratio(cosine, wi.z);
}

double Pfmc::estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng, const Pfmc& below) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  if (family_ != Family::plain) return below.first_pdf(wo, wi) + below.estimate_stack_pdf(wo, wi, rng);
  const Lane events(layers_);
  const auto facet = events.meet(wo.z, rng);
  const auto crossing = events.cross(wo.z, facet, layers_.index_ratio);
  const double first = first_pdf(wo, wi);
  if (crossing.weight == 0) return first;
  return first + (1 - reflect_chance(facet.cosine)) * below.pdf_below(wi, rng);
}

// Of a walk below the film. The base's guide asks for no direction of arrival.
double Pfmc::pdf_below(const Vec3& wi, Rng& rng) const {
  const Lane events(layers_);
  double pdf = 0;
  for (;;) {
    double cosine;
    const double leave = leave_pdf(wi, rng, cosine);
    pdf += leave * layers_.open_guide.density(square(cosine)) * cosine * kInvPi;
    const auto up = events.leave_base(layers_.open_guide, rng);
    const auto facet = events.meet(up.cosine, rng);
    if (events.mirror(up.cosine, facet).weight == 0) return pdf;
    if (rng.uniform() >= mean_power(reflectances(layers_.film_below, facet.cosine))) return pdf;
  }
}

}  // namespace sunbeam
