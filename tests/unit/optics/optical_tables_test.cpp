// The tables of optical constants: what their files say, that the build holds the same, and known values.
#include "bake/optics/dispersion/optical_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>

#include "bake/optics/dispersion/optical_index.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/film_stack.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

using ::testing::ElementsAre;
using ::testing::MatchesRegex;

const std::filesystem::path kFolder = SUNBEAM_SOURCE_DIR "/tables/optics";

struct File {
  std::vector<std::string> comments;
  std::string header;
  std::vector<OpticalConstants> lines;
};

double number_of(const std::string& text) {
  double value = NAN;
  EXPECT_TRUE(parse_number(text, value)) << text;
  return value;
}

File read_table(const std::filesystem::path& path) {
  File file;
  for (const auto& line : split(read_text(path.string()), '\n')) {
    if (line.starts_with('#')) {
      file.comments.push_back(line);
    } else if (file.header.empty()) {
      file.header = line;
    } else if (!line.empty()) {
      const auto cells = split(line, ',');
      EXPECT_EQ(cells.size(), 3u) << path << ": " << line;
      if (cells.size() == 3)
        file.lines.push_back({number_of(cells[0]), number_of(cells[1]), number_of(cells[2])});
    }
  }
  return file;
}

File read_table(const OpticalTable& table) {
  return read_table(kFolder / (std::string(table.name) + ".csv"));
}

TEST(OpticalTables, AreThoseOfTheFolder) {
  EXPECT_THAT(optical_table_names(), ElementsAre("Ag", "Al", "Au", "Cu", "Fe", "Nb", "Ti", "aragonite",
                                                 "chitin", "guanine", "keratin", "magnesium_fluoride",
                                                 "melanin", "niobia", "silica", "titania", "water"));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    files += entry.path().extension() == ".csv";
  EXPECT_EQ(files, optical_tables().size());
}

TEST(OpticalTables, EveryFileHasItsSourceLicenceAndSample) {
  for (const auto& table : optical_tables()) {
    const File file = read_table(table);
    EXPECT_THAT(file.comments,
                ElementsAre(MatchesRegex("# Source: .* \\((19|20)[0-9][0-9]\\).*"),
                            MatchesRegex("# DOI: 10\\.[0-9]+/.+"), MatchesRegex("# Licence: .+"),
                            MatchesRegex("# Sample: .+"), MatchesRegex("# Selection: .+")))
        << table.name;
    EXPECT_EQ(file.header, "wavelength_nm,n,k") << table.name;
  }
}

TEST(OpticalTables, TheBuildHoldsTheNumbersOfTheFiles) {
  for (const auto& table : optical_tables())
    EXPECT_EQ(read_table(table).lines, std::vector(table.lines.begin(), table.lines.end())) << table.name;
}

TEST(OpticalTables, CoverWhatIsVisible) {
  for (const auto& table : optical_tables()) {
    EXPECT_LE(table.lines.front().wavelength_nm, 380) << table.name;
    EXPECT_GE(table.lines.back().wavelength_nm, 780) << table.name;
    EXPECT_GE(table.lines.front().wavelength_nm, 100) << table.name;
    EXPECT_LE(table.lines.back().wavelength_nm, 10000) << table.name;
    for (const auto& line : table.lines) {
      EXPECT_TRUE(line.n >= kLeastIor && line.n <= kLargestIor) << table.name << " at " << line.wavelength_nm;
      EXPECT_TRUE(line.k >= 0 && line.k <= kMostExtinction) << table.name << " at " << line.wavelength_nm;
    }
  }
}

// A misplaced digit makes a jump. The widest honest step is gold's edge between 496 and 521 nm.
TEST(OpticalTables, HaveNoJumpsInTheVisible) {
  for (const auto& table : optical_tables())
    for (double nm = 380; nm < 780; nm += 5) {
      const auto index = OpticalIndex::named(table.name);
      const auto here = index.at(nm), next = index.at(nm + 5);
      EXPECT_LT(std::abs(next - here), 0.05 * std::abs(here)) << table.name << " at " << nm;
    }
}

struct Known {
  const char* name;
  double wavelength_nm;
  std::complex<double> index;
  double tolerance;
};

// Values that the sources state themselves, or that other measurements give.
TEST(OpticalTables, KnownValues) {
  const Known known[] = {
      {"chitin", 400, 1.572, 0.0005},      {"chitin", 500, 1.552, 0.0005},
      {"chitin", 600, 1.541, 0.0005},      {"keratin", 400, 1.569, 0.0005},
      {"keratin", 500, 1.556, 0.0005},     {"keratin", 600, 1.548, 0.0005},
      {"melanin", 500, 1.75, 0.1},         {"guanine", 500, 1.83, 1e-12},
      {"aragonite", 589.3, 1.683, 1e-4},   {"silica", 587.6, 1.45846, 2e-5},
      {"silica", 486.1, 1.46313, 2e-5},    {"silica", 656.3, 1.45637, 2e-5},
      {"water", 589.3, 1.333, 0.001},      {"magnesium_fluoride", 550, 1.38, 0.005},
      {"titania", 550, 2.43, 0.05},        {"niobia", 550, 2.36, 0.03},
      {"Ag", 550, {0.055, 3.59}, 0.15},    {"Al", 550, {1.02, 6.62}, 0.1},
      {"Au", 548.6, {0.43, 2.455}, 1e-9},  {"Cu", 548.6, {1.02, 2.577}, 1e-9},
      {"Ti", 549, {2.54, 3.43}, 1e-9},     {"Fe", 549, {2.95, 2.93}, 1e-9},
      {"Nb", 553.2, {2.925, 2.869}, 1e-9},
  };
  for (const auto& [name, nm, index, tolerance] : known)
    EXPECT_LE(std::abs(OpticalIndex::named(name).at(nm) - index), tolerance) << name << " at " << nm;
}

// Straight lines between the rows of a file stay close to the formula that its source gives.
TEST(OpticalTables, TablesOfFormulasFollowThem) {
  const auto error = [](const char* name, auto formula) {
    double largest = 0;
    for (double nm = 380; nm <= 780; nm += 1)
      largest = std::max(largest, std::abs(OpticalIndex::named(name).at(nm) - formula(nm)));
    return largest;
  };
  using Complex = std::complex<double>;
  EXPECT_LT(error("chitin", [](double nm) { return Complex(1.517 + 8800 / (nm * nm)); }), 5e-5);
  EXPECT_LT(error("keratin", [](double nm) { return Complex(1.532 + 5890 / (nm * nm)); }), 5e-5);
  EXPECT_LT(error("melanin",
                  [](double nm) { return Complex(1.648 + 23700 / (nm * nm), 0.56 * std::exp(-nm / 270)); }),
            2e-4);
  EXPECT_LT(error("silica",
                  [](double nm) {
                    const double square = nm * nm * 1e-6;
                    return Complex(std::sqrt(1 + 0.6961663 * square / (square - 0.0684043 * 0.0684043) +
                                             0.4079426 * square / (square - 0.1162414 * 0.1162414) +
                                             0.8974794 * square / (square - 9.896161 * 9.896161)));
                  }),
            5e-5);
}

double reflectance_of(const char* name, double wavelength_nm) {
  return stack_power({1, {}, OpticalIndex::named(name).at(wavelength_nm)}, 1, wavelength_nm).reflectance;
}

TEST(OpticalTables, MetalsHaveTheirColours) {
  for (const double nm : {450.0, 550.0, 650.0}) {
    EXPECT_GT(reflectance_of("Ag", nm), 0.95) << nm;
    EXPECT_NEAR(reflectance_of("Al", nm), 0.915, 0.015) << nm;
    for (const char* grey : {"Fe", "Nb", "Ti"})
      EXPECT_NEAR(reflectance_of(grey, nm), 0.54, 0.09) << grey << nm;
  }
  for (const char* warm : {"Au", "Cu"}) {
    EXPECT_LT(reflectance_of(warm, 450), 0.6) << warm;
    EXPECT_GT(reflectance_of(warm, 650), 0.9) << warm;
  }
  EXPECT_GT(reflectance_of("Au", 550), reflectance_of("Cu", 550) + 0.1);
}

}  // namespace
}  // namespace sunbeam
