// Tests the file of learned chains: a program that ends while it learns chains, and the next one.
#include "daemon/pipeline/device/chain_file.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/methods/localizer_capabilities.h"
#include "daemon/pipeline/device/chain_keeper.h"
#include "engine/chains/chain_record.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::chain_file_test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

// Chains are unknown from the first burst on.
std::shared_ptr<const Localizer> localizer() {
  static const std::shared_ptr<const Localizer> kLocalizer = [] {
    RoomModel room = test::make_room();
    room.access_points.resize(2);
    room.calibration_id = "of_today";
    for (RoomAccessPoint& ap : room.access_points) {
      ap.are_chains_known = false;
      ap.error.plan_tolerance = 0.001;
      ap.error.diffuse = 0.005;
    }
    auto made = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
    return std::make_shared<const Localizer>(*std::move(made));
  }();
  return kLocalizer;
}

// A device somewhere else every two seconds, with rotated chains.
std::vector<CsiFrame> burst(int number) {
  std::mt19937 random(static_cast<unsigned>(number + 1));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = 1.2 * uniform(random);
  const RoomModel& room = localizer()->room();
  auto frames = test::frames_at(
      room, {x, 0.9 * uniform(random), 1.2}, {4, 30.0, static_cast<unsigned>(number + 1)});
  for (CsiFrame& frame : frames) {
    frame.time += std::chrono::seconds(2 * number);
  }
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    test::turn_chain(frames, a, room.access_points[a].rx_chains[1], 2.1);
  }
  return frames;
}

class ChainFile : public ::testing::Test {
 protected:
  ~ChainFile() override { std::filesystem::remove(file_); }

  // Programs with one device model that read and write the file.
  struct Program {
    explicit Program(const std::string& file) : keeper({file, file}), chains(localizer()) {
      keeper.restore({&chains}, localizer()->room());
    }
    // Number of the burst with which the first access point is learned, from `begin` on.
    int learn(int begin, int end) {
      for (int i = begin; i < end; ++i) {
        chains.receive(burst(i));
        keeper.spread(chains, {&chains}, localizer()->room());
        if (!chains.accepted(burst(i)).empty()) {
          return i;
        }
      }
      return end;
    }
    ChainKeeper keeper;
    LocalizerChains chains;
  };

  Json stored() const {
    std::ifstream in(file_);
    return Json::parse(in);
  }
  // The message with which the file is refused after a change.
  std::string refused(const std::function<void(Json&)>& change) const {
    Json json = stored();
    change(json);
    const std::string changed = file_ + ".changed";
    std::ofstream(changed) << json;
    const auto states = read_chain_file(changed, localizer()->room());
    std::filesystem::remove(changed);
    return states ? "" : states.error().message;
  }

  const std::string file_ = std::filesystem::path(::testing::TempDir()) /
                            ("chain_file_" + std::to_string(::getpid()) + ".json");
};

TEST_F(ChainFile, ARestartWhileLearningCostsNoBurst) {
  constexpr int kEnd = 60;
  const int whole = Program(file_).learn(0, kEnd);
  ASSERT_LT(whole, kEnd);
  std::filesystem::remove(file_);
  // All bursts of the first program are evaluated before the next one compares states.
  const int half = std::min(whole / 2, static_cast<int>(kEvaluatedAtOnce));
  Program first(file_);
  ASSERT_EQ(first.learn(0, half), half);
  Program next(file_);
  const auto notices = next.keeper.notices();
  ASSERT_EQ(notices.size(), 2U);
  EXPECT_THAT(notices[0], HasSubstr("learning the chains of"));
  ASSERT_EQ(next.chains.states().size(), 2U);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_GT(next.chains.states()[a].bursts, 0U) << a;
    EXPECT_EQ(next.chains.states()[a].bursts, first.chains.states().at(a).bursts) << a;
  }
  EXPECT_EQ(next.learn(half, kEnd), whole);
}

TEST_F(ChainFile, ASuccessorOnTheSameMachineKeepsTheEvidence) {
  Program before(file_);
  before.learn(0, 8);
  Program next(file_);
  const std::size_t received = next.chains.record(0).value().received.size();
  next.keeper.go_on(before.chains.states(), {&next.chains});
  EXPECT_EQ(next.chains.record(0).value().received.size(), received);
}

// After a seek both device models continue from the file, as at its start.
TEST_F(ChainFile, ASeekKeepsTheEvidenceOfTheOtherDeviceModel) {
  const RoomModel& room = localizer()->room();
  ChainKeeper keeper({file_, file_});
  LocalizerChains a(localizer());
  LocalizerChains b(localizer());
  keeper.restore({&a, &b}, room);
  for (int i = 0; i < 8; ++i) {
    for (LocalizerChains* chains : {&a, &b}) {
      chains->receive(burst(i));
      keeper.spread(*chains, {&a, &b}, room);
    }
  }
  ChainKeeper next({file_, file_});
  LocalizerChains with_evidence(localizer());
  LocalizerChains other(localizer());
  const std::vector<ChainCapability*> both = {&with_evidence, &other};
  next.restore(both, room);
  ASSERT_TRUE(with_evidence.record(0));
  const std::size_t received = with_evidence.record(0)->received.size();
  with_evidence.restart();
  other.restart();
  next.restart();
  next.spread(other, both, room);
  ASSERT_TRUE(with_evidence.record(0));
  EXPECT_EQ(with_evidence.record(0)->received.size(), received);
  EXPECT_EQ(stored()["access_points"][0]["evidence"]["received"].size(), received);
}

TEST_F(ChainFile, WithoutEvidenceLearningStartsAnew) {
  Program(file_).learn(0, 8);
  Json json = stored();
  for (Json& one : json["access_points"]) {
    ASSERT_TRUE(one.contains("evidence"));
    one.erase("evidence");
  }
  std::ofstream(file_) << json;
  const Program next(file_);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(next.chains.states().at(a).bursts, 0U) << a;
    EXPECT_FALSE(next.chains.record(a)) << a;
  }
}

TEST_F(ChainFile, EvidenceForOtherDeviceModelsIsNotUsed) {
  Program(file_).learn(0, 8);
  Json json = stored();
  json["access_points"][0]["evidence"]["learners"] = 2;
  std::ofstream(file_) << json;
  const Program next(file_);
  EXPECT_FALSE(next.chains.record(0));
  EXPECT_TRUE(next.chains.record(1));
}

TEST_F(ChainFile, AFileOfAnotherCalibrationIsNotUsed) {
  Program(file_).learn(0, 8);
  RoomModel other = localizer()->room();
  other.calibration_id = "of_yesterday";
  EXPECT_TRUE(read_chain_file(file_, other).value().empty());
}

TEST_F(ChainFile, WrongEvidenceIsRefusedWithItsPlace) {
  Program(file_).learn(0, 8);
  EXPECT_EQ(refused([](Json&) {}), "");
  const auto evidence = [&](const std::string& key, const Json& value) {
    return refused([&](Json& json) { json["access_points"][1]["evidence"][key] = value; });
  };
  const std::string place = "access_points[1].evidence";
  EXPECT_THAT(evidence("belief", "AAAA"), HasSubstr(place + ".belief"));
  EXPECT_THAT(evidence("belief", stored()["access_points"][0]["id"]), HasSubstr(place));
  EXPECT_THAT(evidence("bursts", -1), HasSubstr(place + ".bursts"));
  for (const char* key : {"learner", "learners", "bursts", "bursts_needed", "unrefined"}) {
    EXPECT_THAT(evidence(key, 18446744073709551615U), HasSubstr(place + "." + key));
  }
  for (const double sigma : {-1.0, 1e300}) {
    EXPECT_THAT(evidence("phase_sigma_rad", sigma), HasSubstr(place + ".phase_sigma_rad"));
  }
  EXPECT_THAT(evidence("gain", Json::parse("[1.0]")), HasSubstr(place + ".gain"));
  EXPECT_THAT(evidence("favourite", Json::parse("[[1.0, 0.0]]")), HasSubstr(place + ".favourite"));
  EXPECT_THAT(evidence("lead", nullptr), HasSubstr(place));
  const auto burst_key = [&](const std::string& key, const Json& value) {
    return refused(
        [&](Json& json) { json["access_points"][1]["evidence"]["received"][0][key] = value; });
  };
  const std::string first = place + ".received[0]";
  EXPECT_THAT(burst_key("h", "AAAA"), HasSubstr(first + ".h"));
  EXPECT_THAT(burst_key("noise", -1.0), HasSubstr(first + ".noise"));
  for (const Json& time : {Json(9223372036854775807), Json(-9223372036854775807), Json(1e300)}) {
    EXPECT_THAT(burst_key("time_ns", time), HasSubstr(first + ".time_ns"));
  }
  EXPECT_THAT(burst_key("gain", Json::parse("[1.0, 0.0, 1.0]")), HasSubstr(first + ".gain"));
  EXPECT_THAT(burst_key("cells", 7), HasSubstr(first + ".weights"));
  EXPECT_THAT(refused([&](Json& json) {
                Json& h = json["access_points"][1]["evidence"]["received"][0]["h"];
                std::string text = h.get<std::string>();
                text[5] = '!';
                h = text;
              }),
              HasSubstr(first + ".h is not base64"));
}

TEST_F(ChainFile, NumbersOfAStateHaveLimits) {
  Program(file_).learn(0, 8);
  const auto state = [&](const std::string& key, const Json& value) {
    return [=](Json& json) { json["access_points"][1][key] = value; };
  };
  for (const Json& time : {Json(9223372036854775807), Json(-9223372036854775807), Json(1e300)}) {
    EXPECT_THAT(refused(state("since_ns", time)), HasSubstr("access_points[1].since_ns"));
  }
  EXPECT_THAT(refused(state("bursts", -1)), HasSubstr("access_points[1].bursts"));
  for (const char* key : {"phase_sigma_rad", "level_sigma"}) {
    for (const char* sigmas : {"[0.0, -1.0, 0.0]", "[0.0, 1e300, 0.0]"}) {
      Json json = stored();
      state(key, Json::parse(sigmas))(json);
      const std::string changed = file_ + ".changed";
      std::ofstream(changed) << json;
      const auto states = read_chain_file(changed, localizer()->room());
      std::filesystem::remove(changed);
      ASSERT_TRUE(states) << states.error().message;
      EXPECT_EQ(states->size(), 1U) << key << sigmas;
    }
  }
}

}  // namespace
}  // namespace rayloc::chain_file_test
