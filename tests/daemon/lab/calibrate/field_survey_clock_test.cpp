// Surveys whose times were noted by another clock than that of the recordings.
#include <unistd.h>

#include <chrono>
#include <complex>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/lab/calibrate/survey_clock.h"
#include "daemon/site/survey/time_offset.h"
#include "tests/support/test_paths.h"

namespace rayloc::field_survey_clock_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kFolder = test::data_path("/sites/meeting_room");

// The rows of the bundled survey, shifted.
class ShiftedSurvey {
 public:
  ShiftedSurvey(Duration shift, std::size_t rows, std::size_t first = 0)
      : file_(std::filesystem::path(::testing::TempDir()) /
              ("shifted_survey_" + std::to_string(::getpid()) + ".csv")) {
    const auto points = load_points_csv(kFolder + "/calibration.csv", shift);
    std::ofstream out(file_);
    out << "t_start,t_end,x,y,z\n";
    for (std::size_t i = first; i < std::min(points->size(), first + rows); ++i) {
      const SurveyPoint& point = (*points)[i];
      out << seconds_text(point.t_start) << ',' << seconds_text(point.t_end) << ','
          << point.position.x << ',' << point.position.y << ',' << point.position.z << '\n';
    }
  }
  ~ShiftedSurvey() { std::filesystem::remove(file_); }
  ShiftedSurvey(const ShiftedSurvey&) = delete;
  ShiftedSurvey& operator=(const ShiftedSurvey&) = delete;

  Expected<CalibrationInputs> read(std::optional<Duration> time_offset = {}) const {
    return read_calibration_inputs(*load_site(kFolder),
                                   {{"ap1", kFolder + "/calibration-ap1.pcap.gz"},
                                    {"ap2", kFolder + "/calibration-ap2.pcap.gz"}},
                                   file_,
                                   time_offset);
  }
  std::string error() const {
    const auto inputs = read();
    return inputs ? "none" : inputs.error().message;
  }

 private:
  std::filesystem::path file_;
};

TEST(Field, SurveyOfAnotherTimeZoneIsNamedWithItsOffset) {
  const std::vector<std::pair<Duration, std::string>> shifts = {
      {std::chrono::hours(2), "7200.0 s earlier (time zone?): give --time-offset -7200"},
      {-std::chrono::hours(8), "28800.0 s later (time zone?): give --time-offset 28800"},
      {std::chrono::minutes(330), "19800.0 s earlier (time zone?)"},
      {-std::chrono::minutes(345), "20700.0 s later (time zone?)"},
      {std::chrono::minutes(3), "180.0 s earlier (a clock that was off?)"},
      {-milliseconds(137'300), "137.3 s later (a clock that was off?)"},
      {seconds(86'400 * 400), "34560000.0 s earlier"},
  };
  for (const auto& [shift, words] : shifts) {
    EXPECT_THAT(ShiftedSurvey(shift, 12).error(), HasSubstr(words));
    EXPECT_THAT(ShiftedSurvey(shift, 72).error(), HasSubstr(words));
  }
}

TEST(Field, SurveyIsReadAtTheStatedTimeOffset) {
  const ShiftedSurvey survey(std::chrono::hours(2), 12);
  const auto inputs = survey.read(-std::chrono::hours(2));
  ASSERT_TRUE(inputs) << inputs.error().message;
  EXPECT_TRUE(inputs->refused.empty());
  EXPECT_EQ(inputs->content, ShiftedSurvey(Duration(0), 12).read()->content);
}

// The windows of some points coincide with other stops of the device.
TEST(Field, SurveyThatMatchesPartlyByAClockThatIsOffIsNoSurvey) {
  for (const int shift : {40, -40, 20, -50, 10}) {
    EXPECT_THAT(ShiftedSurvey(seconds(shift), 72).error(),
                HasSubstr("--time-offset " + std::to_string(-shift)));
  }
}

TEST(Field, SurveyWithoutRecordingOfItsFirstPointsIsStillRead) {
  const auto points = load_points_csv(kFolder + "/calibration.csv");
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("early_rows_" + std::to_string(::getpid()) + ".csv");
  std::ofstream out(file);
  out << "t_start,t_end,x,y,z\n";
  for (int i = 0; i < 8; ++i) {  // before the recording
    const Timestamp start = points->front().t_start - seconds(90 - 10 * i);
    out << seconds_text(start) << ',' << seconds_text(start + milliseconds(500)) << ",0,0,1.2\n";
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const SurveyPoint& point = (*points)[i];
    out << seconds_text(point.t_start) << ',' << seconds_text(point.t_end) << ",0,0,1.2\n";
  }
  out.close();
  const auto inputs = read_calibration_inputs(
      *load_site(kFolder), {{"ap1", kFolder + "/calibration-ap1.pcap.gz"}}, file);
  std::filesystem::remove(file);
  ASSERT_TRUE(inputs) << inputs.error().message;
  EXPECT_EQ(inputs->refused.size(), 8U);
  EXPECT_THAT(inputs->notes, ::testing::Contains(HasSubstr("6 of 14 points only")));
}

// A walk from stop to stop. The device transmits all the time, or at its stops alone.
class Walk {
 public:
  explicit Walk(bool transmits_between) {
    Timestamp time(seconds(1'718'000'000));
    for (int index = 0; index < 14; ++index) {
      const auto place = channel();
      const Timestamp start = time;
      for (; time < start + seconds(5); time += milliseconds(50)) {
        trace_.add(frame(time, place));
      }
      points_.push_back({start + milliseconds(700), time - milliseconds(700), {}, index + 2});
      const Timestamp leaves = time;
      const auto pause =
          seconds(3) + milliseconds(std::uniform_int_distribution<>(0, 4000)(random_));
      for (; time < leaves + pause; time += milliseconds(50)) {
        if (transmits_between) {
          trace_.add(frame(time, channel()));
        }
      }
    }
  }
  std::vector<SurveyPoint> points(Duration shift) const {
    std::vector<SurveyPoint> points = points_;
    for (SurveyPoint& point : points) {
      point.t_start += shift;
      point.t_end += shift;
    }
    return points;
  }
  // Rows of another survey, whose times match no stop.
  std::vector<SurveyPoint> other_points() {
    std::vector<SurveyPoint> points;
    Timestamp time = points_.front().t_start + std::chrono::hours(50);
    for (int i = 0; i < 14; ++i) {
      time += milliseconds(std::uniform_int_distribution<>(4'000, 25'000)(random_));
      points.push_back({time, time + seconds(2), {}, i + 2});
    }
    return points;
  }
  const DeviceTrace& trace() const { return trace_; }

 private:
  using Channel = std::vector<std::complex<float>>;
  static constexpr std::size_t kTones = 32;

  Channel channel() {
    std::normal_distribution<float> normal;
    Channel values(3 * kTones);
    for (auto& value : values) {
      value = {normal(random_), normal(random_)};
    }
    return values;
  }
  CsiFrame frame(Timestamp time, const Channel& place) {
    std::normal_distribution<float> noise(0.0F, 0.2F);
    CsiFrame frame;
    frame.time = frame.time_last = time;
    frame.rx_chains = {0, 1, 2};
    frame.csi = Csi(3, 1, kTones);
    const float phase = 3.0F * noise(random_);
    for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
      for (std::size_t tone = 0; tone < kTones; ++tone) {
        frame.csi.row(rx_chain, 0)[tone] =
            place[rx_chain * kTones + tone] * std::polar(1.0F, phase) +
            std::complex<float>(noise(random_), noise(random_));
      }
    }
    for (std::size_t tone = 0; tone < kTones; ++tone) {
      frame.tone_index.push_back(static_cast<std::int16_t>(tone));
    }
    return frame;
  }

  std::mt19937 random_{7};
  DeviceTrace trace_;
  std::vector<SurveyPoint> points_;
};

TEST(Field, ClockOffsetIsFoundFromThePausesOfADevice) {
  for (const bool transmits_between : {false, true}) {
    const Walk walk(transmits_between);
    for (const int shift : {3600, -40, 75}) {
      const auto found = find_time_offset(walk.points(seconds(shift)), walk.trace());
      ASSERT_TRUE(found) << shift << (transmits_between ? " on the way" : "");
      EXPECT_NEAR(to_seconds(found->offset), -shift, 0.8);
      EXPECT_GE(found->points, 13U);
    }
    EXPECT_FALSE(find_time_offset(walk.points(Duration(0)), walk.trace()));
    EXPECT_FALSE(find_time_offset(walk.points(milliseconds(300)), walk.trace()));
  }
}

TEST(Field, RecordingOfAnotherDayIsGivenNoOffset) {
  for (const bool transmits_between : {false, true}) {
    Walk walk(transmits_between);
    const auto points = walk.other_points();
    EXPECT_FALSE(find_time_offset(points, walk.trace())) << transmits_between;
    EXPECT_THAT(
        explain_other_times("points.csv", points, walk.trace()),
        ::testing::AllOf(HasSubstr("no point has frames"), Not(HasSubstr("the points fit"))));
  }
}

// A survey of one access point whose recorder had another clock.
TEST(Field, RecordingWithAClockOfItsOwnIsNamedAlone) {
  const Walk walk(false);
  const auto found = find_time_offset(walk.points(seconds(3600)), walk.trace());
  ASSERT_TRUE(found);
  EXPECT_THAT(describe(*found, OtherRecordings::kFit), HasSubstr("editcap -t 3600"));
}

}  // namespace
}  // namespace rayloc::field_survey_clock_test
