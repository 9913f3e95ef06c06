#include "bake/live/pfmc.h"

namespace sunbeam {
namespace {

// Russian roulette starts when the film and the albedo together have left less than this of a walk. It looks
// at neither absorption nor base sampling: with the product path later visits can outweigh the first.
constexpr double kRouletteStart = 0.02;

}  // namespace

PfmcOfThree::PfmcOfThree(const Material& material, const Rgb& wavelengths_nm, const Rgb& absorption)
    : film_(material, wavelengths_nm),
      base_(material, absorption),
      radiance_scale_(material.radiance_scale()),
      brightest_albedo_(max_component(material.albedo)) {}

Rgb PfmcOfThree::estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  Rgb sum;
  add_rest(wi, {&wo, 1}, rng, {&sum, 1});
  return sum;
}

void PfmcOfThree::add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums) const {
  const auto entry = film_.cross(wi, film_.meet_from_outside(wi, rng));
  if (!entry) return;
  Vec3 m = entry->inside;
  Rgb throughput = entry->weight;
  double roulette = 1;
  do connect(m, throughput, wo, rng, sums);
  while (next_visit(m, throughput, roulette, rng, wo, sums));
}

// The base sends what arrives along m to every wo, through a passage drawn from that wo.
void PfmcOfThree::connect(const Vec3& m, const Rgb& throughput, std::span<const Vec3> wo, Rng& rng,
                          std::span<Rgb> sums) const {
  for (std::size_t k = 0; k < wo.size(); ++k) {
    const auto passage = film_.cross(wo[k], film_.meet_from_outside(wo[k], rng));
    if (!passage) continue;
    const double mis = passage->density > 0
                           ? passage->density / (passage->density + base_.density(m.z, passage->inside.z))
                           : 1;
    sums[k] += throughput * base_.value(m.z, passage->inside.z) * passage->weight * (mis * radiance_scale_);
  }
}

// The direction the walk itself takes from the base passes the film to every wo.
void PfmcOfThree::connect_own(const Vec3& m, const Rgb& throughput, double density, std::span<const Vec3> wo,
                              std::span<Rgb> sums) const {
  for (std::size_t k = 0; k < wo.size(); ++k) {
    const Exit exit = film_.exit(m, wo[k]);
    sums[k] += throughput * exit.value * (density / (density + exit.density));
  }
}

// From the base up to the film and back down. False when the walk ends.
bool PfmcOfThree::next_visit(Vec3& m, Rgb& throughput, double& roulette, Rng& rng, std::span<const Vec3> wo,
                             std::span<Rgb> sums) const {
  const auto up = base_.sample(m.z, rng);
  throughput *= up.weight;
  if (is_black(throughput)) return false;
  if (film_.has_glossy_crossing()) connect_own(up.direction, throughput, up.density, wo, sums);

  const Facet facet = film_.meet_from_below(up.direction, rng);
  const auto down = film_.reflect_down(up.direction, facet);
  if (!down) return false;
  m = down->direction;
  throughput *= down->weight;

  roulette *= brightest_albedo_ * max_component(down->weight);
  if (roulette >= kRouletteStart) return true;
  const double survival = roulette / kRouletteStart;
  if (rng.uniform() >= survival) return false;
  throughput *= 1 / survival;
  roulette = kRouletteStart;
  return true;
}

std::optional<BsdfSample> PfmcOfThree::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const Facet entry = film_.meet_from_outside(wo, rng);
  if (rng.uniform() < entry.reflect_chance) {
    const auto up = film_.reflect_up(wo, entry);
    if (!up) return {};
    return BsdfSample{up->direction, up->weight / entry.reflect_chance, film_.is_smooth()};
  }
  const auto passage = film_.cross(wo, entry);
  if (!passage) return {};
  Vec3 m = passage->inside;
  Rgb throughput = passage->weight / (1 - entry.reflect_chance);
  for (;;) {
    const auto up = base_.sample(m.z, rng);
    throughput *= up.weight;
    const Facet facet = film_.meet_from_below(up.direction, rng);
    if (rng.uniform() >= facet.reflect_chance) {
      const auto out = film_.leave(up.direction, facet);
      if (!out) return {};
      return BsdfSample{out->direction, throughput * out->weight / (1 - facet.reflect_chance), false};
    }
    const auto down = film_.reflect_down(up.direction, facet);
    if (!down) return {};
    m = down->direction;
    throughput *= down->weight / facet.reflect_chance;
  }
}

// Density that a walk leaving the base, having arrived at cos_in, goes out along wi at this visit.
double PfmcOfThree::connect_density(double cos_in, const Vec3& wi, Rng& rng) const {
  const Facet facet = film_.meet_from_outside(wi, rng);
  const auto passage = film_.cross(wi, facet);
  if (!passage) return 0;
  return base_.density(cos_in, passage->inside.z) * (1 - facet.reflect_chance) * passage->reverse_ratio;
}

double PfmcOfThree::estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  double pdf = film_.first_surface_pdf(wo, wi);
  const Facet entry = film_.meet_from_outside(wo, rng);
  const auto passage = film_.cross(wo, entry);
  if (!passage) return pdf;
  Vec3 m = passage->inside;
  double chance = 1 - entry.reflect_chance;
  for (;;) {
    pdf += chance * connect_density(m.z, wi, rng);
    const auto up = base_.sample(m.z, rng);
    const Facet facet = film_.meet_from_below(up.direction, rng);
    const auto down = film_.reflect_down(up.direction, facet);
    if (!down || rng.uniform() >= facet.reflect_chance) return pdf;
    m = down->direction;
  }
}

Pfmc::Pfmc(const Material& material, Wavelengths w) : smooth_(material.is_smooth()) {
  for (std::size_t k = 0; k < w.size(); k += 3) {
    Rgb nm, albedo, absorption, weights[3];
    for (int i = 0; i < 3; ++i) {
      const std::size_t at = std::min(k + i, w.size() - 1);
      nm[i] = w.nm[at], albedo[i] = w.albedo[at], absorption[i] = w.absorption[at];
      if (k + i < w.size()) weights[i] = w.weight[at];
    }
    Material three = material;
    three.albedo = albedo;
    groups_.push_back({PfmcOfThree(three, nm, absorption), {weights[0], weights[1], weights[2]}});
  }
}

Rgb Pfmc::first(const Vec3& wo, const Vec3& wi) const {
  Rgb sum;
  for (const Group& g : groups_) sum += g.fold(g.walk.first(wo, wi));
  return sum;
}

double Pfmc::first_pdf(const Vec3& wo, const Vec3& wi) const {
  double sum = 0;
  for (const Group& g : groups_) sum += g.walk.film().first_surface_pdf(wo, wi);
  return sum / static_cast<double>(groups_.size());
}

Rgb Pfmc::film_reflectance(double cos_exterior) const {
  Rgb sum;
  for (const Group& g : groups_) sum += g.fold(g.walk.film().power(cos_exterior).reflectance);
  return sum;
}

void Pfmc::add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums) const {
  std::vector<Rgb> values(wo.size());
  for (const Group& g : groups_) {
    std::fill(values.begin(), values.end(), Rgb());
    g.walk.add_rest(wi, wo, rng, values);
    for (std::size_t k = 0; k < wo.size(); ++k) sums[k] += g.fold(values[k]);
  }
}

Rgb Pfmc::estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  Rgb sum;
  add_rest(wi, {&wo, 1}, rng, {&sum, 1});
  return sum;
}

std::optional<BsdfSample> Pfmc::sample(const Vec3& wo, Rng& rng) const {
  const std::size_t count = groups_.size();
  const Group& g =
      groups_[count == 1 ? 0
                         : std::min(count - 1,
                                    static_cast<std::size_t>(rng.uniform() * static_cast<double>(count)))];
  auto sample = g.walk.sample(wo, rng);
  if (sample) sample->throughput = g.fold(sample->throughput) * static_cast<double>(count);
  return sample;
}

double Pfmc::estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  double sum = 0;
  for (const Group& g : groups_) sum += g.walk.estimate_pdf(wo, wi, rng);
  return sum / static_cast<double>(groups_.size());
}

}  // namespace sunbeam
