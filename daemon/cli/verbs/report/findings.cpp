#include "daemon/cli/verbs/report/findings.h"

#include <algorithm>
#include <cstdio>

#include "daemon/cli/command/verb.h"

namespace rayloc::cli {
namespace {

const char* word(Finding::Kind kind) {
  switch (kind) {
    case Finding::Kind::kOk:
      return "ok";
    case Finding::Kind::kWarning:
      return "warning";
    case Finding::Kind::kProblem:
      return "problem";
  }
  return "";
}

}  // namespace

Expected<void> print_findings(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    std::printf("%-8s %s%s%s\n",
                word(finding.kind),
                finding.what.c_str(),
                finding.advice.empty() ? "" : "; ",
                finding.advice.c_str());
  }
  const bool problem = std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.kind == Finding::Kind::kProblem;
  });
  return problem ? Expected<void>(exit_silently(ErrorKind::kUnavailable)) : Expected<void>();
}

}  // namespace rayloc::cli
