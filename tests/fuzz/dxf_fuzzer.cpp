// The reader of DXF drawings: any bytes are refused with the file's name, or give a bounded number
// of lines with finite points and with names that are UTF-8.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/site/import/dxf/dxf_reader.h"
#include "daemon/site/import/utf8_text.h"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// A file without a name on disk, which the reader opens by its descriptor.
std::string file_of(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("plan.dxf", MFD_CLOEXEC);
  require(file >= 0 && ftruncate(file, 0) == 0);
  require(pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = file_of(data, size);
  const auto drawing = rayloc::read_dxf(file);
  if (!drawing) {
    require(drawing.error().message.rfind(file + ":", 0) == 0);
    return 0;
  }
  require(std::isfinite(drawing->metres) && drawing->metres >= 0.0);
  require(!drawing->lines.empty());
  std::size_t points = 0;
  for (const rayloc::DrawnLine& line : drawing->lines) {
    require(rayloc::is_utf8(line.layer));
    require(line.points.size() >= 2);
    points += line.points.size();
    for (const rayloc::FloorPoint& point : line.points) {
      require(std::isfinite(point[0]) && std::isfinite(point[1]));
    }
  }
  require(points <= rayloc::kMaxDrawnPoints);
  for (const auto* names : {&drawing->empty_layers, &drawing->hidden_layers}) {
    for (const std::string& name : *names) {
      require(rayloc::is_utf8(name));
    }
  }
  for (const std::string& remark : drawing->remarks) {
    require(rayloc::is_utf8(remark));
  }
  return 0;
}
