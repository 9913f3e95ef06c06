#include "bake/optics/dispersion/optical_index.h"

#include <algorithm>
#include <cmath>

#include "bake/optics/dispersion/visible.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Throws Error unless n and k are numbers in their ranges.
void require_in_range(double n, double k, double wavelength_nm) {
  const std::string at = " at " + to_text(wavelength_nm) + " nm; allowed: ";
  if (!(n >= kLeastIor && n <= kLargestIor))
    throw Error("found n = " + to_text(n) + at + to_text(kLeastIor) + " to " + to_text(kLargestIor));
  if (!(k >= 0 && k <= kMostExtinction))
    throw Error("found k = " + to_text(k) + at + "0 to " + to_text(kMostExtinction));
}

void require_ascending(const std::vector<OpticalConstants>& lines) {
  double last = 0;
  for (const auto& line : lines) {
    if (!(line.wavelength_nm > last && std::isfinite(line.wavelength_nm)))
      throw Error("found the wavelength " + to_text(line.wavelength_nm) + " nm after " + to_text(last) +
                  " nm; allowed: wavelengths that ascend");
    last = line.wavelength_nm;
  }
}

// Of wavelengths that ascend.
void require_coverage(const std::vector<OpticalConstants>& lines) {
  const std::string allowed = "; allowed: a list from " + to_text(kListBeginsByNm) + " nm or less to " +
                              to_text(kListEndsFromNm) + " nm or more";
  if (lines.empty()) throw Error("the list is empty" + allowed);
  const double from = lines.front().wavelength_nm, to = lines.back().wavelength_nm;
  if (from > kListBeginsByNm || to < kListEndsFromNm)
    throw Error("found wavelengths from " + to_text(from) + " to " + to_text(to) + " nm" + allowed);
}

std::complex<double> interpolate(const std::vector<OpticalConstants>& lines, double wavelength_nm) {
  const double from = lines.front().wavelength_nm, to = lines.back().wavelength_nm;
  const double low = std::min(from, kShortestVisibleNm), high = std::max(to, kLongestVisibleNm);
  if (!(wavelength_nm >= low && wavelength_nm <= high))
    throw Error("found the wavelength " + to_text(wavelength_nm) + " nm; its optical constants allow " +
                to_text(low) + " to " + to_text(high) + " nm");
  const double nm = std::clamp(wavelength_nm, from, to);
  const auto above = std::ranges::lower_bound(lines, nm, {}, &OpticalConstants::wavelength_nm);
  if (above->wavelength_nm == nm) return {above->n, above->k};
  const auto& below = *(above - 1);
  const double t = (nm - below.wavelength_nm) / (above->wavelength_nm - below.wavelength_nm);
  return {std::lerp(below.n, above->n, t), std::lerp(below.k, above->k, t)};
}

}  // namespace

OpticalIndex OpticalIndex::constant(double n, double k) { return cauchy({n, 0, 0}, k); }

OpticalIndex OpticalIndex::cauchy(const std::array<double, 3>& coefficients, double k) {
  OpticalIndex index;
  index.cauchy_ = coefficients;
  index.extinction_ = k;
  // n is a parabola over 1 / wavelength^2: it is extreme at the ends or where its slope B + 2 C /
  // wavelength^2 is zero. Without such a wavelength the root is no number, or lies outside.
  const double flat = std::sqrt(-2 * coefficients[2] / coefficients[1]);
  index.at(kShortestVisibleNm);
  index.at(kLongestVisibleNm);
  if (flat > kShortestVisibleNm && flat < kLongestVisibleNm) index.at(flat);
  return index;
}

OpticalIndex OpticalIndex::measured(std::vector<OpticalConstants> lines) {
  require_ascending(lines);
  for (const auto& line : lines) require_in_range(line.n, line.k, line.wavelength_nm);
  require_coverage(lines);
  OpticalIndex index;
  index.lines_ = std::move(lines);
  return index;
}

OpticalIndex OpticalIndex::named(std::string_view name) {
  const auto table = std::ranges::find(optical_tables(), name, &OpticalTable::name);
  if (table == optical_tables().end())
    throw Error("found \"" + printable(name) +
                "\"; allowed: the name of a table of optical constants, such as \"" +
                std::string(optical_tables().front().name) + "\"");
  return measured({table->lines.begin(), table->lines.end()});
}

std::complex<double> OpticalIndex::at(double wavelength_nm) const {
  if (!lines_.empty()) return interpolate(lines_, wavelength_nm);
  const double square = wavelength_nm * wavelength_nm;
  const double n = cauchy_[0] + (cauchy_[1] + cauchy_[2] / square) / square;
  require_in_range(n, extinction_, wavelength_nm);
  return {n, extinction_};
}

std::vector<std::string> optical_table_names() {
  std::vector<std::string> names;
  for (const auto& table : optical_tables()) names.emplace_back(table.name);
  return names;
}

}  // namespace sunbeam
