#include "daemon/live/studio/studio_routes.h"

#include <charconv>
#include <limits>

#include <nlohmann/json.hpp>

#include "daemon/live/http/map_files.h"
#include "daemon/live/studio/pdf_page.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxDraftBytes = std::size_t{1} << 20U;  // [bytes], as for a site.toml

double number_of(const HttpParameters& parameters, const char* key) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (const auto found = parameters.find(key); found != parameters.end()) {
    const std::string& text = found->second;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ptr != text.data() + text.size()) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }
  return value;
}

std::string text_of(const HttpParameters& parameters, const char* key) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? "" : found->second;
}

HttpReply control(CalibrationJob& job, const HttpParameters& parameters) {
  const std::string what = text_of(parameters, "do");
  Expected<void> done;
  if (what == "start") {
    done = job.start(text_of(parameters, "what"));
  } else if (what == "stop") {
    job.stop();
  } else {
    done = bad_input("write do=start or do=stop");
  }
  return editor_reply(done ? job.state() : Expected<Json>(tl::make_unexpected(done.error())));
}

HttpReply report_of(const CalibrationJob& job) {
  constexpr int kNothing = 404;
  auto report = job.report();
  return report ? HttpReply{200, "text/html; charset=utf-8", *std::move(report), true}
                : HttpReply{kNothing, "text/plain; charset=utf-8", report.error().message + "\n"};
}

HttpReply walk(WalkedSurvey& survey, const HttpParameters& parameters) {
  const std::string what = text_of(parameters, "do");
  Expected<void> done;
  if (what == "stand") {
    done = survey.begin_stay(
        {number_of(parameters, "x"), number_of(parameters, "y"), number_of(parameters, "z")});
  } else if (what == "keep") {
    done = survey.keep();
  } else if (what == "leave") {
    survey.leave();
  } else {
    done = bad_input("write do=stand, do=keep or do=leave");
  }
  return editor_reply(done ? survey.state() : tl::make_unexpected(done.error()));
}

HttpReply picture_of(PdfPage& plan, const HttpParameters& parameters) {
  auto picture = plan.picture(text_of(parameters, "number"));
  return picture ? HttpReply{200, "image/png", *std::move(picture)}
                 : editor_reply(tl::make_unexpected(picture.error()));
}

// A page of a PDF, under the drawing.
std::map<std::string, HttpRoute> plan_routes(const std::shared_ptr<PdfPage>& plan) {
  std::map<std::string, HttpRoute> routes;
  HttpRoute& upload = routes["/api/v1/edit/pdf"];
  upload.receive = [plan](const HttpParameters& parameters, const std::string& body) {
    return editor_reply(plan->start(body, text_of(parameters, "page")));
  };
  upload.content_type = "application/pdf";
  upload.most_bytes = PdfPage::kMaxBytes;
  routes["/api/v1/edit/page"].control = [plan](const HttpParameters& parameters) {
    return editor_reply(plan->state(text_of(parameters, "number")));
  };
  routes["/api/v1/edit/picture"].control = [plan](const HttpParameters& parameters) {
    return picture_of(*plan, parameters);
  };
  for (auto& [path, route] : routes) {
    route.method = "POST";
  }
  return routes;
}

}  // namespace

HttpReply editor_reply(const Expected<Json>& result) {
  constexpr int kRefused = 422;
  const Json json = result ? *result : Json{{"error", result.error().message}};
  return {result ? 200 : kRefused,
          "application/json",
          json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

std::map<std::string, HttpRoute> editor_routes(const std::shared_ptr<const SiteEditor>& editor,
                                               const std::shared_ptr<WalkedSurvey>& survey,
                                               const std::shared_ptr<PdfPage>& plan) {
  std::map<std::string, HttpRoute> routes = plan_routes(plan);
  routes["/edit"] = map_routes().at("/map/edit.html");
  HttpRoute& edit = routes["/api/v1/edit"];
  edit.handler = [editor] { return editor_reply(editor->state()); };
  edit.receive = [editor](const HttpParameters&, const std::string& body) {
    return editor_reply(editor->save(body));
  };
  edit.most_bytes = kMaxDraftBytes;
  HttpRoute& walked = routes["/api/v1/survey"];
  if (survey) {
    walked.handler = [survey] { return editor_reply(survey->state()); };
    walked.control = [survey](const HttpParameters& parameters) {
      return walk(*survey, parameters);
    };
  } else {
    walked.handler = [] { return editor_reply(Json{{"file", ""}, {"points", Json::array()}}); };
  }
  return routes;
}

std::map<std::string, HttpRoute> calibration_routes(const std::shared_ptr<CalibrationJob>& job) {
  std::map<std::string, HttpRoute> routes;
  HttpRoute& calibrate = routes["/api/v1/calibrate"];
  if (!job) {
    calibrate.handler = [] { return editor_reply(Json{{"offered", false}}); };
    return routes;
  }
  calibrate.handler = [job] { return editor_reply(job->state()); };
  calibrate.control = [job](const HttpParameters& parameters) { return control(*job, parameters); };
  routes["/calibration-report"].handler = [job] { return report_of(*job); };
  return routes;
}

}  // namespace rayloc
