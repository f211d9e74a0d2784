#include "daemon/site/import/recognise.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace rayloc {

const char* const kFormats = "DXF, SVG, OBJ, GLB, glTF, PLY, IFC (2x3, 4), JSON of RoomPlan";

namespace {

constexpr std::size_t kHeadBytes = 4096;

struct Refused {
  std::string_view mark;
  std::string_view what;
  std::string_view advice;
};

constexpr std::string_view kTrace =
    "lay it under a drawing in rayloc studio (as PNG, JPEG or PDF), or draw its walls over it in "
    "Inkscape and save that as SVG";
constexpr std::string_view kMakeMesh =
    "make a mesh of it (in CloudCompare or MeshLab), and export that as PLY or OBJ";
constexpr std::string_view kExportModel = "export it as GLB or OBJ";
constexpr std::string_view kExportScan = "export it as GLB or OBJ, of RoomPlan as JSON";
constexpr std::string_view kExportPlan = "export its plan as SVG or DXF";

constexpr std::array kRefused = {
    Refused{"AC10", "a DWG drawing", "export its plan as DXF or SVG, or it as GLB, OBJ or IFC"},
    Refused{
        "ISO-10303-21", "a STEP model", "export it as GLB, OBJ or IFC, or its plan as DXF or SVG"},
    Refused{"AutoCAD Binary DXF", "a DXF in binary", "export it as DXF of text (ASCII)"},
    Refused{"%PDF",
            "a PDF",
            "open it in Inkscape and save its plan as SVG, or lay a page of it under a drawing in "
            "rayloc studio"},
    Refused{"%!PS", "PostScript", "open it in Inkscape and save its plan as SVG"},
    Refused{"\x89PNG", "a picture", kTrace},
    Refused{"\xff\xd8\xff", "a picture", kTrace},
    Refused{"GIF8", "a picture", kTrace},
    Refused{"RIFF", "a picture (WebP)", kTrace},
    Refused{std::string_view("II*\0", 4), "a picture (TIFF)", kTrace},
    Refused{std::string_view("MM\0*", 4), "a picture (TIFF)", kTrace},
    Refused{"\xff\xfe\xff\x0eS", "a SketchUp model", kExportModel},
    Refused{"Kaydara FBX", "an FBX model", "export it as GLB"},
    Refused{"BLENDER", "a file of Blender", "export it as GLB"},
    Refused{"3D Geometry File Format", "a Rhino model", "export it as OBJ, or its plan as DXF"},
    Refused{"\xd0\xcf\x11\xe0",
            "a document of Revit, 3ds Max, Visio or Office",
            "export it as IFC or OBJ, or its plan as DXF or SVG"},
    Refused{"#usda", "a USD scene", kExportScan},
    Refused{"PXR-USDC", "a USD scene", kExportScan},
    Refused{"ASTM-E57", "a cloud of points (E57)", kMakeMesh},
    Refused{"LASF", "a cloud of points (LAS)", kMakeMesh},
    Refused{"# .PCD", "a cloud of points (PCD)", kMakeMesh},
    Refused{"\x1f\x8b", "compressed", "unpack it with gunzip"},
    Refused{"version https://git-lfs", "a pointer of Git LFS", "fetch the file: git lfs pull"},
    Refused{"solid ", "an STL model, which has neither names nor units", "export it as OBJ or GLB"},
};

// By an element or a line near the begin.
constexpr std::array kRefusedTexts = {
    Refused{"<COLLADA", "a COLLADA model", kExportModel},
    Refused{"<ifcXML", "IFC as XML", "export it as IFC of text (.ifc)"},
    Refused{"<mxfile", "a drawing of draw.io", "export it as SVG"},
    Refused{"<?xml", "XML, but no SVG", "a scene of Mitsuba needs no import: name it in site.toml"},
    Refused{"\noutline = [", "a plan of rooms", "make a scene of it with rayloc scene room"},
    Refused{"\nsize = [", "a plan of a room", "make a scene of it with rayloc scene room"},
};

// By the end of the name of the first file within; the last one is any archive.
constexpr std::array kArchives = {
    Refused{".usdc", "a USDZ scan", kExportScan},
    Refused{".usda", "a USDZ scan", kExportScan},
    Refused{"Home", "a home of Sweet Home 3D", "export it as OBJ (3D view), or its plan as SVG"},
    Refused{
        "Home.xml", "a home of Sweet Home 3D", "export it as OBJ (3D view), or its plan as SVG"},
    Refused{"Document.xml", "a document of FreeCAD", "export its plan as DXF, or it as OBJ"},
    Refused{"mimetype", "an OpenDocument drawing", kExportPlan},
    Refused{"[Content_Types].xml", "a document of Office or Visio, or a 3MF model", kExportPlan},
    Refused{"", "an archive (ZIP)", "unpack it, and import the drawing or scan in it"},
};

constexpr std::string_view kZip = "PK\x03\x04";
constexpr std::size_t kZipNameLength = 26;  // [bytes], of its header: two bytes, the lower first
constexpr std::size_t kZipName = 30;        // [bytes]
constexpr std::size_t kStlCount = 80;       // [bytes], of a binary STL: triangles, four bytes
constexpr std::size_t kStlHeader = 84;      // [bytes]
constexpr std::size_t kStlTriangle = 50;    // [bytes]

// Little-endian; 0 beyond the end.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = size; at + size <= bytes.size() && i-- > 0;) {
    number = (number << 8U) | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

Refused archive_of(std::string_view head) {
  const std::size_t length = number_at(head, kZipNameLength, 2);
  const std::string_view name = head.size() > kZipName ? head.substr(kZipName, length) : "";
  return *std::find_if(kArchives.begin(), kArchives.end(), [&](const Refused& one) {
    return name.ends_with(one.mark);
  });
}

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return small;
}

// A format that is recognised by its first bytes and not read; `size` is that of the file.
std::optional<Refused> refused_by_bytes(std::string_view head, std::uintmax_t size) {
  if (head.starts_with(kZip)) {
    return archive_of(head);
  }
  for (const Refused& one : kRefused) {
    if (head.starts_with(one.mark)) {
      return one;
    }
  }
  if (head.substr(0, 8).ends_with("ftyp")) {
    return Refused{"", "a picture or film of a phone", kTrace};
  }
  if (head.size() >= kStlHeader &&
      size == kStlHeader + kStlTriangle * number_at(head, kStlCount, 4)) {
    return Refused{"", "an STL model, which has neither names nor units", kExportModel};
  }
  return std::nullopt;
}

std::optional<Refused> refused_by_text(std::string_view head) {
  const std::string lines = "\n" + in_small_letters(head);
  for (const Refused& one : kRefusedTexts) {
    if (lines.find(in_small_letters(one.mark)) != std::string::npos) {
      return one;
    }
  }
  return std::nullopt;
}

// Its pictures may be SVG.
bool is_web_page(std::string_view head) {
  const std::string small = in_small_letters(head);
  const std::size_t begin = std::min(small.find_first_not_of(" \t\r\n"), small.size());
  return small.compare(begin, 14, "<!doctype html") == 0 || small.compare(begin, 5, "<html") == 0;
}

bool has_line(std::string_view head, std::string_view begin) {
  return head.starts_with(begin) || head.find("\n" + std::string(begin)) != std::string_view::npos;
}

// Pairs of lines, the first of which begin a section; a comment (999) may precede them.
bool is_dxf(std::string_view head) {
  const std::size_t section = head.find("SECTION");
  if (section == std::string_view::npos) {
    return false;
  }
  const std::size_t zero =
      head.find_last_not_of(" \t\r\n", section - std::min<std::size_t>(section, 1));
  return zero != std::string_view::npos && zero < section && head[zero] == '0';
}

// The format of a file of at most kHeadBytes that are its begin; an Error without its name.
Expected<ModelFormat> format_of(const std::string& head, std::uintmax_t size, bool is_gltf) {
  const auto refuse = [](const Refused& one) {
    return bad_input("is " + std::string(one.what) + "; " + std::string(one.advice));
  };
  // IFC is a kind of STEP: its header contains the schema.
  if (head.starts_with("ISO-10303-21") && head.find("FILE_SCHEMA") != std::string::npos &&
      head.find("IFC") != std::string::npos) {
    return ModelFormat::kIfc;
  }
  if (is_web_page(head)) {
    return refuse({"", "a web page and no drawing", "download the file itself"});
  }
  // After a declaration and comments; a scene of Mitsuba begins with <scene>.
  if (head.find("<svg") != std::string::npos && head.find("<scene") == std::string::npos) {
    return ModelFormat::kSvg;
  }
  if (const auto refused = refused_by_bytes(head, size)) {
    return refuse(*refused);
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
    return head.find("\"asset\"") != std::string::npos || is_gltf ? ModelFormat::kGltf
                                                                  : ModelFormat::kRoomScan;
  }
  if (is_dxf(head)) {
    return ModelFormat::kDxf;
  }
  if (has_line(head, "v ") || has_line(head, "mtllib ") || has_line(head, "o ")) {
    return ModelFormat::kObj;
  }
  if (const auto refused = refused_by_text(head)) {
    return refuse(*refused);
  }
  return bad_input("is of no format that can be imported; there are: " + std::string(kFormats));
}

}  // namespace

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
  const auto format = format_of(head, size, file.extension() == ".gltf");
  return format ? format : refuse(format.error().message);
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
