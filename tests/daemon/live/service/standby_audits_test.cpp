#include "daemon/live/service/site/standby_audits.h"

#include <string>

#include <gtest/gtest.h>

namespace rayloc::standby_audits_test {
namespace {

OutStage::Standby standby(std::uint64_t windows, std::uint64_t differing) {
  OutStage::Standby made;
  made.counters.windows = windows;
  made.counters.differing = differing;
  return made;
}

// Value of a site in one of the metrics; -1: absent.
double value(const StandbyAudits& audits, const std::string& metric, const std::string& site) {
  for (const ExtraMetric& one : audits.metrics()) {
    for (const ExtraMetric::Sample& sample : one.samples) {
      if (one.name == metric && sample.label_value == site) {
        return sample.value;
      }
    }
  }
  return -1.0;
}

constexpr const char* kWindows = "rayloc_cluster_standby_windows_total";
constexpr const char* kDivergence = "rayloc_cluster_divergence_total";

TEST(StandbyAudits, CountOverAllRuntimesOfASite) {
  StandbyAudits audits;
  audits.add("hall");
  EXPECT_EQ(value(audits, kWindows, "hall"), 0.0);
  audits.note("hall", standby(4, 1));
  audits.note("hall", standby(6, 1));
  EXPECT_EQ(value(audits, kWindows, "hall"), 6.0);
  audits.end("hall");
  audits.add("hall");
  audits.note("hall", standby(2, 1));
  EXPECT_EQ(value(audits, kWindows, "hall"), 8.0);
  EXPECT_EQ(value(audits, kDivergence, "hall"), 2.0);
}

TEST(StandbyAudits, ForgetASiteThatIsNoLongerConfigured) {
  StandbyAudits audits;
  audits.note("hall", standby(4, 0));
  audits.note("attic", standby(1, 0));
  audits.remove("hall");
  EXPECT_EQ(value(audits, kWindows, "hall"), -1.0);
  EXPECT_EQ(value(audits, kWindows, "attic"), 1.0);
}

}  // namespace
}  // namespace rayloc::standby_audits_test
