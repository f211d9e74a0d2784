// Tests device-free localization through the whole pipeline: two fixed transmitters detect a person
// who stays in a simulated room for two seconds and leaves.
#include "daemon/pipeline/person_estimator.h"

#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "capture/source/pcap_source.h"
#include "daemon/messages/location_message.h"
#include "daemon/messages/proto_time.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::person_estimator_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTransmitters = R"(
[person]
radius_m = 0.16
height_m = 1.7
[[transmitter]]
role = "fixed"
mac = "02:52:4c:00:00:09"
name = "plug"
position = [1.2, -0.6, 1.1]
[[transmitter]]
role = "fixed"
mac = "02:52:4c:00:00:0a"
name = "lamp"
position = [1.1, 0.9, 1.4]
)";
constexpr const char* kHeader = "t_start,t_end,x,y,z\n";
constexpr std::size_t kPcapHeader = 24;  // [bytes], of a file

struct Outcome {
  std::vector<v1::Location> locations;
  std::vector<v1::TrackEvent> events;  // by time
  PersonTrackerCounters counters;
  std::string text;  // all of it

  // The states that a track entered, and when.
  std::vector<std::pair<v1::TrackState, Timestamp>> life(std::uint64_t track) const {
    std::vector<std::pair<v1::TrackState, Timestamp>> states;
    for (const v1::TrackEvent& event : events) {
      if (event.target().track() == track) {
        states.emplace_back(event.state(), from_proto(event.time()));
      }
    }
    return states;
  }
  // The last instant at which a measurement located the track.
  Timestamp last_seen(std::uint64_t track) const {
    Timestamp last{};
    for (const v1::Location& location : locations) {
      if (location.kind() == v1::LOCATION_KIND_FILTERED && location.target().track() == track &&
          location.mode() == v1::FIX_MODE_2D) {
        last = std::max(last, from_proto(location.time()));
      }
    }
    return last;
  }
};

class Recorder : public LocationSink {
 public:
  explicit Recorder(Outcome& outcome)
      : outcome_(outcome), ordered_([&outcome](const Location& location) {
          outcome.locations.push_back(location_message(location));
        }) {}
  void location(Location&& location) override { ordered_.location(std::move(location)); }
  void event(TrackEvent&& event) override { outcome_.events.push_back(event_message(event)); }
  void advance(Timestamp time) override { ordered_.advance(time); }
  void finish() {
    ordered_.finish();
    // As locations, they come in the order in which they became known.
    std::sort(outcome_.events.begin(), outcome_.events.end(), [](const auto& a, const auto& b) {
      return std::pair(from_proto(a.time()), a.event_id()) <
             std::pair(from_proto(b.time()), b.event_id());
    });
    for (const v1::Location& location : outcome_.locations) {
      outcome_.text += location.SerializeAsString();
    }
    for (const v1::TrackEvent& event : outcome_.events) {
      outcome_.text += event.SerializeAsString();
    }
  }

 private:
  Outcome& outcome_;
  OrderedSink ordered_;
};

class PeopleOfTwoTransmitters : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    std::ofstream(path("plan.toml")) << test::closet_plan();
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    std::ofstream(path("site") + "/site.toml", std::ios::app) << kTransmitters;
    std::string survey = kHeader;
    for (int i = 0; i < 30; ++i) {
      const int row = i / 6;
      survey += std::to_string(1000 + 2 * i) + "," + std::to_string(1000.5 + 2 * i) + "," +
                std::to_string(-1.05 + 0.4 * (i % 6)) + "," + std::to_string(-0.75 + 0.3 * row) +
                ",1.2\n";
    }
    simulate("survey", survey, {});
    run({"calibrate",
         path("site"),
         "--gains-only",
         "--quiet",
         "--points",
         path("survey.csv"),
         "--capture",
         "ap1=" + path("survey.pcap"),
         "--out",
         path("calibrated")});
    learn_the_empty_room();
    // A person stays there for two seconds; then both transmitters are silent, and the frames of a
    // device advance the time.
    simulate("plug",
             kHeader + std::string("3000,3002,0.1,-0.1,0\n"),
             {"--transmitter", "plug", "--person", "--frames", "40"});
    simulate("lamp",
             kHeader + std::string("3000.02,3002,0.1,-0.1,0\n"),
             {"--transmitter", "lamp", "--person", "--frames", "40"});
    simulate("later",
             kHeader + std::string("3002.1,3012,0.3,0.2,1.2\n"),
             {"--transmitter", "02:52:4c:00:00:01", "--frames", "120"});
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static void learn_the_empty_room() {
    simulate(
        "empty", kHeader + std::string("2000,2000.5,1.2,-0.6,1.1\n"), {"--transmitter", "plug"});
    simulate("more", kHeader + std::string("2003,2003.5,1.1,0.9,1.4\n"), {"--transmitter", "lamp"});
    std::ifstream in(path("more.pcap"), std::ios::binary);
    in.seekg(kPcapHeader);
    std::ofstream(path("empty.pcap"), std::ios::binary | std::ios::app) << in.rdbuf();
    run({"reference",
         path("calibrated"),
         "--quiet",
         "--capture",
         "ap1=" + path("empty.pcap"),
         "--out",
         path("people")});
  }
  // The folder of this process: other processes run tests of this file at the same time.
  static fs::path folder() {
    return fs::path(::testing::TempDir()) / ("person_estimator_" + std::to_string(::getpid()));
  }
  static std::string path(const std::string& name) { return folder() / name; }
  static void run(const std::vector<std::string>& arguments) {
    const Finished finished = RaylocProcess(arguments).wait();
    ASSERT_EQ(finished.status, 0) << finished.err;
  }
  static void simulate(const std::string& name,
                       const std::string& points,
                       const std::vector<std::string>& more) {
    std::ofstream(path(name + ".csv")) << points;
    std::vector<std::string> arguments = {"simulate",
                                          path("site"),
                                          "--quiet",
                                          "--points",
                                          path(name + ".csv"),
                                          "--out",
                                          "ap1=" + path(name + ".pcap")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
  }
  static Outcome replay(std::size_t ring_frames, const std::shared_ptr<Pace>& pace) {
    PersonEstimator::Options options;
    options.settings.values["person_cell_m"] = 0.1;  // fine enough to detect a person, and fast
    return replay(ring_frames, pace, options);
  }
  static Outcome replay(std::size_t ring_frames,
                        const std::shared_ptr<Pace>& pace,
                        const PersonEstimator::Options& options) {
    const auto estimator =
        PersonEstimator::create(load_site(path("people")).value(), options).value();
    std::vector<SourceWorker::Input> inputs;
    for (const char* name : {"plug", "lamp", "later"}) {
      SourceWorker::Input input;
      input.access_point = "ap1";
      input.source = PcapFileSource::open(path(std::string(name) + ".pcap")).value();
      if (pace) {
        input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
      }
      input.receiver.access_point = 0;
      inputs.push_back(std::move(input));
    }
    Outcome outcome;
    Recorder sink(outcome);
    PipelineOptions pipeline_options;
    pipeline_options.ring_frames = ring_frames;
    pipeline_options.overflow = Overflow::kWait;
    Pipeline pipeline(pipeline_options, std::move(inputs), *estimator, sink);
    pipeline.start();
    pipeline.wait();
    sink.finish();
    outcome.counters = estimator->tracker_counters();
    return outcome;
  }

  // The outcome of one replay, made once.
  static const Outcome& outcome() {
    static const Outcome kMade = replay(8192, nullptr);
    return kMade;
  }
};

TEST_F(PeopleOfTwoTransmitters, AreLostOnceEach) {
  // The plug, first in the site, has the odd numbers, and the lamp the even ones.
  const auto plug = outcome().life(1);
  const auto lamp = outcome().life(2);
  for (const auto& life : {plug, lamp}) {
    ASSERT_EQ(life.size(), 4U);
    EXPECT_EQ(life[0].first, v1::TRACK_STATE_TENTATIVE);
    EXPECT_EQ(life[1].first, v1::TRACK_STATE_CONFIRMED);
    EXPECT_EQ(life[2].first, v1::TRACK_STATE_COASTING);
    EXPECT_EQ(life[3].first, v1::TRACK_STATE_LOST);
  }
  EXPECT_EQ(outcome().events.size(), 8U);
  EXPECT_EQ(outcome().counters.begun, 2U);
  EXPECT_EQ(outcome().counters.lost, 2U);
  EXPECT_GE(outcome().counters.used, 30U);
  EXPECT_EQ(outcome().counters.moments,
            outcome().counters.used + outcome().counters.no_person +
                outcome().counters.unexplained + outcome().counters.out_of_order +
                outcome().counters.unusable);

  // At fixed times after the last detection, independent of the times of other frames.
  EXPECT_EQ(plug[2].second, outcome().last_seen(1) + std::chrono::milliseconds(500));
  EXPECT_EQ(plug[3].second, outcome().last_seen(1) + std::chrono::milliseconds(5100));
  EXPECT_EQ(lamp[2].second, outcome().last_seen(2) + std::chrono::milliseconds(500));
  EXPECT_EQ(lamp[3].second, outcome().last_seen(2) + std::chrono::milliseconds(5100));
}

TEST_F(PeopleOfTwoTransmitters, DependNeitherOnSpeedNorOnQueuesNorOnThreads) {
  ASSERT_FALSE(outcome().text.empty());
  EXPECT_EQ(replay(3, nullptr).text, outcome().text);
  EXPECT_EQ(replay(8192, std::make_shared<Pace>(50.0)).text, outcome().text);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(replay(8192, nullptr).text, outcome().text);
}

// Until a track is lost, snapshots have its number; afterwards, that of the next track.
TEST_F(PeopleOfTwoTransmitters, HaveTheNumbersOfTheirTracksInSnapshots) {
  for (const std::uint64_t number : {1U, 2U}) {
    const Timestamp lost = outcome().life(number).back().second;
    int before = 0;
    for (const v1::Location& location : outcome().locations) {
      const std::uint64_t other = location.target().track();
      if (location.kind() == v1::LOCATION_KIND_SNAPSHOT && other % 2 == number % 2) {
        const bool is_before = from_proto(location.time()) < lost;
        before += is_before ? 1 : 0;
        EXPECT_EQ(other, is_before ? number : number + 2) << location.ShortDebugString();
      }
    }
    EXPECT_GE(before, 5) << number;
  }
}

TEST_F(PeopleOfTwoTransmitters, HaveSeparateTrackNumbers) {
  std::map<std::uint64_t, std::vector<v1::Location>> by_number;
  for (const v1::Location& location : outcome().locations) {
    by_number[location.target().track()].push_back(location);
  }
  // While both detect the person, each reports under its own number, snapshots too.
  for (const std::uint64_t number : {1U, 2U}) {
    const auto snapshots = static_cast<std::size_t>(std::count_if(
        by_number[number].begin(), by_number[number].end(), [](const v1::Location& location) {
          return location.kind() == v1::LOCATION_KIND_SNAPSHOT && location.has_position();
        }));
    EXPECT_GE(snapshots, 5U) << number;
  }
  std::vector<std::string> ids;
  for (const v1::Location& location : outcome().locations) {
    ids.push_back(location.event_id());
  }
  for (const v1::TrackEvent& event : outcome().events) {
    ids.push_back(event.event_id());
  }
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
}

// The same targets and bursts as of our method; each burst is a place, without accuracy or tracks.
TEST_F(PeopleOfTwoTransmitters, AreLocatedByThePapersMethodToo) {
  PersonEstimator::Options options;
  options.method = find_method("paper");
  options.settings.values["iterations"] = 2.0;
  const Outcome papers = replay(8192, nullptr, options);
  const auto snapshots = [](const Outcome& of) {
    std::vector<std::pair<std::uint64_t, Timestamp>> bursts;
    for (const v1::Location& location : of.locations) {
      if (location.kind() == v1::LOCATION_KIND_SNAPSHOT) {
        bursts.emplace_back(location.target().track() % 2, from_proto(location.time()));
      }
    }
    return bursts;
  };
  EXPECT_GE(papers.locations.size(), 10U);
  EXPECT_EQ(snapshots(papers), snapshots(outcome()));
  EXPECT_EQ(papers.locations.size(), snapshots(papers).size());
  EXPECT_TRUE(papers.events.empty());
  for (const v1::Location& location : papers.locations) {
    EXPECT_EQ(location.quality().method(), "paper");
    EXPECT_EQ(location.target().kind(), v1::TARGET_KIND_PERSON);
    EXPECT_TRUE(location.has_position());
    EXPECT_FALSE(location.has_accuracy_m());
    EXPECT_EQ(location.hypotheses_size(), 0);
  }
}

}  // namespace
}  // namespace rayloc::person_estimator_test
