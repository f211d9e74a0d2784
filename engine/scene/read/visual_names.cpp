#include "engine/scene/read/visual_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace rayloc {
namespace {

using Name = std::string_view;

// Mitsuba's plugins that affect light and not radio.
constexpr std::array<Name, 10> kTags{"emitter",
                                     "film",
                                     "integrator",
                                     "medium",
                                     "phase",
                                     "rfilter",
                                     "sampler",
                                     "sensor",
                                     "texture",
                                     "volume"};

// Children of Mitsuba's bsdfs that do not affect radio.
constexpr std::array<Name, 5> kBsdfTags{"rgb", "spectrum", "texture", "color", "medium"};

// Mitsuba's plugins of bsdfs without radio properties.
constexpr std::array<Name, 25> kBsdfTypes{"blendbsdf",    "bumpmap",        "circular",
                                          "conductor",    "dielectric",     "diffuse",
                                          "hair",         "mask",           "measured",
                                          "normalmap",    "null",           "openpbr",
                                          "phong",        "plastic",        "polarizer",
                                          "pplastic",     "principled",     "principledthin",
                                          "retarder",     "roughconductor", "roughdielectric",
                                          "roughplastic", "thindielectric", "twosided",
                                          "ward"};

// Mitsuba's properties of shapes, for shading and textures.
constexpr std::array<Name, 5> kShapeProperties{
    "face_normals", "flip_normals", "flip_tex_coords", "max_smooth_angle", "smooth_normals"};

// Mitsuba's properties of kBsdfTypes.
constexpr std::array<Name, 43> kBsdfProperties{"alpha",
                                               "alpha_u",
                                               "alpha_v",
                                               "anisotropic",
                                               "base_color",
                                               "clearcoat",
                                               "clearcoat_gloss",
                                               "color",
                                               "diff_trans",
                                               "diffuse_reflectance",
                                               "distribution",
                                               "eta",
                                               "exponent",
                                               "ext_eta",
                                               "ext_ior",
                                               "filename",
                                               "flatness",
                                               "int_ior",
                                               "k",
                                               "metallic",
                                               "nonlinear",
                                               "normalmap",
                                               "opacity",
                                               "reflectance",
                                               "roughness",
                                               "sample_visible",
                                               "scale",
                                               "sheen",
                                               "sheen_tint",
                                               "spec_tint",
                                               "spec_trans",
                                               "specular",
                                               "specular_reflectance",
                                               "specular_transmittance",
                                               "theta",
                                               "delta",
                                               "transmittance",
                                               "variant",
                                               "weight",
                                               "longitudinal_roughness",
                                               "azimuthal_roughness",
                                               "scale_tilt",
                                               "wavelength"};

// Prefixes of Mitsuba's properties of bsdfs with layers.
constexpr std::array<Name, 9> kBsdfPrefixes{"base_",
                                            "coat_",
                                            "emission_",
                                            "fuzz_",
                                            "geometry_",
                                            "specular_",
                                            "subsurface_",
                                            "thin_film_",
                                            "transmission_"};

constexpr Name kSamplingRate = "_sampling_rate";  // of the principled ones

// Mitsuba 0.6 wrote "intIOR" instead of "int_ior".
std::string without_style(Name name) {
  std::string plain;
  for (const char c : name) {
    if (c != '_') {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return plain;
}

bool is_one_of(std::span<const Name> names, Name name) {
  const std::string plain = without_style(name);
  return std::any_of(
      names.begin(), names.end(), [&](Name known) { return without_style(known) == plain; });
}

}  // namespace

std::span<const Name> visual_tags() { return kTags; }
std::span<const Name> visual_bsdf_tags() { return kBsdfTags; }
std::span<const Name> visual_bsdf_types() { return kBsdfTypes; }
std::span<const Name> visual_shape_properties() { return kShapeProperties; }
std::span<const Name> visual_bsdf_properties() { return kBsdfProperties; }
std::span<const Name> visual_bsdf_prefixes() { return kBsdfPrefixes; }

bool is_visual_of_shape(Name name) { return is_one_of(kShapeProperties, name); }

bool is_visual_of_bsdf(Name name) {
  return is_one_of(kBsdfProperties, name) || name.ends_with(kSamplingRate) ||
         std::any_of(kBsdfPrefixes.begin(), kBsdfPrefixes.end(), [&](Name prefix) {
           return name.starts_with(prefix);
         });
}

}  // namespace rayloc
