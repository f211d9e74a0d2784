// <default name="h" value="2.5"/>: the values that "$h" stands for. Internal to load_scene.
#pragma once

#include <pugixml.hpp>

#include "engine/scene/read/xml_file.h"

namespace rayloc {

// Replaces "$name" in the attributes of the <bsdf>s and <shape>s of `scene`, and of the <default>s
// themselves, by what the <default>s before them say; of two with one name the first counts. As
// Mitsuba does, where nobody gives another value on the command line. Without any <default> a '$'
// is a letter like others.
void apply_defaults(XmlFile& file, const pugi::xml_node& scene);

}  // namespace rayloc
