#include "capture/record/recording_gap.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <span>
#include <string_view>

namespace rayloc {
namespace {

constexpr std::uint32_t kLoopback = 0x7f000001;
constexpr std::uint16_t kDiscardPort = 9;
constexpr std::string_view kBegin = "rayloc-gap ";
constexpr std::string_view kUnknown = "unknown";
constexpr std::int64_t kMicroseconds = 1'000'000;

// Seconds since 1970 with six decimals.
std::string time_text(Timestamp time) {
  const std::int64_t us =
      std::chrono::floor<std::chrono::microseconds>(time).time_since_epoch().count();
  std::array<char, 40> text{};
  std::snprintf(text.data(),
                text.size(),
                "%lld.%06lld",
                static_cast<long long>(us / kMicroseconds),
                static_cast<long long>(us % kMicroseconds));
  return text.data();
}

template <typename Number>
std::optional<Number> whole_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

std::optional<Timestamp> time_of(std::string_view text) {
  constexpr std::size_t kDecimals = 6;
  // Greater values would overflow a Timestamp.
  constexpr std::uint64_t kMaxSeconds = std::uint64_t{1} << 33U;
  const std::size_t point = text.find('.');
  if (point == std::string_view::npos || text.size() - point - 1 != kDecimals) {
    return std::nullopt;
  }
  const auto seconds = whole_number<std::uint64_t>(text.substr(0, point));
  const auto decimals = whole_number<std::uint32_t>(text.substr(point + 1));
  if (!seconds || *seconds > kMaxSeconds || !decimals) {
    return std::nullopt;
  }
  return Timestamp(std::chrono::seconds(*seconds) + std::chrono::microseconds(*decimals));
}

// The value of "key=value" in words divided by spaces; empty if the key is absent.
std::string_view value_of(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (word.size() > key.size() && word.substr(0, key.size()) == key && word[key.size()] == '=') {
      return word.substr(key.size() + 1);
    }
  }
  return {};
}

}  // namespace

std::string gap_text(const RecordingGap& gap) {
  return std::string(kBegin) +
         "datagrams=" + (gap.datagrams ? std::to_string(*gap.datagrams) : std::string(kUnknown)) +
         " reason=" + gap.reason + " from=" + time_text(gap.from) + " to=" + time_text(gap.to);
}

Datagram gap_mark(const std::string& text, Timestamp time) {
  Datagram mark;
  mark.time = time;
  mark.address = {.source_ip = kLoopback,
                  .destination_ip = kLoopback,
                  .source_port = kDiscardPort,
                  .destination_port = kDiscardPort};
  mark.payload = std::as_bytes(std::span(text));
  return mark;
}

std::optional<RecordingGap> recording_gap(const Datagram& datagram) {
  if (datagram.address.destination_port != kDiscardPort ||
      datagram.address.source_ip != kLoopback) {
    return std::nullopt;
  }
  // The bytes are read as text.
  const std::string_view text(reinterpret_cast<const char*>(datagram.payload.data()),
                              datagram.payload.size());
  if (text.substr(0, kBegin.size()) != kBegin) {
    return std::nullopt;
  }
  const std::string_view words = text.substr(kBegin.size());
  const std::string_view count = value_of(words, "datagrams");
  const auto number = whole_number<std::uint64_t>(count);
  const auto from = time_of(value_of(words, "from"));
  const auto to = time_of(value_of(words, "to"));
  if ((!number && count != kUnknown) || !from || !to) {
    return std::nullopt;
  }
  return RecordingGap{number, std::string(value_of(words, "reason")), *from, *to};
}

}  // namespace rayloc
