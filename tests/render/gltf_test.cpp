// glTF as exporters write it: skins, morph targets, strips, sparse and quantized numbers, buffers in files.
#include "runtime/tracer/gltf.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/render/mesh_support.h"

namespace sunbeam {
namespace {

using Json = nlohmann::json;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;
constexpr double kArea = 4;

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

// A file under construction: a square of side 2 about the origin, in the plane z = 0, under node 0.
struct Gltf {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string data;

  Gltf() {
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = {{{"mesh", 0}}};
    const int position = add<float>(kFloat, "VEC3", 4, {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
    const int indices = add<std::uint16_t>(kUnsignedShort, "SCALAR", 6, {0, 1, 2, 0, 2, 3});
    json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
  }

  template <class T>
  int add_view(std::initializer_list<T> values) {
    data.resize((data.size() + 3) / 4 * 4);
    const std::size_t at = data.size();
    put<T>(data, values);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", data.size() - at}});
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  template <class T>
  int add(int component_type, const char* type, int count, std::initializer_list<T> values) {
    return add_accessor({{"bufferView", add_view(values)},
                         {"componentType", component_type},
                         {"count", count},
                         {"type", type}});
  }
  int add_accessor(const Json& accessor) {
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  Json& node(std::size_t index = 0) { return json["nodes"][index]; }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  Json& attributes() { return primitive()["attributes"]; }

  std::string text(const std::string& uri = "") const {
    Json whole = json;
    whole["buffers"] = {
        {{"byteLength", data.size()},
         {"uri", uri.empty() ? "data:application/octet-stream;base64," + base64(data) : uri}}};
    return whole.dump();
  }
  Mesh mesh() const { return mesh_from("m.gltf", text()); }
  void expect_error(const std::string& part) const { expect_mesh_file_error("m.gltf", text(), part); }
};

// Where a plane mesh lies.
Vec3 middle(const Mesh& mesh) {
  Vec3 sum;
  for (const Vec3& p : mesh.positions) sum = sum + p;
  return sum / static_cast<double>(mesh.positions.size());
}

void expect_near(const Vec3& found, const Vec3& expected) { EXPECT_LT(length(found - expected), 1e-6); }

TEST(Gltf, ASquareIsASquare) {
  expect_covers(Gltf().mesh(), kArea);
  expect_near(middle(Gltf().mesh()), {});
}

// --- skins ---

Gltf skinned() {
  Gltf file;
  file.json["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"translation", {9, 0, 0}}}, {{"children", {2}}}, Json::object()};
  file.json["scenes"] = {{{"nodes", {0, 1}}}};
  file.json["skins"] = {{{"joints", {1, 2}}}};
  file.attributes()["JOINTS_0"] = file.add<std::uint8_t>(kUnsignedByte, "VEC4", 4,
                                                         {0, 1, 0, 0, 0, 1, 0, 0,  //
                                                          0, 1, 0, 0, 0, 1, 0, 0});
  file.attributes()["WEIGHTS_0"] =
      file.add<float>(kFloat, "VEC4", 4, {1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0, 0, 2, 0, 0});
  return file;
}

TEST(Gltf, ASkinnedNodeStaysWhereItsJointsAre) {
  Gltf file = skinned();
  expect_covers(file.mesh(), kArea);
  expect_near(middle(file.mesh()), {});
  file.node(1)["translation"] = {0, 0, 5};
  expect_near(middle(file.mesh()), {0, 0, 5});
}

TEST(Gltf, VerticesFollowTheirJoints) {
  Gltf file = skinned();
  file.node(1)["translation"] = {1, 0, 0};
  file.node(2)["translation"] = {0, 4, 0};
  const Mesh mesh = file.mesh();
  expect_near(mesh.positions[0], {0, -1, 0});
  expect_near(mesh.positions[2], {2, 3, 0});  // half of the second joint
  expect_near(mesh.positions[3], {0, 5, 0});  // all of it; weights need not add up to 1
}

TEST(Gltf, InverseBindMatricesTakeVerticesToTheirJoints) {
  Gltf file = skinned();
  file.node(1)["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  file.node(1)["translation"] = {3, 0, 0};
  // The first joint was bound at (3, 0, 0), not turned; the second is bound as it stands.
  file.json["skins"][0]["inverseBindMatrices"] = file.add<float>(
      kFloat, "MAT4", 2,
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, 0, 1, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1});
  const Mesh mesh = file.mesh();
  expect_near(mesh.positions[0], {4, -4, 0});  // (-1, -1) turned by 90 degrees about (3, 0)
  expect_near(mesh.positions[3], {-1, 1, 0});
}

TEST(Gltf, SkinnedNormalsTurnAndMirroredJointsKeepTheOutside) {
  Gltf file = skinned();
  file.attributes()["NORMAL"] = file.add<float>(kFloat, "VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  file.node(1)["rotation"] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  for (const Vec3& normal : file.mesh().normals) expect_near(normal, {0, -1, 0});
  file.node(1).erase("rotation");
  file.node(1)["scale"] = {-1, 1, 1};
  expect_covers(file.mesh(), kArea);
}

TEST(Gltf, BadSkinsAreRefused) {
  Gltf file = skinned();
  file.attributes()["WEIGHTS_0"] =
      file.add<float>(kFloat, "VEC4", 4, {1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  file.expect_error("the joint weights of vertex 1 add up to 0");
  file = skinned();
  file.attributes()["WEIGHTS_0"] =
      file.add<float>(kFloat, "VEC4", 4, {2, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  file.expect_error("found the joint weight -1");
  file = skinned();
  file.json["skins"][0]["joints"] = {1};
  file.expect_error("joint index 1; allowed: 0 to 0");
  file = skinned();
  file.json["scenes"][0]["nodes"] = {0};
  file.expect_error("joint 1 is no node of the scene");
  file = skinned();
  file.attributes().erase("WEIGHTS_0");
  file.expect_error("WEIGHTS_0 is missing");
  file = skinned();
  file.json["skins"][0]["inverseBindMatrices"] =
      file.add<float>(kFloat, "MAT4", 1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  file.expect_error("a skin has 2 joints and 1 inverse bind matrices");
}

// --- morph targets ---

TEST(Gltf, MorphTargetsHaveTheirWeights) {
  Gltf file;
  file.attributes()["NORMAL"] = file.add<float>(kFloat, "VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int shift = file.add<float>(kFloat, "VEC3", 4, {4, 0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0});
  const int up = file.add<float>(kFloat, "VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int turn = file.add<float>(kFloat, "VEC3", 4, {2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0});
  file.primitive()["targets"] = {{{"POSITION", shift}}, {{"POSITION", up}, {"NORMAL", turn}}};
  expect_near(middle(file.mesh()), {});
  file.json["meshes"][0]["weights"] = {0.5, 0};
  expect_near(middle(file.mesh()), {2, 0, 0});
  file.node()["weights"] = {0, 0.5};  // those of a node go first
  const Mesh mesh = file.mesh();
  expect_near(middle(mesh), {0, 0, 0.5});
  for (const Vec3& normal : mesh.normals) expect_near(normal, normalize(Vec3{1, 0, 1}));
  file.node()["weights"] = {1};
  file.expect_error("weights has 1 numbers; allowed: 2");
}

TEST(Gltf, SparseNumbersReplaceOthers) {
  Gltf file;
  const int places = file.add_view<std::uint8_t>({1, 2});
  const int entries = file.add_view<float>({3, -1, 0, 3, 1, 0});
  const Json sparse = {{"count", 2},
                       {"indices", {{"bufferView", places}, {"componentType", kUnsignedByte}}},
                       {"values", {{"bufferView", entries}}}};
  file.json["accessors"][0]["sparse"] = sparse;
  expect_covers(file.mesh(), 8);
  // Without other data all the rest is 0.
  file.json["accessors"][0].erase("bufferView");
  expect_near(file.mesh().positions[0], {});
  expect_near(file.mesh().positions[2], {3, 1, 0});
  file.json["accessors"][0]["count"] = 2;
  file.expect_error("sparse index 2; allowed: 0 to 1");
  file.json["accessors"][0]["count"] = 1000000000;
  file.expect_error("asks for 48001 MB of memory");
}

// --- numbers ---

TEST(Gltf, QuantizedNumbersAreRead) {
  Gltf file;
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.attributes()["POSITION"] =
      file.add<std::int16_t>(kShort, "VEC3", 4, {-10, -10, 0, 0, 10, -10, 0, 0, 10, 10, 0, 0, -10, 10, 0, 0});
  file.json["bufferViews"].back()["byteStride"] = 8;
  file.attributes()["NORMAL"] =
      file.add<std::int8_t>(kByte, "VEC3", 4, {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0});
  file.json["bufferViews"].back()["byteStride"] = 4;
  file.json["accessors"].back()["normalized"] = true;
  file.attributes()["TEXCOORD_0"] =
      file.add<std::uint16_t>(kUnsignedShort, "VEC2", 4, {0, 0, 65535, 0, 65535, 65535, 0, 65535});
  file.json["accessors"].back()["normalized"] = true;
  const Mesh mesh = file.mesh();
  expect_covers(mesh, 400);
  ASSERT_EQ(mesh.normals.size(), 4u);
  expect_near(mesh.normals[0], {0, 0, 1});
  ASSERT_EQ(mesh.uvs.size(), 4u);
  EXPECT_EQ(mesh.uvs[1].x, 1);
  EXPECT_EQ(mesh.uvs[1].y, 1);
}

TEST(Gltf, WhatReachesBeyondItsBytesIsRefused) {
  const auto expect_error = [](const Json::json_pointer& where, const Json& value, const std::string& part) {
    Gltf file;
    file.json[where] = value;
    SCOPED_TRACE(where.to_string() + " = " + value.dump());
    file.expect_error(part);
  };
  using Pointer = Json::json_pointer;
  const std::string beyond = "reaches beyond its buffer";
  expect_error(Pointer("/accessors/0/count"), 5, beyond);
  expect_error(Pointer("/accessors/0/byteOffset"), 4, beyond);
  expect_error(Pointer("/accessors/1/count"), 1LL << 40, beyond);
  expect_error(Pointer("/bufferViews/0/byteLength"), 47, beyond);
  expect_error(Pointer("/bufferViews/0/byteOffset"), 1LL << 40, beyond);
  expect_error(Pointer("/bufferViews/0/byteStride"), 4, beyond);
  expect_error(Pointer("/bufferViews/0/byteStride"), 100, beyond);
  expect_error(Pointer("/bufferViews/0/buffer"), 1, "buffers index 1; allowed: 0 to 0");
  for (const Json& bad :
       {Json(-1), Json(1.5), Json(1e300), Json(-1e300), Json("0"), Json(nullptr), Json(1ULL << 63)}) {
    const std::string part = "allowed: a whole number from 0 to 2^40";
    for (const char* where :
         {"/accessors/0/count", "/accessors/0/byteOffset", "/accessors/0/bufferView",
          "/bufferViews/0/byteLength", "/bufferViews/0/byteStride", "/scene", "/nodes/0/mesh",
          "/meshes/0/primitives/0/indices", "/meshes/0/primitives/0/mode", "/scenes/0/nodes/0"})
      expect_error(Pointer(where), bad, part);
  }
  expect_error(Pointer("/accessors/1/componentType"), kFloat, beyond);
  expect_error(Pointer("/accessors/1/componentType"), 5124, "found componentType 5124");
  expect_error(Pointer("/accessors/0/type"), "VEC2", "accessor 0 has the type VEC2; allowed: VEC3");
}

TEST(Gltf, WholeNumbersMayBeWrittenAsFractions) {
  Gltf file;
  file.json["accessors"][0]["count"] = 4.0;
  expect_covers(file.mesh(), kArea);
}

// --- primitives ---

TEST(Gltf, StripsAndFansAreRead) {
  Gltf file;
  file.primitive()["mode"] = 5;
  file.primitive()["indices"] = file.add<std::uint8_t>(kUnsignedByte, "SCALAR", 7, {0, 1, 3, 2, 2, 2, 2});
  expect_covers(file.mesh(), kArea);
  file.primitive()["mode"] = 6;
  file.primitive()["indices"] = file.add<std::uint32_t>(kUnsignedInt, "SCALAR", 4, {0, 1, 2, 3});
  expect_covers(file.mesh(), kArea);
  file.primitive().erase("indices");
  expect_covers(file.mesh(), kArea);
  file.primitive()["mode"] = 7;
  file.expect_error("found mode 7; allowed: 0 to 6");
  file.primitive()["mode"] = 4;
  expect_covers(file.mesh(), kArea / 2);  // corners that make no whole triangle are left out
  file.primitive()["mode"] = 1;           // lines
  file.expect_error("the mesh has no face");
}

// --- nodes ---

TEST(Gltf, RotationsAreNormalized) {
  for (const double size : {1.0, 2.0, 0.01, 1e-200, 1e200}) {
    Gltf file;
    file.node()["rotation"] = {0, 0, size * std::sqrt(0.5), size * std::sqrt(0.5)};
    const Mesh mesh = file.mesh();
    expect_covers(mesh, kArea);
    expect_near(mesh.positions[0], {1, -1, 0});
  }
  Gltf file;
  file.node()["rotation"] = {0, 0, 0, 0};
  file.expect_error("a node's rotation has length 0");
}

TEST(Gltf, MatricesAreAffine) {
  Gltf file;
  file.node()["matrix"] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 7, 1};
  expect_covers(file.mesh(), 4 * kArea);
  expect_near(middle(file.mesh()), {0, 0, 7});
  file.node()["matrix"] = {2, 0, 0, 0.5, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 7, 1};
  file.expect_error("a matrix has the last row 0.5 0 0 1; allowed: 0 0 0 1");
  file.node()["matrix"] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 7, 2};
  file.expect_error("a matrix has the last row 0 0 0 2");
}

TEST(Gltf, NodesOfAnyDepthAreReadAndCyclesRefused) {
  Gltf file;
  constexpr int kDepth = 20000;
  for (int i = 0; i < kDepth; ++i) {
    file.json["nodes"].push_back({{"translation", {0, 0, 1}}});
    file.node(static_cast<std::size_t>(i))["children"] = {i + 1};
  }
  file.node(kDepth)["mesh"] = 0;
  file.node(0).erase("mesh");
  expect_near(middle(file.mesh()), {0, 0, kDepth});
  file.node(kDepth)["children"] = {kDepth / 2};
  file.expect_error("node 10000 is met twice");
  file = Gltf();
  file.json["scenes"][0]["nodes"] = {0, 0};
  file.expect_error("node 0 is met twice");
}

TEST(Gltf, TheNamedSceneIsRead) {
  Gltf file;
  file.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  file.json["scenes"].push_back({{"nodes", {1}}});
  file.json["scene"] = 1;
  expect_near(middle(file.mesh()), {5, 0, 0});
  file.json.erase("scene");
  expect_near(middle(file.mesh()), {});
  file.json.erase("scenes");  // all nodes
  expect_near(middle(file.mesh()), {2.5, 0, 0});
}

TEST(Gltf, ANodeOfScaleZeroHasNoArea) {
  Gltf file;
  file.attributes()["NORMAL"] = file.add<float>(kFloat, "VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  file.json["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const ScratchFolder folder;
  const LoadedMesh loaded = load_mesh(folder.write("m.gltf", file.text()));
  EXPECT_EQ(loaded.dropped, 2u);
  expect_covers(loaded.mesh, kArea);
}

// A small file whose nodes show one mesh a million times.
TEST(Gltf, ManyNodesOfOneMeshAreWithinTheLimit) {
  Gltf file;
  const int zeros = file.add_accessor({{"componentType", kFloat}, {"count", 100000}, {"type", "VEC3"}});
  file.attributes()["POSITION"] = zeros;
  for (int i = 1; i < 1000; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(i);
  }
  file.expect_error("of memory; allowed for a file of this size");
}

// The same with primitives that hold nothing: 10^8 of them from 700 kB.
TEST(Gltf, ManyNodesOfManyPrimitivesAreWithinTheLimit) {
  Gltf file;
  file.primitive()["mode"] = 0;
  const Json primitive = file.primitive();
  for (int i = 1; i < 10000; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(i);
    file.json["meshes"][0]["primitives"].push_back(primitive);
  }
  file.expect_error("of memory; allowed for a file of this size");
}

// --- extensions and versions ---

TEST(Gltf, RequiredExtensionsAreHonoured) {
  for (const char* name : {"EXT_made_up_geometry", "KHR_draco_mesh_compression", "EXT_meshopt_compression",
                           "EXT_mesh_gpu_instancing", ""}) {
    Gltf file;
    file.json["extensionsUsed"] = {name};
    expect_covers(file.mesh(), kArea);
    file.json["extensionsRequired"] = {"KHR_texture_transform", name};
    file.expect_error("requires the extension " + std::string(name) + ", which is not read");
  }
  Gltf file;
  file.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform", "KHR_texture_basisu",
                                     "EXT_texture_webp",    "KHR_lights_punctual",   "KHR_techniques_webgl"};
  expect_covers(file.mesh(), kArea);
  file.json["bufferViews"][0]["extensions"] = {{"EXT_meshopt_compression", Json::object()}};
  file.expect_error("is compressed (EXT_meshopt_compression)");
}

TEST(Gltf, OtherVersionsAreRefused) {
  Gltf file;
  file.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}};
  expect_covers(file.mesh(), kArea);
  file.json["asset"]["minVersion"] = "2.1";
  file.expect_error("asks for version 2.1; allowed: 2.0");
  file.json["asset"] = {{"version", "1.0"}};
  file.expect_error("is of version 1.0; allowed: 2");
  file.json["asset"] = {{"version", 2}};
  file.expect_error("m.gltf");
}

TEST(Gltf, DamagedJsonIsRefusedInALine) {
  expect_mesh_file_error("m.gltf", std::string(1000000, '['), "its JSON is nested deeper than 200");
  expect_mesh_file_error("m.gltf", R"({"a":")" + std::string(100000, '\\'),
                         "its JSON is damaged at byte 100007");
  expect_mesh_file_error("m.gltf", R"({"a": 1e999})", "its JSON holds a number that is too large");
  expect_mesh_file_error("m.gltf", "[]", "asset is missing");
  expect_mesh_file_error("m.gltf", "7", "asset is missing");
  const std::string quoted = R"({"asset": {"version": "2.0", "x": "\\\"[[{,\\"}, "x": [1, "]]"]})";
  expect_mesh_file_error("m.gltf", quoted, "the mesh has no face");
}

// --- buffers in files ---

class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_.file("models/parts"));
    std::filesystem::create_directories(folder_.file("secret"));
    for (const char* name : {"models/m.bin", "models/a b.bin", "models/parts/100%.bin", "secret/m.bin"})
      folder_.write(name, file_.data);
  }
  std::string error(const std::string& uri, const std::string& folder = "") {
    const std::string path = folder_.write("models/m.gltf", file_.text(uri));
    return error_of([&] { expect_covers(load_mesh(path, folder).mesh, kArea); });
  }
  void expect_error(const std::string& uri, const std::string& part) {
    EXPECT_NE(error(uri).find(part), std::string::npos) << uri << ": " << error(uri);
  }

  ScratchFolder folder_;
  Gltf file_;
};

TEST_F(GltfFiles, LieInTheFolderOrBelow) {
  for (const char* uri : {"m.bin", "./m.bin", "a%20b.bin", "a b.bin", "%6d.bin", "parts/100%25.bin",
                          "parts/100%.bin", "parts/../m.bin", "parts%2F..%2Fm.bin"})
    EXPECT_EQ(error(uri), "") << uri;
  expect_error("n.bin", "n.bin: cannot read: No such file");
}

TEST_F(GltfFiles, DoNotLieOutside) {
  const std::string outside = "leads out of the folders of the file and of the scene";
  for (const char* uri :
       {"../secret/m.bin", "%2e%2e/secret/m.bin", "parts/../../secret/m.bin", "..%2fsecret%2fm.bin",
        "../models2/m.bin", "..", "../../../../../../../../etc/passwd"})
    expect_error(uri, outside);
  for (const std::string& uri : {folder_.file("models/m.bin"), std::string("/etc/passwd"),
                                 std::string("m.bin%00"), std::string("%2Fetc/passwd")})
    expect_error(uri, "allowed: a path from the folder of the file");
  std::filesystem::create_symlink(folder_.file("secret"), folder_.file("models/link"));
  std::filesystem::create_symlink(folder_.file("models/parts"), folder_.file("models/inside"));
  expect_error("link/m.bin", outside);
  EXPECT_EQ(error("inside/100%25.bin"), "");
  // The folder of the scene is one to read from, too.
  EXPECT_EQ(error("../secret/m.bin", folder_.file("")), "");
  EXPECT_EQ(error("../secret/m.bin", folder_.file("secret")), "");
  EXPECT_NE(error("../secret/m.bin", folder_.file("models/parts")), "");
}

TEST_F(GltfFiles, AreRegularFiles) {
  ASSERT_EQ(mkfifo(folder_.file("models/fifo").c_str(), 0600), 0);
  for (const char* uri : {"fifo", "parts", "."}) expect_error(uri, "it is no regular file");
}

TEST_F(GltfFiles, AreReadOnceHoweverManyBuffersNameThem) {
  Json json = Json::parse(file_.text("m.bin"));
  json["buffers"].push_back({{"byteLength", file_.data.size()}, {"uri", "./m.bin"}});
  json["bufferViews"][1]["buffer"] = 1;
  folder_.write("models/m.gltf", json.dump());
  expect_covers(load_mesh(folder_.file("models/m.gltf")).mesh, kArea);
  json["buffers"][1] = {{"byteLength", 60}};
  expect_mesh_file_error("m.gltf", json.dump(), "m.gltf");
  json["bufferViews"][0]["buffer"] = 1;
  folder_.write("models/m.gltf", json.dump());
  EXPECT_NE(error_of([&] { load_mesh(folder_.file("models/m.gltf")); }).find("buffer 1 has no data"),
            std::string::npos);
}

TEST(Gltf, DataUrisAreBase64) {
  Gltf file;
  for (const std::string head : {"data:;base64,", "data:application/gltf-buffer;base64,"})
    expect_covers(mesh_from("m.gltf", file.text(head + base64(file.data))), kArea);
  for (const std::string uri : {"data:,abc", "data:application/octet-stream,abc", "data:;base64"})
    expect_mesh_file_error("m.gltf", file.text(uri), "a data URI is not base64");
  expect_mesh_file_error("m.gltf", file.text("data:;base64,AA*A"),
                         "a buffer's base64 text has a wrong letter");
  expect_mesh_file_error("m.gltf", file.text("data:;base64,AAAA"),
                         "a buffer has 3 bytes, fewer than byteLength says");
}

// --- .glb ---

std::string glb(const Gltf& file, std::uint32_t version = 2) {
  Json json = file.json;
  json["buffers"] = {{{"byteLength", file.data.size()}}};
  std::string text = json.dump(), bytes = "glTF";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
  put<std::uint32_t>(bytes, {version, 12 + 8 + size(text) + 8 + size(file.data), size(text)});
  bytes += "JSON" + text;
  put<std::uint32_t>(bytes, {size(file.data)});
  return bytes + std::string("BIN\0", 4) + file.data;
}

TEST(Gltf, ChunksOfGlbAreHeldAgainstTheFile) {
  const std::string whole = glb(Gltf());
  expect_covers(mesh_from("m.glb", whole), kArea);
  expect_mesh_file_error("m.glb", glb(Gltf(), 1), "is of version 1; allowed: 2");
  std::string other = whole;
  other.replace(12, 4, "\xff\xff\xff\xff");
  expect_mesh_file_error("m.glb", other, "its header is damaged or the file is cut short");
  other = whole;
  other.replace(16, 4, std::string("BIN\0", 4));
  expect_mesh_file_error("m.glb", other, "its first chunk is not JSON");
  // Chunks of other kinds are passed over.
  other = whole;
  std::string chunk;
  put<std::uint32_t>(chunk, {4});
  other += chunk + "XYZWabcd";
  std::string length;
  put<std::uint32_t>(length, {static_cast<std::uint32_t>(other.size())});
  other.replace(8, 4, length);
  expect_covers(mesh_from("m.glb", other), kArea);
  EXPECT_EQ(mesh_file_error("m.glb", whole + "trailing"), "");
}

}  // namespace
}  // namespace sunbeam
