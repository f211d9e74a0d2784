// Prints notes on the reading of a scene to standard error, for a person.
#pragma once

#include <cstdio>
#include <string>

#include "daemon/site/scene/scene_notes.h"
#include "engine/scene/scene.h"

namespace rayloc::cli {

inline void print_scene_notes(const Scene& scene) {
  for (const std::string& line : scene_note_lines(scene)) {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
}

}  // namespace rayloc::cli
