// What only the eye needs of a Mitsuba scene: it is left out without a word. Everything else that
// is not read is an error. engine/scene/FILES.md has the same list for people.
#pragma once

#include <algorithm>
#include <span>
#include <string_view>

namespace rayloc {

// <sensor>, <emitter>, ...: elements of the <scene> and of a <shape>.
std::span<const std::string_view> visual_tags();
// Elements of a <bsdf> that are colours or textures, whatever their names.
std::span<const std::string_view> visual_bsdf_tags();
// Types of a <bsdf> that say nothing about radio.
std::span<const std::string_view> visual_bsdf_types();

// Properties of a <shape>: "face_normals", ...
bool is_visual_of_shape(std::string_view name);
// Properties of a <bsdf>: "int_ior", "roughness", ...; also as Mitsuba 0.6 spells them, "intIOR".
bool is_visual_of_bsdf(std::string_view name);

std::span<const std::string_view> visual_shape_properties();
std::span<const std::string_view> visual_bsdf_properties();
// Of Mitsuba's openpbr: properties that begin so.
std::span<const std::string_view> visual_bsdf_prefixes();

// Whether a name is one of those, spelt just so.
inline bool is_listed(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace rayloc
