// Tests the access control: CURVE over real sockets, and everything that is no handshake.
#include <sys/stat.h>

#include <atomic>
#include <deque>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/base/secret_file.h"
#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/live/publish/socket/curve_keys.h"
#include "daemon/live/publish/subscriber.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/daemon/live/publish/guarded_daemon.h"
#include "tests/support/eventually.h"
#include "tests/support/hostile_client.h"

namespace rayloc::curve_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto kPatience = 60s;

// The last client that was refused.
class Denied {
 public:
  void set(const std::string& key, const std::string& address) {
    const std::lock_guard lock(mutex_);
    text_ = key + " from " + address;
  }
  std::string text() const {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  mutable std::mutex mutex_;
  std::string text_;  // guarded by mutex_
};

class GuardedDaemon {
 public:
  // With CURVE for `allow`; without it when there are no server keys.
  GuardedDaemon(const CurveKeyPair& keys, const std::vector<std::string>& allow)
      : daemon_(access(keys, allow)) {}

  const std::string& endpoint() const { return daemon_.endpoint(); }
  const std::string& snapshot() const { return daemon_.snapshots().endpoint(); }
  ConnectionGuard& guard() const { return daemon_.guard(); }
  std::uint64_t subscriptions() const { return daemon_.subscriptions(); }
  std::string denied() const { return denied_.text(); }

 private:
  ConnectionGuard::Options access(const CurveKeyPair& keys, const std::vector<std::string>& allow) {
    ConnectionGuard::Options options;
    options.secret_key = keys.secret_key;
    options.allow = allow;
    options.on_denied = [this](const std::string& key, const std::string& address) {
      denied_.set(key, address);
    };
    return options;
  }

  Denied denied_;
  test::GuardedDaemon daemon_;
};

bool joins(const GuardedDaemon& daemon, const std::optional<CurveClientKeys>& keys) {
  const auto late = LateSubscriber::join(
      daemon.endpoint(), daemon.snapshot(), {"v1/"}, test::patient(kPatience), keys);
  return late.has_value();
}

TEST(Curve, AListedClientGetsTheSnapshotAndTheStream) {
  const CurveKeyPair server = make_curve_keys();
  const CurveKeyPair client = make_curve_keys();
  const GuardedDaemon daemon(server, {make_curve_keys().public_key, client.public_key});
  auto late = LateSubscriber::join(daemon.endpoint(),
                                   daemon.snapshot(),
                                   {"v1/"},
                                   test::patient(kPatience),
                                   CurveClientKeys{server.public_key, client});
  ASSERT_TRUE(late) << late.error().message;
  std::uint64_t last = 0;
  for (int i = 0; i < 20; ++i) {
    const auto message = late->receive(test::patient(kPatience));
    v1::Envelope envelope;
    ASSERT_TRUE(message && envelope.ParseFromString(message->payload));
    EXPECT_TRUE(last == 0 || envelope.sequence() == last + 1);
    last = envelope.sequence();
  }
  EXPECT_EQ(daemon.guard().counters().clients_admitted, 2U) << "both sockets";
  EXPECT_EQ(daemon.guard().counters().clients_denied, 0U);
  EXPECT_EQ(daemon.guard().counters().handshakes_failed, 0U);
}

TEST(Curve, AnUnlistedClientReceivesNothingAndIsCounted) {
  const CurveKeyPair server = make_curve_keys();
  const CurveKeyPair client = make_curve_keys();
  const CurveKeyPair stranger = make_curve_keys();
  const GuardedDaemon daemon(server, {client.public_key});
  const std::vector<std::pair<const char*, std::optional<CurveClientKeys>>> refused = {
      {"no keys", std::nullopt},
      {"wrong server key", CurveClientKeys{make_curve_keys().public_key, client}},
      {"not on the list", CurveClientKeys{server.public_key, stranger}},
  };
  for (const auto& [name, keys] : refused) {
    const GuardCounters before = daemon.guard().counters();
    auto subscriber = Subscriber::connect(daemon.endpoint(), {""}, 1000, keys);
    ASSERT_TRUE(subscriber);
    ASSERT_TRUE(eventually(kPatience, [&] {
      return daemon.guard().counters().handshakes_failed > before.handshakes_failed;
    })) << name;
    EXPECT_FALSE(subscriber->receive(50ms)) << name;
    EXPECT_EQ(daemon.subscriptions(), 0U) << name;
    const bool by_list = std::string(name) == "not on the list";
    EXPECT_EQ(daemon.guard().counters().clients_denied > before.clients_denied, by_list) << name;
    const auto late =
        LateSubscriber::join(daemon.endpoint(), daemon.snapshot(), {"v1/"}, 50ms, keys);
    EXPECT_FALSE(late) << name;
  }
  EXPECT_EQ(daemon.denied(), stranger.public_key + " from 127.0.0.1");
  EXPECT_EQ(daemon.guard().counters().clients_admitted, 0U);
  EXPECT_TRUE(joins(daemon, CurveClientKeys{server.public_key, client}));
}

TEST(Curve, TheListMayChangeMeanwhile) {
  const CurveKeyPair server = make_curve_keys();
  const CurveKeyPair client = make_curve_keys();
  const GuardedDaemon daemon(server, {});
  const CurveClientKeys keys{server.public_key, client};
  const auto refused = Subscriber::connect(daemon.endpoint(), {"v1/"}, 1000, keys);
  ASSERT_TRUE(refused);
  ASSERT_TRUE(eventually(kPatience, [&] { return daemon.guard().counters().clients_denied > 0; }));
  daemon.guard().allow({client.public_key});
  EXPECT_TRUE(joins(daemon, keys));
  daemon.guard().allow({});
  auto again = Subscriber::connect(daemon.endpoint(), {"v1/"}, 1000, keys);
  ASSERT_TRUE(eventually(kPatience, [&] { return daemon.guard().counters().clients_denied > 1; }));
  EXPECT_FALSE(again->receive(std::chrono::milliseconds(50)));
}

void expect_to_survive(const GuardedDaemon& daemon, const std::optional<CurveClientKeys>& keys) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::deque<HostileClient> open;  // some stay, saying nothing more
  for (int i = 0; i < 400; ++i) {
    open.emplace_back(i % 2 == 0 ? daemon.endpoint() : daemon.snapshot(),
                      hostile_handshake(random));
    if (open.size() > 50) {
      open.pop_front();
    }
  }
  EXPECT_TRUE(joins(daemon, keys));
  EXPECT_TRUE(eventually(kPatience, [&] {
    return daemon.guard().counters().handshakes_failed > 0;
  })) << "counted";
}

TEST(Curve, BytesThatAreNoHandshakeDoNoHarm) {
  const CurveKeyPair server = make_curve_keys();
  const CurveKeyPair client = make_curve_keys();
  const GuardedDaemon daemon(server, {client.public_key});
  expect_to_survive(daemon, CurveClientKeys{server.public_key, client});
  EXPECT_EQ(daemon.guard().counters().clients_admitted, 2U) << "the one that has the key";
}

TEST(Curve, InvalidHandshakesWithoutCurveDoNoHarm) {
  const GuardedDaemon daemon({}, {});
  expect_to_survive(daemon, std::nullopt);
}

class CurveKeyFile : public ::testing::Test {
 protected:
  CurveKeyFile()
      : file_(std::filesystem::path(::testing::TempDir()) /
              (std::string("curve-") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove(file_);
  }
  void TearDown() override { std::filesystem::remove(file_); }
  const std::filesystem::path file_;
};

TEST_F(CurveKeyFile, IsOfItsOwnerAloneAndReadsBack) {
  const CurveKeyPair keys = make_curve_keys();
  ASSERT_TRUE(write_secret(file_, keys.secret_key));
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0600U);
  const auto read = read_curve_secret(file_);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->secret_key, keys.secret_key);
  EXPECT_EQ(read->public_key, keys.public_key);
  const auto again = write_secret(file_, make_curve_keys().secret_key);
  ASSERT_FALSE(again) << "a key that exists is never lost";
  EXPECT_THAT(again.error().message, HasSubstr("File exists"));
  EXPECT_EQ(read_curve_secret(file_)->secret_key, keys.secret_key);
}

TEST_F(CurveKeyFile, IsRefusedWhenEveryoneMayReadItOrItIsNone) {
  EXPECT_THAT(read_curve_secret(file_).error().message, HasSubstr("No such file"));
  std::ofstream(file_) << make_curve_keys().secret_key << "\r\n";
  std::filesystem::permissions(file_, std::filesystem::perms(0644));
  EXPECT_THAT(read_curve_secret(file_).error().message, HasSubstr("chmod 600"));
  std::filesystem::permissions(file_, std::filesystem::perms(0440));
  EXPECT_TRUE(read_curve_secret(file_)) << "as systemd's credentials are";
  EXPECT_TRUE(read_curve_public(file_)) << "every key looks alike";
  std::filesystem::permissions(file_, std::filesystem::perms(0600));
  std::ofstream(file_) << "secret\n";
  EXPECT_THAT(read_curve_secret(file_).error().message, HasSubstr("40 characters"));
  EXPECT_FALSE(is_curve_key(std::string(40, '"')));
  EXPECT_TRUE(is_curve_key(make_curve_keys().public_key));
}

}  // namespace
}  // namespace rayloc::curve_test
