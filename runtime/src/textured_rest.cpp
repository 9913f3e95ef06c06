#include "textured_rest.h"

#include <cmath>

namespace sunbeam {
namespace {

constexpr double kNodesPerFringe = 10;  // of the shortest wavelength
constexpr int kLeastThicknesses = 9;
constexpr int kIorNodes = 12, kAbsorptionNodes = 12;
constexpr double kLeastCosine = 1e-4;
constexpr double kLeastFrame = 0.05, kLeastSmoothFrame = 1e-3;  // of m~
constexpr double kLeastShare = 0.01;  // of the channels' mean: a folded colour may pass through 0
// Of L. At grazing a pigment of many colours would leave it with poles, where no light is left.
constexpr double kLeastLog = -80, kMostLog = 20;
constexpr double kLeastChance = 0.02;  // of either technique: their estimates may be far off
constexpr double kLeastValue = 1e-18;  // of B over its frame

int nodes_between(const Table& table, double from_nm, double to_nm) {
  const auto& nm = table.factors.wavelengths.nm;
  const double fringes =
      fringe_order(table.material, 1) * (to_nm - from_nm) / *std::min_element(nm.begin(), nm.end());
  return std::max(kLeastThicknesses, static_cast<int>(std::ceil(fringes * kNodesPerFringe)) + 1);
}
int thickness_nodes(const Table& table) {
  return nodes_between(table, table.factors.grid[0].low(), table.factors.grid[0].high());
}

// A smooth film's fringes are not in L.
double path_of(const Material& material, double cosine) {
  return material.is_smooth() ? 1 : fringe_order(material, cosine) / fringe_order(material, 1);
}

// The weighted mean of the pigment's spectrum in each channel, and over channels.
Color4 mean_absorption(const Wavelengths& w) {
  Rgb sum, total;
  for (std::size_t k = 0; k < w.size(); ++k) {
    sum += w.absorption[k] * w.weight[k];
    total += w.weight[k];
  }
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = std::max(sum[c] / total[c], 0.0);
  Color4 lanes = to_color4(result);
  lanes[3] = static_cast<float>(mean(result));
  return lanes;
}

double node_cosine(int c) {
  const double root = static_cast<double>(c) / (TexturedRest::kCosines - 1);
  return std::max(root * root, kLeastCosine);
}

}  // namespace

TexturedMaterial::TexturedMaterial(const Material& material)
    : bends(material.transmission == Transmission::refract),
      exterior_ior(material.exterior_ior),
      pigment_thickness_nm(material.pigment_thickness_nm) {
  const double blur2 = square(0.3 * material.roughness.u);
  film_scale = static_cast<float>(1 / (1 + blur2));
  film_offset = static_cast<float>(blur2 / (1 + blur2));
  path_scale =
      material.is_smooth() ? 0 : static_cast<float>(square(material.exterior_ior / material.film_ior));
  path_offset = 1 - path_scale;
  least_path = static_cast<float>(square(path_of(material, 0)));
  least_below = static_cast<float>(
      square(material.is_smooth() ? kLeastSmoothFrame : std::max(std::sqrt(blur2), kLeastFrame)));
}

TexturedFrame::TexturedFrame(const TexturedMaterial& material, double base_ior, double depth)
    : least_below(material.least_below), optical_depth(static_cast<float>(depth)) {
  const double ratio2 = material.bends ? square(material.exterior_ior / base_ior) : 1;
  below_scale = static_cast<float>(ratio2);
  below_offset = static_cast<float>(1 - ratio2);
}

// Goes through the nodes; what depends on few of the parameters is found once.
class TexturedRest::Builder {
 public:
  Builder(const Table& table, TexturedRest& rest)
      : table_(table), waves_(table.factors.wavelengths), rest_(rest), least_(waves_.absorption[0]) {
    for (const double a : waves_.absorption) least_ = std::min(least_, a);
    for (int c = 0; c < kCosines; ++c) cosines_.push_back(node_cosine(c));
  }

  void build() {
    find_order_stencils();
    for (int n = 0; n < rest_.axes_[1].size(); ++n)
      for (int s = 0; s < rest_.axes_[2].size(); ++s) build_at(n, s);
  }

 private:
  // Where a fringe order lies among the nodes of an array, whose axis is even or has one node.
  struct OrderStencil {
    std::size_t first = 0;
    std::array<float, 4> weight{1, 0, 0, 0};
  };
  static OrderStencil order_stencil(const Axis& axis, double order) {
    const Stencil at = axis.stencil(order);
    OrderStencil result;
    // Four nodes always, so that loops have no branch; slices carry three rows more.
    result.first = at.node[0];
    for (std::size_t k = 0; k < 4; ++k)
      result.weight[k] = k < at.count ? static_cast<float>(at.weight[k]) : 0;
    return result;
  }
  static float blend(const std::vector<float>& values, const OrderStencil& at, std::size_t stride,
                     std::size_t column) {
    const float* from = values.data() + at.first * stride + column;
    return at.weight[0] * from[0] + at.weight[1] * from[stride] + at.weight[2] * from[2 * stride] +
           at.weight[3] * from[3 * stride];
  }

  // Of all thicknesses, wavelengths and cosines, of normal incidence, and of paths.
  void find_order_stencils() {
    const Factors& factors = table_.factors;
    const double straight_down = fringe_order(table_.material, 1);
    for (int d = 0; d < rest_.axes_[0].size(); ++d)
      for (const double nm : waves_.nm) {
        const double per = rest_.axes_[0].node(d) / nm;
        returned_at_.push_back(order_stencil(factors.returned.axes()[2], straight_down * per));
        if (factors.arrival.empty()) continue;
        for (const double cosine : cosines_)
          arrival_at_.push_back(
              order_stencil(factors.arrival.axes()[2], fringe_order(table_.material, cosine) * per));
      }
    if (factors.arrival.empty()) return;
    for (int p = 0; p < rest_.paths_; ++p)
      for (const double nm : waves_.nm)
        path_at_.push_back(order_stencil(factors.arrival.axes()[2], straight_down * rest_.path_nm(p) / nm));
  }

  void build_at(int n, int s) {
    base_ior_ = rest_.axes_[1].node(n);
    depth_ = rest_.axes_[2].node(s) * table_.material.pigment_thickness_nm;
    material_ = table_.material;
    material_.base_ior = base_ior_;
    find_pigment();
    find_quadrature();
    returned_.clear();
    arrival_.clear();
    for (std::size_t k = 0; k < waves_.size(); ++k) take_slices(k);
    weights_.clear();
    norms_.clear();
    for (int d = 0; d < rest_.axes_[0].size(); ++d) {
      find_shares(
          [&](std::size_t k, std::size_t c) -> const OrderStencil& {
            return arrival_at_[(d * waves_.size() + k) * kCosines + c];
          },
          [&](int) { return rest_.axes_[0].node(d); });
      weigh(d);
    }
    for (int p = 0; p < rest_.paths_; ++p) {
      find_shares(
          [&](std::size_t k, std::size_t) -> const OrderStencil& { return path_at_[p * waves_.size() + k]; },
          [&](int c) { return thickness_of(p, c); });
      fold(p, rest_.nodes_.data() + p * rest_.stride_ + rest_.row(n, s));
    }
  }

  double thickness_of(int p, int c) const {
    return rest_.path_nm(p) / path_of(table_.material, cosines_[static_cast<std::size_t>(c)]);
  }

  // What the pigment leaves of each wavelength, relative to the one that it absorbs least; and frames.
  void find_pigment() {
    const TexturedMaterial shared(table_.material);
    const TexturedFrame frame(shared, base_ior_, depth_);
    pigment_.assign(waves_.size() * kCosines, 1);
    for (int c = 0; c < kCosines; ++c) {
      const auto cosine = static_cast<float>(cosines_[c]);
      film_cosines_[c] = std::min(std::sqrt(shared.film_cosine_squared(cosine)), 1.0f);
      path_[c] = 1 / std::sqrt(frame.pigment_cosine_squared(cosine));
      const double per_cosine = 1 / arrival_cosine(material_, cosines_[c]);
      least_decay_[c] = depth_ * least_ * per_cosine;
      for (std::size_t k = 0; k < waves_.size(); ++k)
        pigment_[k * kCosines + c] =
            static_cast<float>(-depth_ * (waves_.absorption[k] - least_) * per_cosine);
    }
  }

  // Trapezoids in the root: cos dw = 4 pi u^3 du.
  void find_quadrature() {
    for (int c = 0; c < kCosines; ++c) {
      const double root = static_cast<double>(c) / (kCosines - 1), end = c == kCosines - 1 ? 0.5 : 1;
      quadrature_[c] = 4 * kPi / (kCosines - 1) * end * root * root * root *
                       std::exp(least_decay_.back() - least_decay_[c]);
    }
  }

  void take_slices(std::size_t k) {
    const double depth = depth_ * waves_.absorption[k];
    if (k > 0 && waves_.absorption[k] == waves_.absorption[k - 1]) {
      returned_.push_back(returned_.back());
      if (!table_.factors.arrival.empty()) arrival_.push_back(arrival_.back());
      return;
    }
    const std::array at{base_ior_, depth};
    const NdArray returned = table_.factors.returned.slice(at);
    returned_.emplace_back(returned.values().begin(), returned.values().end());
    returned_.back().resize(returned.cells() + 3);
    if (!table_.factors.arrival.empty()) arrival_.push_back(at_cosines(table_.factors.arrival.slice(at)));
  }

  // (fringe_order, cos_theta, phi) at the cosines of the nodes, with three rows more.
  std::vector<float> at_cosines(const NdArray& slice) const {
    const std::size_t orders = slice.axes()[0].size(), stride = slice.stride(0);
    std::vector<float> result((orders + 3) * kCosines);
    for (int c = 0; c < kCosines; ++c) {
      const Stencil at = slice.axes()[1].stencil(cosines_[c]);
      for (std::size_t o = 0; o < orders; ++o) {
        double sum = 0;
        for (std::size_t j = 0; j < at.count; ++j)
          sum += at.weight[j] * double{slice.values()[o * stride + at.node[j] * slice.stride(1)]};
        result[o * kCosines + c] = static_cast<float>(sum);
      }
    }
    return result;
  }

  // A of every wavelength and cosine over that of the pigment where it absorbs least. `arrival_at` of a
  // wavelength and cosine, `thickness_at` of a cosine.
  template <class ArrivalAt, class ThicknessAt>
  void find_shares(ArrivalAt arrival_at, ThicknessAt thickness_at) {
    share_ = pigment_;
    if (table_.factors.arrival.empty()) return find_smooth_shares(thickness_at);
    for (std::size_t k = 0; k < waves_.size(); ++k)
      for (std::size_t c = 0; c < kCosines; ++c)
        share_[k * kCosines + c] += blend(arrival_[k], arrival_at(k, c), kCosines, c);
    exponentiate();
  }
  template <class ThicknessAt>
  void find_smooth_shares(ThicknessAt thickness_at) {
    exponentiate();
    std::array<float, kMostWavelengths> passing;
    for (int c = 0; c < kCosines; ++c) {
      rest_.film_.powers(thickness_at(c), base_ior_, static_cast<float>(cosines_[c]), passing.data());
      for (std::size_t k = 0; k < waves_.size(); ++k) share_[k * kCosines + c] *= passing[k];
    }
  }
  void exponentiate() {
    for (std::size_t k = 0; k < share_.size(); k += 4) {
      Color4 four{};
      const std::size_t count = std::min<std::size_t>(4, share_.size() - k);
      std::copy_n(share_.data() + k, count, reinterpret_cast<float*>(&four));
      four = exp4(four);
      std::copy_n(reinterpret_cast<const float*>(&four), count, share_.data() + k);
    }
  }

  // Int A cos dw, relative to the least decay at normal incidence, so that no pigment makes it vanish.
  double hemispherical(const float* values) const {
    double sum = 0;
    for (int c = 0; c < kCosines; ++c) sum += quadrature_[c] * double{values[c]};
    return sum;
  }

  // g A* of each wavelength at a thickness, and fold(g A* A*).
  void weigh(int d) {
    Rgb norm;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const double returned = blend(returned_[k], returned_at_[d * waves_.size() + k], 1, 0);
      const double gain =
          material_.radiance_scale() * waves_.albedo[k] * kInvPi / (1 - waves_.albedo[k] * returned);
      const double arriving = hemispherical(share_.data() + k * kCosines);
      weights_.push_back(gain * arriving);
      norm += gain * arriving * arriving * waves_.weight[k];
    }
    norms_.push_back(norm);
  }

  void fold(int p, Color4* row) {
    for (int c = 0; c < kCosines; ++c) {
      const double thickness = thickness_of(p, c);
      const EvenAxis& axis = rest_.axes_[0];
      const EvenPosition d = axis.locate(axis.clamped(thickness));
      const double upper{d.upper_weight};
      const double* weights = weights_.data() + d.lower * waves_.size();
      Rgb b;
      for (std::size_t k = 0; k < waves_.size(); ++k)
        b += lerp(upper, weights[k], weights[k + waves_.size()]) * double{share_[k * kCosines + c]} *
             waves_.weight[k];
      const Rgb norm = (1 - upper) * norms_[d.lower] + upper * norms_[d.lower + 1];
      FloatRgb reflectance;
      rest_.film_.fold(thickness, base_ior_, {&film_cosines_[c], 1}, &reflectance);
      row[c] = node(b, norm, c, reflectance);
    }
  }

  // `b` is the rest's directional albedo, `norm` its hemispherical integral; both without the least decay.
  Color4 node(const Rgb& b, const Rgb& norm, int c, const FloatRgb& reflectance) const {
    const Color4 passing = material_.is_smooth() ? rest_.passing(reflectance)
                                                 : TexturedMaterial::passing(film_cosines_[c]) + Color4{};
    Color4 result{};
    for (int channel = 0; channel < 3; ++channel) {
      const double albedo = std::max({b[channel], kLeastShare * mean(b), kLeastValue});
      const double scale =
          std::sqrt(std::max({norm[channel], kLeastShare * mean(norm), square(kLeastValue)}));
      const double decay = least_decay_[c] - depth_ * double{rest_.absorption()[channel]} * path_[c];
      const double value = std::log(albedo / scale / double{passing[channel]}) - decay;
      result[channel] = static_cast<float>(std::clamp(value, kLeastLog, kMostLog));
    }
    result[3] = static_cast<float>(first_chance(reflectance, mean(b), c));
    return result;
  }

  double first_chance(const FloatRgb& r, double rest, int c) const {
    const double of_first = std::max(0.0, double{r.r + r.g + r.b} / 3);
    const double of_rest = std::max(0.0, rest) * std::exp(-least_decay_[c] - least_decay_.back());
    return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
  }

  const Table& table_;
  const Wavelengths& waves_;
  TexturedRest& rest_;
  double least_;  // absorption of any wavelength
  std::vector<double> cosines_;
  std::vector<OrderStencil> returned_at_, arrival_at_;  // of thicknesses
  std::vector<OrderStencil> path_at_;                   // of paths, for arrival_

  Material material_;
  double base_ior_ = 1, depth_ = 0;
  std::array<float, kCosines> film_cosines_{}, path_{};
  std::array<double, kCosines> least_decay_{}, quadrature_{};
  std::vector<float> pigment_, share_;        // (wavelength, cosine)
  std::vector<std::vector<float>> returned_;  // of each wavelength: (fringe_order)
  std::vector<std::vector<float>> arrival_;   // and (fringe_order, cosine)
  std::vector<double> weights_;               // (thickness, wavelength)
  std::vector<Rgb> norms_;                    // (thickness)
};

TexturedRest::TexturedRest(const Table& table)
    : film_(table.factors.wavelengths, table.material.exterior_ior, table.material.film_ior),
      axes_{EvenAxis(table.factors.grid[0], thickness_nodes(table)),
            EvenAxis(table.factors.grid[1], kIorNodes), EvenAxis(table.factors.grid[2], kAbsorptionNodes)},
      total_(FilmWavelengths(table.factors.wavelengths).total_weight),
      absorption_(mean_absorption(table.factors.wavelengths)) {
  const double from = axes_[0].low() * path_of(table.material, 0), to = axes_[0].high();
  paths_ = nodes_between(table, from, to);
  first_path_ = static_cast<float>(from);
  if (to > from) per_extent_ = static_cast<float>(1 / (to - from));
  stride_ = axes_[1].size() * axes_[2].size() * kCosines;
  for (int k = 0; k < 4; ++k) corner_[k] = static_cast<int>(row(k >> 1, k & 1));
  nodes_.resize(static_cast<std::size_t>(paths_ * stride_));
  Builder(table, *this).build();
}

TexturedPlace TexturedRest::place(const Parameters& at) const {
  const EvenPosition n = axes_[1].locate(at.base_ior), s = axes_[2].locate(at.absorption_per_nm);
  const auto nearest = [](const EvenPosition& x) { return x.lower + (x.upper_weight < 0.5f ? 0 : 1); };
  const float n_upper = n.upper_weight, s_upper = s.upper_weight;
  return {
      static_cast<float>(at.film_thickness_nm),
      row(n.lower, s.lower),
      row(nearest(n), nearest(s)),
      {(1 - n_upper) * (1 - s_upper), (1 - n_upper) * s_upper, n_upper * (1 - s_upper), n_upper * s_upper}};
}

}  // namespace sunbeam
