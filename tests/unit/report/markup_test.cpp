// What a file says stands in a page as text, never as markup.
#include "bake/report/markup.h"

#include <gtest/gtest.h>

#include "bake/report/html_report.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr const char* kHostile = R"(</p><script>alert("1 & '2'")</script>)";

TEST(Markup, EscapesWhatMeansSomething) {
  EXPECT_EQ(escape_markup(kHostile),
            "&lt;/p&gt;&lt;script&gt;alert(&quot;1 &amp; &#39;2&#39;&quot;)&lt;/script&gt;");
  EXPECT_EQ(escape_markup("\u00e4 \u20ac\n"), "\u00e4 \u20ac\n");
}

TEST(Markup, HoldsNeitherControlCharactersNorBytesThatAreNotUtf8) {
  EXPECT_EQ(escape_markup(std::string("a\0b\x1b", 4)), "a\ufffdb\ufffd");
  EXPECT_EQ(escape_markup("a\xff"), "a\ufffd");
}

TEST(Markup, FormatEscapesTextsAndKeepsMarkup) {
  const std::string text = "<b>";
  const std::string_view view = text;
  EXPECT_EQ(
      format_markup("<i>{} {} {} {} {:.1f} {}</i>", text, view, "<b>", text.c_str(), 0.25, Markup{"<br>"})
          .text,
      "<i>&lt;b&gt; &lt;b&gt; &lt;b&gt; &lt;b&gt; 0.2 <br></i>");
}

// Every text that comes from a table, its recipe, its name or the command line is hostile here.
TEST(HtmlReport, HoldsNoMarkupOfTheTable) {
  Table table = test::small_factored_table(0.3, AbsorptionPath::sum);
  for (auto& [key, value] : table.info)
    if (key != "spectrum" && key != "encoding" && key != "noise") value = kHostile;
  for (Axis& axis : table.factors.grid) axis.unit = kHostile;
  Recipe recipe = parse_recipe("[material]\n", "r");
  recipe.text = recipe.hash = kHostile;
  VerifyReport report{};
  report.truth = kHostile;
  report.points.resize(2);
  for (VerifyPoint& point : report.points) {
    point.parameters = {300, 1.45, 0.05};
    point.cos_i = 0.5;
  }
  VerifySettings settings;
  settings.threads = 1;
  const std::string page =
      html_report({table, recipe, settings, report, kHostile, 1, std::string("sunbeam verify ") + kHostile});
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("&lt;script"), std::string::npos);
}

}  // namespace
}  // namespace sunbeam
