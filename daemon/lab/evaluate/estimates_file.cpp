#include "daemon/lab/evaluate/estimates_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <system_error>

#include <google/protobuf/io/coded_stream.h>
#include <nlohmann/json.hpp>

#include "daemon/messages/json.h"
#include "daemon/messages/proto_time.h"
#include "daemon/messages/topic.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

using Estimates = std::vector<PublishedEstimate>;

bool is_finite(const v1::Point& p) {
  return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z());
}

// Absent fields are zeros, which is no covariance.
template <typename Values>
std::optional<std::array<double, 9>> read_covariance(const Values& values) {
  std::array<double, 9> covariance{};
  if (values.empty()) {
    return covariance;
  }
  if (values.size() != static_cast<int>(covariance.size()) ||
      !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    return std::nullopt;
  }
  std::copy(values.begin(), values.end(), covariance.begin());
  return covariance;
}

Expected<PublishedEstimate> from_message(const v1::Location& location, const std::string& place) {
  if (!location.has_time()) {
    return bad_input(place + ": a Location without a time");
  }
  PublishedEstimate read;
  read.person = location.target().kind() == v1::TARGET_KIND_PERSON;
  read.filtered = location.kind() == v1::LOCATION_KIND_FILTERED;
  read.target = target_component(location.target());
  LocationEstimate& estimate = read.estimate;
  estimate.time = from_proto(location.time());
  if (location.mode() == v1::FIX_MODE_NO_FIX || !location.has_position()) {
    return read;
  }
  const auto covariance = read_covariance(location.position_covariance());
  if (!is_finite(location.position()) || !covariance) {
    return bad_input(place + ": position and position_covariance must be finite, and 9 values");
  }
  const v1::Point& p = location.position();
  estimate.position = Vec3d{p.x(), p.y(), p.z()};
  estimate.covariance = *covariance;
  // A method that states its uncertainty publishes a covariance, hypotheses, or both.
  estimate.is_uncertainty_stated =
      !location.position_covariance().empty() || !location.hypotheses().empty();
  estimate.residual_probability = location.residual_probability();
  for (const v1::Hypothesis& stated : location.hypotheses()) {
    const auto spread = read_covariance(stated.position_covariance());
    if (!is_finite(stated.position()) || !spread || !std::isfinite(stated.weight()) ||
        stated.weight() < 0.0) {
      return bad_input(place + ": a hypothesis with values that are not finite");
    }
    estimate.hypotheses.push_back(
        {{stated.position().x(), stated.position().y(), stated.position().z()},
         *spread,
         stated.weight()});
  }
  return read;
}

Expected<void> read_line(std::string_view line,
                         const std::string& name,
                         int number,
                         Estimates& out) {
  const auto place = [&](std::size_t column) {
    return name + ":" + std::to_string(number) + ":" + std::to_string(column);
  };
  bool enveloped = false;
  try {
    const auto json = nlohmann::json::parse(line);
    if (!json.is_object()) {
      return bad_input(place(1) + ": not a JSON object");
    }
    enveloped = json.contains("epoch") && json.contains("sequence");
  } catch (const nlohmann::json::parse_error& error) {
    return bad_input(place(std::max<std::size_t>(error.byte, 1)) + ": not JSON");
  }
  v1::Envelope envelope;
  const auto parsed =
      enveloped ? from_json(line, envelope) : from_json(line, *envelope.mutable_location());
  if (!parsed) {
    return bad_input(place(1) + ": not a Location or an Envelope: " + parsed.error().message);
  }
  if (!envelope.has_location()) {
    return {};
  }
  auto read = from_message(envelope.location(), place(1));
  RAYLOC_TRY(read);
  out.push_back(std::move(*read));
  return {};
}

Expected<Estimates> read_lines(std::string_view content, const std::string& name) {
  Estimates estimates;
  int number = 0;
  while (!content.empty()) {
    ++number;
    const std::size_t end = content.find('\n');
    const std::string_view line = content.substr(0, end);
    content.remove_prefix(end == std::string_view::npos ? content.size() : end + 1);
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) {
      continue;
    }
    RAYLOC_TRY(read_line(line, name, number, estimates));
  }
  return estimates;
}

Expected<Estimates> read_delimited(std::string_view content, const std::string& name) {
  Estimates estimates;
  google::protobuf::io::CodedInputStream stream(
      reinterpret_cast<const std::uint8_t*>(content.data()), static_cast<int>(content.size()));
  while (stream.CurrentPosition() < static_cast<int>(content.size())) {
    const std::string place = name + ": byte " + std::to_string(stream.CurrentPosition());
    std::uint32_t size = 0;
    v1::Location location;
    if (!stream.ReadVarint32(&size) ||
        size > content.size() - static_cast<std::size_t>(stream.CurrentPosition())) {
      return bad_input(place + ": cut off, or neither JSON lines nor Locations in protobuf");
    }
    const auto at = static_cast<std::size_t>(stream.CurrentPosition());
    if (!location.ParseFromArray(content.data() + at, static_cast<int>(size)) ||
        !stream.Skip(static_cast<int>(size))) {
      return bad_input(place + ": not a Location in protobuf");
    }
    auto read = from_message(location, place);
    RAYLOC_TRY(read);
    estimates.push_back(std::move(*read));
  }
  return estimates;
}

// The length of any real Location has two bytes or more, the first of them above 127; a short one
// is followed by the tag of its first field, which is a line feed.
bool is_delimited(std::string_view content) {
  return content.size() >= 2 &&
         (static_cast<unsigned char>(content[0]) >= 0x80 || content[1] == '\x0a');
}

}  // namespace

Expected<Estimates> load_estimates(const std::filesystem::path& file) {
  if (file == "-") {
    const std::string content{std::istreambuf_iterator<char>(std::cin),
                              std::istreambuf_iterator<char>()};
    return read_estimates(content, "standard input");
  }
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  // A directory can be opened too.
  if (!stream.is_open() || std::filesystem::is_directory(file, ignored)) {
    return bad_input(file.string() + ": cannot be read");
  }
  const std::string content{std::istreambuf_iterator<char>(stream),
                            std::istreambuf_iterator<char>()};
  return read_estimates(content, file.string());
}

Expected<Estimates> read_estimates(std::string_view content, const std::string& name) {
  constexpr std::size_t kMost = 1U << 30U;  // protobuf counts bytes in an int
  if (content.size() > kMost) {
    return bad_input(name + ": longer than 1 GiB; give it in parts");
  }
  const std::size_t begin = content.find_first_not_of(" \t\r\n");
  if (begin != std::string_view::npos && is_delimited(content.substr(begin))) {
    return read_delimited(content, name);
  }
  return read_lines(content, name);
}

}  // namespace rayloc
