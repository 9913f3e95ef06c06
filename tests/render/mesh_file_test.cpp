// Meshes in files: what is written reads back, and damage is told in one line.
#include "runtime/tracer/mesh_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "runtime/tracer/snake.h"
#include "sunbeam/detail/file.h"
#include "tests/render/mesh_support.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

// Corner by corner, for importers may double or merge vertices.
void expect_same(const Mesh& found, const Mesh& expected, double tolerance) {
  ASSERT_EQ(found.triangles.size(), expected.triangles.size());
  ASSERT_EQ(found.normals.empty(), expected.normals.empty());
  ASSERT_EQ(found.uvs.empty(), expected.uvs.empty());
  for (std::size_t t = 0; t < expected.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = found.triangles[t][k], j = expected.triangles[t][k];
      ASSERT_LT(length(found.positions[i] - expected.positions[j]), tolerance);
      if (!expected.normals.empty()) {
        ASSERT_LT(length(found.normals[i] - expected.normals[j]), tolerance);
      }
      if (expected.uvs.empty()) continue;
      ASSERT_NEAR(found.uvs[i].x, expected.uvs[j].x, tolerance);
      ASSERT_NEAR(found.uvs[i].y, expected.uvs[j].y, tolerance);
    }
}

TEST(MeshFile, ObjAndPlyRoundTrip) {
  const ScratchFolder folder;
  const Mesh snake = snake_mesh({.turns = 1, .resolution = 32});
  Mesh bare = torus_mesh({1, 2, 3}, 2, 0.5, {10, 20, 30}, 16);
  Mesh no_uvs = bare, no_normals = bare;
  no_uvs.uvs.clear(), no_normals.normals.clear();
  bare.uvs.clear(), bare.normals.clear();
  for (const std::string name : {"a.obj", "a.ply"})
    for (const Mesh& mesh : {snake, bare, no_uvs, no_normals}) {
      write_mesh(folder.file(name), mesh);
      const LoadedMesh read = load_mesh(folder.file(name));
      EXPECT_EQ(read.dropped, 0u);
      expect_same(read.mesh, mesh, 3e-6);  // single precision, of v up to 10
    }
  EXPECT_EQ(folder.names().size(), 2u);
}

std::string ply(const std::string& vertices, const std::string& faces, int vertex_count = 4,
                int face_count = 1) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" + vertices +
         faces;
}
const std::string kCorners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

void expect_error(const std::string& content, const std::string& part) {
  expect_mesh_file_error("m.ply", content, part);
}

TEST(MeshFile, AsciiPlyPolygonsBecomeTriangles) {
  const ScratchFolder folder;
  const LoadedMesh read = load_mesh(folder.write("m.ply", ply(kCorners, "4 0 1 2 3\n")));
  ASSERT_EQ(read.mesh.triangles.size(), 2u);
  EXPECT_TRUE(read.mesh.normals.empty());
  EXPECT_TRUE(read.mesh.uvs.empty());
}

TEST(MeshFile, BadPlyIsRefused) {
  expect_error(ply(kCorners, "3 0 1 9\n"), "face index 9; allowed: 0 to 3");
  expect_error(ply(kCorners, "3 0 1 -1\n"), "face index -1");
  expect_error(ply("0 0 0\nnan 0 0\n1 1 0\n0 1 0\n", "3 0 1 2\n"), "not finite");
  expect_error(ply("0 0 0\ninf 0 0\n1 1 0\n0 1 0\n", "3 0 1 2\n"), "not finite");
  expect_error(ply(kCorners, "", 4, 0), "the mesh has no face");
  expect_error(ply("", "", 0, 0), "m.ply");
  expect_error(ply(kCorners, "3 0 1 1\n"), "1 triangles without area and no other face");
  expect_error(ply(kCorners, "3 0 1 2\n", 4, 1000000), "ends before its last number");
  expect_error(ply("0 0 0\n", "", 1000000, 1), "ends before its last number");
  expect_error("", "does not begin with 'ply'");
  expect_error("ply\n", "the header has no end");
  expect_error(ply("0 0 0\nx 0 0\n1 1 0\n0 1 0\n", "3 0 1 2\n"), "found 'x'; allowed: a number");
  expect_error("no mesh at all", "not a valid PLY file");
}

TEST(MeshFile, ACutBinaryPlyIsRefusedAnywhere) {
  const ScratchFolder folder;
  write_mesh(folder.file("whole.ply"), sphere_mesh(1, 8));
  const std::string bytes = read_file(folder.file("whole.ply"));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 37)
    EXPECT_NE(mesh_file_error("m.ply", bytes.substr(0, size)), "") << size << " of " << bytes.size();
}

TEST(MeshFile, TrianglesWithoutAreaAreDroppedAndCounted) {
  const ScratchFolder folder;
  const std::string faces = "3 0 1 2\n3 0 1 1\n3 0 2 3\n3 2 2 2\n";
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>{"m.ply", ply(kCorners, faces, 4, 4)},
        {"m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\nf 1 3 4\nf 3 3 3\n"}}) {
    const LoadedMesh read = load_mesh(folder.write(name, text));
    EXPECT_EQ(read.dropped, 2u) << name;
    EXPECT_EQ(read.mesh.triangles.size(), 2u) << name;
  }
  const Scene scene = load_scene(folder.write(
      "a.toml",
      "[camera]\nposition = [0, -5, 1]\nlook_at = [0, 0, 0]\n[[material]]\nname = 'grey'\ntype = 'diffuse'\n"
      "[[object]]\ntype = 'mesh'\nfile = 'm.ply'\nmaterial = 'grey'\n"));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "m.ply: 2 triangles without area are left out");
}

TEST(MeshFile, OtherExtensionsAreRefused) {
  EXPECT_NE(mesh_file_error("m.stl", "").find("allowed for a mesh: .obj, .ply, .gltf, .glb"),
            std::string::npos);
  EXPECT_NE(error_of([] { write_mesh("m.glb", Mesh{}); }).find("allowed for writing a mesh: .obj, .ply"),
            std::string::npos);
  EXPECT_NE(error_of([] { load_mesh("missing.glb"); }).find("missing.glb: cannot read: No such file"),
            std::string::npos);
}

// --- glTF ---

struct GlbParts {
  std::string node = R"("translation": [10, 0, 0], "scale": [2, 2, 2])";
  std::uint16_t last_index = 2;
  int index_count = 3;
  float first_x = 0;
};

// One triangle (0,0,0), (1,0,0), (0,1,0) with normals +z and coordinates (0,0), (1,0), (0,1), under a node.
std::string glb(const GlbParts& parts) {
  std::string data;
  put<float>(data, {parts.first_x, 0, 0, 1, 0, 0, 0, 1, 0});
  put<float>(data, {0, 0, 1, 0, 0, 1, 0, 0, 1});
  put<float>(data, {0, 0, 1, 0, 0, 1});
  put<std::uint16_t>(data, {0, 1, parts.last_index, 0});
  std::string json = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, )" +
                     parts.node + R"(}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3}]}],
    "buffers": [{"byteLength": )" +
                     std::to_string(data.size()) + R"(}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36},
      {"buffer": 0, "byteOffset": 72, "byteLength": 24}, {"buffer": 0, "byteOffset": 96, "byteLength": 6}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"},
      {"bufferView": 3, "componentType": 5123, "count": )" +
                     std::to_string(parts.index_count) + R"(, "type": "SCALAR"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
  put<std::uint32_t>(file, {2, 12 + 8 + size(json) + 8 + size(data), size(json)});
  file += "JSON" + json;
  put<std::uint32_t>(file, {size(data)});
  return file + std::string("BIN\0", 4) + data;
}

TEST(MeshFile, GlbNodesAreTransformed) {
  const ScratchFolder folder;
  const Mesh mesh = load_mesh(folder.write("m.glb", glb({}))).mesh;
  ASSERT_EQ(mesh.triangles.size(), 1u);
  ASSERT_EQ(mesh.normals.size(), 3u);
  ASSERT_EQ(mesh.uvs.size(), 3u);
  const auto [a, b, c] = mesh.triangles[0];
  EXPECT_LT(length(mesh.positions[a] - Vec3{10, 0, 0}), 1e-6);
  EXPECT_LT(length(mesh.positions[b] - Vec3{12, 0, 0}), 1e-6);
  EXPECT_LT(length(mesh.positions[c] - Vec3{10, 2, 0}), 1e-6);
  for (const Vec3& normal : mesh.normals) EXPECT_LT(length(normal - Vec3{0, 0, 1}), 1e-6);
  EXPECT_NEAR(mesh.uvs[b].x, 1, 1e-6);
  // glTF's v points down.
  EXPECT_NEAR(mesh.uvs[a].y, 1, 1e-6);
  EXPECT_NEAR(mesh.uvs[c].y, 0, 1e-6);
}

TEST(MeshFile, BadGlbIsRefused) {
  EXPECT_EQ(mesh_file_error("m.glb", glb({})), "");
  EXPECT_NE(mesh_file_error("m.glb", glb({.last_index = 7})).find("face index 7; allowed: 0 to 2"),
            std::string::npos);
  EXPECT_NE(mesh_file_error("m.glb", glb({.index_count = 300})).find("reaches beyond its buffer"),
            std::string::npos);
  EXPECT_NE(
      mesh_file_error("m.glb", glb({.first_x = std::numeric_limits<float>::quiet_NaN()})).find("not finite"),
      std::string::npos);
  EXPECT_NE(mesh_file_error("m.gltf", "{"), "");
  EXPECT_NE(mesh_file_error("m.gltf", R"({"asset": {"version": "2.0"}})"), "");
  const std::string whole = glb({});
  for (std::size_t size = 0; size < whole.size(); size += 61)
    EXPECT_NE(mesh_file_error("m.glb", whole.substr(0, size)), "") << size << " of " << whole.size();
}

TEST(MeshFile, GltfWithItsBufferInsideOrBeside) {
  // The same triangle, positions only, as base64 and as a file; two nodes, one mirrored.
  const auto text = [](const std::string& uri) {
    return R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1]}],
      "scenes": [{"nodes": [0, 1]}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "buffers": [{"byteLength": 36, "uri": ")" +
           uri + R"("}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]})";
  };
  const ScratchFolder folder;
  std::string data;
  put<float>(data, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  folder.write("data.bin", data);
  for (const std::string uri :
       {"data.bin",
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}) {
    const Mesh mesh = load_mesh(folder.write("m.gltf", text(uri))).mesh;
    ASSERT_EQ(mesh.triangles.size(), 2u);
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 winding =
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      EXPECT_LT(length(winding - Vec3{0, 0, 1}), 1e-6);  // mirrored or not, the same side is out
    }
  }
  EXPECT_NE(mesh_file_error("m.gltf", text("missing.bin")).find("missing.bin: cannot read"),
            std::string::npos);
}

// Flips bytes: what loads is sound, what does not says so in a line.
TEST(MeshFile, DamagedBytesNeverCrash) {
  const ScratchFolder folder;
  write_mesh(folder.file("whole.ply"), sphere_mesh(1, 8));
  int refused = 0, loaded = 0;
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"m.ply", read_file(folder.file("whole.ply"))},
        {"m.ply", ply(kCorners, "4 0 1 2 3\n")},
        {"m.glb", glb({})}}) {
    Rng rng(21, 0);
    for (int i = 0; i < 150; ++i) {
      std::string damaged = whole;
      for (int k = 0; k < 2; ++k)
        damaged[static_cast<std::size_t>(rng.uniform() * static_cast<double>(whole.size()))] =
            static_cast<char>(rng.next());
      const std::string path = folder.write(name, damaged);
      Mesh mesh;
      const std::string message = error_of([&] { mesh = load_mesh(path).mesh; });
      ++(message.empty() ? loaded : refused);
      ASSERT_EQ(message.find('\n'), std::string::npos) << message;
      for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle) {
          ASSERT_LT(corner, mesh.positions.size());
          ASSERT_TRUE(std::isfinite(length(mesh.positions[corner])));
        }
      ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
      ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(loaded, 50);
}

}  // namespace
}  // namespace sunbeam
