#include "tests/cluster/one_site.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/history/story.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/record/system_now.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/support/patience.h"

namespace rayloc::cluster {
namespace {

using e2e::number;
using e2e::Process;

// Rate of the sender, in datagrams a second: at a higher rate, the device also has a track.
std::string rate() {
  const char* const stated = std::getenv("RAYLOC_CLUSTER_RATE");
  return stated == nullptr ? "20" : stated;
}

std::uint64_t marked(const Sequencer& sequencer) {
  std::uint64_t all = 0;
  for (const auto& [access_point, count] : sequencer.counters().marked_datagrams) {
    all += count;
  }
  return all;
}

}  // namespace

Machine::Machine(const std::filesystem::path& folder,
                 const std::string& name,
                 const e2e::LiveDaemonOptions& options)
    : folder_(folder / name) {
  std::filesystem::create_directories(folder_);
  first_ = std::make_unique<e2e::LiveDaemon>(folder_, options);
}

void Machine::signal(int number) {
  if (again_) {
    again_->signal(number);
  } else {
    first_->signal(number);
  }
}

int Machine::end(int number) {
  signal(number);
  return (again_ ? again_->wait(kPatience) : first_->wait(kPatience)).value_or(-1);
}

void Machine::begin() {
  again_ = std::make_unique<Process>(
      folder_,
      "again" + std::to_string(++starts_),
      "raylocd",
      std::vector<std::string>{"--config", first_->configuration().string()});
}

void OneSite::begin_machines(const Servers& servers) {
  servers_ = servers;
  broker_ = *open_broker({servers_.urls, "test"});
  ASSERT_TRUE(wait_for_broker(*broker_, test::patient(kPatience)));
  site_ = e2e::calibrated_site(folder_.path());
  const std::map<std::string, std::string> roles = {{"node", "capture"},
                                                    {"gateway", "gateway"},
                                                    {"witness", "gateway"},
                                                    {"w1", "worker"},
                                                    {"w2", "worker"}};
  for (const auto& [name, role] : roles) {
    machines_.emplace(name,
                      std::make_unique<Machine>(folder_.path(), name, options_of(role, name)));
  }
  for (const std::string name : {"node", "gateway", "witness"}) {
    ASSERT_TRUE(machines_.at(name)->first().ready()) << machines_.at(name)->errors();
  }
  sender_ = std::make_unique<Process>(
      folder_.path(),
      "send",
      "rayloc",
      std::vector<std::string>{"send",
                               "--rate",
                               rate(),
                               "--duration",
                               "7200",
                               e2e::bundled_recording("device_los", "ap2"),
                               "--to",
                               machines_.at("node")->first().address(0)});
  ASSERT_TRUE(goes_on()) << machines_.at("w1")->errors();
}

e2e::LiveDaemonOptions OneSite::options_of(const std::string& role, const std::string& name) const {
  std::string urls;
  for (const std::string& url : servers_.urls) {
    urls += (urls.empty() ? "\"" : ", \"") + url + "\"";
  }
  e2e::LiveDaemonOptions options;
  options.sites = {
      {"hall",
       site_,
       role == "capture" ? std::vector<std::string>{"ap2"} : std::vector<std::string>{}}};
  options.more_configuration = "[cluster]\nrole = \"" + role + "\"\nname = \"" + name +
                               "\"\nstandby = \"" + standby() +
                               "\"\nstorage = \"file\"\nretention_s = 7200\nreplicas = " +
                               std::to_string(servers_.replicas) + "\nservers = [" + urls + "]\n";
  return options;
}

v1::OutputRecord OneSite::last_record() const {
  const auto message = broker_->last_of(std::string(kOutputStream), output_subject("hall"));
  v1::OutputRecord record;
  if (message && *message) {
    (void)unseal((*message)->data, record);
  }
  return record;
}

bool OneSite::goes_on() const {
  const std::int64_t now = us_of(system_now());
  return eventually(kPatience, [&] { return last_record().output().done_us() > now; });
}

std::string OneSite::owner() const {
  v1::SiteClaim claim;
  (void)eventually(kPatience, [&] {
    const auto message = broker_->last_of(std::string(kClaimStream), claim_subject("hall"));
    if (message && *message) {
      (void)unseal((*message)->data, claim);
    }
    return !claim.worker().empty();
  });
  return claim.worker();
}

void OneSite::end_machines() {
  sender_->signal(SIGTERM);
  sender_->wait(kPatience);
  note_captured();
  for (const std::string name : {"w1", "w2"}) {
    EXPECT_EQ(machines_.at(name)->end(SIGTERM), 0) << machines_.at(name)->errors();
  }
}

void OneSite::expect_every_datagram() {
  const auto state = broker_->stream_state(csi_stream("hall"));
  ASSERT_TRUE(state) << state.error().message;
  Sequencer sequencer({}, true);
  std::map<std::uint64_t, std::uint64_t> datagrams;  // by start
  std::uint64_t epoch = 0;
  for (std::uint64_t i = state->first; i <= state->last; ++i) {
    const auto message = broker_->get(csi_stream("hall"), i);
    ASSERT_TRUE(message && *message) << i;
    if ((*message)->subject == owner_subject("hall")) {
      continue;
    }
    auto batch = decode_batch((*message)->data);
    ASSERT_TRUE(batch) << batch.error().message;
    epoch = batch->epoch;
    const std::uint64_t marked_before = marked(sequencer);
    std::vector<Sequencer::Taken> taken;
    sequencer.push("node", *std::move(batch), taken);
    for (const Sequencer::Taken& one : taken) {
      for (const BatchPart& part : one.batch.parts) {
        datagrams[one.batch.epoch] += part.datagrams.entries.size();
      }
    }
    datagrams[epoch] += marked(sequencer) - marked_before;
  }
  const Sequencer::Counters counters = sequencer.counters();
  EXPECT_EQ(counters.missing, 0U);
  EXPECT_EQ(counters.held, 0U);
  EXPECT_EQ(datagrams[epoch], captured_);
  std::uint64_t all = 0;
  for (const auto& [start, count] : datagrams) {
    all += count;
  }
  std::cout << all << " datagrams of " << datagrams.size() << " starts of the node, "
            << marked(sequencer) << " of them in marks\n";
}

void OneSite::expect_one_story() {
  Expected<std::vector<Chapter>> story = read_story(*broker_, "hall");
  // Servers that have just elected a leader do not answer for a moment.
  (void)eventually(kPatience, [&] {
    if (!story) {
      story = read_story(*broker_, "hall");
    }
    return story.has_value();
  });
  ASSERT_TRUE(story) << story.error().message;
  Timestamp done = story->front().from;
  std::set<std::string> known;
  std::size_t items = 0;
  for (const Chapter& chapter : *story) {
    EXPECT_EQ(chapter.from, done);
    done = chapter.done;
    for (const v1::OutputItem& item : chapter.items) {
      EXPECT_TRUE(known.insert(item.SerializeAsString()).second) << item.ShortDebugString();
      ++items;
    }
  }
  std::cout << items << " results of " << story->size() << " owners\n";
}

std::vector<nlohmann::json> OneSite::replay(const std::vector<std::string>& more) {
  std::vector<std::string> words = {
      "replay", site_.string(), "--stream", servers_.urls.front(), "--stream-site", "hall"};
  words.insert(words.end(), more.begin(), more.end());
  Process verb(folder_.path(), "replay", "rayloc", words);
  EXPECT_EQ(verb.wait(std::chrono::seconds(1200)), 0);
  std::cout << verb.errors();
  std::vector<nlohmann::json> locations;
  for (const std::string& line : e2e::read_lines(verb.out())) {
    locations.push_back(nlohmann::json::parse(line));
  }
  return locations;
}

std::vector<nlohmann::json> OneSite::received(const std::string& gateway) {
  return machines_.at(gateway)->first().bodies("location");
}

void OneSite::note_captured() {
  EXPECT_TRUE(eventually(kPatience, [&] {
    const nlohmann::json capture =
        nlohmann::json::parse(
            testing::http_body(testing::http_get(machines_.at("node")->first().http_port(),
                                                 "/site/hall/api/v1/status")))
            .at("capture");
    const nlohmann::json& source = capture.at("access_points").at(0);
    captured_ = number(source.at("captured"));
    return number(source.at("waiting")) == 0 && number(capture.at("unacknowledged")) == 0;
  }));
}

std::vector<nlohmann::json> OneSite::expect_published() {
  std::vector<nlohmann::json> again = replay({});
  // A gateway that connects late publishes no results from before that.
  const std::vector<nlohmann::json> begun = received("witness");
  const auto first =
      begun.empty() ? again.end() : std::find(again.begin(), again.end(), begun.front());
  EXPECT_NE(first, again.end());
  const std::vector<nlohmann::json> expected(first, again.end());
  std::cout << expected.size() << " of " << again.size() << " since the witness listens\n";
  EXPECT_TRUE(eventually(kPatience, [&] { return received("witness").size() >= expected.size(); }));
  EXPECT_EQ(received("witness"), expected);
  // The other gateway was absent at times.
  std::set<std::string> seen;
  for (const nlohmann::json& location : received("gateway")) {
    EXPECT_NE(std::find(again.begin(), again.end(), location), again.end()) << location.dump();
    EXPECT_TRUE(seen.insert(location.dump()).second) << location.dump();
  }
  return again;
}

}  // namespace rayloc::cluster
