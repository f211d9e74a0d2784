#include "daemon/cli/calibration/calibration_summary.h"

#include <cstdio>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/report/expectation.h"
#include "daemon/lab/calibrate/report/fit_summary.h"

namespace rayloc::cli {

void print_summary(const CalibrationResult& result) {
  const CalibrationReport& report = result.report;
  for (const CalibrationMethodResult& method : report.methods) {
    for (const AccessPointUse& one : result.used) {
      const FitSummary fit = summarize_fit(report, method.calibration, one.index);
      if (!fit.before || !fit.after) {
        std::fprintf(stderr,
                     "%s: %s: %zu points, none of them held out\n",
                     method.method.c_str(),
                     report.access_points[one.index].c_str(),
                     one.points);
        continue;
      }
      const auto located = summarize_located(report, one.index);
      const bool written = &method == &report.methods.front() && located;
      std::fprintf(stderr,
                   "%s: %s: %zu points; held-out correlation %.3f -> %.3f (median of %zu)%s\n",
                   method.method.c_str(),
                   report.access_points[one.index].c_str(),
                   one.points,
                   fit.before->median,
                   fit.after->median,
                   fit.points,
                   written ? fmt::format(", {:.3f} as located", located->median).c_str() : "");
    }
  }
  std::fprintf(stderr, "held-out fixes: %s\n", to_text(report.fixes.back()).c_str());
  if (!report.refused.empty()) {
    std::fprintf(stderr,
                 "%zu inputs refused, the first: %s: %s; see report.json\n",
                 report.refused.size(),
                 report.refused.front().what.c_str(),
                 report.refused.front().reason.c_str());
  }
  if (report.verdict.is_success()) {
    std::fprintf(stderr, "%s\n", expectation(report).c_str());
  }
}

void print_verdict(const CalibrationVerdict& verdict, const std::string& site) {
  std::fprintf(stderr, "rayloc: %s: %s", site.c_str(), to_text(verdict).c_str());
}

void print_result(const CalibrationResult& result, const TerminalReport& report) {
  if (!result.is_site_written) {
    print_verdict(result.report.verdict, report.site);
    std::fprintf(
        stderr,
        "rayloc: no site was written, for this calibration is no success; %s has its report. "
        "--force writes the site all the same\n",
        report.out.c_str());
  }
  if (const auto& stop = result.interruption) {
    std::fprintf(stderr,
                 "interrupted: %s holds the %s%s\n",
                 report.out.c_str(),
                 stop->is_whole ? "whole calibration" : "last good state",
                 stop->resumes        ? "; --resume goes on"
                 : !stop->is_compared ? ", without the comparison"
                                      : "");
  }
}

}  // namespace rayloc::cli
