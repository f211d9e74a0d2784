#include "daemon/cli/verbs.h"

#include <array>

namespace rayloc::cli {

// One row a verb, in the order of `rayloc --help`.
extern const Verb kCalibrate;    // calibrate.cpp
extern const Verb kCheckConfig;  // check_config.cpp
extern const Verb kConfig;       // config.cpp
extern const Verb kEvaluate;     // evaluate.cpp
extern const Verb kFrames;       // frames.cpp
extern const Verb kRecord;       // record.cpp
extern const Verb kReplay;       // replay.cpp
extern const Verb kScene;        // scene.cpp
extern const Verb kSend;         // send.cpp
extern const Verb kSimulate;     // simulate.cpp
extern const Verb kSub;          // sub.cpp
extern const Verb kSurvey;       // survey.cpp
extern const Verb kTrace;        // trace.cpp

std::span<const Verb> verbs() {
  static const std::array kVerbs = {
      kCalibrate,
      kCheckConfig,
      kConfig,
      kEvaluate,
      kFrames,
      kRecord,
      kReplay,
      kScene,
      kSend,
      kSimulate,
      kSub,
      kSurvey,
      kTrace,
  };
  return kVerbs;
}

}  // namespace rayloc::cli
