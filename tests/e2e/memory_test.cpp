// Memory and descriptors of a raylocd that locates, records, answers over HTTP and has subscribers
// that come and go: they stay as they are, also where the machine is busy with something else now
// and then, which the tests see to by stopping the process.
// RAYLOC_MEMORY_SECONDS: how long they are watched, in seconds; from 600 on their slope is
// asserted. RAYLOC_MEMORY_RATE: datagrams a second of a second device meanwhile, 5000 unless
// stated.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/publish/late_subscriber.h"
#include "engine/base/median.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/device_recording.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"
#include "tests/support/patience.h"

namespace rayloc::e2e::memory_test {
namespace {

using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};
constexpr int kLong = 600;          // seconds, from which on the slope is meaningful
constexpr double kMaxSlope = 30.0;  // [KiB/min], of the second half of a long run

// How long the process gets no time of a processor. Its sockets hold what comes meanwhile, 8 MiB at
// most; every stage then has to do with all of that at once.
constexpr std::chrono::seconds kStarved{2};
constexpr int kStarvedEvery = 120;             // seconds of a long run
constexpr std::uint64_t kFixesOfBacklog = 20;  // of the walker, at most: 5 a second
// The memory that one of two backlogs may leave behind: each of 10,000 datagrams leaves 14 to 16
// MiB if nothing is given back. The other may leave more: a map without a dead antenna has 7 MiB
// and is kept for good, and on a slow machine the caches of the room are not full before it.
constexpr double kMaxKeptKib = 10 * 1024;
constexpr int kBacklogs = 2;
// Memory has settled when it has not risen by this for so many looks, one each half second.
constexpr double kSettledKib = 1024;
constexpr int kSettledSamples = 4;

struct Sample {
  double seconds = 0.0;
  double rss_kib = 0.0;
  std::size_t descriptors = 0;
};

Sample sample(const LiveDaemon& daemon, std::chrono::steady_clock::time_point begin) {
  Sample sample;
  sample.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  sample.rss_kib = daemon.resident_kib();
  const std::string descriptors = "/proc/" + std::to_string(daemon.pid()) + "/fd";
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(descriptors)) {
    ++sample.descriptors;
  }
  return sample;
}

// Statistics of consecutive samples.
struct Course {
  double least_kib = 0.0;
  double most_kib = 0.0;
  double median_kib = 0.0;
  // Slopes of resident memory [KiB/min]: of a straight line, and the median of those between any
  // two moments, which ignores data that a queue holds for a moment and includes data that stays,
  // even in steps.
  double line = 0.0;
  double slope = 0.0;
  std::size_t least_descriptors = 0;
  std::size_t most_descriptors = 0;
};

// The median slope between any two of at most 200 moments.
double median_slope(const std::vector<Sample>& samples, std::size_t begin, std::size_t end) {
  const std::size_t stride = (end - begin + 199) / 200;
  std::vector<double> slopes;
  for (std::size_t i = begin; i < end; i += stride) {
    for (std::size_t j = i + stride; j < end; j += stride) {
      slopes.push_back(60.0 * (samples[j].rss_kib - samples[i].rss_kib) /
                       (samples[j].seconds - samples[i].seconds));
    }
  }
  const auto median = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), median, slopes.end());
  return *median;
}

Course course_of(const std::vector<Sample>& samples, std::size_t begin, std::size_t end) {
  const auto count = static_cast<double>(end - begin);
  std::vector<double> rss_kib;
  for (std::size_t i = begin; i < end; ++i) {
    rss_kib.push_back(samples[i].rss_kib);
  }
  Course course{samples[begin].rss_kib,
                samples[begin].rss_kib,
                median(rss_kib),
                0.0,
                median_slope(samples, begin, end),
                samples[begin].descriptors,
                samples[begin].descriptors};
  double t = 0.0;
  double y = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const Sample& s = samples[i];
    t += s.seconds / count;
    y += s.rss_kib / count;
    course.least_kib = std::min(course.least_kib, s.rss_kib);
    course.most_kib = std::max(course.most_kib, s.rss_kib);
    course.least_descriptors = std::min(course.least_descriptors, s.descriptors);
    course.most_descriptors = std::max(course.most_descriptors, s.descriptors);
  }
  double ty = 0.0;
  double tt = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    ty += (samples[i].seconds - t) * (samples[i].rss_kib - y);
    tt += (samples[i].seconds - t) * (samples[i].seconds - t);
  }
  course.line = 60.0 * ty / tt;
  return course;
}

void print(const char* what, const Course& course) {
  std::printf(
      "%s: resident %.0f to %.0f KiB, median %.0f, slope %.1f KiB/min (of a line %.1f); %zu to %zu "
      "descriptors\n",
      what,
      course.least_kib,
      course.most_kib,
      course.median_kib,
      course.slope,
      course.line,
      course.least_descriptors,
      course.most_descriptors);
  std::fflush(stdout);  // an hour is watched
}

// A client that sends HTTP requests, subscribes late, reads a little and leaves, repeatedly.
class Visitors {
 public:
  explicit Visitors(const LiveDaemon& daemon) : daemon_(daemon), thread_([this] { run(); }) {}
  ~Visitors() {
    if (thread_.joinable()) {
      end();
    }
  }
  Visitors(const Visitors&) = delete;
  Visitors& operator=(const Visitors&) = delete;

  // Returns the number of visits.
  int end() {
    ending_ = true;
    thread_.join();
    return visits_;
  }

 private:
  void run() {
    while (!ending_ && !::testing::Test::HasFailure()) {
      for (const char* const path :
           {"/metrics", "/api/v1/status", "/api/v1/targets", "/api/v1/sources"}) {
        EXPECT_THAT(testing::http_get(daemon_.http_port(), path), StartsWith("HTTP/1.1 200 "))
            << path;
      }
      {
        auto late = LateSubscriber::join(
            daemon_.endpoint(), daemon_.snapshot(), {"v1/"}, test::patient(kPatience));
        EXPECT_TRUE(late);
        for (int i = 0; late && i < 20; ++i) {
          EXPECT_TRUE(late->receive(test::patient(kPatience))) << "nothing after " << i;
        }
      }
      ++visits_;
      // No client is connected between two visits: anything open then is not theirs.
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  }

  const LiveDaemon& daemon_;
  std::atomic<bool> ending_{false};
  std::atomic<int> visits_{0};
  std::thread thread_;
};

void expect_bounded(const std::filesystem::path& recordings) {
  std::uint64_t recorded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
    std::error_code gone;
    const auto size = std::filesystem::file_size(entry.path(), gone);
    recorded += gone ? 0U : size;
  }
  EXPECT_LT(recorded, std::uint64_t{64} << 20U);
}

void starve(LiveDaemon& daemon) {
  daemon.signal(SIGSTOP);
  std::this_thread::sleep_for(kStarved);  // how long it gets no time is what is tested
  daemon.signal(SIGCONT);
}

// One a second. In a long run the daemon is starved now and then, equally often in each part.
std::vector<Sample> watch(LiveDaemon& daemon, int seconds) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Sample> samples;
  for (int i = 1; i <= seconds; ++i) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    samples.push_back(sample(daemon, begin));
    if (seconds >= kLong && i % kStarvedEvery == kStarvedEvery / 2) {
      starve(daemon);
    }
    if (i % kLong == 0) {
      print((std::to_string(i) + " s").c_str(),
            course_of(samples, samples.size() - kLong, samples.size()));
    }
  }
  return samples;
}

// A calibrated room in which a device walks a metre and is located, at the pace of its recording,
// and another sends at a high rate. A place that a device reaches for the first time adds to the
// map in memory, up to a hundred MiB: over a long walk that would hide a leak.
class LocatedRoom {
 public:
  LocatedRoom()
      : daemon_(path(),
                {.site = calibrated_site(path()),
                 // A ring that is soon full, and recordings that are soon removed.
                 .more_configuration = "[record]\ndirectory = \"" + recordings().string() +
                                       "\"\nrotate_mb = 1\nmax_total_mb = 16\n"
                                       "min_free_mb = 0\nring_mb = 4\n",
                 .subscriptions = {"v1/heartbeat/"}}) {}

  // False when the device is not located.
  bool begin() {
    if (!daemon_.ready()) {
      return false;
    }
    const std::vector<std::string> walk = beginning_of_walk();
    if (walk.empty()) {
      return false;
    }
    send("walker", walk, {daemon_.address(0), daemon_.address(1), daemon_.address(2)}, 90);
    send("other",
         {recording_of_devices(path(), "ap2", 7, 1)},
         {daemon_.address(1)},
         stated("RAYLOC_MEMORY_RATE", 5000));
    return eventually(kPatience, [&] { return fixes() > 0; });
  }

  LiveDaemon& daemon() { return daemon_; }
  std::filesystem::path recordings() const { return path() / "rec"; }
  std::uint64_t fixes() const {
    return number(daemon_.bodies("heartbeat").back().at("estimation").at("fixes"));
  }
  bool all_run() {
    return daemon_.running() && std::all_of(senders_.begin(), senders_.end(), [](const auto& one) {
             return one->running();
           });
  }

 private:
  const std::filesystem::path& path() const { return folder_.path(); }

  // Its first two seconds, of each access point.
  std::vector<std::string> beginning_of_walk() const {
    std::vector<std::string> words = {"send"};
    std::vector<std::string> to;
    for (const std::string ap : {"ap1", "ap2", "ap3"}) {
      words.push_back(ap + "=" + bundled_recording("walk", ap));
      to.push_back((path() / ("walk-" + ap + ".pcap")).string());
    }
    for (const std::string& file : to) {
      words.insert(words.end(), {"--to", "pcap:" + file});
    }
    words.insert(words.end(), {"--duration", "2"});
    Process cut(path(), "cut", "rayloc", words);
    return cut.wait(kPatience) == 0 ? to : std::vector<std::string>();
  }

  // Until this is destroyed.
  void send(const std::string& name,
            const std::vector<std::string>& recordings,
            const std::vector<std::string>& to,
            int rate) {
    std::vector<std::string> words = {"send"};
    words.insert(words.end(), recordings.begin(), recordings.end());
    for (const std::string& address : to) {
      words.insert(words.end(), {"--to", address});
    }
    words.insert(words.end(), {"--rate", std::to_string(rate), "--duration", "1000000"});
    senders_.push_back(std::make_unique<Process>(path(), name, "rayloc", words));
  }

  const TemporaryFolder folder_;
  LiveDaemon daemon_;
  std::vector<std::unique_ptr<Process>> senders_;
};

TEST(Endurance, MemoryAndDescriptorsStayAsTheyAre) {
  LocatedRoom room;
  ASSERT_TRUE(room.begin()) << room.daemon().errors();
  Visitors visitors(room.daemon());
  const int seconds = stated("RAYLOC_MEMORY_SECONDS", 6);
  const std::vector<Sample> samples = watch(room.daemon(), seconds);
  const int visits = visitors.end();
  ASSERT_GE(samples.size(), 4U);
  // The first quarter fills what has a bound.
  const Course first = course_of(samples, samples.size() / 4, samples.size() / 2);
  const Course second = course_of(samples, samples.size() / 2, samples.size());
  print("second quarter", first);
  print("second half", second);
  std::printf("%d s: %d visits, %llu fixes\n",
              seconds,
              visits,
              static_cast<unsigned long long>(room.fixes()));  // NOLINT(google-runtime-int)
  EXPECT_TRUE(room.all_run());
  EXPECT_LE(second.most_descriptors, first.least_descriptors + 12)
      << "a rotation, a request and a visitor are open";
  EXPECT_LT(second.most_kib, first.most_kib * 1.1 + 16 * 1024);
  if (seconds >= kLong) {
    EXPECT_LT(second.slope, kMaxSlope) << "KiB/min";
    EXPECT_EQ(second.least_descriptors, first.least_descriptors);
  }
  expect_bounded(room.recordings());
  EXPECT_EQ(room.daemon().stop(), 0) << room.daemon().errors();
}

// Resident memory, in KiB, once it no longer rises. The least of the last samples: a queue holds
// data for a moment.
double settled_kib(const LiveDaemon& daemon) {
  const auto end = std::chrono::steady_clock::now() + test::patient(kPatience);
  std::vector<double> samples;
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    samples.push_back(daemon.resident_kib());
    if (samples.size() > 2 * kSettledSamples) {
      const auto half = samples.end() - kSettledSamples;
      const double earlier = *std::min_element(half - kSettledSamples, half);
      const double later = *std::min_element(half, samples.end());
      if (later < earlier + kSettledKib) {
        return later;
      }
    }
  }
  return samples.back();
}

// The least that is resident, in KiB, until it is below a bound. A machine that is busy works a
// backlog off for long, and what is given back within ten seconds is taken anew meanwhile.
double least_kib_until(const LiveDaemon& daemon, double bound_kib) {
  double least = daemon.resident_kib();
  eventually(kPatience, [&] {
    least = std::min(least, daemon.resident_kib());
    return least < bound_kib;
  });
  return least;
}

TEST(Endurance, MemoryOfABacklogIsReleased) {
  if (slower() > 1) {
    GTEST_SKIP() << "a sanitizer has an allocator of its own";
  }
  LocatedRoom room;
  ASSERT_TRUE(room.begin()) << room.daemon().errors();
  double least_kept = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= kBacklogs; ++i) {
    const double before = settled_kib(room.daemon());
    const std::uint64_t fixes = room.fixes();
    starve(room.daemon());
    // More fixes than there are in the backlog: it is worked off.
    ASSERT_TRUE(eventually(kPatience, [&] { return room.fixes() > fixes + kFixesOfBacklog; }))
        << room.daemon().errors();
    const double after = least_kib_until(room.daemon(), before + kMaxKeptKib);
    std::printf("backlog %d: %.1f MiB, %+.1f\n", i, after / 1024, (after - before) / 1024);
    least_kept = std::min(least_kept, after - before);
  }
  EXPECT_LT(least_kept, kMaxKeptKib) << "KiB, after each backlog";
  EXPECT_TRUE(room.all_run());
  EXPECT_EQ(room.daemon().stop(), 0) << room.daemon().errors();
}

}  // namespace
}  // namespace rayloc::e2e::memory_test
