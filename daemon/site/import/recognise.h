// Recognises the format of a file by its first bytes, not by its name.
#pragma once

#include <cstdint>
#include <filesystem>

#include "engine/base/expected.h"

namespace rayloc {

// [bytes], chosen: a scan of a floor. Larger files would not fit into the memory of a small
// machine, uploaded or on its disk.
inline constexpr std::uintmax_t kLargestImport = std::uintmax_t{256} << 20U;

// The formats for people: "DXF, SVG, OBJ, ...".
extern const char* const kFormats;

enum class ModelFormat { kObj, kGlb, kGltf, kPly, kIfc, kDxf, kSvg, kRoomScan };

// Returns an Error with a remedy for a file that cannot be imported: another format to export, or
// that the file is empty, too large, or of an unknown format.
Expected<ModelFormat> recognise(const std::filesystem::path& file);

// "GLB (glTF, binary)"
const char* name_of(ModelFormat format);

}  // namespace rayloc
