#include "sunbeam/table_bsdf.h"

#include <functional>
#include <variant>

#include "bound_rest.h"
#include "dense_rest.h"
#include "first_sampler.h"
#include "rest_sampler.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"
#include "sunbeam/ggx.h"

namespace sunbeam {
namespace {

constexpr int kFilmNodes = 1025;          // over even cosines
constexpr int kViewerAzimuths = 4;        // of wo in a quadrant, which sampling data are averaged over
constexpr int kNormalNodes = 96;          // quadrature over visible normals, each way, for an albedo
constexpr int kSamplingNormalNodes = 16;  // the same for the chance of sampling the first surface
constexpr int kAlbedoBins = 32;
constexpr int kRestAzimuths = 8;  // of an anisotropic factored table, in a quadrant

Parameters checked(const Table& table, const Parameters& parameters, OutsideGrid outside) {
  auto values = parameters.values();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Axis& axis = table.parameter_axis(k);
    const double inside = std::clamp(values[k], axis.low(), axis.high());
    if (inside != values[k] && outside == OutsideGrid::refuse)
      throw Error("key '" + axis.name + "': found " + to_text(values[k]) + "; the table holds " +
                  to_text(axis.low()) + " to " + to_text(axis.high()));
    values[k] = inside;
  }
  return {values[0], values[1], values[2]};
}

// Mean of the rest over the azimuth of wi.
class FactoredAzimuthMean {
 public:
  FactoredAzimuthMean(const BoundRest& rest, const Vec3& wo, Symmetry symmetry)
      : rest_(rest), wo_(wo), azimuths_(symmetry == Symmetry::isotropic ? 1 : kRestAzimuths) {}
  Rgb operator()(double cos_i) const {
    Rgb sum;
    for (int a = 0; a < azimuths_; ++a)
      sum += to_rgb(rest_(wo_, direction_from_cosine(cos_i, kPi / 2 * (a + 0.5) / azimuths_)));
    return sum / azimuths_;
  }

 private:
  const BoundRest& rest_;
  Vec3 wo_;
  int azimuths_;
};

}  // namespace

// What of GGX does not depend on directions, in floats.
struct FloatGgx {
  explicit FloatGgx(const Roughness& roughness)
      : u2(static_cast<float>(square(roughness.u))),
        v2(static_cast<float>(square(roughness.v))),
        uv3_per_pi(
            static_cast<float>(square(roughness.u * roughness.v) * roughness.u * roughness.v * kInvPi)),
        least_alpha2(std::min(u2, v2)),
        alpha(static_cast<float>(roughness.u)) {}

  float root_squared(const Vec3& w) const {
    const auto x = static_cast<float>(w.x), y = static_cast<float>(w.y), z = static_cast<float>(w.z);
    return z * z + u2 * x * x + v2 * y * y;
  }
  float form(const Vec3& h) const {
    const auto x = static_cast<float>(h.x), y = static_cast<float>(h.y), z = static_cast<float>(h.z);
    return u2 * v2 * z * z + v2 * x * x + u2 * y * y;
  }

  float u2, v2, uv3_per_pi, least_alpha2, alpha;
};

struct BoundTable {
  BoundTable(const Table& table, const Material& at);

  struct Parts {
    Color4 first, rest;
    float pdf;
  };
  Parts parts(const Vec3& wo, const Vec3& wi) const;
  float cell_density(const EvenPosition& viewer, const Vec3& wo, const Vec3& h, float r, float per_q,
                     float per_height) const;
  double add_first_row(const Vec3& wo);
  Point2 draw_normal(const EvenPosition& viewer, Rng& rng) const {
    return has_cells() ? first_sampler.sample(viewer, rng) : Point2{rng.uniform(), rng.uniform()};
  }

  void eval_span(const BoundRest& factored, const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const;
  bool has_cells() const { return ggx.u2 == ggx.v2; }
  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  Color4 rest_at(const Vec3& wo, const Vec3& wi, const BoundRest::Cosine& o,
                 const BoundRest::Cosine& i) const;
  Rgb film_reflectance(double cosine) const;
  Color4 film_at(float cosine) const {
    return sunbeam::lerp(film.data(), EvenPosition(std::min(cosine, 1.0f), kFilmNodes));
  }
  Rgb first_albedo(const Vec3& wo, int nodes) const;
  Rgb rest_albedo(const Vec3& wo) const;
  void prepare_sampling();
  void visit_azimuth_mean(const Vec3& wo,
                          const std::function<void(const std::function<Rgb(double)>&)>& visit) const;

  Material material;
  Symmetry symmetry;
  double noise = 0;  // relative standard error of a factored rest
  Ggx normals;
  FloatGgx ggx;
  bool smooth;
  std::variant<std::monostate, DenseRest, BoundRest> rest_;
  std::vector<Color4> film;
  RestSampler sampler;
  FirstSampler first_sampler;  // an isotropic rough film's
};

BoundTable::BoundTable(const Table& table, const Material& at)
    : material(at),
      symmetry(table.symmetry),
      normals(at.roughness),
      ggx(at.roughness),
      smooth(at.is_smooth()),
      film(kFilmNodes) {
  const auto cosine_of = [](int node) { return static_cast<double>(node) / (kFilmNodes - 1); };
  if (table.is_factored()) {
    const FactoredRest factored(table, material);
    std::vector<float> cosines(kFilmNodes);
    std::vector<FloatRgb> folded(kFilmNodes);
    for (int i = 0; i < kFilmNodes; ++i) cosines[i] = static_cast<float>(cosine_of(i));
    factored.film().fold(material.film_thickness_nm, material.base_ior, cosines, folded.data());
    for (int i = 0; i < kFilmNodes; ++i) film[i] = Color4{folded[i].r, folded[i].g, folded[i].b, 0};
    rest_.emplace<BoundRest>(factored, symmetry);
    if (const auto known = table.info.find("noise"); known != table.info.end())
      parse_number(known->second, noise);
  } else {
    rest_.emplace<DenseRest>(table, material);
    for (int i = 0; i < kFilmNodes; ++i)
      film[i] = to_color4(table.film_reflectance.interpolate(
          std::array{material.film_thickness_nm, material.base_ior, cosine_of(i)}));
  }
  prepare_sampling();
}

Rgb BoundTable::rest(const Vec3& wo, const Vec3& wi) const {
  if (const auto* factored = std::get_if<BoundRest>(&rest_)) return to_rgb((*factored)(wo, wi));
  return std::get<DenseRest>(rest_)(wo, wi);
}

inline Color4 BoundTable::rest_at(const Vec3& wo, const Vec3& wi, const BoundRest::Cosine& o,
                                  const BoundRest::Cosine& i) const {
  if (const auto* factored = std::get_if<BoundRest>(&rest_)) [[likely]]
    return (*factored)(wo, wi, o, i);
  return to_color4(rest(wo, wi));
}

Rgb BoundTable::film_reflectance(double cosine) const {
  return to_rgb(film_at(static_cast<float>(std::max(cosine, 0.0))));
}

// Density over FirstSampler's square of drawing the normal along h. In the space stretched to roughness 1
// normals mirror w' = (a w.x, a w.y, w.z) / r to the cap; here all lengths are times r.
inline float BoundTable::cell_density(const EvenPosition& viewer, const Vec3& wo, const Vec3& h, float r,
                                      float per_q, float per_height) const {
  const float a = ggx.alpha;
  const auto ox = static_cast<float>(wo.x), oy = static_cast<float>(wo.y), oz = static_cast<float>(wo.z);
  const auto hx = static_cast<float>(h.x), hy = static_cast<float>(h.y), hz = a * static_cast<float>(h.z);
  const float twice = 2 * (a * (ox * hx + oy * hy) + oz * hz) * ggx.u2 * per_q;
  const float x = twice * hx - a * ox, y = twice * hy - a * oy, z = twice * hz - oz;
  return first_sampler.density(viewer, x * ox + y * oy, (x * x + y * y) * (ox * ox + oy * oy),
                               (r - z) * per_height);
}

// The lobe of ggx.h and its bounded density, with h = wo + wi not normalised and all roots and divisions four
// at a time: with l = |h|, q = D's quadratic form of h, r = cosine (1 + 2 Lambda), s = 1 + sin_o and a the
// lesser roughness,
//     D = uv3 l^4 / (pi q^2),  first = D R / (2 (r_o c_i + r_i c_o)),
//     pdf = D / (2 (k c_o + r_o)),  k = (1 - a^2) s^2 / (s^2 + a^2 c_o^2).
BoundTable::Parts BoundTable::parts(const Vec3& wo, const Vec3& wi) const {
  const auto c_o = static_cast<float>(wo.z), c_i = static_cast<float>(wi.z);
  const Color4 roots = sqrt4(Color4{c_o, c_i, ggx.root_squared(wo), ggx.root_squared(wi)});
  const BoundRest::Cosine o(c_o, roots[0]), i(c_i, roots[1]);
  const EvenPosition viewer = sampler.viewer(o.root);
  const float chance = sampler.first_chance(viewer);

  const Vec3 h = wo + wi;
  const float l2 = static_cast<float>(dot(h, h)), q = ggx.form(h);
  const Color4 more = sqrt4(Color4{l2, std::max(0.0f, 1 - c_o * c_o), 1, 1});
  const float s2 = (1 + more[1]) * (1 + more[1]), a2 = ggx.least_alpha2, bound = s2 + a2 * c_o * c_o;
  const float to_first = 2 * (roots[2] * c_i + roots[3] * c_o);
  const float to_pdf = 2 * ((1 - a2) * s2 * c_o + bound * roots[2]);
  const Color4 per = Color4{1, 1, 1, 1} / Color4{i.root, q * q, to_first, to_pdf};

  const Color4 rest = rest_at(wo, wi, o, i);
  const float rest_pdf = (1 - chance) * sampler.pdf(viewer, i.root, per[0]);
  if (smooth) return {Color4{}, rest, rest_pdf};
  const float d = ggx.uv3_per_pi * l2 * l2 * per[1];
  const Color4 first = (d * per[2]) * film_at(0.5f * more[0]);
  float first_pdf = d * bound * per[3];
  if (has_cells()) first_pdf *= cell_density(viewer, wo, h, roots[2], q * per[1], 2 * bound * per[3]);
  return {first, rest, rest_pdf + chance * first_pdf};
}

// Int f_first cos dwi by midpoints in the unit square of visible normals, which turns it into a mean of R
// G2/G1.
Rgb BoundTable::first_albedo(const Vec3& wo, int nodes) const {
  if (smooth) return film_reflectance(wo.z);
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

void BoundTable::visit_azimuth_mean(
    const Vec3& wo, const std::function<void(const std::function<Rgb(double)>&)>& visit) const {
  if (const auto* factored = std::get_if<BoundRest>(&rest_))
    visit(FactoredAzimuthMean(*factored, wo, symmetry));
  else
    visit(DenseRest::AzimuthMean(std::get<DenseRest>(rest_), wo));
}

// Int f_rest cos dwi by four-point Gauss-Legendre in each bin of cos(theta_i).
Rgb BoundTable::rest_albedo(const Vec3& wo) const {
  constexpr double kNode[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  constexpr double kWeight[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
  Rgb total;
  if (wo.z <= 0) return total;
  visit_azimuth_mean(wo, [&](const auto& mean_rest) {
    for (int bin = 0; bin < kAlbedoBins; ++bin)
      for (int g = 0; g < 4; ++g) {
        const double cos_i = (bin + kNode[g]) / kAlbedoBins;
        total += mean_rest(cos_i) * (kWeight[g] * cos_i * 2 * kPi / kAlbedoBins);
      }
  });
  return total;
}

// Adds the viewer's row and returns the albedo, both by midpoints in the cells: there f_first cos / density
// is R G2 / G1 times the bounded cap's share of the whole.
double BoundTable::add_first_row(const Vec3& wo) {
  constexpr int kTurnNodes = 1, kHeightNodes = 2;
  constexpr double kLeastShare =
      0.02;  // of the mean: neighbouring viewers may have light where this has none
  std::vector<double> power(FirstSampler::kCells);
  double albedo = 0;
  for (std::size_t cell = 0; cell < power.size(); ++cell)
    for (int k = 0; k < kTurnNodes * kHeightNodes; ++k) {
      const double turn =
          static_cast<double>(cell / FirstSampler::kHeights) + (k % kTurnNodes + 0.5) / kTurnNodes;
      const double height =
          static_cast<double>(cell % FirstSampler::kHeights) + (k / kTurnNodes + 0.5) / kHeightNodes;
      const Vec3 wi =
          normals.sample_mirrored(wo, {turn / (2 * FirstSampler::kTurns), height / FirstSampler::kHeights});
      if (wi.z <= 0) continue;
      const Vec3 h = normalize(wo + wi);
      const double weight = normals.reflection(wo, wi, h) * wi.z / normals.reflection_pdf_bounded(wo, h);
      power[cell] += std::max(0.0, mean(film_reflectance(dot(wo, h)))) * weight / (kTurnNodes * kHeightNodes);
    }
  for (const double p : power) albedo += p / FirstSampler::kCells;
  for (double& p : power) p = std::max(p, kLeastShare * albedo);
  first_sampler.add_row(power);
  return albedo;
}

// Densities follow the mean over channels, and over the viewer's azimuth.
void BoundTable::prepare_sampling() {
  const int azimuths = symmetry == Symmetry::anisotropic ? kViewerAzimuths : 1;
  for (int row = 0; row < RestSampler::kRows; ++row) {
    std::vector<double> density(RestSampler::kBins);
    const Vec3 in_plane = direction_from_cosine(RestSampler::cosine_of_row(row), 0);
    double of_first = !smooth && has_cells() ? azimuths * add_first_row(in_plane) : 0, of_rest = 0;
    for (int a = 0; a < azimuths; ++a) {
      const double phi = azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths;
      const Vec3 wo = direction_from_cosine(RestSampler::cosine_of_row(row), phi);
      if (smooth || !has_cells()) of_first += std::max(0.0, mean(first_albedo(wo, kSamplingNormalNodes)));
      visit_azimuth_mean(wo, [&](const auto& mean_rest) {
        for (int bin = 0; bin < RestSampler::kBins; ++bin) {
          const double root = RestSampler::middle_of_bin(bin), cos_i = root * root;
          // f cos dwi = f cos 2 pi dcos, dcos = 2 root droot.
          const double power = std::max(0.0, mean(mean_rest(cos_i)) * cos_i * 4 * kPi * root);
          density[static_cast<std::size_t>(bin)] += power;
          of_rest += power / RestSampler::kBins;
        }
      });
    }
    sampler.add_row(density, of_first + of_rest > 0 ? of_first / (of_first + of_rest) : 0.5);
  }
}

// parts() without what pdf needs, and with what the viewer decides done once.
void BoundTable::eval_span(const BoundRest& factored, const Vec3& wo, std::span<const Vec3> wi,
                           std::span<Rgb> f) const {
  const BoundRest::OfViewer rest_of(factored, BoundRest::Cosine(static_cast<float>(wo.z)));
  const auto c_o = static_cast<float>(wo.z);
  const float r_o = std::sqrt(ggx.root_squared(wo));
  for (std::size_t k = 0; k < wi.size(); ++k) {
    f[k] = {};
    if (wi[k].z <= 0) continue;
    const auto c_i = static_cast<float>(wi[k].z);
    const Vec3 h = wo + wi[k];
    const auto l2 = static_cast<float>(dot(h, h));
    const Color4 roots = sqrt4(Color4{c_i, ggx.root_squared(wi[k]), l2, 1});
    Color4 value = rest_of(BoundRest::Cosine(c_i, roots[0]));
    if (!smooth) {
      const float q = ggx.form(h);
      const float lobe = ggx.uv3_per_pi * l2 * l2 / (q * q * 2 * (r_o * c_i + roots[1] * c_o));
      value += lobe * film_at(0.5f * roots[2]);
    }
    f[k] = to_rgb(value);
  }
}

TableBsdf::TableBsdf(const Table& table, const Parameters& parameters, OutsideGrid outside)
    : bound_(std::make_shared<BoundTable>(table,
                                          checked(table, parameters, outside).applied_to(table.material))) {}

TableBsdf Table::bind(const Parameters& parameters, OutsideGrid outside) const {
  return TableBsdf(*this, parameters, outside);
}

const Material& TableBsdf::material() const { return bound_->material; }

Rgb TableBsdf::film_reflectance(double cosine) const { return bound_->film_reflectance(cosine); }

Rgb TableBsdf::dirac(const Vec3& wo) const {
  return bound_->smooth && wo.z > 0 ? bound_->film_reflectance(wo.z) : Rgb();
}

void TableBsdf::eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const {
  const auto* factored = std::get_if<BoundRest>(&bound_->rest_);
  if (wo.z > 0 && factored && factored->is_isotropic()) return bound_->eval_span(*factored, wo, wi, f);
  for (std::size_t k = 0; k < wi.size(); ++k) f[k] = eval_pdf(wo, wi[k]).f;
}

Rgb TableBsdf::first(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return to_rgb(bound_->parts(wo, wi).first);
}

Rgb TableBsdf::rest(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return bound_->rest(wo, wi);
}

Rgb TableBsdf::rest_stderr(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  if (const auto* dense = std::get_if<DenseRest>(&bound_->rest_)) return dense->standard_error(wo, wi);
  return transform(bound_->rest(wo, wi), [&](double x) { return std::abs(x) * bound_->noise; });
}

Rgb TableBsdf::albedo(const Vec3& wo) const {
  return bound_->first_albedo(wo, kNormalNodes) + bound_->rest_albedo(wo);
}

EvalPdf TableBsdf::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const auto parts = bound_->parts(wo, wi);
  return {to_rgb(parts.first + parts.rest), parts.pdf};
}

std::optional<BsdfSample> TableBsdf::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const BoundTable& b = *bound_;
  const EvenPosition viewer = b.sampler.viewer(std::sqrt(static_cast<float>(wo.z)));
  const double chance = b.sampler.first_chance(viewer);
  Vec3 wi;
  if (rng.uniform() < chance) {
    if (b.smooth) return BsdfSample{{-wo.x, -wo.y, wo.z}, b.film_reflectance(wo.z) / chance, true};
    wi = b.normals.sample_mirrored(wo, b.draw_normal(viewer, rng));
  } else {
    const double root = b.sampler.sample(viewer, rng);
    const double cosine = root * root, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Turn phi(rng.uniform());
    wi = {sine * phi.cosine, sine * phi.sine, cosine};
  }
  if (wi.z <= 0) return {};
  const EvalPdf at = eval_pdf(wo, wi);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false};
}

}  // namespace sunbeam
