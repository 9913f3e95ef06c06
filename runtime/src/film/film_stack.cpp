#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"  // long vectors are returned by functions that are inlined only
#endif

#include "sunbeam/detail/film_stack.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/base/lanes.h"
#include "runtime/src/base/vector_clones.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/vec.h"
#include "sunbeam/detail/quadrature.h"
#include "sunbeam/detail/refraction.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI{0, 1};

// Lanes are wavelengths, side by side.
using Quad = Doubles4;

// Processors differ in the alignment that they give to such vectors.
struct alignas(32) ComplexQuad {
  Quad re, im;

  void set(std::size_t lane, const Complex& value) {
    re[lane] = value.real();
    im[lane] = value.imag();
  }
};

SUNBEAM_INLINE ComplexQuad sum(const ComplexQuad& a, const ComplexQuad& b) {
  return {a.re + b.re, a.im + b.im};
}
SUNBEAM_INLINE ComplexQuad product(const ComplexQuad& a, const ComplexQuad& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
SUNBEAM_INLINE Quad squared_norm(const ComplexQuad& a) { return a.re * a.re + a.im * a.im; }

// 1 / a, without the care for overflow that the language asks for.
Complex inverse(Complex a) { return std::conj(a) / std::norm(a); }

// The squared cosine in a medium of light that comes from `ior_from` at `cosine`. The formula is arranged so
// that equal media keep every digit at grazing.
Complex cosine_squared(double ior_from, Complex index, double cosine) {
  if (index.imag() == 0) return refracted_cosine_squared(ior_from, index.real(), cosine);
  const Complex per_n = inverse(index);
  return ((index - ior_from) * (index + ior_from) + square(ior_from * cosine)) * per_n * per_n;
}

// The root for which a wave that goes away decays.
Complex cosine_of(Complex index, Complex c_squared) {
  if (c_squared.imag() == 0 && index.imag() == 0) {
    const double size = std::sqrt(std::abs(c_squared.real()));
    return c_squared.real() < 0 ? Complex{0, size} : Complex{size, 0};
  }
  const Complex c = std::sqrt(c_squared);
  return (index * c).imag() < 0 ? -c : c;
}

// What light of one direction meets in a layer, whatever its thickness: the phases k and delta = k c at the
// nominal one, and factors of LayerMatrix.
struct LayerAngle {
  ComplexQuad k, delta, per_2c, n, per_n, n_c2, c2_per_n;
};

void set_lane(LayerAngle& a, std::size_t lane, Complex index, double phase, double ior_from, double cosine) {
  const Complex c_squared = cosine_squared(ior_from, index, cosine), c = cosine_of(index, c_squared),
                per_n = inverse(index);
  a.k.set(lane, phase * index);
  a.delta.set(lane, phase * index * c);
  a.per_2c.set(lane, c == 0.0 ? 0 : 0.5 * inverse(c));
  a.n.set(lane, index);
  a.per_n.set(lane, per_n);
  a.n_c2.set(lane, index * c_squared);
  a.c2_per_n.set(lane, c_squared * per_n);
}

// What a layer does with the fields below it, times exp(i delta), so that thick layers do not overflow:
// cos(delta), and -i sin(delta) times 1 / q and q, for both polarisations.
struct LayerMatrix {
  ComplexQuad cosine, s_per_q, s_q, p_per_q, p_q;
  alignas(32) Quad damping;  // Im(delta)
};

// exp(i delta) at `factor` times the thickness.
ComplexQuad turn_of(const LayerAngle& a, double factor) {
  ComplexQuad turn;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const double re = factor * a.delta.re[lane], im = factor * a.delta.im[lane];
    const double size = im == 0 ? 1 : std::exp(-im);
    turn.set(lane, {size * std::cos(re), size * std::sin(re)});
  }
  return turn;
}

// -i sin(delta) / c exp(i delta) of a layer so thin that 1 - exp(2 i delta) loses digits.
Complex thin_sine(Complex k, Complex delta, Complex turn) {
  const Complex x = delta * delta;
  return -kI * k * (1.0 - x / 6.0 * (1.0 - x / 20.0)) * turn;
}

SUNBEAM_INLINE LayerMatrix matrix_of(const LayerAngle& a, double factor) {
  const ComplexQuad turn = turn_of(a, factor), twice = product(turn, turn);
  ComplexQuad sine = product({1 - twice.re, Quad{} - twice.im}, a.per_2c);
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const Complex delta = factor * Complex(a.delta.re[lane], a.delta.im[lane]);
    if (std::norm(delta) < 1e-6)
      sine.set(lane, thin_sine(factor * Complex(a.k.re[lane], a.k.im[lane]), delta,
                               {turn.re[lane], turn.im[lane]}));
  }
  return {{0.5 * (1 + twice.re), 0.5 * twice.im},
          product(sine, a.per_n),
          product(sine, a.n_c2),
          product(sine, a.n),
          product(sine, a.c2_per_n),
          factor * a.delta.im};
}

constexpr double kLarge = 0x1p200, kLogLarge = 200 * 0.693147180559945309417;

// (E, H) becomes (a E + b H, c E + d H).
struct Matrix {
  ComplexQuad a, b, c, d;

  SUNBEAM_INLINE Quad size() const {
    return squared_norm(a) + squared_norm(b) + squared_norm(c) + squared_norm(d);
  }
  SUNBEAM_INLINE void scale(const Quad& factor) {
    for (ComplexQuad* entry : {&a, &b, &c, &d}) *entry = {entry->re * factor, entry->im * factor};
  }
};
SUNBEAM_INLINE Matrix product(const Matrix& x, const Matrix& y) {
  return {sum(product(x.a, y.a), product(x.b, y.c)), sum(product(x.a, y.b), product(x.b, y.d)),
          sum(product(x.c, y.a), product(x.d, y.c)), sum(product(x.c, y.b), product(x.d, y.d))};
}

// What several layers do with the fields below them, of both polarisations.
struct Transfer {
  Matrix s, p;
  alignas(32) Quad damping, log_scale;  // the latter of what the matrices were divided by
};

SUNBEAM_INLINE Transfer transfer_of(const LayerMatrix& m) {
  return {{m.cosine, m.s_per_q, m.s_q, m.cosine}, {m.cosine, m.p_per_q, m.p_q, m.cosine}, m.damping, Quad{}};
}
SUNBEAM_INLINE Transfer product(const Transfer& above, const Transfer& below) {
  Transfer t{product(above.s, below.s), product(above.p, below.p), above.damping + below.damping,
             above.log_scale + below.log_scale};
  const auto is_large = t.s.size() + t.p.size() > kLarge * kLarge;
  const Quad factor = select(is_large, Quad{} + 1 / kLarge, Quad{} + 1);
  t.s.scale(factor);
  t.p.scale(factor);
  t.log_scale += select(is_large, Quad{} + kLogLarge, Quad{});
  return t;
}

// All periods of the layers. The same layers once more are a product of what is known already.
SUNBEAM_INLINE Transfer repeated(const LayerMatrix* layers, std::size_t count, int periods) {
  Transfer power = transfer_of(layers[0]);
  for (std::size_t j = 1; j < count; ++j) power = product(power, transfer_of(layers[j]));
  Transfer all = power;
  for (int left = periods - 1; left > 0; left /= 2) {
    if (left % 2 == 1) all = product(all, power);
    power = product(power, power);
  }
  return all;
}

// The fields of both polarisations at one height. Those of p are (H, E), as their admittance is c / N.
struct Fields {
  ComplexQuad s_e, s_h, p_h, p_e;
  alignas(32) Quad log_scale;  // of what they were divided by

  SUNBEAM_INLINE void pass(const LayerMatrix& m) {
    const ComplexQuad e = s_e, h = p_h;
    s_e = sum(product(m.cosine, e), product(m.s_per_q, s_h));
    s_h = sum(product(m.cosine, s_h), product(m.s_q, e));
    p_h = sum(product(m.cosine, h), product(m.p_per_q, p_e));
    p_e = sum(product(m.cosine, p_e), product(m.p_q, h));
  }

  // Upwards through all layers, or downwards: the product of all matrices in the other order has a and d
  // exchanged, since those of one layer are equal.
  SUNBEAM_INLINE void pass(const Transfer& t, bool upwards) {
    const Matrix &s = t.s, &p = t.p;
    const ComplexQuad e = s_e, h = p_h;
    s_e = sum(product(upwards ? s.a : s.d, e), product(s.b, s_h));
    s_h = sum(product(upwards ? s.d : s.a, s_h), product(s.c, e));
    p_h = sum(product(upwards ? p.a : p.d, h), product(p.b, p_e));
    p_e = sum(product(upwards ? p.d : p.a, p_e), product(p.c, h));
    log_scale += t.log_scale;
  }

  // Mirrors of many layers make fields grow without end, but a few layers by less than the range of numbers.
  SUNBEAM_INLINE void keep_finite() {
    const Quad size = squared_norm(s_e) + squared_norm(s_h) + squared_norm(p_h) + squared_norm(p_e);
    const auto is_large = size > kLarge * kLarge;
    const Quad factor = select(is_large, Quad{} + 1 / kLarge, Quad{} + 1);
    for (ComplexQuad* field : {&s_e, &s_h, &p_h, &p_e}) *field = {field->re * factor, field->im * factor};
    log_scale += select(is_large, Quad{} + kLogLarge, Quad{});
  }
};

// The cosines in a medium at the end of the stack, and its admittances.
struct End {
  ComplexQuad q_s, q_p;
  bool is_open[4];  // light travels there

  Fields fields() const { return {{Quad{} + 1, Quad{}}, q_s, {Quad{} + 1, Quad{}}, q_p, Quad{}}; }
};

void set_lane(End& end, std::size_t lane, Complex index, double ior_from, double cosine) {
  const Complex c_squared = cosine_squared(ior_from, index, cosine), c = cosine_of(index, c_squared);
  end.q_s.set(lane, index * c);
  end.q_p.set(lane, c * inverse(index));
  end.is_open[lane] = index.imag() == 0 && c_squared.real() > 0;
}

// R and T of one polarisation at the end where light comes from: its admittance q, and the real part `far` of
// that at the other end.
struct Polarised {
  Quad reflectance, transmittance;
};
SUNBEAM_INLINE Polarised polarised(const ComplexQuad& field, const ComplexQuad& conjugate, const Quad& q,
                                   const Quad& far) {
  const ComplexQuad plus{q * field.re + conjugate.re, q * field.im + conjugate.im};
  const ComplexQuad minus{q * field.re - conjugate.re, q * field.im - conjugate.im};
  const Quad size = squared_norm(plus);
  return {squared_norm(minus) / size, 4 * q * far / size};
}

// Gauss' rule of n nodes integrates up to 2 n radians; fringes of so many orders are resolved.
std::vector<std::pair<double, double>> thickness_factors(double spread, double waves, double orders) {
  constexpr double kCut = 3;
  if (waves > kMostFilmWaves)
    throw Error("key 'thickness_spread': found " + to_text(spread) + " of a film whose path 2 sum(n d) is " +
                to_text(waves) + " wavelengths; allowed: up to " + to_text(kMostFilmWaves) + " wavelengths");
  const double radians = 2 * kPi * waves * 2 * kCut * spread;
  const GaussRule rule = gauss_legendre(static_cast<int>(orders * (12 + radians / 2)));
  std::vector<std::pair<double, double>> factors;
  double sum = 0;
  for (int i = 0; i < rule.size(); ++i) {
    const double z = lerp(rule.node[i], -kCut, kCut);
    factors.emplace_back(1 + z * spread, rule.weight[i] * std::exp(-0.5 * z * z));
    sum += factors.back().second;
  }
  for (auto& [factor, weight] : factors) weight /= sum;
  return factors;
}

SUNBEAM_INLINE void pass_once(const LayerMatrix* layers, std::size_t count, Fields& up, Fields& down,
                              Quad& damping) {
  constexpr std::size_t kFew = 8;
  for (std::size_t j = 0; j < count; ++j) {
    up.pass(layers[count - 1 - j]);
    down.pass(layers[j]);
    damping += layers[j].damping;
    if (j % kFew == 0) {
      up.keep_finite();
      down.keep_finite();
    }
  }
}

// Means of both polarisations; the transmittance is through times exp(log_damping).
struct LaneSides {
  std::array<double, 4> above, through, below, log_damping;
};

SUNBEAM_FLAT_VECTOR_CLONES
void write_sides(const LayerMatrix* layers, std::size_t count, int periods, const End& exterior,
                 const End& base, LaneSides& sides) {
  Fields up = base.fields(), down = exterior.fields();
  Quad damping{};
  if (periods == 1) {
    pass_once(layers, count, up, down, damping);
  } else if (count > 0) {
    const Transfer all = repeated(layers, count, periods);
    up.pass(all, true);
    down.pass(all, false);
    damping = all.damping;
  }
  const Polarised s = polarised(up.s_e, up.s_h, exterior.q_s.re, base.q_s.re),
                  p = polarised(up.p_h, up.p_e, exterior.q_p.re, base.q_p.re),
                  back_s = polarised(down.s_e, down.s_h, base.q_s.re, exterior.q_s.re),
                  back_p = polarised(down.p_h, down.p_e, base.q_p.re, exterior.q_p.re);
  for (std::size_t lane = 0; lane < 4; ++lane) {
    sides.above[lane] = (s.reflectance[lane] + p.reflectance[lane]) / 2;
    sides.through[lane] = (s.transmittance[lane] + p.transmittance[lane]) / 2;
    sides.below[lane] = (back_s.reflectance[lane] + back_p.reflectance[lane]) / 2;
    sides.log_damping[lane] = -2 * (damping[lane] + up.log_scale[lane]);
  }
}

}  // namespace

StackSpectrum::StackSpectrum(const std::vector<FilmStack>& stacks, const std::vector<double>& wavelengths_nm,
                             double spread, double spread_orders)
    : count_(stacks.size()),
      exterior_ior_(stacks.front().exterior_ior),
      periods_(stacks.front().periods),
      factors_{{1, 1}} {
  double most_waves = 0;
  for (std::size_t first = 0; first < count_; first += kLanes) {
    Lanes lanes;
    const std::size_t layers = stacks[first].layers.size();
    lanes.layers.resize(layers);
    lanes.phase.resize(layers);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t k = std::min(first + lane, count_ - 1);
      double waves = 0;
      for (std::size_t j = 0; j < layers; ++j) {
        const FilmLayer& layer = stacks[k].layers[j];
        lanes.layers[j].n[lane] = layer.index.real();
        lanes.layers[j].k[lane] = layer.index.imag();
        lanes.phase[j][lane] = 2 * kPi * layer.thickness_nm / wavelengths_nm[k];
        waves += 2 * layer.index.real() * layer.thickness_nm / wavelengths_nm[k];
      }
      lanes.base.n[lane] = stacks[k].base_index.real();
      lanes.base.k[lane] = stacks[k].base_index.imag();
      most_waves = std::max(most_waves, waves * periods_);
    }
    lanes_.push_back(std::move(lanes));
  }
  if (spread > 0) factors_ = thickness_factors(spread, most_waves, spread_orders);
}

void StackSpectrum::add_powers(const Lanes& lanes, double ior_from, double cosine, double* above,
                               double* through, double* below) const {
  std::vector<LayerAngle> angles(lanes.layers.size());
  End exterior, base;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (std::size_t j = 0; j < angles.size(); ++j)
      set_lane(angles[j], lane, {lanes.layers[j].n[lane], lanes.layers[j].k[lane]}, lanes.phase[j][lane],
               ior_from, cosine);
    set_lane(exterior, lane, exterior_ior_, ior_from, cosine);
    set_lane(base, lane, {lanes.base.n[lane], lanes.base.k[lane]}, ior_from, cosine);
  }
  std::vector<LayerMatrix> layers(angles.size());
  for (const auto& [factor, weight] : factors_) {
    for (std::size_t j = 0; j < angles.size(); ++j) layers[j] = matrix_of(angles[j], factor);
    LaneSides sides;
    write_sides(layers.data(), layers.size(), periods_, exterior, base, sides);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double r = exterior.is_open[lane] ? sides.above[lane] : 1;
      above[lane] += weight * r;
      if (exterior.is_open[lane])
        through[lane] += weight * std::exp(sides.log_damping[lane]) * sides.through[lane];
      below[lane] += weight * (base.is_open[lane] ? sides.below[lane] : r);
    }
  }
}

void StackSpectrum::powers(double ior_from, double cosine, double* above, double* through,
                           double* below) const {
  for (double* values : {above, through, below}) std::fill_n(values, lanes(), 0.0);
  for (std::size_t chunk = 0; chunk < lanes_.size(); ++chunk) {
    const std::size_t at = chunk * kLanes;
    add_powers(lanes_[chunk], ior_from, cosine, above + at, through + at, below + at);
  }
}

StackPower stack_power(const FilmStack& stack, double cos_exterior, double wavelength_nm) {
  if (cos_exterior <= 0) return {1, 0};
  std::array<double, 4> above, through, below;
  StackSpectrum({stack}, {wavelength_nm})
      .powers(stack.exterior_ior, cos_exterior, above.data(), through.data(), below.data());
  return {above[0], through[0]};
}

std::optional<double> reflectance_below(const FilmStack& stack, double cos_exterior, double wavelength_nm) {
  if (stack.base_index.imag() > 0) return {};
  const double c2_squared = cosine_squared(stack.exterior_ior, stack.base_index, cos_exterior).real();
  if (c2_squared <= 0) return {};
  FilmStack reversed{stack.base_index.real(),
                     {stack.layers.rbegin(), stack.layers.rend()},
                     stack.exterior_ior,
                     stack.periods};
  return stack_power(reversed, std::sqrt(c2_squared), wavelength_nm).reflectance;
}

}  // namespace v1
}  // namespace sunbeam
