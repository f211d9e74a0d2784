// The picture of a scene or site: antennas, zones, and the paths of a link on request.
#pragma once

#include "daemon/lab/draw/scene_picture.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_options.h"

namespace rayloc::draw {

// The scene with the access points and zones of its site, if it has one. `source` must outlive the
// picture. Thread safety: a pure function.
ScenePicture source_picture(const SceneSource& source);

struct DrawnLink {
  Transmitter transmitter;
  Receiver receiver;
  bool marks_transmitter = false;  // an end that is no access point gets a mark of its own
  bool marks_receiver = false;
  TraceOptions options;
  double range_db = 40.0;  // weaker paths, relative to the strongest, are left out
};

// Traces the link and adds its paths, its ends and a caption. The picture has no paths if there are
// none.
void add_link(const DrawnLink& link, const SceneSource& source, ScenePicture& picture);

}  // namespace rayloc::draw
