// Prints notes on the reading of a scene to standard error, for a person.
#pragma once

#include <cstdio>

#include "engine/scene/scene.h"

namespace rayloc::cli {

inline void print_scene_notes(const Scene& scene) {
  for (const SceneNote& note : scene.notes()) {
    std::fprintf(stderr, "%s\n", to_line(note).c_str());
  }
}

}  // namespace rayloc::cli
