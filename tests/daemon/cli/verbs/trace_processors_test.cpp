// The same paths on every kind of processor: GLIBC_TUNABLES hides AVX, AVX2, AVX-512 and fused
// multiply-add from the C library (the kernel over tones: tests/engine/trace/cfr_kernel_test.cpp).
#include <complex>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::trace_processors_test {
namespace {

using nlohmann::json;

json paths_of(const char* processor) {
  if (processor == nullptr) {
    ::unsetenv("GLIBC_TUNABLES");
  } else {
    ::setenv("GLIBC_TUNABLES", processor, 1);
  }
  const Finished finished = RaylocProcess({"trace",
                                           test::data_path("/sites/meeting_room"),
                                           "--tx",
                                           "0.412,1.037,1.519",
                                           "--rx=-1.45,1.13,2.25",
                                           "--json"})
                                .wait();
  ::unsetenv("GLIBC_TUNABLES");
  EXPECT_EQ(finished.status, 0) << finished.err;
  return json::parse(finished.out).at("paths");
}

TEST(TraceVerb, GivesTheSamePathsWithoutWideVectors) {
  const json wide = paths_of(nullptr);
  const json baseline = paths_of("glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA,-FMA4");
  ASSERT_GT(wide.size(), 50U);
  ASSERT_EQ(baseline.size(), wide.size());
  for (std::size_t i = 0; i < wide.size(); ++i) {
    for (const char* key : {"kinds", "objects", "vertices", "tau"}) {
      EXPECT_EQ(baseline[i].at(key), wide[i].at(key));
    }
    const auto a = [&](const json& path) {
      return std::complex<double>(path.at("a").at(0), path.at("a").at(1));
    };
    EXPECT_LE(std::abs(a(baseline[i]) - a(wide[i])), 1e-12 * std::abs(a(wide[i])));
  }
}

}  // namespace
}  // namespace rayloc::trace_processors_test
