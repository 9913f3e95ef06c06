#include "sunbeam/table.h"

#include <algorithm>

#include "sunbeam/detail/factor_frame.h"

namespace sunbeam {
inline namespace v1 {

bool is_in_tables(std::string_view key, int schema_version) {
  return schema_version > kSingleFilmSchemaVersion || (key != "thickness_spread" && key != "base_extinction");
}

bool reaches_below(const Table& table) {
  return reaches_below_exterior(table.material, table.parameter_axis(1).low());
}

Rgb Table::transmittance(const std::array<double, 3>& x) const {
  if (film_transmittance.empty()) return Rgb(1) - film_reflectance.interpolate(x);
  return film_transmittance.interpolate(x);
}

bool Table::is_full_spectrum() const {
  const auto at = info.find("spectrum");
  return at != info.end() && at->second == "full";
}

ColorSpace Table::color_space() const {
  return is_full_spectrum() ? color_space_from(info.at("color_space")) : ColorSpace::rec709;
}

std::vector<const NdArray*> Table::arrays() const {
  std::vector<const NdArray*> arrays;
  for (const NdArray* array : {&factors.arrival, &factors.crossing, &factors.exchange, &factors.facet_cosine,
                               &film_reflectance, &film_transmittance, &first_visit, &remainder, &rest_stderr,
                               &factors.return_cosine, &factors.returned, &factors.returning})
    if (!array->empty()) arrays.push_back(array);
  return arrays;
}

bool Table::operator==(const Table& other) const {
  for (const auto& key : material_keys())
    if (get_text(material, key) != get_text(other.material, key)) return false;
  const auto mine = arrays(), others = other.arrays();
  return symmetry == other.symmetry && frame == other.frame && info == other.info &&
         factors.grid == other.factors.grid && factors.wavelengths == other.factors.wavelengths &&
         std::equal(mine.begin(), mine.end(), others.begin(), others.end(),
                    [](const NdArray* a, const NdArray* b) { return *a == *b; });
}

}  // namespace v1
}  // namespace sunbeam
