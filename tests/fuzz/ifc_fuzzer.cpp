// The check of IFC files and the conversion of IFC 4: any bytes are refused with the file's name,
// or give a text that passes the same check again, and elements that can be read.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/site/import/ifc/ifc4.h"
#include "daemon/site/import/ifc/ifc_check.h"
#include "daemon/site/import/ifc/ifc_materials.h"
#include "daemon/site/import/ifc/ifc_units.h"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// As read_model.cpp checks a file.
rayloc::Expected<rayloc::StepText> checked(rayloc::StepText step, const std::string& file) {
  if (rayloc::is_ifc4(step)) {
    auto made = rayloc::ifc4_as_2x3(step, file);
    RAYLOC_TRY(made);
    step = std::move(made->step);
  }
  RAYLOC_TRY(rayloc::check_ifc(step, file));
  return step;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = "/nonexistent/room.ifc";
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  auto step = rayloc::StepText::parse(bytes, file);
  if (!step) {
    require(step.error().message.rfind(file + ":", 0) == 0);
    return 0;
  }
  const auto elements = rayloc::ifc_elements(*step);
  const auto text = checked(*std::move(step), file);
  if (!text) {
    require(text.error().message.rfind(file + ":", 0) == 0);
    return 0;
  }
  const double metres = rayloc::ifc_metres(*text);
  require(std::isfinite(metres) && metres > 0.0);
  const auto again = rayloc::StepText::parse(rayloc::plain_ifc(*text), file);
  require(again.has_value());
  require(rayloc::check_ifc(*again, file).has_value());
  require(again->entities().size() <= text->entities().size());
  return 0;
}
