#include "runtime/src/lookup/bound_table.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr int kNormalNodes = 96;  // of an albedo's quadrature over visible normals, each way

}  // namespace

BoundTable::BoundTable(const Table& table, const Material& material, const BindOptions& options)
    : values_(table, material, options),
      facets_(material.roughness),
      smooth_(material.is_smooth()),
      separable_(values_.is_separable()),
      least_(least_component(options.clip_negative)) {
  BoundSampling sampling(values_);
  cosine_rows_ = std::move(sampling.rest);
  facet_cells_ = std::move(sampling.first);
  fill_last_lanes(sampling);
}

void BoundTable::fill_last_lanes(const BoundSampling& sampling) {
  Separable& nodes = values_.separable;
  for (int k = 0; k < kScales; ++k) {
    const float cosine = static_cast<float>(k) / (kScales - 1);
    nodes.scales[k][3] = lerp(sampling.first_chances.data(), EvenPosition(std::sqrt(cosine), kRows));
  }
  const int roots = ratio_roots();
  const auto at = [roots](int root, int count) {
    return EvenPosition(static_cast<float>(root) / static_cast<float>(roots - 1), count);
  };
  for (int o = 0; o < roots; ++o)
    for (int i = 0; i < roots; ++i) {
      const EvenPosition row = at(o, kRows), light = at(i, CosineRows::kNodes);
      const float* densities = sampling.rest_densities.data() + row.lower * CosineRows::kNodes;
      const float low = lerp(densities, light), high = lerp(densities + CosineRows::kNodes, light);
      nodes.ratios[static_cast<std::size_t>(o * roots + i)][3] = low + row.upper_weight * (high - low);
    }
}

Rgb BoundTable::rest(const Vec3& wo, const Vec3& wi) const {
  return separable_ ? to_rgb(parts(wo, wi).rest) : values_.other_rest(wo, wi);
}

Rgb BoundTable::rest_stderr(const Vec3& wo, const Vec3& wi) const {
  if (const auto* dense = std::get_if<DenseRest>(&values_.other)) return dense->standard_error(wo, wi);
  return transform(rest(wo, wi), [&](double x) { return std::abs(x) * values_.noise; });
}

Rgb BoundTable::albedo(const Vec3& wo) const {
  return values_.first_albedo(wo, kNormalNodes) + values_.rest_albedo(wo);
}

// The chance first, and without a root: sample() waits for it.
inline BoundTable::Viewer::Viewer(const BoundTable& table, const Vec3& wo)
    : scale(table.values_.separable.scale(EvenPosition(std::min(static_cast<float>(wo.z), 1.0f), kScales))),
      facets(table.facets_, wo),
      ratios(std::min(facets.root, 1.0f), table.ratio_roots()),
      rows(std::min(facets.root, 1.0f), kRows),
      mixture(table.facet_cells_, rows) {}

// What eval_pdf() and sample() know of a light, which is above the horizon.
SUNBEAM_ALWAYS_INLINE BoundTable::Parts BoundTable::parts(const Viewer& viewer, const Vec3& wo,
                                                          const Vec3& wi) const {
  constexpr float kPerSolidAngle = static_cast<float>(kInvPi / 4);  // d(root) / d(cosine) / (2 pi)
  const FacetPair pair(facets_, viewer.facets, wo, wi);
  const Color4 last = last_nodes();
  const EvenPositions at(last * Color4{pair.cosine, pair.root, pair.half_cosine, 0}, last);
  const Color4 ratio = values_.separable.ratio(viewer.ratios, {at, 1});
  const float chance = viewer.first_chance();

  Parts parts{{}, {}, ratio[3] * (1 - chance) * kPerSolidAngle * pair.per_root, least_};
  parts.rest = separable_ ? separable_rest(viewer.scale, values_.separable.scale({at, 0}), ratio)
                          : to_color4(values_.other_rest(wo, wi));
  if (smooth_) return parts;
  parts.first = pair.lobe * values_.film.at({at, 2});
  parts.pdf += chance * pair.pdf * (has_cells() ? cell_density(viewer, pair) : 1);
  return parts;
}

inline float BoundTable::cell_density(const Viewer& viewer, const FacetPair& pair) const {
  return facet_cells_.density(viewer.mixture, FacetCells::cell(facets_.u, viewer.facets, pair));
}

BoundTable::Parts BoundTable::parts(const Vec3& wo, const Vec3& wi) const {
  return parts(Viewer(*this, wo), wo, wi);
}

EvalPdf BoundTable::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  return parts(Viewer(*this, wo), wo, wi).eval_pdf();
}

// The first number chooses the technique; what is left of it chooses the row. Visible normals come from
// FacetCells's square, or evenly.
SUNBEAM_ALWAYS_INLINE Vec3 BoundTable::draw(const Viewer& viewer, const Vec3& wo, const Random3& u) const {
  const float chance = viewer.first_chance(), upper = viewer.rows.upper_weight;
  const auto lot = static_cast<float>(u[0]);
  if (lot < chance) {
    const int row = viewer.rows.lower + (lot < chance * upper);
    const auto at = has_cells() ? facet_cells_.sample(row, u[1], u[2]) : FacetCells::even(u[1], u[2]);
    return viewer.facets.mirrored(facets_, wo, at.turn, at.height);
  }
  const int row = viewer.rows.lower + (lot - chance < (1 - chance) * upper);
  const auto drawn = cosine_rows_.draw(row, u[1]);
  const Color4* density = rest_density(row, static_cast<int>(drawn.bin));
  const double root{
      CosineRows::root(drawn, density[0][3], density[(ratio_roots() - 1) / CosineRows::kIntervals][3])};
  return at_azimuth(root * root, FloatTurn(u[2]));
}

double BoundTable::first_chance(const Vec3& wo) const { return double{Viewer(*this, wo).first_chance()}; }

BsdfSample BoundTable::mirrored(const Viewer& viewer, const Vec3& wo) const {
  return {{-wo.x, -wo.y, wo.z}, dirac(wo.z) / double{viewer.first_chance()}, true, 0};
}

std::optional<BsdfSample> BoundTable::sample(const Vec3& wo, const Random3& u) const {
  return sample(Viewer(*this, wo), wo, u);
}

SUNBEAM_ALWAYS_INLINE std::optional<BsdfSample> BoundTable::sample(const Viewer& viewer, const Vec3& wo,
                                                                   const Random3& u) const {
  if (smooth_ && static_cast<float>(u[0]) < viewer.first_chance()) return mirrored(viewer, wo);
  const Vec3 wi = draw(viewer, wo, u);
  if (wi.z <= 0) return {};
  return parts(viewer, wo, wi).sample(wi);
}

EvalAndSample BoundTable::eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u) const {
  const Viewer viewer(*this, wo);
  if (smooth_ && static_cast<float>(u[0]) < viewer.first_chance())
    return {parts(viewer, wo, wi).eval_pdf(), mirrored(viewer, wo)};
  const Vec3 drawn = draw(viewer, wo, u);  // first, so that a processor works on both directions at once
  const Parts lit = parts(viewer, wo, wi);
  if (drawn.z <= 0) return {lit.eval_pdf(), {}};
  return {lit.eval_pdf(), parts(viewer, wo, drawn).sample(drawn)};
}

// parts() without what pdf needs, of four lights. `ratios` is the viewer's row of Q times its S.
SUNBEAM_ALWAYS_INLINE void BoundTable::eval_four(const Viewer& viewer, const Color4* ratios, const Vec3& wo,
                                                 const Vec3* wi, Rgb* f) const {
  const FacetLights lights(facets_, viewer.facets, wo, wi);
  const Color4 last = last_nodes();
  const auto place = [&](const Color4& x, int k) {
    const Color4 all = Color4{} + last[k];
    return EvenPositions(all * x, all);
  };
  const EvenPositions scales = place(lights.cosine, 0), roots = place(lights.root, 1),
                      film = place(lights.half_cosine, 2);
  SUNBEAM_UNROLL_4
  for (int k = 0; k < 4; ++k) {
    Color4 value = values_.separable.scale({scales, k}) * lerp(ratios, {roots, k});
    if (!smooth_) value += lights.lobe[k] * values_.film.at({film, k});
    f[k] = lights.cosine[k] > 0 ? to_rgb(max4(value, least_)) : Rgb();
  }
}

// The viewer's row of Q is interpolated once for all lights, with its S: a light then reads two neighbours in
// place of four, and a list costs a quarter of single look-ups.
void BoundTable::eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const {
  if (!separable_) {
    for (std::size_t k = 0; k < wi.size(); ++k) f[k] = wi[k].z > 0 ? eval_pdf(wo, wi[k]).f : Rgb();
    return;
  }
  const Viewer viewer(*this, wo);
  const int roots = ratio_roots();
  std::array<Color4, Separable::kMostRatioRoots + 1> ratios;
  const Color4* row = values_.separable.ratios.data() + viewer.ratios.lower * roots;
  for (int i = 0; i < roots; ++i)
    ratios[i] = viewer.scale * (row[i] + viewer.ratios.upper_weight * (row[i + roots] - row[i]));
  ratios[roots] = Color4{};

  const std::size_t left = wi.size() % 4, last = wi.size() - left;
  for (std::size_t k = 0; k < last; k += 4) eval_four(viewer, ratios.data(), wo, &wi[k], &f[k]);
  if (left == 0) return;
  std::array<Vec3, 4> four;
  std::array<Rgb, 4> values;
  std::copy_n(wi.begin() + static_cast<std::ptrdiff_t>(last), left, four.begin());
  eval_four(viewer, ratios.data(), wo, four.data(), values.data());
  std::copy_n(values.begin(), left, f.begin() + static_cast<std::ptrdiff_t>(last));
}

}  // namespace v1
}  // namespace sunbeam
