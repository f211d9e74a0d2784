#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

#include "tests/support/read_meshes.h"

namespace rayloc::ply_reader_test {
namespace {

std::string header(const std::string& format, const std::string& scalar = "float") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex 4\nproperty " +
         scalar + " x\nproperty " + scalar + " y\nproperty " + scalar +
         " z\nproperty uchar red\nelement face 1\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(raw.begin(), raw.end());
  }
  bytes += raw;
}

template <typename T>
std::string binary(bool big_endian, const std::string& scalar) {
  std::string bytes = header(big_endian ? "binary_big_endian" : "binary_little_endian", scalar);
  for (const auto& [x, y] : {std::pair{0.1, 0.2}, {1.1, 0.2}, {1.1, 1.2}, {0.1, 1.2}}) {
    append(bytes, static_cast<T>(x), big_endian);
    append(bytes, static_cast<T>(y), big_endian);
    append(bytes, static_cast<T>(0.3), big_endian);
    bytes += '\x7f';
  }
  bytes += '\x04';
  for (const std::int32_t index : {0, 1, 2, 3}) {
    append(bytes, index, big_endian);
  }
  return bytes;
}

void expect_square(const Expected<Mesh>& mesh, double tolerance) {
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->vertices.size(), 4U);
  EXPECT_NEAR(mesh->vertices[2].x, 1.1, tolerance);
  EXPECT_NEAR(mesh->vertices[2].y, 1.2, tolerance);
  EXPECT_NEAR(mesh->vertices[2].z, 0.3, tolerance);
  ASSERT_EQ(mesh->triangles.size(), 2U);
  EXPECT_EQ(mesh->triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(PlyReader, ReadsEveryEncoding) {
  expect_square(read_ply(binary<float>(false, "float"), "a.ply"), 1e-7);
  expect_square(read_ply(binary<float>(true, "float32"), "a.ply"), 1e-7);
  expect_square(read_ply(header("ascii") + "0.1 0.2 0.3 1\n1.1 0.2 0.3 1\n1.1 1.2 0.3 1\n"
                                           "0.1 1.2 0.3 1\n4 0 1 2 3\n",
                         "a.ply"),
                0.0);
}

TEST(PlyReader, KeepsDoubles) {
  expect_square(read_ply(binary<double>(false, "double"), "a.ply"), 0.0);
  expect_square(read_ply(binary<double>(true, "float64"), "a.ply"), 0.0);
}

TEST(PlyReader, EveryTruncationIsAnErrorWithAPlace) {
  const std::string whole = binary<float>(false, "float");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto mesh = read_ply(whole.substr(0, size), "a.ply");
    ASSERT_FALSE(mesh) << size;
    EXPECT_EQ(mesh.error().message.substr(0, 6), "a.ply:") << size;
  }
}

void expect_error(const std::string& bytes, const std::string& message) {
  const auto mesh = read_ply(bytes, "a.ply");
  ASSERT_FALSE(mesh) << "wanted " << message;
  EXPECT_NE(mesh.error().message.find(message), std::string::npos)
      << "wanted " << message << ", got " << mesh.error().message;
}

TEST(PlyReader, EachMistakeHasItsMessage) {
  const std::string vertices = "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n";
  expect_error("solid\nend_header\n", "a.ply:1: this is not a PLY file");
  expect_error("ply\nformat ascii 1.0\n", "a.ply:2: the header has no end_header");
  expect_error("ply\nend_header\n", "a.ply:2: the header states no format");
  expect_error("ply\nformat utf8 1.0\nend_header\n", "a.ply:2: unknown format 'utf8'");
  expect_error("ply\nproperty float x\nend_header\n", "a.ply:2: a property without an element");
  expect_error("ply\nelement vertex many\nend_header\n", "is not a number");
  expect_error("ply\nelement vertex 1\nproperty half x\nend_header\n", "has an unknown type");
  expect_error("ply\nelement vertex 1\nproperty x\nend_header\n", "a property is 'property TYPE");
  expect_error("ply\nvertices 8\nend_header\n", "a.ply:2: 'vertices' cannot be read");
  expect_error("ply\nformat ascii 1.0\nend_header\n", "a.ply: the mesh has no vertex");
  expect_error(header("ascii") + "0 0 nan 1\n" + vertices, "a.ply:12: vertex 0 has a coordinate");
  expect_error(header("ascii") + "0 0 x 1\n" + vertices, "a.ply:12: a number is missing for 'z'");
  expect_error(header("ascii") + vertices + "3 0 1 4\n", "face 1 of 1: it refers to vertex 4 of 4");
  expect_error(header("ascii") + vertices + "3 0 1 -1\n", "a.ply:16: a face refers to a vertex");
  expect_error(header("ascii") + vertices + "9999 0 1\n", "the length of 'vertex_indices'");
  expect_error(
      "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1",
      "the file is too short for 99999999999 entries of element 'vertex'");
}

}  // namespace
}  // namespace rayloc::ply_reader_test
