// Measures the time that links of a scene file take in C++, for tests/bench/python_ratio.
//   link_bench SCENE COUNT tree|reuse TX RX
// reuse: one receiver's tree for all links; tree: a tree for each link. TX and RX are X,Y,Z [m].
// The transmitter moves by 1 mm along x from link to link. Prints CPU seconds per link.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <optional>
#include <string_view>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"

namespace {

constexpr double kCarrier = 5.18e9;  // [Hz]

std::optional<rayloc::Vec3d> parse_position(const char* text) {
  rayloc::Vec3d position;
  if (std::sscanf(text, "%lf,%lf,%lf", &position.x, &position.y, &position.z) != 3) {
    return std::nullopt;
  }
  return position;
}

rayloc::Transmitter transmitter(rayloc::Vec3d position, int i) {
  rayloc::Transmitter device;
  position.x -= 0.001 * static_cast<double>(i % 1000);
  device.position = position;
  return device;
}

}  // namespace

int main(int argc, char** argv) {
  const auto tx = argc == 6 ? parse_position(argv[4]) : std::nullopt;
  const auto rx = argc == 6 ? parse_position(argv[5]) : std::nullopt;
  if (!tx || !rx) {
    std::fprintf(stderr, "link_bench SCENE COUNT tree|reuse X,Y,Z X,Y,Z\n");
    return 64;
  }
  const bool reuse = std::string_view(argv[3]) == "reuse";
  auto scene = rayloc::load_scene(argv[1], {kCarrier, {}});
  if (!scene) {
    std::fprintf(stderr, "%s\n", scene.error().message.c_str());
    return 65;
  }
  const int count = std::max(1, std::atoi(argv[2]));
  const rayloc::PathTracer tracer(std::make_shared<const rayloc::Scene>(*std::move(scene)));
  rayloc::Receiver receiver;
  receiver.position = *rx;
  const rayloc::ReceiverTracer at_receiver = tracer.at(receiver);
  double sum = 0.0;  // so that nothing is left out
  const std::clock_t begin = std::clock();
  for (int i = 0; i < count; ++i) {
    const rayloc::Paths paths = reuse ? at_receiver.trace(transmitter(*tx, i))
                                      : tracer.trace(transmitter(*tx, i), receiver);
    sum += paths[0].a.re;
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%.9g\n", seconds / count);
  return sum == 0.0 ? 70 : 0;
}
