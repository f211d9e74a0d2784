// The same paths from shot rays whichever instructions Embree traces them with: its real kernels,
// each that this processor has.
//
// Embree chooses them when a device is made, by the processor or by the device's configuration. The
// engine configures nothing; the rtcNewDevice that it finds here does.
#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/trace/path_tracer.h"
#include "tests/support/laboratory.h"
#include "tests/support/office_floor.h"

namespace {

// The configuration of all devices made from now on.
const char*& configuration() {
  static const char* chosen = nullptr;
  return chosen;
}

int& devices_made() {
  static int count = 0;
  return count;
}

}  // namespace

RTCDevice rtcNewDevice(const char*) {
  using NewDevice = RTCDevice (*)(const char*);
  static const auto kEmbrees = reinterpret_cast<NewDevice>(::dlsym(RTLD_NEXT, "rtcNewDevice"));
  ++devices_made();
  return kEmbrees(configuration());
}

namespace rayloc::instruction_sets_test {
namespace {

// Numbers of rays that Embree traces at once with each: they identify a device's instruction set.
struct InstructionSet {
  const char* configuration;
  bool is_here;
  bool has_8;
  bool has_16;
};

std::vector<InstructionSet> instruction_sets() {
  const bool avx = __builtin_cpu_supports("avx") != 0;
  const bool avx2 = __builtin_cpu_supports("avx2") != 0;
  const bool avx512 =
      __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  return {{"isa=sse2", true, false, false},
          {"isa=sse4.2", __builtin_cpu_supports("sse4.2") != 0, false, false},
          {"isa=avx", avx, true, false},
          {"isa=avx2", avx2, true, false},
          {"isa=avx512", avx512, true, true}};
}

bool has(const RTCDevice& device, RTCDeviceProperty property) {
  return rtcGetDeviceProperty(device, property) != 0;
}

TEST(InstructionSets, AreThoseThatTheTestsAskFor) {
  for (const InstructionSet& set : instruction_sets()) {
    SCOPED_TRACE(set.configuration);
    if (set.is_here) {
      configuration() = set.configuration;
      const RTCDevice device = rtcNewDevice(nullptr);
      EXPECT_EQ(has(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED), set.has_8);
      EXPECT_EQ(has(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED), set.has_16);
      rtcReleaseDevice(device);
    }
  }
  configuration() = nullptr;
}

// The paths of every device, by rays; the scene is made with the instructions, too.
std::vector<Paths> paths_with(const char* instructions,
                              std::shared_ptr<const Scene> (*scene)(),
                              const Vec3d& access_point,
                              const std::vector<Vec3d>& devices) {
  configuration() = instructions;
  devices_made() = 0;
  const PathTracer tracer(scene(), {.candidates = CandidateGenerator::kShooting});
  const ReceiverTracer receiver = tracer.at(Receiver{{access_point, {}}});
  std::vector<Paths> paths;
  paths.reserve(devices.size());
  for (const Vec3d& device : devices) {
    paths.push_back(receiver.trace(Transmitter{{device, {}}}));
  }
  EXPECT_EQ(devices_made(), 2);  // for the rays and for what blocks a path
  configuration() = nullptr;
  return paths;
}

void expect_same(const Paths& found, const Paths& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].tau, expected[i].tau);
    EXPECT_EQ(found[i].a.re, expected[i].a.re);
    EXPECT_EQ(found[i].a.im, expected[i].a.im);
    ASSERT_EQ(found[i].interactions.size(), expected[i].interactions.size());
    for (std::size_t k = 0; k < found[i].interactions.size(); ++k) {
      EXPECT_EQ(found[i].interactions[k].surface, expected[i].interactions[k].surface);
      EXPECT_EQ(found[i].interactions[k].position, expected[i].interactions[k].position);
    }
  }
}

void expect_same_paths(std::shared_ptr<const Scene> (*scene)(),
                       const Vec3d& access_point,
                       const std::vector<Vec3d>& devices) {
  const auto expected = paths_with(nullptr, scene, access_point, devices);
  std::size_t count = 0;
  for (const Paths& paths : expected) {
    count += paths.size();
  }
  EXPECT_GT(count, 30 * devices.size());
  for (const InstructionSet& set : instruction_sets()) {
    if (set.is_here) {
      const auto found = paths_with(set.configuration, scene, access_point, devices);
      for (std::size_t i = 0; i < devices.size(); ++i) {
        SCOPED_TRACE(std::string(set.configuration) + ", device " + std::to_string(i));
        expect_same(found[i], expected[i]);
      }
    }
  }
}

TEST(InstructionSets, GiveTheSamePathsInTheLaboratory) {
  expect_same_paths(test::laboratory,
                    test::laboratory_access_point().pose.position,
                    test::laboratory_positions(143));
}

TEST(InstructionSets, GiveTheSamePathsInAnOffice) {
  expect_same_paths([] { return test::office_floor(20'000); },
                    test::office_access_point(),
                    {test::office_device(), {2.9, 2.4, 1.0}, {0.5, 4.4, 1.6}, {3.0, 1.1, 0.8}});
}

// Where a ray within matter meets two faces that touch, one of either object, Embree's kernels
// differ in which they give.
TEST(InstructionSets, GiveTheSamePathsWithinAPartition) {
  expect_same_paths([] { return test::office_floor(2'000); },
                    {4.059, 4.041, 2.233},
                    {{4.063, 4.238, 1.218}, {4.065, 4.7, 2.441}, {4.063, 0.357, 2.689}});
}

}  // namespace
}  // namespace rayloc::instruction_sets_test
