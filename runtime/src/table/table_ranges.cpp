#include "sunbeam/detail/table_ranges.h"

#include <algorithm>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr Interval kReturned{0, 1};
// All visits of the base add up to 1 / (1 - albedo returned). A white base under indices of 5 comes to 0.96.
constexpr double kMostReturned = 0.999;
// ln A + tau/m~, where A is at most 1 and its logarithm at least -70. Beyond, a float is too coarse for exp.
constexpr Interval kArrival{-100, 1e6};
constexpr Interval kExchange{-1e30, 1e30};
// Shares of light: plainly, with what sums of numbers lack of 1, or folded into colours.
constexpr Interval kShare{-0.001, 1.01}, kFoldedShare{-1, 2};
constexpr Interval kRemainder{-1e7, 1e7}, kStandardError{0, 1e7};

void require(const NdArray& array, const Interval& allowed) {
  const auto low = static_cast<float>(allowed.low), high = static_cast<float>(allowed.high);
  const auto is_outside = [=](float value) { return !(value >= low && value <= high); };
  const auto at = std::ranges::find_if(array.values(), is_outside);
  if (at != array.values().end())
    throw Error("array '" + array.name() + "' leaves " + to_text(allowed.low) + " to " +
                to_text(allowed.high) + ": it holds " + to_text(*at));
}

void require_light_leaves(const Table& table) {
  const auto& albedo = table.factors.wavelengths.albedo;
  const auto returned = table.factors.returned.values();
  const double most = *std::max_element(albedo.begin(), albedo.end()) *
                      double{*std::max_element(returned.begin(), returned.end())};
  if (most > kMostReturned)
    throw Error("array 'returned' times attribute 'spectral.albedo' reaches " + to_text(most) +
                "; allowed: up to " + to_text(kMostReturned));
}

void require_depths_of_product(const Table& table) {
  const auto& absorption = table.factors.wavelengths.absorption;
  const double deepest = table.factors.grid[2].high() * table.material.pigment_thickness_nm *
                         *std::max_element(absorption.begin(), absorption.end());
  if (deepest > kDeepestProduct)
    throw Error("absorption_per_nm reaches an optical depth of " + to_text(deepest) +
                "; allowed in a factored table of path product: up to " + to_text(kDeepestProduct));
}

}  // namespace

void require_in_ranges(const Table& table) {
  const Interval share = table.is_full_spectrum() ? kFoldedShare : kShare;
  require(table.factors.returned, kReturned);
  require(table.factors.arrival, kArrival);
  require(table.factors.exchange, kExchange);
  require(table.film_reflectance, share);
  require(table.film_transmittance, share);
  require(table.first_visit, kFoldedShare);
  require(table.remainder, kRemainder);
  require(table.rest_stderr, kStandardError);
  if (!table.factors.returned.empty()) require_light_leaves(table);
  if (!table.factors.exchange.empty()) require_depths_of_product(table);
}

}  // namespace v1
}  // namespace sunbeam
