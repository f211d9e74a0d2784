// scene_note_lines, note_scene: the notes on the reading of a scene as lines for a person.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "engine/scene/scene.h"

namespace rayloc {

// One line for each note, in the order of the file, without newlines.
inline std::vector<std::string> scene_note_lines(const Scene& scene) {
  std::vector<std::string> lines;
  lines.reserve(scene.notes().size());
  for (const SceneNote& note : scene.notes()) {
    lines.push_back(to_line(note));
  }
  return lines;
}

// Passes these lines to the observer.
inline void note_scene(const Scene& scene, const Observer& observer) {
  for (const std::string& line : scene_note_lines(scene)) {
    observer.note(line);
  }
}

}  // namespace rayloc
