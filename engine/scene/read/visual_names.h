// Visual-only names of a Mitsuba scene, which are silently left out. Everything else that is not
// read is an error. engine/scene/FILES.md has the same list for people.
#pragma once

#include <algorithm>
#include <span>
#include <string_view>

namespace rayloc {

// <sensor>, <emitter>, ...: elements of the <scene> and of a <shape>.
std::span<const std::string_view> visual_tags();
// Elements of a <bsdf> that are colours or textures, with any name.
std::span<const std::string_view> visual_bsdf_tags();
// Types of a <bsdf> without radio properties.
std::span<const std::string_view> visual_bsdf_types();

// Properties of a <shape>: "face_normals", ...
bool is_visual_of_shape(std::string_view name);
// Properties of a <bsdf>: "int_ior", "roughness", ...; also as in Mitsuba 0.6, "intIOR".
bool is_visual_of_bsdf(std::string_view name);

std::span<const std::string_view> visual_shape_properties();
std::span<const std::string_view> visual_bsdf_properties();
// Prefixes of property names of Mitsuba's openpbr.
std::span<const std::string_view> visual_bsdf_prefixes();

// True if the list contains exactly this name.
inline bool is_listed(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace rayloc
