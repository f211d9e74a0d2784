// Scene loading: any bytes are refused with a message or give a scene whose paths are finite.
//
// The input is the XML of a scene; what follows a line "%%" is the content of every PLY or OBJ file
// that the XML names.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"

namespace {

constexpr std::string_view kSeparator = "\n%%\n";
// Images grow with the square of the surfaces; time is better spent on other inputs.
constexpr std::size_t kMaxSurfaces = 64;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void trace(rayloc::Scene scene) {
  const auto shared = std::make_shared<const rayloc::Scene>(std::move(scene));
  const rayloc::Vec3d lower = shared->bounds_min();
  const rayloc::Vec3d upper = shared->bounds_max();
  const rayloc::PathTracer tracer(shared, {.max_depth = 2});
  const rayloc::Receiver receiver{{0.3 * lower + 0.7 * upper, {0.1, 0.2, 0.3}}};
  const rayloc::Transmitter transmitter{{0.6 * lower + 0.4 * upper, {}}};
  for (const rayloc::Path& path : tracer.trace(transmitter, receiver)) {
    require(std::isfinite(path.a.re) && std::isfinite(path.a.im));
    require(std::isfinite(path.tau) && path.tau > 0.0);
    require(std::isfinite(path.theta_t()) && std::isfinite(path.phi_r()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(data, data + size);
  const std::size_t split = input.find(kSeparator);
  const std::string mesh =
      split == std::string::npos ? std::string() : input.substr(split + kSeparator.size());
  const auto read_mesh = [&](const std::string& name) -> rayloc::Expected<std::string> {
    if (!name.ends_with(".ply") && !name.ends_with(".obj")) {
      return rayloc::bad_input(name + " is not there");
    }
    return mesh;
  };
  rayloc::SceneOptions options;
  options.carrier_hz = 5.19e9;
  auto scene = rayloc::parse_scene(input.substr(0, split), "scene.xml", options, read_mesh);
  if (!scene) {
    require(!scene.error().message.empty());
  } else if (scene->surfaces().size() <= kMaxSurfaces) {
    trace(std::move(*scene));
  }
  return 0;
}
