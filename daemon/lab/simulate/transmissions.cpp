#include "daemon/lab/simulate/transmissions.h"

#include <algorithm>

#include "daemon/lab/simulate/random_stream.h"

namespace rayloc {
namespace {

constexpr std::uint16_t kSequenceNumbers = 4096;  // 12 bits

Error error_at(const std::string& file, int line, const std::string& what) {
  return {ErrorKind::kBadInput, file + ":" + std::to_string(line) + ": " + what};
}

// Checks that a device can send the requested frames at point `i`, one at a time.
Expected<void> check_times(std::span<const SurveyPoint> ordered,
                           std::size_t i,
                           const TransmissionOptions& options,
                           const std::string& file) {
  const SurveyPoint& point = ordered[i];
  if (i > 0) {
    const SurveyPoint& last = ordered[i - 1];
    if (options.walk && point.t_start < last.t_start + kMinFrameInterval) {
      return tl::make_unexpected(error_at(file,
                                          point.line,
                                          "follows within 0.2 ms of line " +
                                              std::to_string(last.line) +
                                              "; a device sends one frame at a time"));
    }
    if (point.t_start < last.t_end) {
      return tl::make_unexpected(error_at(file,
                                          point.line,
                                          "begins before the point of line " +
                                              std::to_string(last.line) +
                                              " ends; one device is at one point at a time"));
    }
  }
  const auto count = static_cast<Duration::rep>(options.frames);
  if (!options.walk && (point.t_end - point.t_start) / count < kMinFrameInterval) {
    return tl::make_unexpected(
        error_at(file,
                 point.line,
                 std::to_string(options.frames) + " frames do not fit between t_start and t_end"));
  }
  return {};
}

// Transmission times of a device at the point.
std::vector<Timestamp> times_at(const SurveyPoint& point, const TransmissionOptions& options) {
  if (options.walk) {
    return {point.t_start};
  }
  const auto count = static_cast<Duration::rep>(options.frames);
  const Duration interval = (point.t_end - point.t_start) / count;
  std::vector<Timestamp> times;
  for (Duration::rep n = 0; n < count; ++n) {
    times.push_back(point.t_start + n * interval + interval / 2);
  }
  return times;
}

}  // namespace

Expected<std::vector<SimulatedPoint>> plan_transmissions(std::span<const SurveyPoint> points,
                                                         const TransmissionOptions& options,
                                                         const std::string& file) {
  std::vector<SurveyPoint> ordered(points.begin(), points.end());
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) {
    return a.t_start < b.t_start;
  });
  RandomStream traffic = random_stream(options.seed, "traffic");
  RandomStream survey = random_stream(options.seed, "survey");
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  auto number = static_cast<std::uint16_t>(traffic() % kSequenceNumbers);
  std::size_t sent = 0;
  std::vector<SimulatedPoint> test_points;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const SurveyPoint& point = ordered[i];
    RAYLOC_TRY(check_times(ordered, i, options, file));
    SimulatedPoint test_point;
    test_point.line = point.line;
    test_point.t_start = point.t_start;
    test_point.t_end = point.t_end;
    const double dx = normal(survey);
    const double dy = normal(survey);
    const double dz = normal(survey);
    test_point.position = point.position + options.survey_error * Vec3d{dx, dy, dz};
    for (const Timestamp time : times_at(point, options)) {
      const bool retry = uniform(traffic) < options.retry_share;
      number = static_cast<std::uint16_t>((number + (retry ? 0 : 1)) % kSequenceNumbers);
      test_point.frames.push_back(
          {time, static_cast<std::uint16_t>(number << 4U), traffic(), sent++ % options.channels});
    }
    test_points.push_back(std::move(test_point));
  }
  return test_points;
}

}  // namespace rayloc
