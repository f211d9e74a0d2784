// Own reader and not assimp's: that one keeps vertices as float and tells no place in its errors.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/number_text.h"
#include "engine/scene/read/mesh_reader.h"
#include "engine/scene/read/polygon_list.h"

namespace rayloc {
namespace {

enum class Encoding { kAscii, kLittleEndian, kBigEndian };
enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Type type = Type::kFloat32;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::size_t size = 0;   // [bytes]
  std::size_t lines = 0;  // in it
};

std::size_t size_of(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 1;
    case Type::kInt16:
    case Type::kUint16:
      return 2;
    case Type::kInt32:
    case Type::kUint32:
    case Type::kFloat32:
      return 4;
    case Type::kFloat64:
      break;
  }
  return 8;
}

std::optional<Type> type_named(std::string_view name) {
  // The two names that PLY has for each type.
  constexpr std::array<std::pair<std::string_view, Type>, 16> kNames{{
      {"char", Type::kInt8},
      {"int8", Type::kInt8},
      {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},
      {"short", Type::kInt16},
      {"int16", Type::kInt16},
      {"ushort", Type::kUint16},
      {"uint16", Type::kUint16},
      {"int", Type::kInt32},
      {"int32", Type::kInt32},
      {"uint", Type::kUint32},
      {"uint32", Type::kUint32},
      {"float", Type::kFloat32},
      {"float32", Type::kFloat32},
      {"double", Type::kFloat64},
      {"float64", Type::kFloat64},
  }};
  for (const auto& [known, type] : kNames) {
    if (known == name) {
      return type;
    }
  }
  return std::nullopt;
}

// Blanks that part words of a header and numbers of a body.
constexpr std::string_view kPlyBlank = " \t\r\n";

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(kPlyBlank); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kPlyBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kPlyBlank, end);
  }
  return words;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<Header> read() {
    bool has_format = false;
    for (;;) {
      const std::size_t end = bytes_.find('\n', header_.size);
      if (end == std::string_view::npos) {
        return refuse("the header has no end_header");
      }
      const auto words = words_of(bytes_.substr(header_.size, end - header_.size));
      header_.size = end + 1;
      ++header_.lines;
      if (header_.lines == 1) {
        if (words.size() != 1 || words[0] != "ply") {
          return refuse("this is not a PLY file; it must begin with a line 'ply'");
        }
        continue;
      }
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
        continue;
      }
      if (words[0] == "end_header") {
        if (!has_format) {
          return refuse("the header states no format");
        }
        return header_;
      }
      has_format = has_format || words[0] == "format";
      if (auto line = read_line(words); !line) {
        return tl::make_unexpected(line.error());
      }
    }
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(name_ + ":" + std::to_string(header_.lines) + ": " + what);
  }

  Expected<void> read_line(const std::vector<std::string_view>& words) {
    if (words[0] == "format" && words.size() >= 2) {
      if (words[1] == "ascii") {
        header_.encoding = Encoding::kAscii;
      } else if (words[1] == "binary_little_endian") {
        header_.encoding = Encoding::kLittleEndian;
      } else if (words[1] == "binary_big_endian") {
        header_.encoding = Encoding::kBigEndian;
      } else {
        return refuse("unknown format '" + std::string(words[1]) +
                      "'; ascii, binary_little_endian and binary_big_endian are read");
      }
      return {};
    }
    if (words[0] == "element" && words.size() == 3) {
      std::size_t count = 0;
      const char* last = words[2].data() + words[2].size();
      const auto [end, status] = std::from_chars(words[2].data(), last, count);
      if (status != std::errc() || end != last) {
        return refuse("the count of element '" + std::string(words[1]) + "' is not a number");
      }
      header_.elements.push_back({std::string(words[1]), count, {}});
      return {};
    }
    if (words[0] == "property") {
      return read_property(words);
    }
    return refuse("'" + std::string(words[0]) + "' cannot be read");
  }

  Expected<void> read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) {
      return refuse("a property without an element");
    }
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) {
      return refuse("a property is 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }
    Property property;
    property.name = std::string(words.back());
    const auto type = type_named(words[list ? 3 : 1]);
    if (list) {
      property.count_type = type_named(words[2]);
    }
    if (!type || (list && !property.count_type)) {
      return refuse("property '" + property.name + "' has an unknown type");
    }
    property.type = *type;
    header_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  std::string_view bytes_;
  const std::string& name_;
  Header header_;
};

// Numbers of the body, one after the other, in whichever encoding.
class BodyReader {
 public:
  BodyReader(std::string_view bytes, const Header& header)
      : bytes_(bytes), encoding_(header.encoding), at_(header.size), line_(header.lines + 1) {}

  // Nothing at the end of the bytes or where no number is.
  std::optional<double> next(Type type) {
    return encoding_ == Encoding::kAscii ? next_text() : next_binary(type);
  }
  std::size_t bytes_left() const { return bytes_.size() - at_; }
  // How the newest number is written; empty in a binary file.
  std::string_view text() const { return text_; }
  std::string place() const {
    return encoding_ == Encoding::kAscii ? ":" + std::to_string(line_)
                                         : ": byte " + std::to_string(at_);
  }

 private:
  std::optional<double> next_text() {
    while (at_ < bytes_.size() && kPlyBlank.find(bytes_[at_]) != std::string_view::npos) {
      line_ += bytes_[at_] == '\n' ? 1U : 0U;
      ++at_;
    }
    std::string_view rest = bytes_.substr(at_);
    const auto value = read_number(rest);
    if (!rest.empty() && kPlyBlank.find(rest[0]) == std::string_view::npos) {
      return std::nullopt;  // "1,5" and "4m" are no numbers
    }
    text_ = bytes_.substr(at_, bytes_.size() - rest.size() - at_);
    at_ = bytes_.size() - rest.size();
    return value;
  }

  template <typename T>
  double decode() {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if ((encoding_ == Encoding::kBigEndian) != (std::endian::native == std::endian::big)) {
      std::reverse(raw.begin(), raw.end());
    }
    at_ += sizeof(T);
    return static_cast<double>(std::bit_cast<T>(raw));
  }

  std::optional<double> next_binary(Type type) {
    if (bytes_left() < size_of(type)) {
      return std::nullopt;
    }
    switch (type) {
      case Type::kInt8:
        return decode<std::int8_t>();
      case Type::kUint8:
        return decode<std::uint8_t>();
      case Type::kInt16:
        return decode<std::int16_t>();
      case Type::kUint16:
        return decode<std::uint16_t>();
      case Type::kInt32:
        return decode<std::int32_t>();
      case Type::kUint32:
        return decode<std::uint32_t>();
      case Type::kFloat32:
        return decode<float>();
      case Type::kFloat64:
        break;
    }
    return decode<double>();
  }

  std::string_view bytes_;
  std::string_view text_;
  Encoding encoding_;
  std::size_t at_;
  std::size_t line_;
};

class MeshReader {
 public:
  MeshReader(std::string_view bytes, const std::string& name, const Header& header)
      : name_(name), body_(bytes, header) {}

  Expected<Mesh> read(const Header& header) {
    for (const Element& element : header.elements) {
      // Each entry takes at least a byte per property: a count beyond that is a lie that must not
      // cost time.
      if (element.count >
          body_.bytes_left() / std::max<std::size_t>(element.properties.size(), 1)) {
        return refuse("the file is too short for " + std::to_string(element.count) +
                      " entries of element '" + element.name + "'");
      }
      for (std::size_t i = 0; i < element.count; ++i) {
        if (auto entry = read_entry(element); !entry) {
          return tl::make_unexpected(entry.error());
        }
      }
    }
    if (mesh_.vertices.empty() || faces_.size() == 0) {
      return bad_input(name_ + ": the mesh has no " + (mesh_.vertices.empty() ? "vertex" : "face"));
    }
    mesh_.rounding = std::max(mesh_.rounding, precision_.rounding());
    if (auto cut = faces_.append_to(mesh_, [&](std::size_t) { return name_; }); !cut) {
      return tl::make_unexpected(cut.error());
    }
    return std::move(mesh_);
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(name_ + body_.place() + ": " + what);
  }

  Expected<void> read_entry(const Element& element) {
    const bool is_vertex = element.name == "vertex";
    Vec3d vertex;
    for (const Property& property : element.properties) {
      if (property.count_type) {
        if (auto list = read_list(property, use_of(element, property)); !list) {
          return list;
        }
        continue;
      }
      const auto value = body_.next(property.type);
      if (!value) {
        return refuse("a number is missing for '" + property.name + "'");
      }
      if (is_vertex && !body_.text().empty() && is_coordinate(property)) {
        precision_.note(body_.text(), *value);
      }
      if (property.name == "x") {
        vertex.x = *value;
      } else if (property.name == "y") {
        vertex.y = *value;
      } else if (property.name == "z") {
        vertex.z = *value;
      }
    }
    if (is_vertex) {
      if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
        return refuse("vertex " + std::to_string(mesh_.vertices.size()) +
                      " has a coordinate that is not a finite number");
      }
      mesh_.vertices.push_back(vertex);
      return note_rounding(element, vertex);
    }
    return {};
  }

  static bool is_coordinate(const Property& property) {
    return property.name == "x" || property.name == "y" || property.name == "z";
  }

  // A float of a binary file tells no more than its 24 bits.
  Expected<void> note_rounding(const Element& element, const Vec3d& vertex) {
    // A ratio: half of the last bit of a float, 2^-24.
    constexpr double kFloatRounding = 5.9604644775390625e-8;
    constexpr double kCoarsest = 1e-3;  // [m], 6 degrees of phase at 5 GHz
    const bool is_float = std::any_of(
        element.properties.begin(), element.properties.end(), [](const Property& property) {
          return property.type == Type::kFloat32 && is_coordinate(property);
        });
    if (!is_float || !body_.text().empty()) {
      return {};
    }
    const double furthest = std::max({std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
    mesh_.rounding = std::max(mesh_.rounding, kFloatRounding * furthest);
    if (mesh_.rounding > kCoarsest) {
      return refuse("a coordinate of vertex " + std::to_string(mesh_.vertices.size() - 1) + " is " +
                    std::to_string(std::llround(furthest)) +
                    " m, of which a float keeps no millimetres; export the mesh about a local "
                    "origin, or with coordinates of type double");
    }
    return {};
  }

  // What a list is to the mesh.
  enum class Use { kNone, kFace, kStrips };
  static Use use_of(const Element& element, const Property& property) {
    if (property.name != "vertex_indices" && property.name != "vertex_index") {
      return Use::kNone;
    }
    if (element.name == "face") {
      return Use::kFace;
    }
    return element.name == "tristrips" ? Use::kStrips : Use::kNone;
  }

  Expected<void> read_list(const Property& property, Use use) {
    const auto count = body_.next(*property.count_type);
    if (!count || !(*count >= 0.0) || *count > static_cast<double>(body_.bytes_left())) {
      return refuse("the length of '" + property.name + "' is missing or beyond the file");
    }
    std::vector<double> entries;
    const auto size = static_cast<std::size_t>(*count);
    for (std::size_t i = 0; i < size; ++i) {
      const auto value = body_.next(property.type);
      if (!value) {
        return refuse("a number is missing in '" + property.name + "'");
      }
      const bool ends_strip = use == Use::kStrips && *value == -1.0;
      if (use != Use::kNone && !ends_strip &&
          (!(*value >= 0.0) || *value > 4'294'967'295.0 || *value != std::floor(*value))) {
        return refuse("a face refers to a vertex that is not a whole number from 0 on");
      }
      entries.push_back(*value);
    }
    if (use == Use::kFace && !entries.empty()) {
      add_face(entries);
    } else if (use == Use::kStrips) {
      add_strips(entries);
    }
    return {};
  }

  void add_face(std::span<const double> corners) {
    for (const double corner : corners) {
      faces_.add_corner(static_cast<std::uint32_t>(corner));
    }
    faces_.end_face();
  }

  // Each vertex after the second makes a triangle with the two before it, every other one turned
  // round; -1 begins another strip. A vertex named twice only turns the strip.
  void add_strips(std::span<const double> vertices) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] == -1.0) {
        first = i + 1;
        continue;
      }
      if (i < first + 2) {
        continue;
      }
      const bool is_turned = (i - first) % 2 == 1;
      const double a = vertices[i - (is_turned ? 1 : 2)];
      const double b = vertices[i - (is_turned ? 2 : 1)];
      if (a != b && b != vertices[i] && a != vertices[i]) {
        add_face(std::array{a, b, vertices[i]});
      }
    }
  }

  const std::string& name_;
  BodyReader body_;
  Mesh mesh_;
  TextPrecision precision_;
  PolygonList faces_;
};

}  // namespace

Expected<Mesh> read_ply(std::string_view bytes, const std::string& name) {
  const auto header = HeaderReader(bytes, name).read();
  if (!header) {
    return tl::make_unexpected(header.error());
  }
  return MeshReader(bytes, name, *header).read(*header);
}

}  // namespace rayloc
