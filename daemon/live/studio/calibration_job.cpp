#include "daemon/live/studio/calibration_job.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/site/model/site_copy.h"
#include "daemon/site/survey/points_csv.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// "progress SHARE TEXT": a line of `rayloc calibrate --progress`.
constexpr std::string_view kProgress = "progress ";

// A new folder name within the site's folder.
fs::path free_folder(const fs::path& site) {
  fs::path folder = site / "calibrated";
  std::error_code unknown;
  for (int i = 2; fs::exists(folder, unknown); ++i) {
    folder = site / ("calibrated-" + std::to_string(i));
  }
  return folder;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

// Reason for a missing report: the last messages, without the progress lines.
std::string last_line(const std::string& errors) {
  std::string words;
  for (const std::string& line : lines_of(errors)) {
    if (line.rfind(kProgress, 0) != 0 && !line.empty()) {
      words = line;
    }
  }
  return words.empty() ? "it ended without a word" : words;
}

}  // namespace

Json CalibrationJob::progress() const {
  constexpr double kUnknown = 0.0;
  Json state = {{"share", kUnknown}, {"text", "reading"}};
  for (const std::string& line : lines_of(process_->errors())) {
    if (line.rfind(kProgress, 0) == 0) {
      char* text = nullptr;
      state["share"] = std::strtod(line.c_str() + kProgress.size(), &text);
      state["text"] = *text == ' ' ? text + 1 : text;
    }
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begun_;
  state["seconds"] = seconds.count();
  return state;
}

Json CalibrationJob::outcome(int status) const {
  if (process_->was_stopped()) {
    return {{"success", false},
            {"verdict", "Stopped. The results that it had written are not used."}};
  }
  const auto text = read_file(out_ / "report.json");
  const Json report = text ? Json::parse(*text, nullptr, false) : Json();
  if (!report.is_object() || !report.contains("verdict")) {
    return {{"success", false}, {"verdict", "Not calibrated: " + last_line(process_->errors())}};
  }
  std::error_code unknown;
  return {{"success", status == 0},
          {"verdict", report["verdict"].value("expectation", "It states no reason.")},
          {"folder", fs::absolute(out_, unknown).string()},
          {"report", true}};
}

Json CalibrationJob::state() {
  const std::optional<int> status = process_ ? process_->status() : std::nullopt;
  if (status && process_->was_stopped() && !out_.empty()) {
    std::error_code none;  // it is a new folder, and a partial fit is of no use
    fs::remove_all(std::exchange(out_, fs::path()), none);
  }
  Json state = {{"offered", true}, {"running", process_ && !status}};
  if (process_) {
    state.update(status ? outcome(*status) : progress());
  }
  return state;
}

Expected<void> CalibrationJob::start(const std::string& what) {
  if (state().at("running")) {
    return bad_input("a calibration runs; wait for it, or stop it");
  }
  if (what != "all" && what != "chains") {
    return bad_input("write what=all or what=chains");
  }
  std::error_code status;
  if (fs::exists(site_ / "calibration.toml", status)) {
    return bad_input(site_.string() +
                     " is calibrated already; calibrate the site as it was drawn, without a "
                     "calibration.toml");
  }
  const fs::path survey = site_ / "survey.csv";
  const auto points = load_points_csv(survey);
  if (!points) {
    return bad_input("walk a survey first: choose \"I am here\" and tap your place (" +
                     points.error().message + ")");
  }
  auto recordings = recordings_(points->front().t_start);
  const auto program = rayloc_program();
  if (!recordings || !program) {
    return tl::make_unexpected(recordings ? program.error() : recordings.error());
  }
  const fs::path out = free_folder(site_);
  std::vector<std::string> arguments{"calibrate",
                                     site_.string(),
                                     "--points",
                                     survey.string(),
                                     "--out",
                                     out.string(),
                                     "--progress"};
  if (what == "chains") {
    arguments.emplace_back("--gains-only");
  }
  arguments.emplace_back("--capture");
  arguments.insert(arguments.end(), recordings->begin(), recordings->end());
  auto process = ChildProcess::start(*program, arguments);
  RAYLOC_TRY(process);
  process_ = *std::move(process);
  out_ = out;
  begun_ = std::chrono::steady_clock::now();
  return {};
}

void CalibrationJob::stop() {
  if (process_) {
    process_->stop();
  }
}

Expected<std::string> CalibrationJob::report() const {
  if (out_.empty()) {
    return bad_input("nothing was calibrated here since this program was started");
  }
  return read_file(out_ / "report.html");
}

}  // namespace rayloc
