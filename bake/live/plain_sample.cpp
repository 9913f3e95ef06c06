// Pfmc's sample and pdf over plain materials: one scalar walk in polar cosines, azimuths drawn at its ends.
#include "bake/live/pfmc.h"

namespace sunbeam {
namespace {

using Lane = walk::Events<double>;

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

std::optional<BsdfSample> Pfmc::sample_plain(const Vec3& wo, Rng& rng, const Pfmc& below) const {
  const Lane events(layers_);
  const auto facet = events.meet(wo.z, rng);
  const FilmPowers film = film_at(sunbeam::Side::outside, facet.cosine);
  const double reflect_chance = layers_.entry_chance(importance_.data(), film);
  if (rng.uniform() < reflect_chance) {
    const auto up = events.mirror(wo.z, facet);
    if (up.weight == 0) return {};
    return BsdfSample{reflect(wo, facet_normal(wo, facet, rng)),
                      fold(film.reflectance.data()) * (up.weight / reflect_chance), layers_.is_smooth(), 0};
  }
  const auto crossing = events.cross(wo.z, facet, layers_.index_ratio);
  if (crossing.weight == 0) return {};
  const double share = crossing.weight / (1 - reflect_chance);
  const auto go_on = [&](const FilmPowers& entering) {
    Powers throughput;
    for (int k = 0; k < below.layers_.count; ++k) throughput[k] = entering.transmittance[k] * share;
    return below.sample_below(crossing.cosine, throughput, rng);
  };
  return &below == this ? go_on(film) : go_on(below.film_at(sunbeam::Side::outside, facet.cosine));
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
    const FilmPowers film = film_at(sunbeam::Side::inside, facet.cosine);
    const double reflect_chance = layers_.mirror_chance(importance_.data(), film);
    if (rng.uniform() >= reflect_chance) {
      const auto out = events.cross(up.cosine, facet, 1 / layers_.index_ratio);
      if (out.weight == 0) return {};
      const double share = out.weight / (1 - reflect_chance);
      for (int k = 0; k < layers_.count; ++k) throughput[k] *= film.transmittance[k] * share;
      return BsdfSample{any_azimuth(out.cosine, rng), fold(throughput.data()), false, 0};
    }
    const auto down = events.mirror(up.cosine, facet);
    if (down.weight == 0) return {};
    for (int k = 0; k < layers_.count; ++k)
      throughput[k] *= film.reflectance[k] * (down.weight / reflect_chance);
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
  const double pass_chance =
      1 - layers_.mirror_chance(importance_.data(), film_at(sunbeam::Side::outside, facet.cosine));
  if (!layers_.bends) return pass_chance;
  const double solid_angles = square(layers_.index_ratio) * wi.z / cosine;
  return pass_chance * solid_angles * events.g1_ratio(cosine, wi.z);
}

double Pfmc::estimate_plain_pdf(const Vec3& wo, const Vec3& wi, Rng& rng, const Pfmc& below) const {
  const Lane events(layers_);
  const auto facet = events.meet(wo.z, rng);
  const auto crossing = events.cross(wo.z, facet, layers_.index_ratio);
  const double first = first_pdf(wo, wi);
  if (crossing.weight == 0) return first;
  const double enters = 1 - reflect_chance(facet.cosine);
  if (!layers_.is_layered()) return first + enters * below.pdf_below(wi, rng);
  // What a dark film lets in it seldom lets out. Such walks are taken no more often than sample() takes them.
  return rng.uniform() < enters ? first + below.pdf_below(wi, rng) : first;
}

// Density of where a walk below the film leaves. The base's guide asks for no direction of arrival.
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
    const FilmPowers film = film_at(sunbeam::Side::inside, facet.cosine);
    if (rng.uniform() >= layers_.mirror_chance(importance_.data(), film)) return pdf;
  }
}

}  // namespace sunbeam
