// PLY as exporters write it: faces, strips, texture coordinates at corners, all three formats.
#include <gtest/gtest.h>

#include "tests/render/mesh_support.h"

namespace sunbeam {
namespace {

const std::string kCorners = "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
constexpr double kArea = 4;

std::string ply(const std::string& header, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}

// A square of four vertices and what else the header says.
std::string square(const std::string& elements, const std::string& body) {
  return ply("element vertex 4\n" + kXyz + elements, kCorners + body);
}

const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

TEST(Ply, ConcavePolygonsAreCoveredOnce) {
  const std::string u = "1 1 0\n1 -0.5 0\n-1 -0.5 0\n-1 1 0\n-1.5 1 0\n-1.5 -1 0\n1.5 -1 0\n1.5 1 0\n";
  expect_covers(mesh_from("m.ply", ply("element vertex 8\n" + kXyz + kFaces, u + "8 0 1 2 3 4 5 6 7\n")), 3);
  expect_covers(mesh_from("m.ply", square(kFaces, "4 0 1 2 3\n")), kArea);
}

std::string strips(const std::string& indices) {
  return ply("element vertex 4\n" + kXyz + "element tristrips 1\nproperty list int int vertex_indices\n",
             "-1 -1 0\n1 -1 0\n-1 1 0\n1 1 0\n" + indices);
}

TEST(Ply, TriangleStripsAreRead) {
  for (const char* indices :
       {"4 0 1 2 3", "9 0 1 2 -1 2 1 3 -1 -1", "6 0 0 1 2 3 3", "7 -1 0 1 2 -1 1 3", "8 0 1 2 2 1 1 2 3"})
    EXPECT_EQ(mesh_file_error("m.ply", strips(indices)), "") << indices;
  expect_covers(mesh_from("m.ply", strips("4 0 1 2 3")), kArea);
  expect_covers(mesh_from("m.ply", strips("8 0 1 2 -1 2 1 3 -1")), kArea);
  expect_covers(mesh_from("m.ply", strips("5 0 1 2 3 3")), kArea);
  expect_covers(mesh_from("m.ply", strips("7 -1 -1 0 1 2 3 -1")), kArea);
  const ScratchFolder folder;
  EXPECT_EQ(load_mesh(folder.write("m.ply", strips("6 0 1 2 3 3 3"))).dropped,
            0u);  // the usual end of a strip
  expect_mesh_file_error("m.ply", strips("4 0 1 2 4"), "face index 4; allowed: 0 to 3");
  expect_mesh_file_error("m.ply", strips("4 0 1 -2 3"), "face index -2");
  expect_mesh_file_error("m.ply", strips("5 0 1 -1 2 3"), "the mesh has no face");
}

TEST(Ply, OnlyFacesAndStripsHoldFaces) {
  const std::string others =
      "element edge 1\nproperty list uchar int vertex_indices\nelement patch 2\nproperty list char float "
      "vertex_index\n"
      "property double weight\n" +
      kFaces + "property uchar red\nproperty list ushort float extra\n";
  const Mesh mesh = mesh_from("m.ply", square(others, "3 0 1 2\n3 0 1 2 0.5\n0 1.5\n4 0 1 2 3 255 2 7 8\n"));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  expect_covers(mesh, kArea);
  expect_mesh_file_error("m.ply",
                         square("element edge 1\nproperty list uchar int vertex_indices\n", "3 0 1 2\n"),
                         "the mesh has no face");
}

TEST(Ply, OtherLinesOfTheHeaderArePassedOver) {
  expect_covers(
      mesh_from("m.ply", square("Created by Blender3D 247\n\nobj_info 1\n" + kFaces, "4 0 1 2 3\n")), kArea);
}

TEST(Ply, ElementsMayComeInAnyOrder) {
  expect_covers(mesh_from("m.ply", ply(kFaces + "element vertex 4\nproperty uchar red\n" + kXyz +
                                           "property float quality\n",
                                       "4 0 1 2 3\n9 -1 -1 0 5\n9 1 -1 0 5\n9 1 1 0 5\n9 -1 1 0 5\n")),
                kArea);
}

const std::string kWedges = kFaces + "property list uchar float texcoord\n";

TEST(Ply, TextureCoordinatesAtCornersAreRead) {
  const Mesh mesh = mesh_from("m.ply", square(kWedges, "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n"));
  expect_covers(mesh, kArea);
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    EXPECT_EQ(mesh.uvs[i].x, (mesh.positions[i].x + 1) / 2);
    EXPECT_EQ(mesh.uvs[i].y, (mesh.positions[i].y + 1) / 2);
  }
}

// At a seam one vertex has two coordinates; its normal goes to both.
TEST(Ply, VerticesAreSplitWhereCornersDiffer) {
  const std::string header =
      "element vertex 4\n" + kXyz +
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 2\nproperty list uchar float texcoord\nproperty int texnumber\n"
      "property list uchar int vertex_index\n";
  const std::string vertices = "-1 -1 0 0 0 1 9 9\n1 -1 0 0 0 1 9 9\n1 1 0 0 0 1 9 9\n-1 1 0 0 0 1 9 9\n";
  const Mesh mesh =
      mesh_from("m.ply", ply(header, vertices + "6 0 0 1 0 1 1 -1 3 0 1 2\n6 0.5 0 0.5 1 0 1 -1 3 0 2 3\n"));
  expect_covers(mesh, kArea);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  const auto uv = [&](std::size_t t, std::size_t corner) { return mesh.uvs[mesh.triangles[t][corner]]; };
  EXPECT_EQ(uv(0, 0).x, 0);
  EXPECT_EQ(uv(1, 0).x, 0.5);
  EXPECT_EQ(uv(0, 2).y, 1);
  EXPECT_EQ(uv(1, 2).x, 0);
  // Where a face has none, those of the vertices stay.
  const Mesh partly = mesh_from("m.ply", ply(header, vertices + "6 0 0 1 0 1 1 -1 3 0 1 2\n0 -1 3 0 2 3\n"));
  ASSERT_EQ(partly.uvs.size(), 4u);
  EXPECT_EQ(partly.uvs[0].x, 9);
  expect_mesh_file_error("m.ply", square(kWedges, "4 0 1 2 3 6 0 0 1 0 1 1\n"),
                         "found a face of 4 corners with 6 numbers in texcoord; allowed: 0 or 8");
  expect_mesh_file_error("m.ply", square(kWedges, "3 0 1 2 6 0 0 1 nan 1 1\n"), "not finite");
}

TEST(Ply, CoordinatesOfVerticesHaveThreeNames) {
  for (const auto& [u, v] :
       {std::pair<std::string, std::string>{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const Mesh mesh = mesh_from("m.ply", ply("element vertex 3\n" + kXyz + "property float " + u +
                                                 "\nproperty float " + v + "\n" + kFaces,
                                             "0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"));
    ASSERT_EQ(mesh.uvs.size(), 3u);
    EXPECT_EQ(mesh.uvs[0].x, 0.25);
    EXPECT_EQ(mesh.uvs[0].y, 0.5);
  }
}

template <class T>
std::string raw(T value, bool is_big) {
  std::string bytes;
  put<T>(bytes, {value});
  return is_big ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string binary_square(bool is_big, const std::string& line_end) {
  std::string bytes =
      "ply\nformat binary_" + std::string(is_big ? "big" : "little") +
      "_endian 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty float y\n"
      "property short z\nproperty list uchar ushort seen_by\nelement face 1\n"
      "property list uint uchar vertex_indices\nend_header\n";
  for (std::size_t at = 0; (at = bytes.find('\n', at)) != std::string::npos; at += line_end.size())
    bytes.replace(at, 1, line_end);
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    bytes += raw<double>(x, is_big) + raw<float>(static_cast<float>(y), is_big) +
             raw<std::int16_t>(0, is_big) + raw<std::uint8_t>(2, is_big) + raw<std::uint16_t>(10, is_big) +
             raw<std::uint16_t>(2570, is_big);
  bytes += raw<std::uint32_t>(4, is_big);
  for (const int corner : {0, 1, 2, 3}) bytes += raw(static_cast<std::uint8_t>(corner), is_big);
  return bytes;
}

TEST(Ply, BinaryOfBothOrdersAndEveryLineEnd) {
  for (const bool is_big : {false, true})
    for (const char* end : {"\n", "\r\n", "\r"})
      expect_covers(mesh_from("m.ply", binary_square(is_big, end)), kArea);
  std::string text = square(kFaces, "4 0 1 2 3\n");
  expect_covers(mesh_from("m.ply", "\xef\xbb\xbf" + text), kArea);
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\r\n");
  expect_covers(mesh_from("m.ply", text), kArea);
}

TEST(Ply, CountsAreHeldAgainstTheBytes) {
  const auto expect_short = [](const std::string& content) {
    expect_mesh_file_error("m.ply", content, "ends before its last number");
  };
  expect_short(ply("element vertex 900000000000\n" + kXyz + kFaces, kCorners));
  expect_short(square("element face 900000000000\nproperty list uchar int vertex_indices\n", "3 0 1 2\n"));
  expect_short(square("element face 1\nproperty list uint int vertex_indices\n", "4000000000 0 1 2\n"));
  expect_short(square("element face 1\nproperty list double int vertex_indices\n", "1e300 0 1 2\n"));
  std::string binary = binary_square(false, "\n");
  binary.replace(binary.size() - 8, 4, "\xff\xff\xff\xff");
  expect_short(binary);
  expect_mesh_file_error("m.ply", ply("element vertex -1\n" + kXyz, ""), "an element without name and count");
  expect_mesh_file_error("m.ply", ply("element vertex 99999999999999999999\n" + kXyz, ""),
                         "an element without name");
  expect_mesh_file_error("m.ply", square(kFaces, "-3 0 1 2\n"), "found a list of -3 entries");
  expect_mesh_file_error("m.ply",
                         square("element face 1\nproperty list float int vertex_indices\n", "2.5 0 1 2\n"),
                         "found a list of 2.5 entries");
}

TEST(Ply, WhatIsWrongIsRefused) {
  expect_mesh_file_error("m.ply",
                         square("element face 1\nproperty list uchar float vertex_indices\n", "3 0 1 1.5\n"),
                         "face index 1.5; allowed: 0 to 3");
  expect_mesh_file_error("m.ply", square(kFaces, "3 0 1 nan\n"), "face index nan");
  expect_mesh_file_error("m.ply", square("element face 1\nproperty list uchar int corners\n", "3 0 1 2\n"),
                         "found the element face without a list vertex_indices");
  expect_mesh_file_error("m.ply", square(kFaces + kFaces, "3 0 1 2\n3 0 1 2\n"),
                         "found the element face a second time");
  expect_mesh_file_error("m.ply", square("property int\n" + kFaces, "3 0 1 2\n"),
                         "a property without type and name");
  expect_mesh_file_error("m.ply", square("property int64 q\n" + kFaces, "3 0 1 2\n"),
                         "found the type 'int64'");
  expect_mesh_file_error("m.ply", "ply\nformat ascii 2.0\nend_header\n", "not version 1.0");
  expect_mesh_file_error("m.ply", "ply\nelement vertex 0\nend_header\n", "the header has no format");
  expect_mesh_file_error("m.ply", "plyx\nformat ascii 1.0\nend_header\n", "does not begin with 'ply'");
  expect_mesh_file_error("m.ply", square(kFaces, "3 0 1 " + std::string(5000, 'x')),
                         std::string(60, 'x') + "...'");
  expect_mesh_file_error(
      "m.ply",
      ply("element vertex 4\nproperty float x\nproperty float y\n" + kFaces, "0 0\n1 0\n1 1\n0 1\n3 0 1 2\n"),
      "its vertices have no x, y, z");
}

TEST(Ply, NormalsAndNumbersWithoutMeaningAreRefused) {
  const auto with_normal = [](const std::string& normal) {
    return ply(
        "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty double nx\n"
        "property double ny\nproperty double nz\n" +
            kFaces,
        "0 0 0 " + normal + "\n1 0 0 0 0 1\n0 1 1e-400 0 0 1\n3 0 1 2\n");
  };
  EXPECT_EQ(mesh_file_error("m.ply", with_normal("0 0 2")), "");
  for (const char* normal : {"0 0 0", "0 0 1e300", "0 0 1e-300"})
    EXPECT_NE(mesh_file_error("m.ply", with_normal(normal)), "") << normal;  // its square is no number
  expect_mesh_file_error(
      "m.ply",
      ply("element vertex 3\nproperty double x\nproperty double y\nproperty double z\n" + kFaces,
          "0 0 0\n1e300 0 0\n0 1 0\n3 0 1 2\n"),
      "not finite");
}

}  // namespace
}  // namespace sunbeam
