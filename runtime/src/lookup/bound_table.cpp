#include "runtime/src/lookup/bound_table.h"

#include "runtime/src/film/film_spectrum.h"
#include "sunbeam/detail/text.h"

namespace sunbeam::inline v1 {
namespace {

constexpr int kFilmNodes = 1025;          // over even cosines
constexpr int kViewerAzimuths = 4;        // of wo in a quadrant, which sampling data are averaged over
constexpr int kNormalNodes = 96;          // quadrature over visible normals_, each way, for an albedo
constexpr int kSamplingNormalNodes = 16;  // the same for the chance of sampling the first surface
constexpr int kAlbedoBins = 32;
constexpr int kRestAzimuths = 8;       // of an anisotropic factored table, in a quadrant
constexpr double kLeastCosine = 1e-4;  // of a node at grazing

// The last coordinates of what EvenPositions count.
constexpr float kLastScale = BoundRest::kScaleCosines - 1, kLastPair = BoundRest::kRatioCosines - 1,
                kLastFilm = kFilmNodes - 1;

double cosine_of_root(double root) { return std::max(root * root, kLeastCosine); }

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

BoundTable::BoundTable(const Table& table, const Material& material, Arithmetic arithmetic)
    : material_(material),
      symmetry_(table.symmetry),
      normals_(material.roughness),
      facets_(material.roughness),
      smooth_(material.is_smooth()) {
  take_rest(table, arithmetic);
  prepare_sampling();
  prepare_pairs();
}

void BoundTable::take_rest(const Table& table, Arithmetic arithmetic) {
  ends_.resize(BoundRest::kScaleCosines + 1);
  film_.resize(kFilmNodes + 1);
  const auto cosine_of = [](int node) { return static_cast<double>(node) / (kFilmNodes - 1); };
  if (!table.is_factored()) {
    rest_.emplace<DenseRest>(table, material_);
    for (int i = 0; i < kFilmNodes; ++i)
      film_[i] = to_color4(table.film_reflectance.interpolate(
          std::array{material_.film_thickness_nm, material_.base_ior, cosine_of(i)}));
    return;
  }
  const WaveField factored(table, material_,
                           arithmetic == Arithmetic::fastest ? best_film_kernels() : baseline_film_kernels());
  std::vector<float> cosines(kFilmNodes);
  std::vector<FloatRgb> folded(kFilmNodes);
  for (int i = 0; i < kFilmNodes; ++i) cosines[i] = static_cast<float>(cosine_of(i));
  factored.film().fold(material_.film_thickness_nm, material_.base_ior, cosines, folded.data());
  for (int i = 0; i < kFilmNodes; ++i) film_[i] = Color4{folded[i].r, folded[i].g, folded[i].b, 0};
  const auto& bound = rest_.emplace<BoundRest>(factored, symmetry_);
  has_scales_ = bound.is_isotropic();
  if (has_scales_) std::copy(bound.scales().begin(), bound.scales().end(), ends_.begin());
  if (const auto known = table.info.find("noise"); known != table.info.end())
    parse_number(known->second, noise_);
}

Rgb BoundTable::rest(const Vec3& wo, const Vec3& wi) const {
  if (const auto* factored = std::get_if<BoundRest>(&rest_)) return to_rgb((*factored)(wo, wi));
  return std::get<DenseRest>(rest_)(wo, wi);
}

Rgb BoundTable::rest_stderr(const Vec3& wo, const Vec3& wi) const {
  if (const auto* dense = std::get_if<DenseRest>(&rest_)) return dense->standard_error(wo, wi);
  return transform(rest(wo, wi), [&](double x) { return std::abs(x) * noise_; });
}

Rgb BoundTable::film_reflectance(double cosine) const {
  return to_rgb(
      lerp(film_.data(), EvenPosition(static_cast<float>(std::clamp(cosine, 0.0, 1.0)), kFilmNodes)));
}

// Int f_first cos dwi by midpoints in the unit square of visible normals, which turns it into a mean of R
// G2/G1.
Rgb BoundTable::first_albedo(const Vec3& wo, int nodes) const {
  if (smooth_) return film_reflectance(wo.z);
  Rgb sum;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const double turn = kPi * (j + 0.5) / nodes;  // roots at both ends of the height become smooth
      const Vec3 h = normals_.sample_visible(wo, {(i + 0.5) / nodes, (1 - std::cos(turn)) / 2});
      const Vec3 wi = reflect(wo, h);
      if (wi.z > 0)
        sum += film_reflectance(dot(wo, h)) * (normals_.g2_over_g1(wo, wi) * kPi / 2 * std::sin(turn));
    }
  return sum / (nodes * nodes);
}

void BoundTable::visit_azimuth_mean(
    const Vec3& wo, const std::function<void(const std::function<Rgb(double)>&)>& visit) const {
  if (const auto* factored = std::get_if<BoundRest>(&rest_))
    visit(FactoredAzimuthMean(*factored, wo, symmetry_));
  else
    visit(DenseRest::AzimuthMean(std::get<DenseRest>(rest_), wo));
}

Rgb BoundTable::albedo(const Vec3& wo) const { return first_albedo(wo, kNormalNodes) + rest_albedo(wo); }

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

// First and second moment over a cell, by midpoints, of f_first cos / density: R G2 / G1 times the bounded
// cap's share of the whole.
BoundTable::Moments BoundTable::first_moments(const Vec3& wo, std::size_t cell, int nodes) const {
  Moments sum;
  for (int k = 0; k < nodes * nodes; ++k) {
    const double turn = static_cast<double>(cell / FacetCells::kHeights) + (k % nodes + 0.5) / nodes;
    const double height = static_cast<double>(cell % FacetCells::kHeights) + (k / nodes + 0.5) / nodes;
    const Vec3 wi =
        normals_.sample_mirrored(wo, {turn / (2 * FacetCells::kTurns), height / FacetCells::kHeights});
    sum.least_cosine = std::min(sum.least_cosine, wi.z);
    if (wi.z <= 0) continue;
    const Vec3 h = normalize(wo + wi);
    const double weight = normals_.reflection(wo, wi, h) * wi.z / normals_.reflection_pdf_bounded(wo, h);
    const double power = std::max(0.0, mean(film_reflectance(dot(wo, h)))) * weight / (nodes * nodes);
    sum.first += power;
    sum.second += power * power * (nodes * nodes);
  }
  return sum;
}

// Adds the viewer's row and returns the albedo. Cells are drawn by the root of their second moment, which
// makes the variance least; near the horizon, where light rises steeply and ends, it takes more nodes.
double BoundTable::add_first_row(const Vec3& wo) {
  constexpr int kNodes = 1, kHorizonNodes = 4;
  constexpr double kHorizon = 0.1;
  constexpr double kLeastShare =
      0.005;  // of the mean: neighbouring viewers may have light where this has none
  std::vector<double> power(FacetCells::kCells);
  double albedo = 0;
  for (std::size_t cell = 0; cell < power.size(); ++cell) {
    Moments moments = first_moments(wo, cell, kNodes);
    if (moments.least_cosine < kHorizon) moments = first_moments(wo, cell, kHorizonNodes);
    power[cell] = std::sqrt(moments.second);
    albedo += moments.first / FacetCells::kCells;
  }
  for (double& p : power) p = std::max(p, kLeastShare * albedo);
  first_sampler_.add_row(power);
  return albedo;
}

// Adds the row of `viewers`, one an azimuth, and returns the albedo.
double BoundTable::add_rest_row(std::span<const Vec3> viewers) {
  std::vector<double> density(CosineRows::kNodes);
  for (const Vec3& wo : viewers)
    visit_azimuth_mean(wo, [&](const auto& mean_rest) {
      for (int node = 0; node < CosineRows::kNodes; ++node) {
        const double root = CosineRows::root_of_node(node), cos_i = cosine_of_root(root);
        // f cos dwi = f cos 2 pi dcos, dcos = 2 root droot.
        density[static_cast<std::size_t>(node)] +=
            std::max(0.0, mean(mean_rest(cos_i)) * cos_i * 4 * kPi * root) /
            static_cast<double>(viewers.size());
      }
    });
  return rest_sampler_.add_row(density);
}

// Densities follow the mean over channels, and over the viewer's azimuth.
void BoundTable::prepare_sampling() {
  const int azimuths = symmetry_ == Symmetry::anisotropic ? kViewerAzimuths : 1;
  std::vector<float> chances;
  for (int row = 0; row < kRows; ++row) {
    const double cosine = cosine_of_root(static_cast<double>(row) / (kRows - 1));
    std::vector<Vec3> viewers;
    for (int a = 0; a < azimuths; ++a)
      viewers.push_back(direction_from_cosine(cosine, azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths));
    const double rest = add_rest_row(viewers);
    double first = 0;
    if (smooth_ || !has_cells())
      for (const Vec3& wo : viewers)
        first += std::max(0.0, mean(first_albedo(wo, kSamplingNormalNodes))) / azimuths;
    else
      first = add_first_row(viewers[0]);
    chances.push_back(static_cast<float>(first + rest > 0 ? first / (first + rest) : 0.5));
  }
  for (int k = 0; k < BoundRest::kScaleCosines; ++k) {
    const float cosine = static_cast<float>(k) / (BoundRest::kScaleCosines - 1);
    ends_[k][3] = lerp(chances.data(), EvenPosition(std::sqrt(cosine), kRows));
  }
}

void BoundTable::prepare_pairs() {
  pairs_.resize((kPairs + 1) * kPairs + 1);
  const auto* factored = std::get_if<BoundRest>(&rest_);
  for (int o = 0; o < kPairs; ++o)
    for (int i = 0; i < kPairs; ++i) {
      Color4& node = pairs_[static_cast<std::size_t>(o * kPairs + i)];
      if (has_scales_) node = factored->ratio(o, i);
      const auto at = [](int pair, int nodes) {
        return EvenPosition(static_cast<float>(pair) / (kPairs - 1), nodes);
      };
      node[3] = rest_sampler_.density(at(o, kRows), at(i, CosineRows::kNodes));
    }
}

// The chance first, and without a root: sample() waits for it.
inline BoundTable::Viewer::Viewer(const BoundTable& table, const Vec3& wo)
    : end(lerp(table.ends_.data(),
               EvenPosition(std::min(static_cast<float>(wo.z), 1.0f), BoundRest::kScaleCosines))),
      facets(table.facets_, wo),
      pairs(std::min(facets.root, 1.0f), kPairs),
      rows(std::min(facets.root, 1.0f), kRows) {}

// Where lights lie among nodes.
struct BoundTable::Places {
  template <int kLights>
  explicit Places(const FacetLights<kLights>& lights)
      : end(kLastScale * lights.cosine, all(kLastScale)),
        pair(kLastPair * lights.root, all(kLastPair)),
        film(kLastFilm * lights.half_cosine, all(kLastFilm)) {}

  EvenPositions end, pair, film;

 private:
  static Color4 all(float x) { return Color4{x, x, x, x}; }
};

// What eval_pdf() and sample() know of several lights of one viewer, all above the horizon.
template <int kLights>
SUNBEAM_ALWAYS_INLINE std::array<BoundTable::Parts, kLights> BoundTable::parts(
    const Viewer& viewer, const Vec3& wo, const std::array<Vec3, kLights>& wi) const {
  constexpr float kPerSolidAngle = static_cast<float>(kInvPi / 4);  // d(root) / d(cosine) / (2 pi)
  const FacetLights<kLights> lights(facets_, viewer.facets, wo, wi.data());
  const Places at(lights);
  const float chance = viewer.first_chance();
  const Color4 rest_pdf = (1 - chance) * kPerSolidAngle / lights.root,  // times the density over the root
      first_pdf = chance * viewer.facets.pdf_per_d * lights.d;
  const Ints4 cells = has_cells() ? FacetCells::cells(facets_.u, viewer.facets, lights) : Ints4{};
  const Color4* row = pairs_.data() + viewer.pairs.lower * kPairs;

  std::array<Parts, kLights> result;
  SUNBEAM_UNROLL_4
  for (int k = 0; k < kLights; ++k) {
    const Color4 low = lerp(row, {at.pair, k}), high = lerp(row + kPairs, {at.pair, k});
    const Color4 ratio = low + viewer.pairs.upper_weight * (high - low);
    Parts& parts = result[static_cast<std::size_t>(k)];
    parts.rest = has_scales_ ? viewer.end * lerp(ends_.data(), {at.end, k}) * ratio
                             : to_color4(rest(wo, wi[static_cast<std::size_t>(k)]));
    parts.first = Color4{};
    parts.pdf = ratio[3] * rest_pdf[k];
    if (smooth_) continue;
    parts.first = lights.lobe[k] * lerp(film_.data(), {at.film, k});
    parts.pdf += first_pdf[k] * (has_cells() ? first_sampler_.density(viewer.rows, cells[k]) : 1);
  }
  return result;
}

BoundTable::Parts BoundTable::parts(const Vec3& wo, const Vec3& wi) const {
  return parts<1>(Viewer(*this, wo), wo, {wi})[0];
}

EvalPdf BoundTable::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  return parts<1>(Viewer(*this, wo), wo, {wi})[0].eval_pdf();
}

// Draws from FacetCells's square, or evenly.
inline Vec3 BoundTable::draw_first(const Viewer& viewer, int row, const Vec3& wo, Rng& rng) const {
  const auto at = has_cells() ? first_sampler_.sample(row, rng) : FacetCells::even(rng);
  return viewer.facets.mirrored(facets_, wo, at.turn, at.height);
}

inline Vec3 BoundTable::draw_rest(int row, Rng& rng) const {
  const double root{rest_sampler_.sample(row, rng)};
  return at_random_azimuth(root * root, rng);
}

// One number, `lot`, has chosen the technique; what is left of it chooses the row.
SUNBEAM_ALWAYS_INLINE Vec3 BoundTable::draw(const Viewer& viewer, float lot, const Vec3& wo, Rng& rng) const {
  const float chance = viewer.first_chance(), upper = viewer.rows.upper_weight;
  if (lot < chance) return draw_first(viewer, viewer.rows.lower + (lot < chance * upper), wo, rng);
  return draw_rest(viewer.rows.lower + (lot - chance < (1 - chance) * upper), rng);
}

BsdfSample BoundTable::mirrored(const Viewer& viewer, const Vec3& wo) const {
  return {{-wo.x, -wo.y, wo.z}, film_reflectance(wo.z) / double{viewer.first_chance()}, true, 0};
}

std::optional<BsdfSample> BoundTable::sample(const Vec3& wo, Rng& rng) const {
  const Viewer viewer(*this, wo);
  const float lot = uniform_float(rng);
  if (smooth_ && lot < viewer.first_chance()) return mirrored(viewer, wo);
  const Vec3 wi = draw(viewer, lot, wo, rng);
  if (wi.z <= 0) return {};
  return parts<1>(viewer, wo, {wi})[0].sample(wi);
}

EvalAndSample BoundTable::eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  const Viewer viewer(*this, wo);
  const float lot = uniform_float(rng);
  if (smooth_ && lot < viewer.first_chance())
    return {parts<1>(viewer, wo, {wi})[0].eval_pdf(), mirrored(viewer, wo)};
  const Vec3 drawn = draw(viewer, lot, wo, rng);
  if (drawn.z <= 0) return {parts<1>(viewer, wo, {wi})[0].eval_pdf(), {}};
  const auto both = parts<2>(viewer, wo, {wi, drawn});
  return {both[0].eval_pdf(), both[1].sample(drawn)};
}

// parts() without what pdf needs, four lights at a time.
void BoundTable::eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const {
  if (!has_scales_) {
    for (std::size_t k = 0; k < wi.size(); ++k) f[k] = wi[k].z > 0 ? eval_pdf(wo, wi[k]).f : Rgb();
    return;
  }
  const Viewer viewer(*this, wo);
  std::array<Color4, kPairs + 1> ratios;  // of this viewer, with its scale
  const Color4* row = pairs_.data() + viewer.pairs.lower * kPairs;
  for (int i = 0; i < kPairs; ++i)
    ratios[i] = viewer.end * (row[i] + viewer.pairs.upper_weight * (row[i + kPairs] - row[i]));
  ratios[kPairs] = Color4{};

  const auto take_four = [&](const Vec3* four, Rgb* values) {
    const FacetLights<4> lights(facets_, viewer.facets, wo, four);
    const Places at(lights);
    SUNBEAM_UNROLL_4
    for (int k = 0; k < 4; ++k) {
      Color4 value = lerp(ends_.data(), {at.end, k}) * lerp(ratios.data(), {at.pair, k});
      if (!smooth_) value += lights.lobe[k] * lerp(film_.data(), {at.film, k});
      values[k] = lights.cosine[k] > 0 ? to_rgb(value) : Rgb();
    }
  };
  const std::size_t left = wi.size() % 4, last = wi.size() - left;
  for (std::size_t k = 0; k < last; k += 4) take_four(&wi[k], &f[k]);
  if (left == 0) return;
  std::array<Vec3, 4> four;
  std::array<Rgb, 4> values;
  std::copy_n(wi.begin() + static_cast<std::ptrdiff_t>(last), left, four.begin());
  take_four(four.data(), values.data());
  std::copy_n(values.begin(), left, f.begin() + static_cast<std::ptrdiff_t>(last));
}

}  // namespace sunbeam::inline v1
