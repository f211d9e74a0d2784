// A file of IFC 4 as the text of IFC 2x3 that the library assimp reads.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "daemon/site/import/ifc/step_text.h"
#include "engine/base/expected.h"

namespace rayloc {

struct Ifc4Text {
  StepText step;                              // of IFC 2x3; lines are those of the file
  std::vector<std::string> remarks;           // content that is left out, for a person
  std::set<std::string, std::less<>> shaped;  // GlobalIds of the elements with a shape in `step`
};

// True for IFC4, IFC4X1 .. IFC4X3_ADD2. Thread-safe.
bool is_ifc4(const StepText& step);

// The project with its units, the elements of the building with their shapes and openings, and the
// names of surface styles; other entities have no effect on a scene. An element whose shape is not
// read, or only in part, is counted in the remarks by the type of the cause. An Error (kBadInput)
// is one of Ifc4Shapes::read(). Thread-safe.
Expected<Ifc4Text> ifc4_as_2x3(const StepText& step, const std::string& file);

}  // namespace rayloc
