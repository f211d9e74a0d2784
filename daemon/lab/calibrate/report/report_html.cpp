#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/lab/calibrate/report/expectation.h"
#include "daemon/lab/calibrate/report/fit_summary.h"
#include "daemon/lab/calibrate/report/introduction.h"
#include "daemon/lab/calibrate/report/parameter_change.h"
#include "daemon/lab/calibrate/report/report_figures.h"
#include "daemon/lab/draw/html.h"
#include "daemon/lab/draw/svg.h"
#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

using draw::html_page;
using draw::html_paragraph;
using draw::html_section;
using draw::HtmlTable;

constexpr const char* kNone = "\u2013";

std::string figures(const std::vector<draw::Drawing>& drawings) {
  std::string html = "<div class=\"figures\">\n";
  for (const draw::Drawing& drawing : drawings) {
    html += draw::to_svg_element(drawing);
  }
  return html + "</div>\n";
}

std::string summary_text(const std::optional<CorrelationSummary>& summary) {
  return summary ? fmt::format("{:.3f} ({:.3f} \u2013 {:.3f})",
                               summary->median,
                               summary->lower_quartile,
                               summary->upper_quartile)
                 : kNone;
}

std::string rays_text(const TraceOptions& rays) {
  return fmt::format("{} {}{}",
                     rays.max_depth,
                     rays.transmission ? "reflections and crossings" : "reflections",
                     rays.softness > 0.0 ? fmt::format(" at edges of {:g} m", rays.softness) : "");
}

std::string headline(const CalibrationReport& report) {
  const CalibrationMethodResult& written = report.methods.front();
  std::string html = html_paragraph(
      fmt::format("Method {}, {} points, {:.0f} % of them held out (seed {}), {:.1f} s{}{}. "
                  "Calibration {}.",
                  written.method,
                  report.positions.size(),
                  100.0 * report.holdout,
                  report.seed,
                  written.seconds,
                  report.peak_memory_bytes > 0
                      ? fmt::format(", at most {:.0f} MiB of memory",
                                    static_cast<double>(report.peak_memory_bytes) / (1024.0 * 1024))
                      : "",
                  written.calibration.interrupted ? ", interrupted: the last good state" : "",
                  report.calibration_id));
  HtmlTable table{{"access point",
                   "points held out",
                   "before",
                   "after",
                   "mean before, after",
                   "after, survey errors fitted",
                   "as located"},
                  {}};
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    const FitSummary fit = summarize_fit(report, written.calibration, ap);
    table.rows.push_back(
        {report.access_points[ap],
         std::to_string(fit.points),
         summary_text(fit.before),
         summary_text(fit.after),
         fit.after ? fmt::format("{:.3f}, {:.3f}", fit.before->mean, fit.after->mean) : kNone,
         summary_text(fit.placed),
         summary_text(summarize_located(report, ap))});
  }
  html += to_html(table);
  html += html_paragraph(
      "Squared normalised correlation of measured and expected CSI at the points held out: median "
      "and quartiles. 1: all that was measured is explained; before: floor plan and chain gains "
      "alone. Where the column with survey errors fitted is much better than \u201cafter\u201d, "
      "the places "
      "of the points "
      "limit what can be reached, not the model of the room: a point a tenth of a wavelength off "
      "turns the phases of its paths against each other. As located: the site as it was written, "
      "seen by a fix with " +
      rays_text(written.calibration.room.trace) + "; the method saw it with " +
      rays_text(written.rays) + ".");
  if (!report.fixes.empty()) {
    html += html_paragraph("Held-out fixes: " + to_text(report.fixes.back()) + ".");
  }
  return html;
}

std::string mistake_table(const std::vector<TriedMistake>& mistakes) {
  constexpr std::size_t kMost = 10;
  HtmlTable table{{"tried", "mean correlation", "as stated", "standard errors", "to change"}, {}};
  for (std::size_t i = 0; i < std::min(mistakes.size(), kMost); ++i) {
    const TriedMistake& one = mistakes[i];
    table.rows.push_back({one.what,
                          fmt::format("{:.2f}", one.explained),
                          fmt::format("{:.2f}", one.stated),
                          fmt::format("{:+.1f}", one.significance),
                          one.remedy});
  }
  return to_html(table) +
         html_paragraph(
             "Frequent mistakes of surveys and plans, the best fit first. Each was tried on the "
             "floor plan, with chain gains fitted to one half of the points, and judged by the "
             "other half. Standard errors are those of the mean difference per point.");
}

// Empty for a success: then the page has only the list of alternatives, at its end.
std::string failure(const CalibrationReport& report) {
  if (report.verdict.is_success()) {
    return "";
  }
  std::string html;
  for (const std::string& reason : report.verdict.reasons) {
    html += html_paragraph(reason);
  }
  return html_section("This calibration is no success", html + mistake_table(report.verdict.tried));
}

std::string loss_text(const std::vector<CalibrationStep>& history) {
  const auto least = std::min_element(
      history.begin(), history.end(), [](const auto& a, const auto& b) { return a.loss < b.loss; });
  return fmt::format("{:.5g} ({:.5g})", history.back().loss, least->loss);
}

std::string method_table(const CalibrationReport& report) {
  HtmlTable table{{"method", "rays", "time", "iterations", "parameters", "last (least) loss"}, {}};
  for (const std::string& ap : report.access_points) {
    table.columns.push_back(ap + " before");
    table.columns.push_back(ap + " after");
  }
  for (const CalibrationMethodResult& result : report.methods) {
    const RoomCalibration& calibration = result.calibration;
    const bool has_history = !calibration.history.empty();
    table.rows.push_back(
        {result.method,
         rays_text(result.rays),
         fmt::format("{:.1f} s", result.seconds),
         has_history ? std::to_string(calibration.history.back().iteration) : kNone,
         std::to_string(calibration.parameters.size()),
         has_history ? loss_text(calibration.history) : kNone});
    for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
      const FitSummary fit = summarize_fit(report, calibration, ap);
      table.rows.back().push_back(fit.before ? fmt::format("{:.3f}", fit.before->median) : kNone);
      table.rows.back().push_back(summary_text(fit.after));
    }
  }
  return to_html(table) +
         html_paragraph(
             "Median and quartiles at the points held out, before by the rays of each method. A "
             "method's loss is its own; only the correlations compare. The paper's method keeps "
             "the room of its least loss.");
}

std::string progress(const CalibrationReport& report) {
  std::vector<draw::Drawing> drawings;
  for (const CalibrationMethodResult& result : report.methods) {
    drawings.push_back(draw_loss(result));
  }
  drawings.push_back(draw_heldout_history(report));
  return figures(drawings);
}

std::string fit_distributions(const CalibrationReport& report) {
  std::vector<draw::Drawing> drawings;
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    drawings.push_back(draw_fit_distribution(report, ap));
  }
  return figures(drawings);
}

// Units in which people read lengths and angles of a room.
struct ReadableUnit {
  std::string name;
  double scale = 1.0;
};

ReadableUnit readable(const std::string& unit) {
  if (unit == "m") {
    return {"mm", 1e3};
  }
  if (unit == "rad") {
    return {"\u00b0", 180.0 / std::numbers::pi};
  }
  if (unit == "deg") {
    return {"\u00b0", 1.0};
  }
  return {unit == "1" ? "" : unit, 1.0};
}

std::vector<std::string> change_row(const ParameterChange& change) {
  const RoomParameter& parameter = change.parameter;
  const ReadableUnit unit = readable(parameter.unit);
  const std::string sigma =
      parameter.sigma > 0.0 ? fmt::format(" \u00b1 {:.2g}", unit.scale * parameter.sigma) : "";
  const std::string prior_sigma =
      parameter.prior_sigma > 0.0
          ? fmt::format(" \u00b1 {:.2g}", unit.scale * parameter.prior_sigma)
          : "";
  return {to_string(parameter.id),
          fmt::format("{:+.4g} {}", unit.scale * change.by, unit.name),
          change.prior_sigmas ? fmt::format("{:.2f}", *change.prior_sigmas) : kNone,
          fmt::format("{:.5g}{} {}", unit.scale * parameter.value, sigma, unit.name),
          fmt::format("{:.5g}{} {}", unit.scale * parameter.prior, prior_sigma, unit.name),
          change.caution};
}

// The first rows are open, the others fold out.
std::string moved_table(const CalibrationReport& report) {
  constexpr std::size_t kOpen = 25;
  const auto changes = parameter_changes(report.methods.front().calibration.parameters,
                                         kSpeedOfLight / report.before.grid.centre_hz);
  if (changes.empty()) {
    return html_paragraph("No parameter was fitted.");
  }
  HtmlTable open{{"parameter", "moved by", "prior sigmas", "value", "assumed", "caution"}, {}};
  HtmlTable folded{open.columns, {}};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    (i < kOpen ? open : folded).rows.push_back(change_row(changes[i]));
  }
  std::string html = to_html(open);
  if (!folded.rows.empty()) {
    html += fmt::format(
        "<details><summary>{} more</summary>\n{}</details>\n", folded.rows.size(), to_html(folded));
  }
  return html;
}

std::string residual_maps(const CalibrationReport& report) {
  std::vector<draw::Drawing> drawings;
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    drawings.push_back(draw_residuals(report, ap));
  }
  return figures(drawings);
}

std::string refused_table(const CalibrationReport& report) {
  if (report.refused.empty()) {
    return html_paragraph("Nothing was refused.");
  }
  HtmlTable table{{"input", "why"}, {}};
  for (const RefusedInput& one : report.refused) {
    table.rows.push_back({one.what, one.reason});
  }
  return to_html(table);
}

}  // namespace

std::string to_html(const CalibrationReport& report) {
  RAYLOC_CHECK(!report.methods.empty() && report.positions.size() == report.held_out.size());
  return html_page(
      "Calibration of " + report.site,
      introduction(expectation(report),
                   report.verdict.is_success() ? advice(report) : std::vector<std::string>()) +
          failure(report) + headline(report) + html_section("Methods", method_table(report)) +
          html_section("Course of the fit", progress(report)) +
          html_section("Fit of the points held out", fit_distributions(report)) +
          html_section("Changes to the plan",
                       figures({draw_displacements(report)}) +
                           html_paragraph(
                               "Floors and ceilings, poses and materials are in the table only.") +
                           moved_table(report)) +
          html_section("Where the room is explained", residual_maps(report)) +
          html_section("Refused", refused_table(report)));
}

}  // namespace rayloc
