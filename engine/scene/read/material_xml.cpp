#include "engine/scene/read/material_xml.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <span>
#include <utility>

#include "engine/base/suggestion.h"
#include "engine/scene/read/visual_names.h"

namespace rayloc {
namespace {

constexpr std::string_view kMaterialPrefix = "mat-";  // prefix of ids from Mitsuba's exporters
constexpr std::string_view kItuPrefix = "itu_";  // prefix of ITU-R P.2040-4 materials in Sionna RT
constexpr std::string_view kRadio = "radio-material";         // a type of bsdf of Sionna RT
constexpr std::string_view kItuRadio = "itu-radio-material";  // a type of bsdf of Sionna RT
constexpr std::size_t kMaxLevels = 64;  // of nested bsdfs; files have two or three

std::string_view without_prefix(std::string_view text, std::string_view prefix) {
  return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
}

// "concrete" of "mat-itu_concrete"; "" for an id that names no ITU material.
std::string_view itu_id(std::string_view id) {
  const std::string_view bare = without_prefix(id, kMaterialPrefix);
  return bare.starts_with(kItuPrefix) ? bare.substr(kItuPrefix.size()) : std::string_view();
}

bool is_itu_material(const std::string& name) {
  const auto names = itu_material_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_left_out_of_conductor(std::string_view name) {
  return is_visual_of_bsdf(name) || name == "material";  // the metal of the colour
}

// The outermost of several statements is used; a different one beside it is a mistake.
template <typename T>
void keep(XmlElement& element,
          std::string_view name,
          std::optional<T> found,
          std::optional<T>& kept) {
  if (found && kept && *found != *kept) {
    element.refuse(name, "is stated in another <bsdf> of this material with another value");
  } else if (found) {
    kept = std::move(found);
  }
}

// Values stated by the user take precedence.
void replace(const RadioMaterialOverride& by, RadioMaterial& material) {
  const auto set = [](const std::optional<double>& value, double& number) {
    number = value.value_or(number);
  };
  set(by.relative_permittivity, material.relative_permittivity);
  set(by.conductivity, material.conductivity);
  set(by.thickness, material.thickness);
  set(by.scattering_coefficient, material.scattering.scattering_coefficient);
  set(by.xpd_coefficient, material.scattering.xpd_coefficient);
}

}  // namespace

std::string material_name(std::string_view id) {
  return std::string(without_prefix(without_prefix(id, kMaterialPrefix), kItuPrefix));
}

bool MaterialReader::is_overridden(const std::string& name) const {
  const auto found = options_.materials.find(name);
  return found != options_.materials.end() && found->second.relative_permittivity &&
         found->second.conductivity;
}

// The <bsdf> and all within it, also by <ref>, from the outermost inwards, each once.
std::vector<pugi::xml_node> MaterialReader::levels_of(const pugi::xml_node& bsdf) const {
  std::vector<pugi::xml_node> levels{bsdf};
  std::set<std::ptrdiff_t> seen{bsdf.offset_debug()};
  const auto add = [&](const pugi::xml_node& found) {
    if (levels.size() < kMaxLevels && seen.insert(found.offset_debug()).second) {
      levels.push_back(found);
    }
  };
  for (std::size_t next = 0; next < levels.size();) {
    const pugi::xml_node level = levels[next++];
    for (const pugi::xml_node& child : level.children()) {
      const std::string_view tag = child.name();
      if (tag == "bsdf") {
        add(child);
      } else if (tag == "ref") {
        if (const auto named = bsdfs_.find(child.attribute("id").value()); named != bsdfs_.end()) {
          add(named->second);
        }
      }
    }
  }
  return levels;
}

BsdfKind MaterialReader::kind_of(const pugi::xml_node& bsdf) const {
  bool is_null = false;
  bool is_seen = false;
  for (const pugi::xml_node& level : levels_of(bsdf)) {
    const std::string_view type = level.attribute("type").value();
    const std::string_view id = level.attribute("id").value();
    if (!itu_id(id).empty() || options_.materials.contains(material_name(id)) ||
        !is_listed(visual_bsdf_types(), type)) {
      return BsdfKind::kRadio;
    }
    const bool is_around_others = level.child("bsdf") || level.child("ref");
    is_null = is_null || type == "null";
    is_seen = is_seen || (type != "null" && !is_around_others);
  }
  return is_null && !is_seen ? BsdfKind::kNull : BsdfKind::kVisual;
}

std::optional<RadioMaterial> MaterialReader::read(const pugi::xml_node& bsdf,
                                                  const std::string& user) {
  const std::vector<pugi::xml_node> levels = levels_of(bsdf);
  Stated stated = named(levels, user);
  if (levels.size() == kMaxLevels) {
    file_.complain(bsdf, "material '" + stated.name + "' is made of too many <bsdf>s");
    return std::nullopt;
  }
  for (const pugi::xml_node& level : levels) {
    read_level(level, stated);
  }
  Expected<RadioMaterial> material = RadioMaterial{};
  if (!is_overridden(stated.name)) {
    material = material_of(stated, bsdf);
  }
  if (!material) {
    file_.complain(bsdf, "material '" + stated.name + "': " + material.error().message);
    return std::nullopt;
  }
  const auto scattering = scattering_of(stated, bsdf);
  if (!scattering) {
    file_.complain(bsdf, "material '" + stated.name + "': " + scattering.error().message);
    return std::nullopt;
  }
  material->scattering = *scattering;
  material->name = stated.name;
  material->thickness = stated.thickness.value_or(kDefaultThickness);
  if (const auto found = options_.materials.find(stated.name); found != options_.materials.end()) {
    replace(found->second, *material);
  }
  if (auto valid = validate(*material); !valid) {
    file_.complain(bsdf, valid.error().message);
    return std::nullopt;
  }
  return *std::move(material);
}

MaterialReader::Stated MaterialReader::named(const std::vector<pugi::xml_node>& levels,
                                             const std::string& user) const {
  Stated stated;
  for (const pugi::xml_node& level : levels) {
    const std::string_view id = level.attribute("id").value();
    const std::string_view itu = itu_id(id);
    stated.name = stated.name.empty() ? material_name(id) : stated.name;
    if (stated.itu_id.empty()) {
      stated.itu_id = itu;
    } else if (!itu.empty() && itu != stated.itu_id &&
               itu_id(levels[0].attribute("id").value()).empty()) {
      stated.other_itu_id = itu;
    }
  }
  stated.name = stated.name.empty() ? user : stated.name;
  return stated;
}

void MaterialReader::read_level(const pugi::xml_node& bsdf, Stated& stated) {
  XmlElement element(file_, bsdf, "material '" + stated.name + "'");
  const std::string type = element.attribute("type");
  element.attribute("id");
  element.attribute("name");
  check_type(element, type, stated);
  check_references(bsdf);
  stated.radio_material = stated.radio_material || type == kRadio;
  stated.itu_radio_material = stated.itu_radio_material || type == kItuRadio;
  read_properties(element, type, stated);
  element.allow_tags({"bsdf", "ref"});
  element.allow_tags(visual_bsdf_tags());
  element.leave_out(type.ends_with("conductor") ? is_left_out_of_conductor : is_visual_of_bsdf);
  element.finish();
}

void MaterialReader::check_type(XmlElement& element,
                                const std::string& type,
                                const Stated& stated) {
  if (type == kRadio || type == kItuRadio || is_listed(visual_bsdf_types(), type) ||
      !file_.listens()) {
    return;
  }
  const std::string_view close = closest_name(type, visual_bsdf_types());
  element.complain("the type '" + type + "' of the material '" + stated.name + "' is not known" +
                   (close.empty() ? "; write radio-material for one with values of its own, "
                                    "itu-radio-material for one of ITU-R P.2040-4"
                                  : "; did you mean '" + std::string(close) + "'?"));
}

void MaterialReader::check_references(const pugi::xml_node& bsdf) {
  for (const pugi::xml_node& reference : bsdf.children("ref")) {
    XmlElement element(file_, reference, {});
    const std::string id = element.attribute("id");
    element.attribute("name");
    element.finish();
    // A texture's reference has a role: "reflectance".
    const std::string_view role = reference.attribute("name").value();
    if (file_.listens() && !bsdfs_.contains(id) && (role.empty() || role == "bsdf")) {
      std::vector<std::string> ids;
      for (const auto& [known, node] : bsdfs_) {
        ids.push_back(known);
      }
      element.complain("there is no <bsdf> with the id '" + id + "'" + suggestion(id, ids));
    }
  }
}

void MaterialReader::read_properties(XmlElement& element, const std::string& type, Stated& stated) {
  const auto permittivity = element.number("relative_permittivity");
  const auto conductivity = element.number("conductivity");
  const auto itu_type = element.text("type");
  keep(element, "thickness", element.number("thickness"), stated.thickness);
  read_scattering(element, stated);
  if (type == kRadio) {
    keep(element, "relative_permittivity", permittivity, stated.permittivity);
    keep(element, "conductivity", conductivity, stated.conductivity);
    element.refuse("type", "is of the type itu-radio-material only");
    return;
  }
  keep(element, "type", itu_type, stated.itu_type);
  for (const char* value : {"relative_permittivity", "conductivity"}) {
    element.refuse(value, "is of the type radio-material only; this <bsdf> is a '" + type + "'");
  }
}

void MaterialReader::read_scattering(XmlElement& element, Stated& stated) {
  keep(element,
       "scattering_coefficient",
       element.number("scattering_coefficient"),
       stated.scattering);
  keep(element, "xpd_coefficient", element.number("xpd_coefficient"), stated.xpd);
  keep(element, "scattering_pattern", element.text("scattering_pattern"), stated.pattern);
  keep(element, "alpha_r", element.whole_or_number("alpha_r"), stated.alpha_r);
  keep(element, "alpha_i", element.whole_or_number("alpha_i"), stated.alpha_i);
  keep(element, "lambda_", element.number("lambda_"), stated.lambda);
}

Expected<SurfaceScattering> MaterialReader::scattering_of(const Stated& stated,
                                                          const pugi::xml_node& bsdf) {
  SurfaceScattering scattering;
  scattering.scattering_coefficient = stated.scattering.value_or(0.0);
  scattering.xpd_coefficient = stated.xpd.value_or(0.0);
  const std::string pattern = stated.pattern.value_or("lambertian");
  const auto known =
      std::find(kScatteringPatternNames.begin(), kScatteringPatternNames.end(), pattern);
  if (known == kScatteringPatternNames.end()) {
    return bad_input(
        "there is no scattering_pattern '" + pattern + "'" +
        suggestion(pattern, std::span<const std::string_view>(kScatteringPatternNames)));
  }
  scattering.pattern = static_cast<ScatteringPattern>(known - kScatteringPatternNames.begin());
  const bool has_lobe = scattering.pattern != ScatteringPattern::kLambertian;
  const bool has_back = scattering.pattern == ScatteringPattern::kBackscattering;
  if ((has_lobe && !stated.alpha_r) || (has_back && !(stated.alpha_i && stated.lambda))) {
    return bad_input("the scattering_pattern '" + pattern +
                     (has_back ? "' needs alpha_r, alpha_i and lambda_" : "' needs alpha_r"));
  }
  scattering.alpha_r = has_lobe ? *stated.alpha_r : scattering.alpha_r;
  scattering.alpha_i = has_back ? *stated.alpha_i : scattering.alpha_i;
  scattering.lambda = has_back ? *stated.lambda : scattering.lambda;
  if (scattering.is_rough()) {
    note(bsdf,
         stated,
         "its scattering_coefficient counts for what is asked to trace diffuse scattering "
         "(--diffuse); a location takes the diffuse power of a room from its calibration");
  }
  return scattering;
}

Expected<RadioMaterial> MaterialReader::material_of(const Stated& stated,
                                                    const pugi::xml_node& bsdf) {
  if (stated.radio_material && stated.itu_radio_material) {
    return bad_input("it is a radio-material and an itu-radio-material; leave one of them out");
  }
  if (!stated.other_itu_id.empty()) {
    return bad_input("it is made of '" + stated.itu_id + "' and of '" + stated.other_itu_id +
                     "'; leave one of them out");
  }
  if (stated.radio_material && (stated.permittivity || stated.conductivity)) {
    return of_values(stated, bsdf);
  }
  if (!stated.itu_id.empty() || stated.itu_radio_material) {
    return of_table(stated, bsdf);
  }
  if (stated.radio_material) {
    note(
        bsdf,
        stated,
        "it states neither relative_permittivity nor conductivity: it is read as vacuum, as Sionna "
        "RT does");
    return RadioMaterial{};
  }
  return bad_input(
      "the <bsdf> has no radio properties; use an id mat-itu_NAME with a name of ITU-R P.2040-4, "
      "the type radio-material, or state relative_permittivity and conductivity of the material '" +
      stated.name + "' in the site");
}

Expected<RadioMaterial> MaterialReader::of_values(const Stated& stated,
                                                  const pugi::xml_node& bsdf) {
  RadioMaterial material;
  if (is_itu_material(stated.itu_id)) {
    note(bsdf,
         stated,
         "its id names an ITU material, but it states values of its own, and these are kept; "
         "Sionna RT takes those of the table");
    if (auto of_table = itu_material(stated.itu_id, options_.carrier_hz)) {
      material = *std::move(of_table);
    }
  }
  material.relative_permittivity = stated.permittivity.value_or(material.relative_permittivity);
  material.conductivity = stated.conductivity.value_or(material.conductivity);
  return material;
}

Expected<RadioMaterial> MaterialReader::of_table(const Stated& stated, const pugi::xml_node& bsdf) {
  const std::string& name = stated.itu_type ? *stated.itu_type : stated.itu_id;
  if (name.empty()) {
    return bad_input(R"(an itu-radio-material needs <string name="type" value="NAME"/>)" +
                     suggestion(name, itu_material_names()));
  }
  if (name != stated.itu_id && is_itu_material(stated.itu_id)) {
    note(bsdf,
         stated,
         "its id names the ITU material '" + stated.itu_id + "', its type '" + name + "': '" +
             name + "' is read, as Sionna RT does");
  }
  return itu_material(name, options_.carrier_hz);
}

void MaterialReader::note(const pugi::xml_node& bsdf,
                          const Stated& stated,
                          const std::string& what) {
  notes_.push_back({"material", file_.place(bsdf), "material '" + stated.name + "': " + what});
}

}  // namespace rayloc
