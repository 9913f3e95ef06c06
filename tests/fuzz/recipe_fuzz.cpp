// Recipes: TOML, its keys, its grids, and what their text says when it is parsed again.
#include "bake/recipe/recipe.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) {
    const Recipe recipe = parse_recipe(bytes, "r");
    parse_recipe(recipe.text, "again");
  });
}
