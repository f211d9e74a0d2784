// A LinkTrace as text: JSON, and a table for people.
#pragma once

#include <string>

#include "daemon/lab/trace/trace_link.h"
#include "engine/scene/scene.h"

namespace rayloc {

// One line with the keys of INTERFACE 3.4; numbers with 17 significant digits, paths in canonical
// order.
std::string trace_json(const LinkTrace& traced, const Scene& scene);

// Table for people: one line per path, the strongest first.
std::string trace_table(const LinkTrace& traced, const Scene& scene);

}  // namespace rayloc
