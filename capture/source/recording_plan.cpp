#include "capture/source/recording_plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "capture/source/rejection_words.h"
#include "capture/source/seconds_text.h"

namespace rayloc {
namespace {

std::optional<TimeSpan> span_of(const PlannedFile& file) {
  if (!file.scan || file.scan->times.busy.empty()) {
    return std::nullopt;
  }
  TimeSpan span = file.scan->times.busy.front();
  for (const TimeSpan& busy : file.scan->times.busy) {
    span = {std::min(span.begin, busy.begin), std::max(span.end, busy.end)};
  }
  return span;
}

// "./a.pcap" and "a.pcap" are the same.
bool is_same(const std::string& a, const std::string& b) {
  std::error_code unknown;
  return a == b || std::filesystem::equivalent(a, b, unknown);
}

// Orders the spans, and joins those that are separated by no longer gap than `gap`.
std::vector<TimeSpan> joined(std::vector<TimeSpan> spans, Duration gap) {
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& a, const TimeSpan& b) {
    return a.begin < b.begin;
  });
  std::vector<TimeSpan> all;
  for (const TimeSpan& span : spans) {
    if (!all.empty() && span.begin <= all.back().end + gap) {
      all.back().end = std::max(all.back().end, span.end);
    } else {
      all.push_back(span);
    }
  }
  return all;
}

// Message about two consecutive files; empty if there is no finding.
std::string describe_between(const PlannedFile& before, const PlannedFile& next, Duration gap) {
  const auto first = span_of(before);
  const auto second = span_of(next);
  if (!first || !second) {
    return {};
  }
  const std::string both = before.path + " and " + next.path + ": ";
  if (second->begin < first->end) {
    return both + "they overlap by " +
           seconds_text(std::min(first->end, second->end) - second->begin) +
           "; frames in both count once";
  }
  if (second->begin > first->end + gap) {
    return both + "nothing was recorded for " + seconds_text(second->begin - first->end) +
           " between them";
  }
  return {};
}

}  // namespace

Timestamp begin_of(const PlannedFile& file) {
  const bool known = file.scan && !file.scan->times.busy.empty();
  return known ? file.scan->times.busy.front().begin : Timestamp::min();
}

PcapFileOptions as_stamped_options() {
  PcapFileOptions options;
  options.max_disorder = std::chrono::seconds(1);
  options.as_stamped = true;
  return options;
}

Expected<RecordingPlan> plan_recording(const std::vector<std::string>& files,
                                       const PcapFileOptions& options) {
  RecordingPlan plan;
  plan.options = options;
  for (const std::string& path : files) {
    const auto same = std::find_if(plan.files.begin(), plan.files.end(), [&](const auto& other) {
      return is_same(other.path, path);
    });
    if (same != plan.files.end()) {
      return make_error(ErrorKind::kUsage,
                        path + ": is named twice for one access point; name each file once");
    }
    PlannedFile file{path, std::nullopt};
    if (can_be_read_twice(path)) {
      auto scan = scan_recording(path, options);
      RAYLOC_TRY(scan);
      file.scan = std::move(*scan);
    } else if (files.size() > 1 && std::filesystem::exists(path)) {
      return make_error(ErrorKind::kUsage,
                        path +
                            ": a pipe cannot be one of several recordings of an access point, as "
                            "its times are unknown before it is read; save it to a file first");
    }
    plan.files.push_back(std::move(file));
  }
  std::stable_sort(
      plan.files.begin(), plan.files.end(), [](const PlannedFile& a, const PlannedFile& b) {
        return begin_of(a) < begin_of(b);
      });
  return plan;
}

std::optional<TimeSpan> span_of(const RecordingPlan& plan) {
  std::optional<TimeSpan> all;
  for (const PlannedFile& file : plan.files) {
    if (const auto span = span_of(file)) {
      all =
          all ? TimeSpan{std::min(all->begin, span->begin), std::max(all->end, span->end)} : *span;
    }
  }
  return all;
}

std::vector<TimeSpan> busy_times(const std::vector<RecordingPlan>& plans) {
  std::vector<TimeSpan> spans;
  Duration gap = kMaxGap;
  for (const RecordingPlan& plan : plans) {
    gap = plan.options.max_gap;
    for (const PlannedFile& file : plan.files) {
      if (file.scan) {
        spans.insert(spans.end(), file.scan->times.busy.begin(), file.scan->times.busy.end());
      }
    }
  }
  return joined(std::move(spans), gap);
}

std::vector<std::string> describe(const RecordingPlan& plan) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < plan.files.size(); ++i) {
    const PlannedFile& file = plan.files[i];
    if (i > 0) {
      if (std::string between = describe_between(plan.files[i - 1], file, plan.options.max_gap);
          !between.empty()) {
        words.push_back(std::move(between));
      }
    }
    if (!file.scan) {
      continue;
    }
    const std::vector<std::string> own =
        describe(file.scan->times, file.path, least_gap(plan.options));
    words.insert(words.end(), own.begin(), own.end());
    const std::vector<std::string> rejections = rejection_words(file.scan->counters, file.path);
    words.insert(words.end(), rejections.begin(), rejections.end());
  }
  return words;
}

Duration least_gap(const PcapFileOptions& options) {
  // During a survey the person walks between points without sending.
  constexpr Duration kPauseOfSurvey = std::chrono::minutes(10);
  return options.as_stamped ? std::max(kPauseOfSurvey, options.max_gap) : options.max_gap;
}

std::string name_of(const RecordingPlan& plan) {
  const std::size_t more = plan.files.size() - 1;
  return plan.files.front().path + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

std::string rejections_text(const std::map<std::string, std::uint64_t>& rejected) {
  std::string text;
  for (const auto& [reason, count] : rejected) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
  }
  return text;
}

}  // namespace rayloc
