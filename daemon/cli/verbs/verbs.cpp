#include "daemon/cli/verbs/verbs.h"

#include <array>

namespace rayloc::cli {

// One row per verb, in the order of `rayloc --help`, on separate lines, so that branches merge.
extern const Verb kCalibrate;    // calibrate_verb.cpp
extern const Verb kCheckConfig;  // check_config.cpp
extern const Verb kCluster;      // cluster.cpp
extern const Verb kCompletion;   // completion.cpp
extern const Verb kConfig;       // config.cpp
extern const Verb kDoctor;       // doctor.cpp
extern const Verb kEvaluate;     // evaluate.cpp
extern const Verb kExperiment;   // experiment.cpp
extern const Verb kFrames;       // frames.cpp
extern const Verb kKeygen;       // keygen.cpp
extern const Verb kMan;          // man.cpp
extern const Verb kPredict;      // predict.cpp
extern const Verb kRecord;       // record.cpp
extern const Verb kReference;    // reference.cpp
extern const Verb kReplay;       // replay.cpp
extern const Verb kScene;        // scene.cpp
extern const Verb kSend;         // send.cpp
extern const Verb kSimulate;     // simulate.cpp
extern const Verb kSnapshot;     // snapshot.cpp
extern const Verb kStatus;       // status.cpp
extern const Verb kStudio;       // studio.cpp
extern const Verb kSub;          // sub.cpp
extern const Verb kSurvey;       // survey.cpp
extern const Verb kTop;          // top.cpp
extern const Verb kTrace;        // trace.cpp
extern const Verb kTrain;        // train.cpp
extern const Verb kWaitReady;    // wait_ready.cpp

std::span<const Verb> verbs() {
  // clang-format off
  static const std::array kVerbs = {
      kCalibrate,
      kCheckConfig,
      kCluster,
      kCompletion,
      kConfig,
      kDoctor,
      kEvaluate,
      kExperiment,
      kFrames,
      kKeygen,
      kMan,
      kPredict,
      kRecord,
      kReference,
      kReplay,
      kScene,
      kSend,
      kSimulate,
      kSnapshot,
      kStatus,
      kStudio,
      kSub,
      kSurvey,
      kTop,
      kTrace,
      kTrain,
      kWaitReady,
  };
  // clang-format on
  return kVerbs;
}

}  // namespace rayloc::cli
