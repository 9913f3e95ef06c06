#include "textured_rest.h"

#include <cmath>

namespace sunbeam {
namespace {

constexpr double kNodesPerFringe = 12;  // of the shortest wavelength
constexpr int kLeastThicknesses = 9;
constexpr int kIorNodes = 12, kAbsorptionNodes = 12;
constexpr int kPhis = 7;  // of an anisotropic film
// Of its pairs only every second cosine and every third azimuth are kept: they are many.
constexpr int kCosineStep = 2, kPhiStep = 3;
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
  const double blur2 = square(0.3 * std::max(material.roughness.u, material.roughness.v));
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
      : table_(table),
        waves_(table.factors.wavelengths),
        rest_(rest),
        columns_(static_cast<std::size_t>(kCosines * rest.phis_)),
        least_(waves_.absorption[0]) {
    for (const double a : waves_.absorption) least_ = std::min(least_, a);
    for (int c = 0; c < kCosines; ++c) cosines_.push_back(node_cosine(c));
  }

  void build() {
    find_order_stencils();
    for (int n = 0; n < rest_.axes_[1].size(); ++n) {
      base_ior_ = rest_.axes_[1].node(n);
      if (rest_.is_product()) exchange_of_base_ = table_.factors.exchange.slice(std::array{base_ior_});
      for (int s = 0; s < rest_.axes_[2].size(); ++s) build_at(n, s);
    }
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
        const Axis& orders = rest_.is_product() ? factors.exchange.axes()[3] : factors.returned.axes()[2];
        base_at_.push_back(order_stencil(orders, straight_down * per));
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
      find_shares_at(d);
      weigh(d);
    }
    for (int p = 0; p < rest_.paths_; ++p) {
      find_shares(
          [&](std::size_t k, std::size_t) -> const OrderStencil& { return path_at_[p * waves_.size() + k]; },
          [&](int c) { return thickness_of(p, c); });
      fold(p, rest_.nodes_.data() + p * rest_.stride_ + rest_.row(n, s));
    }
    if (rest_.is_product()) build_pairs(n, s);
  }

  void find_shares_at(int d) {
    find_shares(
        [&](std::size_t k, std::size_t c) -> const OrderStencil& {
          return arrival_at_[(d * waves_.size() + k) * kCosines + c];
        },
        [&](int) { return rest_.axes_[0].node(d); });
  }

  double thickness_of(int p, int c) const {
    return rest_.path_nm(p) / path_of(table_.material, cosines_[static_cast<std::size_t>(c)]);
  }

  // What the pigment leaves of each wavelength, relative to the one that it absorbs least; and frames.
  void find_pigment() {
    const TexturedMaterial shared(table_.material);
    const TexturedFrame frame(shared, base_ior_, depth_);
    pigment_.resize(waves_.size() * columns_);
    for (int c = 0; c < kCosines; ++c) {
      const auto cosine = static_cast<float>(cosines_[c]);
      film_cosines_[c] = std::min(std::sqrt(shared.film_cosine_squared(cosine)), 1.0f);
      path_[c] = 1 / std::sqrt(frame.pigment_cosine_squared(cosine));
      const double per_cosine = 1 / arrival_cosine(material_, cosines_[c]);
      least_decay_[c] = depth_ * least_ * per_cosine;
      for (std::size_t k = 0; k < waves_.size(); ++k)
        for (std::size_t column = c; column < columns_; column += kCosines)
          pigment_[k * columns_ + column] =
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
      if (!rest_.is_product()) returned_.push_back(returned_.back());
      if (!table_.factors.arrival.empty()) arrival_.push_back(arrival_.back());
      return;
    }
    const std::array at{base_ior_, depth};
    if (!table_.factors.arrival.empty()) arrival_.push_back(at_columns(table_.factors.arrival.slice(at)));
    if (rest_.is_product()) return;
    const NdArray returned = table_.factors.returned.slice(at);
    returned_.emplace_back(returned.values().begin(), returned.values().end());
    returned_.back().resize(returned.cells() + 3);
  }

  double node_phi(int p) const { return rest_.phis_ == 1 ? 0 : kPi / 2 * p / (rest_.phis_ - 1); }

  // Nodes of (cos_theta, phi) that the value at a column is made of.
  struct Tap {
    std::size_t node;
    double weight;
  };
  std::vector<Tap> taps(const Axis& cosines, const Axis& phis, int c, int p) const {
    const Stencil at = cosines.stencil(cosines_[static_cast<std::size_t>(c)]), by = phis.stencil(node_phi(p));
    std::vector<Tap> taps;
    for (std::size_t j = 0; j < at.count; ++j)
      for (std::size_t l = 0; l < by.count; ++l)
        taps.push_back({at.node[j] * phis.size() + by.node[l], at.weight[j] * by.weight[l]});
    return taps;
  }

  // (fringe_order, cos_theta, phi) at the columns, with three rows more.
  std::vector<float> at_columns(const NdArray& slice) const {
    const std::size_t orders = slice.axes()[0].size(), stride = slice.stride(0);
    std::vector<float> result((orders + 3) * columns_);
    for (std::size_t column = 0; column < columns_; ++column) {
      const auto from = taps(slice.axes()[1], slice.axes()[2], static_cast<int>(column % kCosines),
                             static_cast<int>(column / kCosines));
      for (std::size_t o = 0; o < orders; ++o) {
        double sum = 0;
        for (const Tap& tap : from) sum += tap.weight * double{slice.values()[o * stride + tap.node]};
        result[o * columns_ + column] = static_cast<float>(sum);
      }
    }
    return result;
  }

  // A of every wavelength and column over that of the pigment where it absorbs least. `arrival_at` of a
  // wavelength and cosine, `thickness_at` of a cosine.
  template <class ArrivalAt, class ThicknessAt>
  void find_shares(ArrivalAt arrival_at, ThicknessAt thickness_at) {
    share_ = pigment_;
    if (table_.factors.arrival.empty()) return find_smooth_shares(thickness_at);
    for (std::size_t k = 0; k < waves_.size(); ++k)
      for (std::size_t c = 0; c < columns_; ++c)
        share_[k * columns_ + c] += blend(arrival_[k], arrival_at(k, c % kCosines), columns_, c);
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
    for (int p = 0; p < rest_.phis_; ++p)
      for (int c = 0; c < kCosines; ++c)
        sum += phi_share(p, rest_.phis_) * quadrature_[c] * double{values[p * kCosines + c]};
    return sum;
  }
  // Of a node in the mean over the quadrant, by trapezoids.
  static double phi_share(int p, int phis) {
    if (phis == 1) return 1;
    return (p == 0 || p == phis - 1 ? 0.5 : 1.0) / (phis - 1);
  }

  // Without a base that knows where light comes from (path "product") `returned` is left to X.
  double gain(int d, std::size_t k) const {
    const double once = material_.radiance_scale() * waves_.albedo[k] * kInvPi;
    if (rest_.is_product()) return once;
    return once / (1 - waves_.albedo[k] * blend(returned_[k], base_at_[d * waves_.size() + k], 1, 0));
  }

  // g A* of each wavelength at a thickness, and fold(g A* A*).
  void weigh(int d) {
    Rgb norm;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const double gain = this->gain(d, k), arriving = hemispherical(share_.data() + k * columns_);
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
      const Rgb norm = (1 - upper) * norms_[d.lower] + upper * norms_[d.lower + 1];
      FloatRgb reflectance;
      rest_.film_.fold(thickness, base_ior_, {&film_cosines_[c], 1}, &reflectance);
      for (std::size_t column = c; column < columns_; column += kCosines) {
        Rgb b;
        for (std::size_t k = 0; k < waves_.size(); ++k)
          b += lerp(upper, weights[k], weights[k + waves_.size()]) * double{share_[k * columns_ + column]} *
               waves_.weight[k];
        row[column] = node(b, norm, c, reflectance);
      }
    }
  }

  // `b` is the rest's directional albedo, `norm` its hemispherical integral; both without the least decay.
  Color4 node(const Rgb& b, const Rgb& norm, int c, const FloatRgb& reflectance) const {
    const Color4 passing = this->passing(c, reflectance);
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

  Color4 passing(int c, const FloatRgb& reflectance) const {
    return material_.is_smooth() ? rest_.passing(reflectance)
                                 : TexturedMaterial::passing(film_cosines_[c]) + Color4{};
  }

  double first_chance(const FloatRgb& r, double rest, int c) const {
    const double of_first = std::max(0.0, double{r.r + r.g + r.b} / 3);
    double of_rest = std::max(0.0, rest) * std::exp(-least_decay_[c] - least_decay_.back());
    if (rest_.is_product())  // the bracket, without X, at a mean cosine of the light
      of_rest *= one_visit_of_product(depth_ * double{rest_.absorption()[3]},
                                      material_.cosine_below(cosines_[static_cast<std::size_t>(c)]),
                                      material_.cosine_below(2.0 / 3));
    return std::clamp(of_first / (of_first + of_rest + kLeastValue), kLeastChance, 1 - kLeastChance);
  }

  // A direction of pairs_.
  struct End {
    int c, p;
    std::size_t column() const { return static_cast<std::size_t>(p * kCosines + c); }
  };
  std::vector<End> pair_ends() const {
    const int by_c = rest_.phis_ == 1 ? 1 : kCosineStep, by_p = rest_.phis_ == 1 ? 1 : kPhiStep;
    std::vector<End> ends;
    for (int p = 0; p < rest_.phis_; p += by_p)
      for (int c = 0; c < kCosines; c += by_c) ends.push_back({c, p});
    return ends;
  }

  // X at all thicknesses.
  void build_pairs(int n, int s) {
    const auto ends = pair_ends();
    const std::size_t pairs = ends.size() * ends.size();
    take_visits(ends);
    for (int d = 0; d < rest_.axes_[0].size(); ++d) {
      find_shares_at(d);
      std::vector<Rgb> sum(pairs);
      for (std::size_t k = 0; k < waves_.size(); ++k) add_visits(d, k, ends, sum);
      const auto scales = factors(d, s, ends);
      const std::size_t node =
          static_cast<std::size_t>((d * rest_.axes_[1].size() + n) * rest_.axes_[2].size() + s);
      for (std::size_t a = 0; a < ends.size(); ++a)
        for (std::size_t b = 0; b < ends.size(); ++b)
          rest_.pairs_[node * pairs + a * ends.size() + b] =
              to_color4(sum[a * ends.size() + b] / (scales[a] * scales[b]) - one_visit(ends[a], ends[b]));
    }
  }

  // What of a pair X leaves to its closed form.
  Rgb one_visit(const End& a, const End& b) const {
    Rgb result;
    for (int channel = 0; channel < 3; ++channel)
      result[channel] =
          one_visit_of_product(depth_ * double{rest_.absorption()[channel]}, below_[a.c], below_[b.c]);
    return result;
  }

  // B of each end at a thickness as a look-up finds it, without the least decay.
  std::vector<Rgb> factors(int d, int s, const std::vector<End>& ends) const {
    const double thickness = rest_.axes_[0].node(d);
    const TexturedPlace place = rest_.place({thickness, base_ior_, rest_.axes_[2].node(s)});
    std::vector<Rgb> result;
    for (const End& end : ends) {
      const double cosine = cosines_[static_cast<std::size_t>(end.c)];
      const auto w = rest_.direction(place, static_cast<float>(path_of(table_.material, cosine)),
                                     static_cast<float>(end.c) / (kCosines - 1));
      const float phi =
          rest_.phis_ == 1 ? 0 : static_cast<float>(end.p) / static_cast<float>(rest_.phis_ - 1);
      FloatRgb reflectance;
      rest_.film_.fold(thickness, base_ior_, {&film_cosines_[end.c], 1}, &reflectance);
      const Rgb log = to_rgb(rest_.at(place, w, phi)), passing = to_rgb(this->passing(end.c, reflectance));
      Rgb b;
      for (int channel = 0; channel < 3; ++channel)
        b[channel] = std::exp(log[channel] + least_decay_[end.c] -
                              depth_ * double{rest_.absorption()[channel]} * path_[end.c]) *
                     passing[channel];
      result.push_back(b);
    }
    return result;
  }

  // Of every wavelength: the bracket of "product" (factors.h) over (fringe_order, end, end).
  void take_visits(const std::vector<End>& ends) {
    for (int c = 0; c < kCosines; ++c)
      below_[c] = material_.cosine_below(cosines_[static_cast<std::size_t>(c)]);
    visits_.resize(waves_.size());
    visits_of_.clear();
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      const bool is_known = k > 0 && waves_.absorption[k] == waves_.absorption[k - 1] &&
                            waves_.albedo[k] == waves_.albedo[k - 1];
      visits_of_.push_back(is_known ? visits_of_.back() : k);
      if (!is_known) visits_[k] = visits(k, ends);
    }
  }
  std::vector<float> visits(std::size_t k, const std::vector<End>& ends) const {
    const double depth = depth_ * waves_.absorption[k];
    const NdArray slice = exchange_of_base_.slice(std::array{depth, waves_.albedo[k]});
    const std::size_t orders = slice.axes()[0].size(), nodes = slice.stride(2);
    std::vector<std::vector<Tap>> from;
    for (const End& end : ends) from.push_back(taps(slice.axes()[1], slice.axes()[2], end.c, end.p));
    std::vector<float> result((orders + 3) * ends.size() * ends.size());
    std::vector<double> row(nodes);
    float* to = result.data();
    for (std::size_t o = 0; o < orders; ++o)
      for (std::size_t a = 0; a < ends.size(); ++a) {
        std::fill(row.begin(), row.end(), 0);
        for (const Tap& tap : from[a])
          for (std::size_t b = 0; b < nodes; ++b)
            row[b] += tap.weight * double{slice.values()[o * slice.stride(0) + tap.node * nodes + b]};
        for (std::size_t b = 0; b < ends.size(); ++b) {
          double sum = one_visit_of_product(depth, below_[ends[a].c], below_[ends[b].c]);
          for (const Tap& tap : from[b]) sum += tap.weight * row[tap.node];
          *to++ = static_cast<float>(sum);
        }
      }
    return result;
  }

  // Adds one wavelength's part of the rest, both without the least decay.
  void add_visits(int d, std::size_t k, const std::vector<End>& ends, std::vector<Rgb>& sum) const {
    const std::vector<float>& visits = visits_[visits_of_[k]];
    const OrderStencil& order = base_at_[d * waves_.size() + k];
    std::vector<float> here(sum.size());
    for (std::size_t j = 0; j < here.size(); ++j) here[j] = blend(visits, order, here.size(), j);
    const float* share = share_.data() + k * columns_;
    const Rgb scale = gain(d, k) / most_leaving(here, share, ends, gain(d, k)) * waves_.weight[k];
    for (std::size_t a = 0; a < ends.size(); ++a)
      for (std::size_t b = 0; b < ends.size(); ++b)
        sum[a * ends.size() + b] +=
            double{share[ends[a].column()] * share[ends[b].column()] * here[a * ends.size() + b]} * scale;
  }

  // No more than one leaves the film of each unit of power that arrives at the base; else by how much more,
  // as FactoredRest limits it. Simpson's rule over the root: cos dw = 4 pi u^3 du.
  double most_leaving(const std::vector<float>& visits, const float* share, const std::vector<End>& ends,
                      double gain) const {
    constexpr double kLeastViewer = 0.125;
    const int count = rest_.pair_cosines_;  // ends of azimuth 0
    double most = 1;
    for (int a = 0; a < count; ++a) {
      if (cosines_[static_cast<std::size_t>(ends[a].c)] < kLeastViewer) continue;
      double sum = 0;
      for (int b = 0; b < count; ++b) {
        const double root = static_cast<double>(b) / (count - 1);
        const double simpson = (b == 0 || b == count - 1 ? 1.0
                                : b % 2 == 1             ? 4.0
                                                         : 2.0) /
                               (3.0 * (count - 1));
        sum += simpson * root * root * root * double{share[ends[b].c]} * std::exp(-least_decay_[ends[b].c]) *
               double{visits[static_cast<std::size_t>(a) * ends.size() + static_cast<std::size_t>(b)]};
      }
      most = std::max(most, 4 * kPi * gain * sum);
    }
    return most;
  }

  const Table& table_;
  const Wavelengths& waves_;
  TexturedRest& rest_;
  std::size_t columns_;  // (phi, cosine)
  double least_;         // absorption of any wavelength
  std::vector<double> cosines_;
  std::vector<OrderStencil> base_at_, arrival_at_;  // of thicknesses
  std::vector<OrderStencil> path_at_;               // of paths, for arrival_

  Material material_;
  double base_ior_ = 1, depth_ = 0;
  std::array<float, kCosines> film_cosines_{}, path_{};
  std::array<double, kCosines> least_decay_{}, quadrature_{};
  std::vector<float> pigment_, share_;        // (wavelength, column)
  std::vector<std::vector<float>> returned_;  // of each wavelength: (fringe_order)
  std::vector<std::vector<float>> arrival_;   // and (fringe_order, column)
  std::vector<double> weights_;               // (thickness, wavelength)
  std::vector<Rgb> norms_;                    // (thickness)
  NdArray exchange_of_base_;                  // at one base IOR
  std::array<double, kCosines> below_{};      // cosines below the film
  std::vector<std::vector<float>> visits_;    // see take_visits()
  std::vector<std::size_t> visits_of_;        // whose of them a wavelength shares
};

TexturedRest::TexturedRest(const Table& table)
    : film_(table.factors.wavelengths, table.material.exterior_ior, table.material.film_ior),
      axes_{EvenAxis(table.factors.grid[0], thickness_nodes(table)),
            EvenAxis(table.factors.grid[1], kIorNodes), EvenAxis(table.factors.grid[2], kAbsorptionNodes)},
      total_(FilmWavelengths(table.factors.wavelengths).total_weight),
      absorption_(mean_absorption(table.factors.wavelengths)) {
  phis_ = table.symmetry == Symmetry::isotropic ? 1 : kPhis;
  const double from = axes_[0].low() * path_of(table.material, 0), to = axes_[0].high();
  paths_ = nodes_between(table, from, to);
  first_path_ = static_cast<float>(from);
  if (to > from) per_extent_ = static_cast<float>(1 / (to - from));
  stride_ = axes_[1].size() * axes_[2].size() * phis_ * kCosines;
  for (int k = 0; k < 4; ++k) corner_[k] = static_cast<int>(row(k >> 1, k & 1));
  nodes_.resize(static_cast<std::size_t>(paths_ * stride_));
  if (table.material.absorption_path == AbsorptionPath::product) {
    pair_cosines_ = phis_ == 1 ? kCosines : (kCosines - 1) / kCosineStep + 1;
    pair_phis_ = phis_ == 1 ? 1 : (kPhis - 1) / kPhiStep + 1;
    pairs_.resize(static_cast<std::size_t>(axes_[0].size() * axes_[1].size() * axes_[2].size()) *
                  static_cast<std::size_t>(pair_ends() * pair_ends()));
  }
  Builder(table, *this).build();
}

TexturedRest::PairTaps TexturedRest::taps(const PairEnd& end) const {
  const EvenPosition c(end.root, pair_cosines_);
  PairTaps taps{{c.lower, c.lower + 1}, {1 - c.upper_weight, c.upper_weight}, 2};
  if (pair_phis_ == 1) return taps;
  const EvenPosition p(end.phi, pair_phis_);
  for (int k = 0; k < 2; ++k) {
    taps.node[k] += p.lower * pair_cosines_;
    taps.node[k + 2] = taps.node[k] + pair_cosines_;
    taps.weight[k + 2] = taps.weight[k] * p.upper_weight;
    taps.weight[k] *= 1 - p.upper_weight;
  }
  taps.count = 4;
  return taps;
}

Color4 TexturedRest::exchange(const Parameters& at, const PairEnd& o, const PairEnd& i) const {
  const PairTaps of_o = taps(o), of_i = taps(i);
  const EvenPosition d = axes_[0].locate(at.film_thickness_nm), n = axes_[1].locate(at.base_ior),
                     s = axes_[2].locate(at.absorption_per_nm);
  const auto weight = [](const EvenPosition& x, int upper) {
    return upper ? x.upper_weight : 1 - x.upper_weight;
  };
  Color4 sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const int u = corner >> 2, v = corner >> 1 & 1, w = corner & 1;
    const auto node = static_cast<std::size_t>(
        ((d.lower + u) * axes_[1].size() + n.lower + v) * axes_[2].size() + s.lower + w);
    const Color4* pairs = pairs_.data() + node * static_cast<std::size_t>(pair_ends() * pair_ends());
    Color4 of_corner{};
    for (int a = 0; a < of_o.count; ++a) {
      const Color4* row = pairs + of_o.node[a] * pair_ends();
      Color4 of_row{};
      for (int b = 0; b < of_i.count; ++b) of_row += of_i.weight[b] * row[of_i.node[b]];
      of_corner += of_o.weight[a] * of_row;
    }
    sum += weight(d, u) * weight(n, v) * weight(s, w) * of_corner;
  }
  return sum;
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
