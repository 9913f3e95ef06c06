// Readers refuse what is not a sound table, naming the file and the defect, and survive damage of any kind.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <limits>
#include <sstream>

#include "sunbeam/detail/file.h"
#include "tests/table/files/defects.h"

namespace sunbeam {
namespace {

using test::axis;
using test::Defect;
using test::expect_error_or_equal;
using test::expect_named;
using test::Form;
using test::forms;
using test::kName;
using test::refusal;
using test::small_table;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

// The array anew, with other axes or another name; content does not matter.
NdArray rebuilt(const NdArray& array, std::vector<Axis> axes, const std::string& name = "") {
  NdArray result(name.empty() ? array.name() : name, std::move(axes), array.precision(), array.channels());
  test::fill_randomly(result, 0, 1, 9);
  return result;
}

// Both arrays of the rest with axis `k` replaced.
std::function<void(Table&)> with_rest_axis(std::size_t k, std::vector<double> nodes) {
  return [=](Table& table) {
    auto axes = table.remainder.axes();
    axes[k].nodes = nodes;
    axes[k].power = 1;  // a node below the origin of a power has a message of its own
    table.remainder = rebuilt(table.remainder, axes);
    table.rest_stderr = rebuilt(table.rest_stderr, axes);
  };
}

// Both with axis `k` of this period.
std::function<void(Table&)> with_rest_period(std::size_t k, double period) {
  return [=](Table& table) {
    auto axes = table.remainder.axes();
    axes[k].period = period;
    table.remainder = rebuilt(table.remainder, axes);
    table.rest_stderr = rebuilt(table.rest_stderr, axes);
  };
}

std::vector<Defect> defects() {
  std::vector<Defect> list = {
      {"missing array",
       [](Table& t) { t.rest_stderr = rebuilt(t.rest_stderr, t.rest_stderr.axes(), "noise"); },
       {"'rest_stderr' is missing", "film_reflectance", "noise", "remainder"}},
      {"missing film array",
       [](Table& t) { t.film_transmittance = NdArray(); },
       {"'film_transmittance' is missing"}},
      {"renamed axis",
       [](Table& t) {
         auto axes = t.remainder.axes();
         axes[3].name = "theta_i";
         t.remainder = rebuilt(t.remainder, axes);
       },
       {"'remainder'", "axis 3", "'theta_i'", "'cos_theta_i'"}},
      {"renamed film axis",
       [](Table& t) {
         auto axes = t.film_reflectance.axes();
         axes[1].name = "film_ior";
         t.film_reflectance = rebuilt(t.film_reflectance, axes);
       },
       {"'film_reflectance'", "axis 1", "'film_ior'", "'base_ior'"}},
      {"one axis too few",
       [](Table& t) {
         auto axes = t.remainder.axes();
         axes.pop_back();
         t.remainder = rebuilt(t.remainder, axes);
       },
       {"'remainder' has 6 axes", "expected 7"}},
      {"one film axis too many",
       [](Table& t) {
         auto axes = t.film_reflectance.axes();
         axes.push_back(axis("phi", {0}));
         t.film_reflectance = rebuilt(t.film_reflectance, axes);
       },
       {"'film_reflectance' has 4 axes", "expected 3"}},
      {"other axes of the errors",
       [](Table& t) {
         auto axes = t.remainder.axes();
         axes[0].nodes[1] = 310;
         t.rest_stderr = rebuilt(t.rest_stderr, axes);
       },
       {"'rest_stderr'", "axes"}},
      {"other size of the errors",
       [](Table& t) {
         auto axes = t.remainder.axes();
         axes[0].nodes.pop_back();
         t.rest_stderr = rebuilt(t.rest_stderr, axes);
       },
       {"'rest_stderr'", "axes"}},
      {"other axes of the film arrays",
       [](Table& t) {
         auto axes = t.film_reflectance.axes();
         axes[2].nodes = {0, 0.4, 1};
         t.film_transmittance = rebuilt(t.film_transmittance, axes);
       },
       {"'film_transmittance'", "axes"}},
      {"azimuth of wi in an isotropic table", with_rest_axis(4, {0, 1}), {"'phi_i'", "isotropic"}},
      {"thickness below 0", with_rest_axis(0, {-1, 2}), {"'film_thickness_nm'", "0 to"}},
      {"thickness too large", with_rest_axis(0, {0, 2e5}), {"'film_thickness_nm'", "0 to"}},
      {"base IOR below 1", with_rest_axis(1, {0.5, 1.5}), {"'base_ior'", "1 to 5"}},
      {"base IOR above 5", with_rest_axis(1, {1.5, 6}), {"'base_ior'", "1 to 5"}},
      {"absorption below 0", with_rest_axis(2, {-0.1}), {"'absorption_per_nm'", "0 to 1000"}},
      {"horizon", with_rest_axis(3, {0, 1}), {"'cos_theta_i'", "to 1"}},
      {"cosine above 1", with_rest_axis(5, {0.5, 1.01}), {"'cos_theta_o'", "to 1"}},
      {"azimuth below 0", with_rest_axis(6, {-0.1, 1}), {"'phi_o'", "0 to"}},
      {"azimuth beyond the mirror side", with_rest_axis(6, {0, 3.2}), {"'phi_o'", "0 to"}},
      {"azimuth that stops short of the mirror side",
       with_rest_axis(6, {0, 3}),
       {"'phi_o'", "from 0 to 3;", "expected 0 to 3.14"}},
      {"periodic azimuth in an isotropic table",
       with_rest_period(6, 2 * kPi),
       {"'phi_o'", "period 6.28", "expected 0"}},
      {"anisotropic roughness",
       [](Table& t) {
         t.material.roughness = {0.1, 0.3};
       },
       {"symmetry is isotropic", "0.1;0.3", "expected symmetry anisotropic"}},
      {"smooth film in an anisotropic table",
       [](Table& t) {
         t.symmetry = Symmetry::anisotropic;
         t.material.roughness = 0;
       },
       {"symmetry is anisotropic", "roughness is 0", "expected symmetry isotropic"}},
      {"film cosine below 0",
       [](Table& t) {
         auto axes = t.film_reflectance.axes();
         axes[2].nodes[0] = -0.1;
         t.film_reflectance = rebuilt(t.film_reflectance, axes);
         t.film_transmittance = rebuilt(t.film_transmittance, axes);
       },
       {"'cos_theta'", "0 to 1"}},
      {"film IOR out of range", [](Table& t) { t.material.film_ior = 9; }, {"'film_ior'", "'9'", "1 to 5"}},
      {"albedo above 1",
       [](Table& t) {
         t.material.albedo = {0, 2, 0};
       },
       {"'albedo'", "0 to 1"}},
      {"roughness nearly 0", [](Table& t) { t.material.roughness = 1e-5; }, {"'roughness'", "0.001 to 1"}},
  };
  for (const auto& [key, value] : test::complete_info())
    list.push_back({"missing " + key, [key = key](Table& t) { t.info.erase(key); }, {key, "is missing"}});
  return list;
}

TEST(TableReader, NamesEveryDefect) { expect_named(small_table(), defects()); }

TEST(TableReader, NamesEveryDefectOfAnAnisotropicTable) {
  expect_named(
      test::small_anisotropic_table(),
      {{"isotropic roughness",
        [](Table& t) { t.material.roughness = 0.1; },
        {"symmetry is anisotropic", "roughness is 0.1;", "expected symmetry isotropic"}},
       {"one azimuth of wi", with_rest_axis(4, {0}), {"'phi_i'", "from 0 to 0;", "expected 0 to 1.57"}},
       {"azimuth of wi that starts late", with_rest_axis(4, {0.1, kPi / 2}), {"'phi_i'", "from 0.1 to 1.57"}},
       {"azimuth of wi beyond the quadrant", with_rest_axis(4, {0, kPi}), {"'phi_i'", "from 0 to 3.14"}},
       {"periodic azimuth of wi", with_rest_period(4, 2 * kPi), {"'phi_i'", "period 6.28", "expected 0"}},
       {"azimuth of wo below 0", with_rest_axis(6, {-0.1, 1}), {"'phi_o'", "0 to"}},
       {"azimuth of wo beyond a turn", with_rest_axis(6, {6, 7}), {"'phi_o'", "0 to"}},
       {"azimuth of wo without period", with_rest_period(6, 0), {"'phi_o'", "period 0", "expected 6.28"}},
       {"azimuth of wo of another period", with_rest_period(6, 6.3), {"'phi_o'", "period 6.3", "6.28"}}});
}

// Edits the value of a text attribute in place, length kept. Both formats write: name, "string" as the type,
// four bytes of length (OpenEXR ends name and type with a zero), value. An OpenVDB file gets an identifier
// of another tool, so that its content alone decides.
std::string with_attribute(const Form& form, std::string bytes, const std::string& key,
                           const std::string& before, const std::string& after) {
  const bool is_exr = form.name == "exr";
  const std::size_t name = bytes.find("sunbeam." + key);
  const std::size_t value = bytes.find("string", name) + 6 + (is_exr ? 1 : 0) + 4;
  EXPECT_EQ(before.size(), after.size());
  EXPECT_EQ(bytes.substr(value, before.size()), before);
  bytes.replace(value, after.size(), after);
  if (!is_exr) bytes.replace(21, 36, "01234567-89ab-4def-8123-456789abcdef");
  return bytes;
}

TEST(TableReader, UnknownRestFrame) {
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(small_table()), "rest_frame", "closed", "opened");
    EXPECT_THAT(refusal(form, bytes, kName),
                AllOf(StartsWith(kName), HasSubstr("'rest_frame' is 'opened'"), HasSubstr("closed, none")))
        << form.name;
  }
}

TEST(TableReader, UnknownSchemaVersion) {
  for (const Form& form : forms())
    for (const std::string version : {"5", "1"}) {
      const auto bytes = with_attribute(form, form.bytes(small_table()), "schema_version", "3", version);
      EXPECT_THAT(refusal(form, bytes, kName),
                  AllOf(StartsWith(kName), HasSubstr("'" + version + "'"), HasSubstr("2 to 4")))
          << form.name;
    }
}

// A look-up would take such a film for another.
TEST(TableReader, FilmsThatNoTableOfVersion3Holds) {
  for (const std::string key : {"thickness_spread", "base_extinction"}) {
    Table table = small_table();
    table.info["material." + key] = "0.1";
    for (const Form& form : forms())
      EXPECT_THAT(refusal(form, form.bytes(table), kName),
                  AllOf(StartsWith(kName), HasSubstr("'material." + key + "'")))
          << form.name;
  }
  Table table = small_table();
  table.material.thickness_spread = 0.1;
  for (const Form& form : forms()) EXPECT_THROW(form.bytes(table), Error) << form.name;
}

// Version 2 was wrong there.
TEST(TableReader, Version2BelowTheExterior) {
  Table table = small_table();
  table.material.exterior_ior = 1.45;
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(table), "schema_version", "3", "2");
    EXPECT_THAT(refusal(form, bytes, kName),
                AllOf(StartsWith(kName), HasSubstr("base_ior reaches down to 1.4, below exterior_ior 1.45"),
                      HasSubstr("schema version 2"), HasSubstr("bake")))
        << form.name;
  }
}

// Three film cosines in the pixels, two by the axis.
TEST(TableReader, SizeAgainstAxes) {
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(small_table()), "axis.2.nodes", "0 0.5 1", "0 0.531");
    EXPECT_THAT(refusal(form, bytes, kName),
                AllOf(StartsWith(kName), HasSubstr("film_reflectance"), HasSubstr("agree with the axes")))
        << form.name;
  }
}

TEST(TableReader, AxisThatIsNoNumber) {
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(small_table()), "axis.2.nodes", "0 0.5 1", "0 0,5 1");
    EXPECT_THAT(refusal(form, bytes, kName), AllOf(StartsWith(kName), HasSubstr("'0,5'"))) << form.name;
  }
}

TEST(TableReader, AxisThatDoesNotIncrease) {
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(small_table()), "axis.2.nodes", "0 0.5 1", "0 1.5 1");
    EXPECT_THAT(refusal(form, bytes, kName),
                AllOf(StartsWith(kName), HasSubstr("'cos_theta'"), HasSubstr("do not increase")))
        << form.name;
  }
}

// A value changed by hand and nothing else: sound, but not what was written.
TEST(TableReader, EditedAttribute) {
  for (const Form& form : forms()) {
    const auto bytes = with_attribute(form, form.bytes(small_table()), "seed", "7", "8");
    EXPECT_THAT(refusal(form, bytes, kName), AllOf(StartsWith(kName), HasSubstr("hash"))) << form.name;
  }
}

TEST(TableReader, NotAFileOfItsKind) {
  for (const Form& form : forms())
    for (const std::string& bytes : {std::string(), std::string("P6"), std::string(1000, '\0')})
      EXPECT_THAT(refusal(form, bytes, kName), AllOf(StartsWith(kName), HasSubstr("not an Open")))
          << form.name;
}

TEST(TableReader, ForeignExr) {
  const ScratchFolder folder;
  const std::string picture = folder.file("picture.exr");
  {
    const std::vector<Imf::Rgba> pixels(12, Imf::Rgba(0.5f, 0.25f, 1.f));
    Imf::RgbaOutputFile file(picture.c_str(), 4, 3, Imf::WRITE_RGB);
    file.setFrameBuffer(pixels.data(), 1, 4);
    file.writePixels(3);
  }
  const Form exr = forms()[0];
  EXPECT_THAT(refusal(exr, read_file(picture), kName),
              AllOf(StartsWith(kName), HasSubstr("not a Sunbeam table")));

  // Ones that claim to be a table, without axes.
  for (const char* channel : {"Z", "Y"}) {
    const std::string grey = folder.file("grey.exr");
    {
      Imf::Header header(4, 3);
      header.insert("sunbeam.schema_version", Imf::StringAttribute("3"));
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      std::vector<float> pixels(12, 0.5f);
      Imf::FrameBuffer buffer;
      buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()), 4, 16));
      Imf::OutputFile file(grey.c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(3);
    }
    EXPECT_THAT(refusal(exr, read_file(grey), kName), AllOf(StartsWith(kName), HasSubstr("no sunbeam.axis")));
  }
}

std::string vdb_bytes(const openvdb::GridBase::Ptr& grid, bool claims_to_be_a_table) {
  openvdb::MetaMap metadata;
  if (claims_to_be_a_table) metadata.insertMeta("sunbeam.schema_version", openvdb::StringMetadata("3"));
  std::ostringstream out;
  openvdb::io::Stream(out).write(openvdb::GridPtrVec{grid}, metadata);
  return out.str();
}

TEST(TableReader, ForeignVdb) {
  openvdb::initialize();
  const auto smoke = openvdb::FloatGrid::create(0);
  smoke->setName("density");
  smoke->tree().setValue(openvdb::Coord(1, 2, 3), 0.5f);
  const auto doubles = openvdb::DoubleGrid::create(0);
  doubles->setName("heat");
  const auto wind = openvdb::Vec3SGrid::create(openvdb::Vec3f(0));
  wind->setName("velocity");
  const Form vdb = forms()[1];
  EXPECT_THAT(refusal(vdb, vdb_bytes(smoke, false), kName),
              AllOf(StartsWith(kName), HasSubstr("not a Sunbeam table")));
  EXPECT_THAT(refusal(vdb, vdb_bytes(smoke, true), kName),
              AllOf(StartsWith(kName), HasSubstr("'density'"), HasSubstr("sunbeam.precision")));
  EXPECT_THAT(refusal(vdb, vdb_bytes(doubles, true), kName),
              AllOf(StartsWith(kName), HasSubstr("'heat'"), HasSubstr("vec3s or float")));
  EXPECT_THAT(refusal(vdb, vdb_bytes(wind, true), kName), AllOf(StartsWith(kName), HasSubstr("'velocity'")));
}

// The writer refuses to write what has no arrays instead of crashing.
// The reader's own check of finiteness is behind the writer's: a NaN in a file changes its hash as well.
TEST(TableWriter, ValuesThatAreNotFiniteAreRefused) {
  const std::pair<const char*, std::function<void(Table&)>> defects[] = {
      {"remainder",
       [](Table& t) {
         t.remainder.set(17, {0, kNan, 0});
       }},
      {"remainder", [](Table& t) { t.remainder.set(0, Rgb(1e6)); }},  // beyond a half
      {"rest_stderr", [](Table& t) { t.rest_stderr.set(287, Rgb(kInf)); }},
      {"film_reflectance", [](Table& t) { t.film_reflectance.set(0, Rgb(kNan)); }}};
  for (const Form& form : forms())
    for (const auto& [array, spoil] : defects) {
      Table table = small_table();
      spoil(table);
      EXPECT_THAT([&] { form.bytes(table); },
                  ThrowsMessage<Error>(AllOf(HasSubstr(array), HasSubstr("not finite"))))
          << form.name;
    }
}

TEST(TableWriter, EmptyTableIsRefused) {
  for (const Form& form : forms()) EXPECT_THROW(form.bytes(Table()), Error) << form.name;
}

TEST(TableReader, SurvivesTruncation) { test::expect_survives_truncation(small_table()); }

TEST(TableReader, SurvivesTruncationUnderAForeignIdentifier) {
  const Table table = small_table();
  std::string bytes = table_vdb_bytes(table);
  bytes.replace(21, 36, "01234567-89ab-4def-8123-456789abcdef");
  for (std::size_t k = 0; k < 50; ++k) {
    const std::string cut = bytes.substr(0, bytes.size() * k / 50);
    EXPECT_THAT(refusal(forms()[1], cut, kName), StartsWith(kName)) << cut.size() << " bytes";
  }
}

TEST(TableReader, SurvivesFlippedBits) {
  const Table tables[] = {small_table(Precision::single_float), small_table(Precision::half_float),
                          test::small_anisotropic_table()};
  for (std::size_t k = 0; k < std::size(tables); ++k) test::expect_survives_flipped_bits(tables[k], k);
}

}  // namespace
}  // namespace sunbeam
