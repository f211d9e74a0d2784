// MaterialReader: the radio material of a <bsdf>, as Sionna RT reads it. Internal to load_scene;
// load_scene.h lists the properties that are read.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "engine/em/radio_material.h"
#include "engine/scene/read/load_scene.h"
#include "engine/scene/read/xml_element.h"
#include "engine/scene/read/xml_file.h"
#include "engine/scene/scene_note.h"

namespace rayloc {

// kVisual has no radio properties; kNull is Mitsuba's invisible surface.
enum class BsdfKind { kRadio, kVisual, kNull };

class MaterialReader {
 public:
  using Bsdfs = std::map<std::string, pugi::xml_node>;  // all of the scene, by id

  MaterialReader(XmlFile& file,
                 const SceneOptions& options,
                 const Bsdfs& bsdfs,
                 std::vector<SceneNote>& notes)
      : file_(file), options_(options), bsdfs_(bsdfs), notes_(notes) {}

  BsdfKind kind_of(const pugi::xml_node& bsdf) const;

  // Evaluated at the carrier, with the overrides. Faults are reported as complaints, and the result
  // is empty where nothing can be read. `user` names one whose <bsdf> has no id.
  std::optional<RadioMaterial> read(const pugi::xml_node& bsdf, const std::string& user);

 private:
  // Values stated in the <bsdf> and in those within it.
  struct Stated {
    std::string name;
    // Outermost id "mat-itu_...", a name that the table may not have; and another one, where it is
    // not the id of the whole.
    std::string itu_id, other_itu_id;
    std::optional<double> permittivity, conductivity, thickness;
    std::optional<std::string> itu_type;
    bool radio_material = false;      // contains a <bsdf type="radio-material">
    bool itu_radio_material = false;  // contains an "itu-radio-material"
    std::optional<double> scattering, xpd, alpha_r, alpha_i, lambda;
    std::optional<std::string> pattern;
  };

  std::vector<pugi::xml_node> levels_of(const pugi::xml_node& bsdf) const;
  Stated named(const std::vector<pugi::xml_node>& levels, const std::string& user) const;
  bool is_overridden(const std::string& name) const;
  void read_level(const pugi::xml_node& bsdf, Stated& stated);
  void check_type(XmlElement& element, const std::string& type, const Stated& stated);
  void check_references(const pugi::xml_node& bsdf);
  void read_properties(XmlElement& element, const std::string& type, Stated& stated);
  void read_scattering(XmlElement& element, Stated& stated);
  Expected<SurfaceScattering> scattering_of(const Stated& stated, const pugi::xml_node& bsdf);
  Expected<RadioMaterial> material_of(const Stated& stated, const pugi::xml_node& bsdf);
  Expected<RadioMaterial> of_values(const Stated& stated, const pugi::xml_node& bsdf);
  Expected<RadioMaterial> of_table(const Stated& stated, const pugi::xml_node& bsdf);
  void note(const pugi::xml_node& bsdf, const Stated& stated, const std::string& what);

  XmlFile& file_;
  const SceneOptions& options_;
  const Bsdfs& bsdfs_;
  std::vector<SceneNote>& notes_;
};

// "concrete" of "mat-itu_concrete": the name of the material for people.
std::string material_name(std::string_view id);

}  // namespace rayloc
