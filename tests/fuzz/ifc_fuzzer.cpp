// The check of IFC files: any bytes are refused with the file's name, or give a text that passes
// the same check again, and elements that can be read.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "daemon/site/import/ifc/ifc_check.h"
#include "daemon/site/import/ifc/ifc_materials.h"
#include "daemon/site/import/ifc/ifc_units.h"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = "/nonexistent/room.ifc";
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto step = rayloc::StepText::parse(bytes, file);
  if (!step) {
    require(step.error().message.rfind(file + ":", 0) == 0);
    return 0;
  }
  if (const auto checked = rayloc::check_ifc(*step, file); !checked) {
    require(checked.error().message.rfind(file + ":", 0) == 0);
    return 0;
  }
  const double metres = rayloc::ifc_metres(*step);
  require(std::isfinite(metres) && metres > 0.0);
  const auto elements = rayloc::ifc_elements(*step);
  const auto again = rayloc::StepText::parse(rayloc::plain_ifc(*step), file);
  require(again.has_value());
  require(rayloc::check_ifc(*again, file).has_value());
  require(again->entities().size() <= step->entities().size());
  return 0;
}
