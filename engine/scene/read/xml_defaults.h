// <default name="h" value="2.5"/>: the values that replace "$h". Internal to load_scene.
#pragma once

#include <pugixml.hpp>

#include "engine/scene/read/xml_file.h"

namespace rayloc {

// Replaces "$name" in the attributes of the <bsdf>s and <shape>s of `scene`, and of the <default>s
// themselves, by the values of the preceding <default>s; of two with one name the first counts.
// The same as Mitsuba without values on the command line. Without any <default> a '$' is an
// ordinary character.
void apply_defaults(XmlFile& file, const pugi::xml_node& scene);

}  // namespace rayloc
