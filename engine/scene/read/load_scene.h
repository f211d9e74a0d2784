// load_scene: reads a scene file, as Sionna RT and Mitsuba write it, into a Scene. The only part of
// the engine that reads files.
//
// Mitsuba XML with <shape type="ply|obj|cube|rectangle">, mesh paths relative to the XML file,
// <transform name="to_world">, <default>. A material is that of the shape's <bsdf> or <ref>:
//   - an id "mat-itu_NAME" or "itu_NAME": ITU-R P.2040-4, or its <string name="type"> beside;
//   - <bsdf type="itu-radio-material"> with <string name="type">;
//   - <bsdf type="radio-material"> with <float name="relative_permittivity"|"conductivity">;
// each with <float name="thickness">, 0.1 m without, and Sionna RT's scattering_coefficient,
// xpd_coefficient, scattering_pattern, alpha_r, alpha_i and lambda_, and also inside
// <bsdf type="twosided">. The
// material's name is the id without "mat-" and "itu_", the object's name the shape's id without
// "mesh-".
//
// Any part of the file that is not read is an error, except visual properties (visual_names.h).
// Every error states file:line:column, the fault and the remedy; all errors of the XML are reported
// together, one per line. Notes on a scene that was read are in Scene::notes().
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc {

// Values that replace those of the scene file or of the ITU table.
struct RadioMaterialOverride {
  std::optional<double> relative_permittivity;
  std::optional<double> conductivity;  // [S/m]
  std::optional<double> thickness;     // [m]
  std::optional<double> scattering_coefficient = {};
  std::optional<double> xpd_coefficient = {};
};

struct SceneOptions {
  double carrier_hz = 0.0;  // frequency of the materials
  // By material name ("concrete"). A name that no shape of the scene uses is an error.
  std::map<std::string, RadioMaterialOverride> materials;
};

Expected<Scene> load_scene(const std::filesystem::path& file, const SceneOptions& options);

// The same from memory: `xml_name` denotes the file in errors, `read_mesh` returns the bytes of a
// mesh file named in the XML.
using ReadFile = std::function<Expected<std::string>(const std::string& name)>;
Expected<Scene> parse_scene(std::string_view xml,
                            const std::string& xml_name,
                            const SceneOptions& options,
                            const ReadFile& read_mesh);

}  // namespace rayloc
