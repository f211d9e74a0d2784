// Makes the method or the control of a condition for a layout of the study.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "daemon/lab/evaluate/estimates_file.h"
#include "daemon/lab/experiment/condition.h"
#include "daemon/lab/experiment/controls.h"
#include "daemon/lab/experiment/study_world.h"
#include "engine/base/expected.h"

namespace rayloc {

// Locates a device, or a person who does not move. Returns an Error with a message if the method is
// outside its domain. REQUIRES: `layout` outlives the result.
Expected<Locate> make_locate(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed);

// Tracks a person along a walk, burst by burst: the estimates of a
// method's track, or, for a method without tracks, those of the bursts.
// Without a track: the reason. Returns an Error as make_locate() does.
using Follow = std::function<Expected<std::vector<PublishedEstimate>>(const StudyWalk& walk)>;
Expected<Follow> make_follow(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed);

}  // namespace rayloc
