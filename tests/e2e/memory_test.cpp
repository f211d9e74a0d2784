// Memory and descriptors of a raylocd that locates, records, answers over HTTP and has subscribers
// that come and go: they stay as they are.
// RAYLOC_MEMORY_SECONDS: how long they are watched, in seconds; from 600 on their slope is
// asserted. RAYLOC_MEMORY_RATE: datagrams a second of a second device meanwhile, 5000 unless
// stated.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/publish/late_subscriber.h"
#include "tests/daemon/http/http_client.h"
#include "tests/e2e/device_recording.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e {
namespace {

using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};
constexpr int kLong = 600;          // seconds, from which on the slope says something
constexpr double kMaxSlope = 30.0;  // [KiB/min], of the second half of a long run

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

// Of some samples in a row.
struct Course {
  double least_kib = 0.0;
  double most_kib = 0.0;
  // Of resident memory [KiB/min]: of a straight line, and the median of those between any two
  // moments. A queue that a busy machine lets fill once leaves a step, which the median does not
  // see; what grows, even by steps, it sees.
  double line = 0.0;
  double slope = 0.0;
  std::size_t least_descriptors = 0;
  std::size_t most_descriptors = 0;
};

// Between any two of at most 200 moments.
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
  Course course{samples[begin].rss_kib,
                samples[begin].rss_kib,
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
      "%s: resident %.0f to %.0f KiB, slope %.1f KiB/min (of a line %.1f); %zu to %zu "
      "descriptors\n",
      what,
      course.least_kib,
      course.most_kib,
      course.slope,
      course.line,
      course.least_descriptors,
      course.most_descriptors);
  std::fflush(stdout);  // an hour is watched
}

// Somebody who asks over HTTP, joins late, reads a little and goes, again and again.
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

  // How many there were.
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
        auto late =
            LateSubscriber::join(daemon_.endpoint(), daemon_.snapshot(), {"v1/"}, kPatience);
        EXPECT_TRUE(late);
        for (int i = 0; late && i < 20; ++i) {
          EXPECT_TRUE(late->receive(kPatience)) << "nothing after " << i;
        }
      }
      ++visits_;
      // Between two of them nobody is there: what stays open then is not theirs.
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  }

  const LiveDaemon& daemon_;
  std::atomic<bool> ending_{false};
  std::atomic<int> visits_{0};
  std::thread thread_;
};

// Until the test ends, `recordings` to the access points `to`.
std::vector<std::string> without_end(const std::vector<std::string>& recordings,
                                     const std::vector<std::string>& to,
                                     int rate) {
  std::vector<std::string> words = {"send"};
  words.insert(words.end(), recordings.begin(), recordings.end());
  for (const std::string& address : to) {
    words.insert(words.end(), {"--to", address});
  }
  words.insert(words.end(), {"--rate", std::to_string(rate), "--duration", "1000000"});
  return words;
}

std::uint64_t fixes(const LiveDaemon& daemon) {
  return number(daemon.bodies("heartbeat").back().at("estimation").at("fixes"));
}

void expect_bounded(const std::filesystem::path& recordings) {
  std::uint64_t recorded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
    std::error_code gone;
    const auto size = std::filesystem::file_size(entry.path(), gone);
    recorded += gone ? 0U : size;
  }
  EXPECT_LT(recorded, std::uint64_t{64} << 20U);
}

// One a second.
std::vector<Sample> watch(const LiveDaemon& daemon, int seconds) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Sample> samples;
  for (int i = 1; i <= seconds; ++i) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    samples.push_back(sample(daemon, begin));
    if (i % kLong == 0) {
      print((std::to_string(i) + " s").c_str(),
            course_of(samples, samples.size() - kLong, samples.size()));
    }
  }
  return samples;
}

TEST(Endurance, MemoryAndDescriptorsStayAsTheyAre) {
  const TemporaryFolder folder;
  // A ring that is soon full, and recordings that are soon removed.
  const std::filesystem::path recordings = folder.path() / "rec";
  LiveDaemon daemon(folder.path(),
                    {.site = calibrated_site(folder.path()),
                     .more_configuration = "[record]\ndirectory = \"" + recordings.string() +
                                           "\"\nrotate_mb = 1\nmax_total_mb = 16\n"
                                           "min_free_mb = 0\nring_mb = 4\n",
                     .subscriptions = {"v1/heartbeat/"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  // A device that walks and is located, at the pace of its recording, and one that says much.
  Process walker(folder.path(),
                 "walker",
                 "rayloc",
                 without_end({bundled_recording("walk", "ap1"),
                              bundled_recording("walk", "ap2"),
                              bundled_recording("walk", "ap3")},
                             {daemon.address(0), daemon.address(1), daemon.address(2)},
                             90));
  Process other(folder.path(),
                "other",
                "rayloc",
                without_end({recording_of_devices(folder.path(), "ap2", 7, 1)},
                            {daemon.address(1)},
                            stated("RAYLOC_MEMORY_RATE", 5000)));
  ASSERT_TRUE(eventually(kPatience, [&] { return fixes(daemon) > 0; })) << daemon.errors();
  Visitors visitors(daemon);
  const int seconds = stated("RAYLOC_MEMORY_SECONDS", 6);
  const std::vector<Sample> samples = watch(daemon, seconds);
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
              static_cast<unsigned long long>(fixes(daemon)));  // NOLINT(google-runtime-int)
  EXPECT_TRUE(daemon.running() && walker.running() && other.running());
  EXPECT_LE(second.most_descriptors, first.least_descriptors + 12)
      << "a rotation, a request and a visitor are open";
  EXPECT_LT(second.most_kib, first.most_kib * 1.1 + 16 * 1024);
  if (seconds >= kLong) {
    EXPECT_LT(second.slope, kMaxSlope) << "KiB/min";
    EXPECT_EQ(second.least_descriptors, first.least_descriptors);
  }
  expect_bounded(recordings);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e
