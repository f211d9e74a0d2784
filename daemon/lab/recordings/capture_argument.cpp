#include "daemon/lab/recordings/capture_argument.h"

#include <algorithm>
#include <utility>

#include "daemon/site/model/site.h"

namespace rayloc {
namespace {

std::string list_of(const std::vector<std::string>& ids) {
  std::string list;
  for (const std::string& id : ids) {
    list += (list.empty() ? "" : ", ") + id;
  }
  return list;
}

void add_file(const CaptureArgument& capture, std::vector<RecordingArgument>& recordings) {
  const auto same = std::find_if(recordings.begin(), recordings.end(), [&](const auto& other) {
    return !capture.access_point.empty() && other.access_point == capture.access_point;
  });
  if (same == recordings.end()) {
    recordings.push_back({capture.access_point, {capture.file}});
  } else {
    same->files.push_back(capture.file);
  }
}

}  // namespace

CaptureArgument parse_capture_argument(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || !is_access_point_id(text.substr(0, equals))) {
    return {"", text};
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Expected<std::vector<CaptureArgument>> resolve_captures(const std::vector<std::string>& arguments,
                                                        const std::vector<std::string>& ids,
                                                        PerAccessPoint files) {
  std::vector<CaptureArgument> captures;
  for (const std::string& argument : arguments) {
    CaptureArgument capture = parse_capture_argument(argument);
    if (capture.access_point.empty()) {
      if (ids.size() != 1) {
        return make_error(
            ErrorKind::kUsage,
            argument +
                ": which access point recorded it? Write AP=FILE with one of: " + list_of(ids));
      }
      capture.access_point = ids.front();
    }
    if (std::find(ids.begin(), ids.end(), capture.access_point) == ids.end()) {
      return make_error(ErrorKind::kUsage,
                        argument + ": the site has no access point '" + capture.access_point +
                            "'; it has: " + list_of(ids));
    }
    const bool named_twice = std::any_of(captures.begin(), captures.end(), [&](const auto& other) {
      return other.access_point == capture.access_point;
    });
    if (named_twice && files == PerAccessPoint::kOne) {
      return make_error(ErrorKind::kUsage,
                        argument + ": access point '" + capture.access_point +
                            "' has a recording already; give each one file");
    }
    captures.push_back(std::move(capture));
  }
  return captures;
}

std::vector<RecordingArgument> recordings_of(const std::vector<CaptureArgument>& captures) {
  std::vector<RecordingArgument> recordings;
  for (const CaptureArgument& capture : captures) {
    add_file(capture, recordings);
  }
  return recordings;
}

std::vector<RecordingArgument> recordings_of_any(const std::vector<std::string>& arguments) {
  std::vector<RecordingArgument> recordings;
  for (const std::string& argument : arguments) {
    add_file(parse_capture_argument(argument), recordings);
  }
  return recordings;
}

std::string files_text(const RecordingArgument& recording) { return list_of(recording.files); }

}  // namespace rayloc
