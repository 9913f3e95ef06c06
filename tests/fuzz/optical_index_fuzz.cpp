// Refractive indices of a recipe: what is read has n and k in their ranges at every visible wavelength.
#include <complex>
#include <cstdlib>

#include "bake/recipe/optical_index_key.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) {
    const OpticalIndex index = read_optical_index(ConfigTable::parse(bytes, "r"), "ior", "extinction");
    for (double nm = 380; nm <= 780; nm += 0.5) {
      const auto [n, k] = std::pair(index.at(nm).real(), index.at(nm).imag());
      if (!(n >= kLeastIor && n <= kLargestIor && k >= 0 && k <= kMostExtinction)) std::abort();
    }
  });
}
