#include "bake/factored/orders/stack_powers.h"

#include <algorithm>
#include <limits>

#include "sunbeam/detail/layered_film.h"
#include "sunbeam/detail/refraction.h"

namespace sunbeam {
namespace {

// A fringe is less than a fifth of a radian wide between two nodes at 100 orders.
constexpr std::size_t kLeastSteps = 384, kStepsPerOrder = 24;

std::size_t steps_for(std::span<const double> orders) {
  const double most = *std::max_element(orders.begin(), orders.end());
  return kLeastSteps + static_cast<std::size_t>(kStepsPerOrder * most);
}

}  // namespace

StackSpectrum stack_at_orders(const Material& material, const Wavelengths& one,
                              std::span<const double> orders) {
  Material thin = material;
  thin.film_thickness_nm = 1;
  const FilmStack stack = film_stack(thin, one, 0);
  const double path = path_per_thickness(material, one, 0);
  std::vector<double> wavelengths;
  for (const double order : orders)
    wavelengths.push_back(order > 0 ? path / order : std::numeric_limits<double>::infinity());
  return {std::vector<FilmStack>(orders.size(), stack), wavelengths, material.thickness_spread};
}

double ior_of(const Material& material, Side side) {
  const bool is_below = side == Side::inside && material.transmission == Transmission::refract;
  return is_below ? bending_base_ior(material) : material.exterior_ior;
}

StackPowers::StackPowers(const Material& material, const Wavelengths& one, Side side,
                         std::span<const double> orders)
    : orders_(orders.size()), steps_(steps_for(orders)) {
  constexpr double kGrazing = 1e-9;  // the film's powers are not asked for at 0
  const StackSpectrum film = stack_at_orders(material, one, orders);
  const auto count = static_cast<std::ptrdiff_t>(orders_);
  std::vector<double> above(film.lanes()), through(film.lanes()), below(film.lanes());
  for (std::size_t node = 0; node <= steps_; ++node) {
    const double cosine = static_cast<double>(node) / static_cast<double>(steps_);
    film.powers(ior_of(material, side), std::max(cosine, kGrazing), above.data(), through.data(),
                below.data());
    const std::vector<double>& reflectance = side == Side::outside ? above : below;
    rows_.insert(rows_.end(), reflectance.begin(), reflectance.begin() + count);
    rows_.insert(rows_.end(), through.begin(), through.begin() + count);
  }
}

void StackPowers::at(double cosine, std::span<double> reflectance, std::span<double> transmittance) const {
  const double x = std::clamp(cosine, 0.0, 1.0) * static_cast<double>(steps_);
  const std::size_t node = std::min(static_cast<std::size_t>(x), steps_ - 1);
  const double t = x - static_cast<double>(node);
  const double *lower = row(node), *upper = row(node + 1);
  for (std::size_t j = 0; j < orders_; ++j) {
    reflectance[j] = (1 - t) * lower[j] + t * upper[j];
    transmittance[j] = (1 - t) * lower[orders_ + j] + t * upper[orders_ + j];
  }
}

}  // namespace sunbeam
