#include "engine/scene/read/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace rayloc {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  // The two names that PLY has for each type.
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{
      {"char", PlyType::kInt8},
      {"int8", PlyType::kInt8},
      {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},
      {"short", PlyType::kInt16},
      {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},
      {"uint16", PlyType::kUint16},
      {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},
      {"uint", PlyType::kUint32},
      {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},
      {"float32", PlyType::kFloat32},
      {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64},
  }};
  for (const auto& [known, type] : kNames) {
    if (known == name) {
      return type;
    }
  }
  return std::nullopt;
}

std::vector<std::string_view> split_words(std::string_view line) {
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

  Expected<PlyHeader> read() {
    bool has_format = false;
    for (;;) {
      const std::size_t end = bytes_.find('\n', header_.size);
      if (end == std::string_view::npos) {
        return refuse("the header has no end_header");
      }
      const auto words = split_words(bytes_.substr(header_.size, end - header_.size));
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
        RAYLOC_TRY(check_elements());
        return header_;
      }
      has_format = has_format || words[0] == "format";
      RAYLOC_TRY(read_line(words));
    }
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return refuse_at(header_.lines, what);
  }
  tl::unexpected<Error> refuse_at(std::size_t line, const std::string& what) const {
    return bad_input(name_ + ":" + std::to_string(line) + ": " + what);
  }

  Expected<void> read_line(const std::vector<std::string_view>& words) {
    if (words[0] == "format" && words.size() >= 2) {
      if (words[1] == "ascii") {
        header_.encoding = PlyEncoding::kAscii;
      } else if (words[1] == "binary_little_endian") {
        header_.encoding = PlyEncoding::kLittleEndian;
      } else if (words[1] == "binary_big_endian") {
        header_.encoding = PlyEncoding::kBigEndian;
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
      header_.elements.push_back({std::string(words[1]), count, header_.lines, {}});
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
    PlyProperty property;
    property.name = std::string(words.back());
    const auto type = type_named(words[list ? 3 : 1]);
    if (list) {
      property.count_type = type_named(words[2]);
    }
    if (!type || (list && !property.count_type)) {
      return refuse("property '" + property.name + "' has an unknown type, '" +
                    std::string(words[list && property.count_type ? 3
                                      : list                      ? 2
                                                                  : 1]) +
                    "'; the types are char, uchar, short, ushort, int, uint, float and double");
    }
    if (property.count_type == PlyType::kFloat32 || property.count_type == PlyType::kFloat64) {
      return refuse("the list '" + property.name +
                    "' has a length that is no whole number; its type must be uchar or int");
    }
    property.type = *type;
    auto& properties = header_.elements.back().properties;
    if (use_of(header_.elements.back(), property) != PlyUse::kNone &&
        std::any_of(properties.begin(), properties.end(), [&](const PlyProperty& other) {
          return other.name == property.name;
        })) {
      return refuse("element '" + header_.elements.back().name + "' has two properties '" +
                    property.name + "'");
    }
    properties.push_back(std::move(property));
    return {};
  }

  Expected<void> check_elements() const {
    for (const PlyElement& element : header_.elements) {
      if (element.count == 0) {
        continue;
      }
      if (element.name == "vertex") {
        for (const auto& [use, name] :
             {std::pair{PlyUse::kX, "x"}, {PlyUse::kY, "y"}, {PlyUse::kZ, "z"}}) {
          if (!has_property(element, use)) {
            return refuse_at(
                element.line,
                "element 'vertex' has no property " + std::string(name) + found_in(element));
          }
        }
      } else if ((element.name == "face" && !has_property(element, PlyUse::kFace)) ||
                 (element.name == "tristrips" && !has_property(element, PlyUse::kStrips))) {
        return refuse_at(
            element.line,
            "element '" + element.name + "' has no list vertex_indices" + found_in(element));
      }
    }
    return {};
  }

  static bool has_property(const PlyElement& element, PlyUse use) {
    return std::any_of(
        element.properties.begin(), element.properties.end(), [&](const PlyProperty& property) {
          return use_of(element, property) == use;
        });
  }

  static std::string found_in(const PlyElement& element) {
    std::string names;
    for (const PlyProperty& property : element.properties) {
      names += (names.empty() ? "" : ", ") + std::string(property.count_type ? "list " : "") +
               property.name;
    }
    return "; it has: " + (names.empty() ? "none" : names) +
           "; rename the property in the header, or export the mesh again";
  }

  std::string_view bytes_;
  const std::string& name_;
  PlyHeader header_;
};

// Exporters that number the materials of faces use different names.
bool is_material_number(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  constexpr std::array<std::string_view, 5> kShort{"mat", "mtl", "mat_id", "matid", "mat_index"};
  return lower.starts_with("material") ||
         std::find(kShort.begin(), kShort.end(), lower) != kShort.end();
}

}  // namespace

PlyUse use_of(const PlyElement& element, const PlyProperty& property) {
  if (element.name == "vertex" && !property.count_type) {
    return property.name == "x"   ? PlyUse::kX
           : property.name == "y" ? PlyUse::kY
           : property.name == "z" ? PlyUse::kZ
                                  : PlyUse::kNone;
  }
  if (element.name == "face" && !property.count_type) {
    return is_material_number(property.name) ? PlyUse::kMaterial : PlyUse::kNone;
  }
  if (!property.count_type ||
      (property.name != "vertex_indices" && property.name != "vertex_index")) {
    return PlyUse::kNone;
  }
  return element.name == "face"        ? PlyUse::kFace
         : element.name == "tristrips" ? PlyUse::kStrips
                                       : PlyUse::kNone;
}

Expected<PlyHeader> read_ply_header(std::string_view bytes, const std::string& name) {
  return HeaderReader(bytes, name).read();
}

}  // namespace rayloc
