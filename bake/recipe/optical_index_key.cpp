#include "bake/recipe/optical_index_key.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr Range kIor{kLeastIor, kLargestIor}, kExtinction{0, kMostExtinction};

// Makes an index; an Error of it names the key.
template <class Make>
OpticalIndex made(const ConfigTable& config, const char* key, Make make) {
  try {
    return make();
  } catch (const Error& error) {
    config.fail(key, error.what());
  }
}

OpticalIndex read_cauchy(const ConfigTable& config, const char* ior_key, double extinction) {
  constexpr const char* kCauchy = "cauchy";
  const ConfigTable formula = config.table(ior_key);
  const auto values = formula.numbers(kCauchy, {});
  if (values.size() != 2 && values.size() != 3)
    formula.fail(kCauchy, fmt::format("found {} numbers; allowed: [A, B] or [A, B, C]", values.size()));
  for (const double value : values)
    if (&value != values.data() && value != 0 && std::abs(value) < 1)
      formula.fail(kCauchy,
                   fmt::format("found {:g}; allowed: B in nm^2 and C in nm^4, 0 or of at least 1; B in "
                               "um^2 is a million times that in nm^2",
                               value));
  std::array<double, 3> coefficients{};
  std::ranges::copy(values, coefficients.begin());
  return made(formula, kCauchy, [&] { return OpticalIndex::cauchy(coefficients, extinction); });
}

OpticalIndex read_list(const ConfigTable& config, const char* ior_key) {
  std::vector<OpticalConstants> lines;
  for (const auto& row : config.rows(ior_key, 2, 3))
    lines.push_back({row[0], row[1], row.size() == 3 ? row[2] : 0});
  return made(config, ior_key, [&] { return OpticalIndex::measured(std::move(lines)); });
}

OpticalIndex read_name(const ConfigTable& config, const char* ior_key) {
  const std::string name = config.string(ior_key);
  const auto names = optical_table_names();
  if (std::ranges::find(names, name) == names.end())
    config.fail(ior_key, fmt::format("found \"{}\"; allowed: a table of optical constants, one of {}",
                                     printable(name), fmt::join(names, ", ")));
  return OpticalIndex::named(name);
}

}  // namespace

OpticalIndex read_optical_index(const ConfigTable& config, const char* ior_key, const char* extinction_key) {
  const bool is_number = config.is_number(ior_key);
  if (is_number || config.is_table(ior_key)) {
    const double extinction = config.number(extinction_key, kExtinction, 0);
    return is_number ? OpticalIndex::constant(config.number(ior_key, kIor), extinction)
                     : read_cauchy(config, ior_key, extinction);
  }
  const bool is_list = config.is_list(ior_key);
  if (!is_list && !config.is_string(ior_key))
    config.refuse(
        ior_key,
        fmt::format("a number, {:g} to {:g}; {{ cauchy = [A, B] }}; a list of [nm, n] or [nm, n, k]; "
                    "the name of a table of optical constants",
                    kIor.low, kIor.high));
  if (config.has(extinction_key))
    config.fail(extinction_key,
                fmt::format("stands beside a {} in '{}'; allowed beside a number or {{ cauchy = "
                            "[A, B] }}",
                            is_list ? "list" : "name", ior_key));
  return is_list ? read_list(config, ior_key) : read_name(config, ior_key);
}

}  // namespace sunbeam
