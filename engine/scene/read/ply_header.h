// The header of a PLY file: the elements of the body, and the properties of each.
// Internal to read_ply.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

// Separators of words in a header and of numbers in a body.
inline constexpr std::string_view kPlyBlank = " \t\r\n";

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };
enum class PlyType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat32,
  kFloat64
};

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::size_t line = 0;  // of the header, from 1
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;   // [bytes]
  std::size_t lines = 0;  // in it
};

// The role of a property in the mesh.
enum class PlyUse : std::uint8_t { kNone, kX, kY, kZ, kFace, kStrips, kMaterial };
PlyUse use_of(const PlyElement& element, const PlyProperty& property);

// An Error names the line. A header whose vertices lack a coordinate, or whose faces lack their
// list of vertices, is an error: the mesh would be wrong without it.
Expected<PlyHeader> read_ply_header(std::string_view bytes, const std::string& name);

}  // namespace rayloc
