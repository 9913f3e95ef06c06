// Refractive indices in recipes: the four forms, and the messages of what is refused.
#include "bake/recipe/optical_index_key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Complex = std::complex<double>;

OpticalIndex read(const std::string& lines) {
  const ConfigTable config = ConfigTable::parse("[layer]\n" + lines, "r.toml"), layer = config.table("layer");
  const auto index = read_optical_index(layer, "ior", "extinction");
  config.finish();
  return index;
}
std::string refusal(const std::string& lines) {
  return error_of([&] { read(lines); });
}

TEST(OpticalIndexKey, ReadsItsForms) {
  EXPECT_EQ(read("ior = 1.56"), OpticalIndex::constant(1.56));
  EXPECT_EQ(read("ior = 2"), OpticalIndex::constant(2));
  EXPECT_EQ(read("ior = 0.05\nextinction = 3.5"), OpticalIndex::constant(0.05, 3.5));
  EXPECT_EQ(read("ior = { cauchy = [1.517, 8800] }"), OpticalIndex::cauchy({1.517, 8800, 0}));
  EXPECT_EQ(read("ior = { cauchy = [1.5, 8800, 2e8] }\nextinction = 0.1"),
            OpticalIndex::cauchy({1.5, 8800, 2e8}, 0.1));
  EXPECT_EQ(read("ior = [[400, 1.6], [700, 1.5, 0.01]]"),
            OpticalIndex::measured({{400, 1.6, 0}, {700, 1.5, 0.01}}));
  EXPECT_EQ(read("ior = \"chitin\""), OpticalIndex::named("chitin"));
  EXPECT_EQ(read("ior = \"Ti\""), OpticalIndex::named("Ti"));
}

TEST(OpticalIndexKey, RefusesOtherKinds) {
  const std::string forms =
      "allowed: a number, 0.05 to 10; { cauchy = [A, B] }; a list of [nm, n] or [nm, n, k]; the name of a "
      "table";
  EXPECT_THAT(refusal(""), AllOf(StartsWith("r.toml:1: key 'layer.ior': is missing"), HasSubstr(forms)));
  EXPECT_THAT(refusal("ior = true"),
              AllOf(StartsWith("r.toml:2: key 'layer.ior': found a boolean"), HasSubstr(forms)));
  EXPECT_THAT(refusal("ior = 2026-01-01"), HasSubstr("found a date or time"));
  EXPECT_THAT(refusal("extinction = 0.1"), HasSubstr("key 'layer.ior': is missing"));
}

TEST(OpticalIndexKey, RefusesNumbersOutOfRange) {
  EXPECT_THAT(refusal("ior = 0.01"), HasSubstr("key 'layer.ior': found 0.01; allowed: 0.05 to 10"));
  EXPECT_THAT(refusal("ior = nan"), HasSubstr("key 'layer.ior': found nan; allowed: 0.05 to 10"));
  EXPECT_THAT(refusal("ior = inf"), HasSubstr("found inf"));
  EXPECT_THAT(refusal("ior = 1.5\nextinction = -1"),
              HasSubstr("r.toml:3: key 'layer.extinction': found -1; allowed: 0 to 100"));
  EXPECT_THAT(refusal("ior = 1.5\nextinction = \"big\""),
              HasSubstr("found a string; allowed: a number, 0 to 100"));
}

TEST(OpticalIndexKey, RefusesWrongFormulas) {
  EXPECT_THAT(refusal("ior = { cauchy = [1.5] }"), HasSubstr("key 'layer.ior.cauchy': found 1 numbers"));
  EXPECT_THAT(refusal("ior = { cauchy = [1, 2, 3, 4] }"),
              HasSubstr("found 4 numbers; allowed: [A, B] or [A, B, C]"));
  EXPECT_THAT(refusal("ior = { cauchy = [1.5, \"x\"] }"), HasSubstr("element 2 is a string"));
  EXPECT_THAT(refusal("ior = { cauchy = [1.5, nan] }"), HasSubstr("element 2 is nan"));
  EXPECT_THAT(refusal("ior = { cauchy = 1.5 }"), HasSubstr("key 'layer.ior.cauchy'"));
  EXPECT_THAT(refusal("ior = {}"), HasSubstr("key 'layer.ior.cauchy': is missing"));
  EXPECT_THAT(refusal("ior = { cauchi = [1.5, 1] }"), HasSubstr("key 'layer.ior.cauchy': is missing"));
  EXPECT_THAT(refusal("ior = { cauchy = [1.5, 1], k = 1 }"), HasSubstr("key 'layer.ior.k': is not known"));
  EXPECT_THAT(refusal("ior = { cauchy = [1.5, 1e8] }"), AllOf(HasSubstr("key 'layer.ior.cauchy': found n = "),
                                                              HasSubstr("at 380 nm; allowed: 0.05 to 10")));
}

TEST(OpticalIndexKey, RefusesWrongLists) {
  const std::string rows = "allowed: a list of lists of 2 to 3 numbers";
  EXPECT_THAT(refusal("ior = []"), HasSubstr("key 'layer.ior': the list is empty"));
  EXPECT_THAT(refusal("ior = [1.5, 1.6]"), AllOf(HasSubstr("element 1 is 1.5"), HasSubstr(rows)));
  EXPECT_THAT(refusal("ior = [[400, 1.5], [500]]"),
              AllOf(HasSubstr("element 2 is a list of 1"), HasSubstr(rows)));
  EXPECT_THAT(refusal("ior = [[400, 1.5, 0, 0]]"), HasSubstr("element 1 is a list of 4"));
  EXPECT_THAT(refusal("ior = [[400, 1.5], [700, nan]]"), HasSubstr("element 2 is [700, nan]"));
  EXPECT_THAT(refusal("ior = [[400, \"x\", 0]]"), HasSubstr("element 1 is [400, a string, 0]"));
  EXPECT_THAT(refusal("ior = [[400, 1.5], [400, 1.6]]"),
              HasSubstr("key 'layer.ior': found the wavelength 400 nm after"));
  EXPECT_THAT(refusal("ior = [[500, 1.5], [600, 1.6]]"), HasSubstr("found wavelengths from 500 to 600 nm"));
  EXPECT_THAT(refusal("ior = [[400, 1.5], [700, 1.6, -0.1]]"), HasSubstr("found k = -0.1 at 700 nm"));
}

// Most books print B in um^2, which in nm^2 would be no dispersion at all.
TEST(OpticalIndexKey, RefusesCauchysFormulaInMicrometres) {
  EXPECT_THAT(refusal("ior = { cauchy = [1.45, 0.0042] }"),
              AllOf(HasSubstr("found 0.0042"), HasSubstr("nm^2")));
  EXPECT_THAT(refusal("ior = { cauchy = [1.45, 4200, -1e-4] }"), HasSubstr("found -0.0001"));
}

TEST(OpticalIndexKey, RefusesWrongNames) {
  EXPECT_THAT(refusal("ior = \"chitn\""),
              AllOf(HasSubstr("key 'layer.ior': found \"chitn\""),
                    HasSubstr("optical constants, one of Ag, Al"), HasSubstr("chitin")));
  EXPECT_THAT(refusal("ior = \"\""), HasSubstr("found \"\""));
  EXPECT_THAT(refusal("ior = \"1.5\""), HasSubstr("found \"1.5\""));
  EXPECT_THAT(refusal("ior = \"a\\u0007b\""), HasSubstr("found \"a\\x07b\""));
}

TEST(OpticalIndexKey, RefusesAnExtinctionBesideWhatHasItsOwn) {
  EXPECT_THAT(refusal("ior = \"Ag\"\nextinction = 1"),
              HasSubstr("r.toml:3: key 'layer.extinction': stands beside a name in 'ior'"));
  EXPECT_THAT(refusal("ior = [[400, 1.5], [700, 1.5]]\nextinction = 0"),
              HasSubstr("stands beside a list in 'ior'"));
}

}  // namespace
}  // namespace sunbeam
