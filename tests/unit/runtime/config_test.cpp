#include "runtime/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sunbeam/core/error.h"
#include "tests/support/error_of.h"
#include "tests/support/scratch_folder.h"

namespace sunbeam {
namespace {

using test::error_of;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

constexpr const char* kText = R"(title = "skin"
[film]
thickness = 300.5
count = 7
smooth = true
mode = "sum"
colour = [0.1, 0.2, 0.3]
grey = 0.5
)";

ConfigTable config(const std::vector<std::string>& overrides = {}) {
  return ConfigTable::parse(kText, "skin.toml", overrides);
}
ConfigTable film(const std::vector<std::string>& overrides = {}) { return config(overrides).table("film"); }

TEST(Config, ReadsEveryType) {
  const ConfigTable table = film();
  EXPECT_EQ(config().string("title"), "skin");
  EXPECT_EQ(table.number("thickness", {0, 1000}), 300.5);
  EXPECT_EQ(table.number("count", {}), 7);  // a whole number is a number
  EXPECT_EQ(table.integer("count", 0, 10), 7);
  EXPECT_TRUE(table.boolean("smooth", false));
  EXPECT_EQ(table.choice("mode", {"product", "sum"}), 1);
  EXPECT_EQ(table.numbers("colour", {0, 1}), (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(table.rgb("colour", {0, 1}), Rgb(0.1, 0.2, 0.3));
  EXPECT_EQ(table.rgb("grey", {0, 1}), Rgb(0.5));
  EXPECT_EQ(table.vec3("colour").y, 0.2);
}

TEST(Config, RowsAreListsOfNumbers) {
  const auto table =
      ConfigTable::parse("rows = [[1, 2], [3, 4.5, 6]]\nword = \"a\"\nnumber = 1", "skin.toml");
  EXPECT_EQ(table.rows("rows", 2, 3), (std::vector<std::vector<double>>{{1, 2}, {3, 4.5, 6}}));
  EXPECT_TRUE(table.is_string("word"));
  EXPECT_FALSE(table.is_string("number"));
  EXPECT_FALSE(table.is_string("absent"));
  EXPECT_EQ(error_of([&] { table.rows("rows", 1, 2); }),
            "skin.toml:1: key 'rows': element 2 is a list of 3; allowed: a list of lists of 1 to 2 numbers");
  EXPECT_EQ(error_of([&] { table.rows("number", 2, 3); }),
            "skin.toml:3: key 'number': found 1; allowed: a list of lists of 2 to 3 numbers");
  EXPECT_THAT(error_of([&] { table.rows("absent", 2, 3); }),
              HasSubstr("key 'absent': is missing; allowed: a list"));
}

TEST(Config, FallbacksServeMissingKeysOnly) {
  const ConfigTable table = film();
  EXPECT_EQ(table.number("absent", {0, 1}, 0.25), 0.25);
  EXPECT_EQ(table.number("grey", {0, 1}, 0.25), 0.5);
  EXPECT_EQ(table.integer("absent", 0, 9, 3), 3);
  EXPECT_EQ(table.choice("absent", {"a", "b"}, 1), 1);
  EXPECT_EQ(table.string("absent", "x"), "x");
  EXPECT_TRUE(table.boolean("absent", true));
  EXPECT_EQ(table.rgb("absent", {0, 1}, Rgb(1, 2, 3)), Rgb(1, 2, 3));
}

// A bad value is refused even where a fallback is given. Line 3 holds `thickness`.
TEST(Config, RangeErrorNamesFileLineKeyValueAndRange) {
  const auto message = error_of([] { film().number("thickness", {0, 200}, 100); });
  EXPECT_THAT(message, StartsWith("skin.toml:3: key 'film.thickness'"));
  EXPECT_THAT(message, AllOf(HasSubstr("300.5"), HasSubstr("0 to 200")));
  EXPECT_EQ(film().number("thickness", {300.5, 300.5}), 300.5);  // closed interval
}

TEST(Config, TypeErrors) {
  EXPECT_THAT(error_of([] {
                film().number("mode", {0, 1});
              }),
              AllOf(StartsWith("skin.toml:6: key 'film.mode'"), HasSubstr("found a string")));
  EXPECT_THAT(error_of([] { film().number("smooth", {0, 1}); }), HasSubstr("found a boolean"));
  EXPECT_THAT(error_of([] { film().string("grey"); }), HasSubstr("key 'film.grey'"));
  EXPECT_THAT(error_of([] { film().boolean("grey", true); }), HasSubstr("true or false"));
  EXPECT_THAT(error_of([] { film().integer("thickness", 0, 1000); }), HasSubstr("whole number"));
  EXPECT_THAT(error_of([] { film().numbers("grey", {}); }), HasSubstr("list of numbers"));
  EXPECT_THAT(error_of([] { film().rgb("mode", {}); }), HasSubstr("found a string"));
  EXPECT_THAT(error_of([] { config().table("title"); }), HasSubstr("a section"));
  EXPECT_THAT(error_of([] { config().tables("film"); }), HasSubstr("[[film]]"));
}

TEST(Config, MissingKeyIsNamed) {
  EXPECT_THAT(error_of([] {
                film().number("absent", {0, 1});
              }),
              AllOf(HasSubstr("key 'film.absent'"), HasSubstr("missing"), HasSubstr("0 to 1")));
  EXPECT_THAT(error_of([] { film().string("absent"); }), HasSubstr("missing"));
}

TEST(Config, NotFiniteIsRefused) {
  const auto table = ConfigTable::parse("a = nan\nb = inf\nc = [0, nan, 1]", "f", {});
  EXPECT_THROW(table.number("a", {}), Error);
  EXPECT_THROW(table.number("b", {}), Error);
  EXPECT_THROW(table.numbers("c", {}), Error);
}

TEST(Config, ListErrorNamesTheElement) {
  EXPECT_THAT(error_of([] {
                film().numbers("colour", {0, 0.25});
              }),
              AllOf(StartsWith("skin.toml:7:"), HasSubstr("element 3"), HasSubstr("0.3")));
  const auto short_list = ConfigTable::parse("c = [1, 2]", "f", {});
  EXPECT_THAT(error_of([&] { short_list.rgb("c", {}); }), HasSubstr("found 2 numbers"));
  EXPECT_THAT(error_of([&] { short_list.vec3("c"); }), HasSubstr("found 2 numbers"));
}

TEST(Config, ChoiceErrorListsWhatIsAllowed) {
  EXPECT_THAT(error_of([] {
                film().choice("mode", {"product", "straight"});
              }),
              AllOf(HasSubstr("\"sum\""), HasSubstr("\"product\", \"straight\"")));
}

TEST(Config, UnknownKeyNamesTheNearest) {
  const auto root = ConfigTable::parse("[film]\nthicknes = 1\n", "f.toml", {});
  const auto table = root.table("film");
  table.number("thickness", {}, 1);
  table.number("count", {}, 1);
  EXPECT_THAT(error_of([&] { root.finish(); }),
              AllOf(StartsWith("f.toml:2: key 'film.thicknes'"), HasSubstr("'thickness'")));
}

TEST(Config, UnknownSectionIsRefused) {
  const auto root = ConfigTable::parse("[flim]\nx = 1\n", "f.toml", {});
  root.table("film");
  EXPECT_THAT(error_of([&] { root.finish(); }), AllOf(HasSubstr("'flim'"), HasSubstr("'film'")));
}

TEST(Config, FinishPassesWhenAllIsAsked) {
  const auto root = config();
  root.string("title");
  const auto table = root.table("film");
  for (const char* key : {"thickness", "count", "smooth", "mode", "colour", "grey"}) table.has(key);
  EXPECT_NO_THROW(root.finish());
}

TEST(Config, ListsOfTables) {
  const auto root =
      ConfigTable::parse("[[light]]\npower = 1\n[[light]]\npower = 2\nradios = 3\n", "f.toml", {});
  const auto lights = root.tables("light");
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[1].number("power", {}), 2);
  EXPECT_EQ(lights[0].number("power", {}), 1);
  EXPECT_TRUE(root.tables("absent").empty());
  EXPECT_THAT(error_of([&] { root.finish(); }), HasSubstr("f.toml:5: key 'light[1].radios'"));
}

TEST(Config, OverridesReplaceAddAndKeepTypes) {
  EXPECT_EQ(film({"film.thickness=12"}).number("thickness", {}), 12);
  EXPECT_EQ(film({"film.mode=product"}).string("mode"), "product");  // bare string
  EXPECT_EQ(film({"film.mode=\"product\""}).string("mode"), "product");
  EXPECT_EQ(film({"film.colour=[1, 0, 0.5]"}).rgb("colour", {0, 1}), Rgb(1, 0, 0.5));
  EXPECT_FALSE(film({"film.smooth=false"}).boolean("smooth", true));
  EXPECT_EQ(config({"other.sub.x=4"}).table("other").table("sub").integer("x", 0, 9), 4);
  EXPECT_EQ(film({"film.count=1", "film.count=2"}).integer("count", 0, 9), 2);  // the last one counts
}

TEST(Config, OverridesReachIntoLists) {
  const std::string text = "[[light]]\nx = 1\n[[light]]\nx = 2\n";
  const auto lights =
      ConfigTable::parse(text, "f.toml", {"light[1].x=7", "light[0].sub.y=3"}).tables("light");
  EXPECT_EQ(lights[0].integer("x", 0, 9), 1);
  EXPECT_EQ(lights[1].integer("x", 0, 9), 7);
  EXPECT_EQ(lights[0].table("sub").integer("y", 0, 9), 3);
  for (const char* bad :
       {"light[2].x=1", "light[-1].x=1", "light[].x=1", "light[0.x=1", "light.x=1", "lamp[0].x=1"})
    EXPECT_THAT(error_of([&] { ConfigTable::parse(text, "f.toml", {bad}); }), HasSubstr("is not a section"))
        << bad;
}

TEST(Config, OverriddenValueIsCheckedToo) {
  EXPECT_THAT(error_of([] {
                film({"film.thickness=-1"}).number("thickness", {0, 9});
              }),
              AllOf(HasSubstr("film.thickness"), HasSubstr("-1")));
}

TEST(Config, MalformedOverridesAreRefused) {
  for (const char* bad : {"film.thickness", "thickness=3", ".x=3", "=", "", "a=b.c"})
    EXPECT_THAT(error_of([&] { config({bad}); }), HasSubstr("section.key=value")) << bad;
  EXPECT_THAT(error_of([] { config({"title.x=1"}); }), HasSubstr("'title' is not a section"));
}

TEST(Config, SyntaxErrorNamesFileAndLine) {
  EXPECT_THAT(error_of([] { ConfigTable::parse("a = 1\nb = = 2\n", "bad.toml"); }),
              StartsWith("bad.toml:2: not valid TOML"));
}

TEST(Config, MissingFileAndFolder) {
  EXPECT_THAT(error_of([] { ConfigTable::load("/nowhere/x.toml"); }), StartsWith("/nowhere/x.toml: "));
  EXPECT_THROW(ConfigTable::load("/"), Error);
}

TEST(Config, ResolveIsRelativeToTheFile) {
  EXPECT_EQ(ConfigTable::parse("", "scenes/a/s.toml").resolve("../t.stbl"), "scenes/t.stbl");
}

TEST(Config, TwoDotsBehindALinkLeadAboveItsEnd) {
  const ScratchFolder folder;
  fs::create_directories(folder.file("disk/deep"));
  fs::create_directory_symlink("disk/deep", folder.file("link"));
  const ConfigTable table = ConfigTable::parse("[a]\n", folder.file("s.toml"));
  EXPECT_EQ(table.resolve("disk/../f"), folder.file("f"));
  EXPECT_EQ(table.resolve("link/../f"), folder.file("link/../f"));  // which is disk/f
  EXPECT_EQ(table.table("a").resolve("link/f"), folder.file("link/f"));
  EXPECT_THAT(table.resolved_files(),
              ElementsAre(folder.file("f"), folder.file("link/../f"), folder.file("link/f")));
}

TEST(Config, InfinityIsNoPointOfACurve) {
  for (const std::string pair : {"[1, inf]", "[inf, 1]", "[1, nan]", "[1, -inf]"})
    EXPECT_THAT(error_of([&] { ConfigTable::parse("a = [[0, 1], " + pair + "]", "c").curve("a", {}, {}); }),
                HasSubstr("element 2 is " + pair));
}

TEST(Config, CanonicalTextHoldsOverridesAndReadsBack) {
  const auto text = config({"film.count=9"}).canonical_text();
  const auto back = ConfigTable::parse(text, "back");
  EXPECT_EQ(back.table("film").integer("count", 0, 9), 9);
  EXPECT_EQ(back.canonical_text(), text);
}

TEST(Config, NearestByEditDistance) {
  EXPECT_EQ(nearest("rougness", {"albedo", "roughness", "mode"}), "roughness");
  EXPECT_EQ(nearest("x", {}), "");
}

}  // namespace
}  // namespace sunbeam
