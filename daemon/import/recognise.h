// Which format a file is of, by its first bytes and not by its name.
#pragma once

#include <cstdint>
#include <filesystem>

#include "engine/base/expected.h"

namespace rayloc {

// [bytes], chosen: a scan of a floor. Larger ones would not fit into the memory of a small machine,
// whether they are uploaded or lie on its disk.
inline constexpr std::uintmax_t kLargestImport = std::uintmax_t{256} << 20U;

// The formats for people: "DXF, SVG, OBJ, ...".
extern const char* const kFormats;

enum class ModelFormat { kObj, kGlb, kGltf, kPly, kIfc, kDxf, kSvg, kRoomScan };

// An Error for what cannot be imported, with what to do: another format to export, or that the file
// is empty, too large, or of no format that is known.
Expected<ModelFormat> recognise(const std::filesystem::path& file);

// "GLB (glTF, binary)"
const char* name_of(ModelFormat format);

}  // namespace rayloc
