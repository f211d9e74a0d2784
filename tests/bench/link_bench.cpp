// The time that links of a scene file take in C++: the yardstick of tests/bench/python_ratio.
//   link_bench SCENE COUNT [REUSE]     REUSE: one receiver's tree for all, else a tree a link
// Prints seconds of CPU a link.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"

namespace {

constexpr double kCarrier = 5.18e9;  // [Hz]

rayloc::Transmitter transmitter(int i) {
  rayloc::Transmitter device;
  device.position = {0.4 - 0.001 * static_cast<double>(i % 1000), 0.1, 1.2};
  return device;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "link_bench SCENE COUNT [REUSE]\n");
    return 64;
  }
  auto scene = rayloc::load_scene(argv[1], {kCarrier, {}});
  if (!scene) {
    std::fprintf(stderr, "%s\n", scene.error().message.c_str());
    return 65;
  }
  const int count = std::max(1, std::atoi(argv[2]));
  const rayloc::PathTracer tracer(std::make_shared<const rayloc::Scene>(*std::move(scene)));
  rayloc::Receiver receiver;
  receiver.position = {-1.45, 1.13, 2.25};
  const rayloc::ReceiverTracer at_receiver = tracer.at(receiver);
  double sum = 0.0;  // so that nothing is left out
  const std::clock_t begin = std::clock();
  for (int i = 0; i < count; ++i) {
    const rayloc::Paths paths =
        argc > 3 ? at_receiver.trace(transmitter(i)) : tracer.trace(transmitter(i), receiver);
    sum += paths[0].a.re;
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%.9g\n", seconds / count);
  return sum == 0.0 ? 70 : 0;
}
