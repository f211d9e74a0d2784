#include "daemon/site/import/recognise.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>

namespace rayloc {
namespace {

constexpr std::size_t kHeadBytes = 4096;

struct Refused {
  std::string_view begins;
  std::string_view what;
  std::string_view advice;
};

constexpr std::string_view kTrace =
    "draw its walls over it and save that as SVG or DXF, or write a plan for rayloc scene room";

constexpr std::array kRefused = {
    Refused{"AC10", "a DWG drawing", "export its plan as DXF or SVG, or it as GLB, OBJ or IFC"},
    Refused{
        "ISO-10303-21", "a STEP model", "export it as GLB, OBJ or IFC, or its plan as DXF or SVG"},
    Refused{"AutoCAD Binary DXF", "a DXF in binary", "export it as DXF of text (ASCII)"},
    Refused{"%PDF",
            "a PDF",
            "open it in Inkscape and save its plan as SVG, or write a plan for rayloc scene room"},
    Refused{"\x89PNG", "a picture", kTrace},
    Refused{"\xff\xd8\xff", "a picture", kTrace},
    Refused{"\xff\xfe\xff\x0eS", "a SketchUp model", "export it as GLB or OBJ"},
    Refused{"Kaydara FBX", "an FBX model", "export it as GLB"},
    Refused{"BLENDER", "a file of Blender", "export it as GLB"},
    Refused{"#usda", "a USD scene", "export it as GLB or OBJ, of RoomPlan as JSON"},
    Refused{"PXR-USDC", "a USD scene", "export it as GLB or OBJ, of RoomPlan as JSON"},
    Refused{"PK\x03\x04",
            "an archive (USDZ, SKP or ZIP)",
            "export the scan as GLB, OBJ or JSON, or unpack it"},
    Refused{"\x1f\x8b", "compressed", "unpack it with gunzip"},
    Refused{"solid ", "an STL model, which has neither names nor units", "export it as OBJ or GLB"},
    Refused{"<?xml", "XML, but no SVG", "a scene of Mitsuba needs no import: name it in site.toml"},
};

bool has_line(std::string_view head, std::string_view begin) {
  return head.starts_with(begin) || head.find("\n" + std::string(begin)) != std::string_view::npos;
}

}  // namespace

const char* const kFormats = "DXF, SVG, OBJ, GLB, glTF, PLY, IFC 2x3, JSON of RoomPlan";

Expected<ModelFormat> recognise(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) {
    return bad_input(file.string() + ": " + what);
  };
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) {
    return refuse(error.message());
  }
  if (size > kLargestImport) {
    return refuse("has " + std::to_string(size >> 20U) + " MiB, more than the " +
                  std::to_string(kLargestImport >> 20U) +
                  " MiB that are read; export one storey, or a scan of "
                  "fewer triangles");
  }
  std::string head(kHeadBytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  if (head.empty()) {
    return refuse("is empty, or cannot be read");
  }
  // IFC is a kind of STEP: its header contains the schema.
  if (head.starts_with("ISO-10303-21") && head.find("FILE_SCHEMA") != std::string::npos &&
      head.find("IFC") != std::string::npos) {
    return ModelFormat::kIfc;
  }
  // After a declaration and comments; a scene of Mitsuba begins with <scene>.
  if (head.find("<svg") != std::string::npos && head.find("<scene") == std::string::npos) {
    return ModelFormat::kSvg;
  }
  for (const Refused& one : kRefused) {
    if (head.starts_with(one.begins)) {
      return refuse("is " + std::string(one.what) + "; " + std::string(one.advice));
    }
  }
  if (head.starts_with("glTF")) {
    return ModelFormat::kGlb;
  }
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) {
    return ModelFormat::kPly;
  }
  const std::size_t text = head.find_first_not_of(" \t\r\n");
  if (text != std::string::npos && head[text] == '{') {
    // A room scan has no fixed beginning: its reader rejects other files.
    return head.find("\"asset\"") != std::string::npos || file.extension() == ".gltf"
               ? ModelFormat::kGltf
               : ModelFormat::kRoomScan;
  }
  // Pairs of lines, the first of which begin a section; a comment (999) may precede them.
  if (const std::size_t section = head.find("SECTION"); section != std::string::npos) {
    const std::size_t zero =
        head.find_last_not_of(" \t\r\n", section - std::min<std::size_t>(section, 1));
    if (zero != std::string::npos && zero < section && head[zero] == '0') {
      return ModelFormat::kDxf;
    }
  }
  if (has_line(head, "v ") || has_line(head, "mtllib ") || has_line(head, "o ")) {
    return ModelFormat::kObj;
  }
  return refuse("is of no format that can be imported; there are: " + std::string(kFormats));
}

const char* name_of(ModelFormat format) {
  switch (format) {
    case ModelFormat::kObj:
      return "OBJ";
    case ModelFormat::kGlb:
      return "GLB";
    case ModelFormat::kGltf:
      return "glTF";
    case ModelFormat::kPly:
      return "PLY";
    case ModelFormat::kIfc:
      return "IFC";
    case ModelFormat::kRoomScan:
      return "JSON of RoomPlan";
    case ModelFormat::kSvg:
      return "SVG";
    case ModelFormat::kDxf:
      break;
  }
  return "DXF";
}

}  // namespace rayloc
