#include "daemon/lab/draw/picture_bytes.h"

#include "daemon/lab/draw/png.h"
#include "daemon/lab/draw/svg.h"

namespace rayloc::draw {
namespace {

constexpr double kPngScale = 2.0;  // image pixels per drawing pixel

}  // namespace

Expected<std::string> picture_bytes(const Drawing& drawing, const std::string& file) {
  if (file.ends_with(".svg")) {
    return to_svg(drawing);
  }
  if (file.ends_with(".png")) {
    return to_png(drawing, kPngScale);
  }
  return make_error(ErrorKind::kUsage,
                    file + ": pictures are .svg or .png; choose one by the ending");
}

}  // namespace rayloc::draw
