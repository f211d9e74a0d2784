// The check of an IFC file before the library assimp reads it.
//
// assimp 5.2.5 follows references without a check: a missing entity, a type outside IFC 2x3 or a
// cycle ends the process. No list of such faults is complete, therefore a program that must not end
// reads a file in another process (README).
#pragma once

#include <string>

#include "daemon/site/import/ifc/step_text.h"
#include "engine/base/expected.h"

namespace rayloc {

// An Error (kBadInput) begins "FILE:LINE: ", or "FILE: " for the schema. It names the first fault:
// another schema than IFC 2x3, a reference to an entity that does not exist or whose type IFC 2x3
// does not have, a value of '*' where an attribute is needed, a cycle of references or of
// containment, deep or repeated nesting, a representation of another type, a number or an angle too
// large for a shape. Thread-safe.
Expected<void> check_ifc(const StepText& step, const std::string& file);

// The same entities for assimp: one on each line, without comments, without types that IFC 2x3 does
// not have, strings in UTF-8 and without characters that have a meaning in the text. assimp
// therefore reads what was checked.
std::string plain_ifc(const StepText& step);

}  // namespace rayloc
