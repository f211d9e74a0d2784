// The method or the control of a condition, made for a layout of the study.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "daemon/evaluate/estimates_file.h"
#include "daemon/experiment/condition.h"
#include "daemon/experiment/controls.h"
#include "daemon/experiment/study_world.h"
#include "engine/base/expected.h"

namespace rayloc {

// Locates a device, or a person who stands. An Error, in words, where the method is out of its
// domain. REQUIRES: `layout` outlives the result.
Expected<Locate> make_locate(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed);

// Follows a person along a walk, burst by burst: the estimates of a method's track, or, of a method
// without tracks, those of the bursts. Where there is no track: why not. An Error as of
// make_locate().
using Follow = std::function<Expected<std::vector<PublishedEstimate>>(const StudyWalk& walk)>;
Expected<Follow> make_follow(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed);

}  // namespace rayloc
