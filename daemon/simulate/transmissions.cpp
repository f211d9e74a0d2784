#include "daemon/simulate/transmissions.h"

#include <algorithm>

#include "daemon/simulate/random_stream.h"

namespace rayloc {
namespace {

constexpr std::uint16_t kSequenceNumbers = 4096;  // 12 bits

Error error_at(const std::string& file, int line, const std::string& what) {
  return {ErrorKind::kBadInput, file + ":" + std::to_string(line) + ": " + what};
}

}  // namespace

Expected<std::vector<SimulatedSpot>> plan_transmissions(std::span<const SurveyPoint> points,
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
  std::vector<SimulatedSpot> spots;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const SurveyPoint& point = ordered[i];
    if (i > 0 && point.t_start < ordered[i - 1].t_end) {
      return tl::make_unexpected(error_at(file,
                                          point.line,
                                          "begins before the point of line " +
                                              std::to_string(ordered[i - 1].line) +
                                              " ends; one device stands at one point at a time"));
    }
    const auto count = static_cast<Duration::rep>(options.frames);
    const Duration interval = (point.t_end - point.t_start) / count;
    if (interval < kLeastFrameInterval) {
      return tl::make_unexpected(error_at(
          file,
          point.line,
          std::to_string(options.frames) + " frames do not fit between t_start and t_end"));
    }
    SimulatedSpot spot;
    spot.line = point.line;
    const double dx = normal(survey);
    const double dy = normal(survey);
    const double dz = normal(survey);
    spot.position = point.position + options.survey_error * Vec3d{dx, dy, dz};
    for (Duration::rep n = 0; n < count; ++n) {
      const bool retry = uniform(traffic) < options.retry_share;
      number = static_cast<std::uint16_t>((number + (retry ? 0 : 1)) % kSequenceNumbers);
      spot.frames.push_back({point.t_start + n * interval + interval / 2,
                             static_cast<std::uint16_t>(number << 4U),
                             traffic()});
    }
    spots.push_back(std::move(spot));
  }
  return spots;
}

}  // namespace rayloc
