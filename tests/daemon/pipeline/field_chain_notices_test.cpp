// Tests the notices on receive chains: dead ones, and those restored from a file.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/chain_presence.h"
#include "daemon/methods/localizer_capabilities.h"
#include "daemon/pipeline/device/chain_file.h"
#include "daemon/pipeline/device/chain_keeper.h"
#include "daemon/pipeline/watch/dead_chains.h"
#include "engine/localize/localizer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::field_chain_notices_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const RoomModel& room() {
  static const RoomModel kRoom = test::make_room();
  return kRoom;
}

// Frames of the first access point, without its second core, as its receiver emits them.
std::vector<CsiFrame> frames(bool lacks_rx_chain, bool lasts) {
  const auto& rx_chains = room().access_points[0].rx_chains;
  std::vector<CsiFrame> all(3);
  for (CsiFrame& frame : all) {
    frame.rx_chains =
        lacks_rx_chain ? std::vector<std::uint8_t>{rx_chains[0], rx_chains[2]} : rx_chains;
    frame.csi = Csi(frame.rx_chains.size(), 1, 16);
    for (std::size_t m = 0; m < frame.rx_chains.size(); ++m) {
      for (std::size_t k = 0; k < 16; ++k) {
        frame.csi.row(m, 0)[k] = static_cast<float>(k + 1);
      }
    }
    if (lasts) {
      frame.flags.push_back(ChainPresence::kFlag);
    }
  }
  return all;
}

TEST(Field, DeadChainIsNamedUntilItComesBack) {
  DeadChains dead;
  dead.observe(frames(true, false), room());
  EXPECT_TRUE(dead.warnings(room()).empty()) << "datagrams may have been lost";
  EXPECT_TRUE(dead.observe(frames(true, true), room()));
  ASSERT_EQ(dead.warnings(room()).size(), 1U);
  const CalibrationWarning warning = dead.warnings(room()).front();
  const RoomAccessPoint& ap = room().access_points[0];
  EXPECT_EQ(warning.problem, CalibrationProblem::kDeadChain);
  EXPECT_EQ(warning.rx_chain, ap.rx_chains[1]);
  EXPECT_THAT(warning.text,
              AllOf(HasSubstr("access point " + ap.id),
                    HasSubstr("core " + std::to_string(ap.rx_chains[1])),
                    HasSubstr("pigtail")));
  EXPECT_FALSE(dead.observe(frames(true, true), room())) << "nothing new";
  EXPECT_TRUE(dead.observe(frames(false, false), room()));
  EXPECT_TRUE(dead.warnings(room()).empty());
}

std::string notices_of(ChainKnowledge knowledge) {
  LocalizerChains chains(std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(room()), {})));
  ChainState state;
  state.knowledge = knowledge;
  state.factors = ChainFactors::unity(room().access_points[0].rx_chains.size());
  state.bursts = 12;
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("chain_notices_" + std::to_string(::getpid()) + ".json");
  EXPECT_TRUE(write_chain_file(file, {state}, room()));
  ChainKeeper keeper({file, ""});
  keeper.restore({&chains}, room());
  std::filesystem::remove(file);
  std::string all;
  for (const std::string& line : keeper.notices()) {
    all += line + "\n";
  }
  return all;
}

TEST(Field, ChainsUnknownToTheFileAreReportedAsLearning) {
  EXPECT_THAT(notices_of(ChainKnowledge::kLearning),
              AllOf(HasSubstr("learning the chains of " + room().access_points[0].id),
                    HasSubstr("0 of at least"),
                    Not(HasSubstr("degrees"))));
  EXPECT_THAT(notices_of(ChainKnowledge::kLearned),
              AllOf(HasSubstr("as learned before"), HasSubstr("degrees")));
}

}  // namespace
}  // namespace rayloc::field_chain_notices_test
