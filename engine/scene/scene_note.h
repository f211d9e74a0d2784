// SceneNote: a part of a scene file that the reader interpreted differently from the file's likely
// intention, or left out. The scene can be used; a person should check it.
#pragma once

#include <string>

namespace rayloc {

struct SceneNote {
  std::string kind;     // "left_out", "mesh_count" and others: for scripts
  std::string place;    // "scene.xml:12:5: "
  std::string message;  // for people
};

inline std::string to_line(const SceneNote& note) {
  return note.place + "warning: " + note.message;
}

}  // namespace rayloc
