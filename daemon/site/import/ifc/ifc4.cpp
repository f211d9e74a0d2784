#include "daemon/site/import/ifc/ifc4.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/ifc/ifc4_rules.h"
#include "daemon/site/import/ifc/ifc4_shapes.h"
#include "daemon/site/import/ifc/ifc_materials.h"
#include "daemon/site/import/ifc/ifc_types.h"
#include "daemon/site/import/ifc/row_of.h"

namespace rayloc {
namespace {

// Places among the attributes of IfcProduct.
constexpr std::size_t kPlacement = 5;
constexpr std::size_t kShape = 6;
constexpr std::size_t kTag = 7;

// The string as the file writes it; $ for another value.
std::string_view string_or_none(std::string_view item) {
  return item.starts_with('\'') ? item : "$";
}

// Elements that lack a shape for one cause.
struct Missing {
  std::size_t count = 0;
  std::string first;  // "#12 'Chair'"
};

class Ifc4Conversion {
 public:
  Ifc4Conversion(const StepText& step, const std::string& file)
      : step_(step), file_(file), shapes_(step, file) {}

  Expected<Ifc4Text> read() {
    owner_ = fmt::format("#{}", shapes_.add(1, "IFCOWNERHISTORY", "($,$,$,.ADDED.,$,$,$,0)"));
    RAYLOC_TRY(read_project());
    for (const StepEntity& entity : step_.entities()) {
      RAYLOC_TRY(read_product(entity));
    }
    for (const StepEntity& entity : step_.entities()) {
      RAYLOC_TRY(read_relation(entity));
      read_style(entity);
    }
    Ifc4Text text;
    text.remarks = remarks();
    text.shaped = std::move(shaped_);
    text.step = shapes_.finish();
    return text;
  }

 private:
  IfcItems items_of(const StepEntity& entity) const { return step_items(step_.arguments(entity)); }

  // Null: the value is no reference to an entity.
  const StepEntity* entity_of(std::string_view reference) const {
    const auto found = step_.find(step_reference(reference));
    return found ? &step_.entities()[*found] : nullptr;
  }

  Expected<void> read_project() {
    const auto& all = step_.entities();
    const auto project = std::find_if(all.begin(), all.end(), [&](const StepEntity& entity) {
      return step_.type(entity) == "IFCPROJECT";
    });
    if (project == all.end()) {
      return bad_input(file_ + ": has no IfcProject; export it again");
    }
    const IfcItems items = items_of(*project);
    constexpr std::size_t kContexts = 7;
    constexpr std::size_t kUnits = 8;
    if (items.size() <= kUnits) {
      return shapes_.refuse(*project, "has too few attributes");
    }
    RAYLOC_TRY(read_context(items[kContexts]));
    const std::string units = read_units(items[kUnits], project->line);
    shapes_.add_as(*project,
                   "IFCPROJECT",
                   fmt::format("({},{},$,$,$,$,$,({}),{})",
                               string_or_none(items[0]),
                               owner_,
                               shapes_.context(),
                               units));
    written_.insert(project->id);
    return {};
  }

  // The coordinates of the context of the model.
  Expected<void> read_context(std::string_view contexts) {
    std::uint64_t placement = 0;
    for (const std::string_view one : step_items(contexts)) {
      const StepEntity* const context = entity_of(one);
      if (context == nullptr || step_.type(*context) != "IFCGEOMETRICREPRESENTATIONCONTEXT") {
        continue;
      }
      const IfcItems items = items_of(*context);
      constexpr std::size_t kCoordinates = 4;
      if (items.size() > kCoordinates && step_string(items[1]) == "Model" &&
          items[kCoordinates] != "$") {
        const auto read = shapes_.read(items[kCoordinates], *context, "AB");
        RAYLOC_TRY(read);
        placement = read->kind == 'A' ? read->id : 0;
        break;
      }
    }
    shapes_.set_context(placement);
    return {};
  }

  // "#9": the units of lengths and angles.
  std::string read_units(std::string_view reference, std::uint32_t line) {
    std::string length;
    std::string angle;
    const StepEntity* const all = entity_of(reference);
    const IfcItems items = all != nullptr ? items_of(*all) : IfcItems{};
    for (const std::string_view one : items.empty() ? items : step_items(items[0])) {
      const StepEntity* const unit = entity_of(one);
      const IfcItems own = unit != nullptr ? items_of(*unit) : IfcItems{};
      if (own.size() < 4) {
        continue;
      }
      if (own[1] == ".LENGTHUNIT.") {
        length = read_unit(*unit, own);
      } else if (own[1] == ".PLANEANGLEUNIT." && step_.type(*unit) != "IFCSIUNIT") {
        angle = read_unit(*unit, own);
      }
    }
    if (length.empty()) {
      length = fmt::format("#{}", shapes_.add(line, "IFCSIUNIT", "(*,.LENGTHUNIT.,$,.METRE.)"));
    }
    if (angle.empty()) {
      // assimp takes radians for negative ones unless they are a converted unit.
      const auto radian = shapes_.add(line, "IFCSIUNIT", "(*,.PLANEANGLEUNIT.,$,.RADIAN.)");
      angle = add_converted(
          line, ".PLANEANGLEUNIT.", fmt::format("(IFCPLANEANGLEMEASURE(1.),#{})", radian));
    }
    return fmt::format(
        "#{}", shapes_.add(line, "IFCUNITASSIGNMENT", fmt::format("(({},{}))", length, angle)));
  }

  // "#9": `measure` are the attributes of its IFCMEASUREWITHUNIT.
  std::string add_converted(std::uint32_t line, std::string_view kind, const std::string& measure) {
    const auto with = shapes_.add(line, "IFCMEASUREWITHUNIT", measure);
    const auto exponents = shapes_.add(line, "IFCDIMENSIONALEXPONENTS", "(0,0,0,0,0,0,0)");
    return fmt::format("#{}",
                       shapes_.add(line,
                                   "IFCCONVERSIONBASEDUNIT",
                                   fmt::format("(#{},{},'unit',#{})", exponents, kind, with)));
  }

  // Empty: another form of a unit. `items`: four or more.
  std::string read_unit(const StepEntity& unit, const IfcItems& items) {
    if (step_.type(unit) == "IFCSIUNIT") {
      return fmt::format(
          "#{}",
          shapes_.add(
              unit.line, "IFCSIUNIT", fmt::format("(*,{},{},{})", items[1], items[2], items[3])));
    }
    const StepEntity* const factor = entity_of(items[3]);
    const IfcItems measure = factor != nullptr ? items_of(*factor) : IfcItems{};
    const StepEntity* const base = measure.size() > 1 ? entity_of(measure[1]) : nullptr;
    const IfcItems own = base != nullptr ? items_of(*base) : IfcItems{};
    if (!step_.type(unit).starts_with("IFCCONVERSIONBASEDUNIT") || own.size() < 4 ||
        step_.type(*base) != "IFCSIUNIT") {
      return "";
    }
    return add_converted(
        unit.line, items[1], fmt::format("({},{})", measure[0], read_unit(*base, own)));
  }

  // An element of the building: by its row, else by its attributes.
  bool is_product(std::string_view type, const IfcItems& items, const Ifc4Product* row) const {
    if (items.size() <= kTag || is_immaterial_ifc4(type) || !items[0].starts_with('\'')) {
      return false;
    }
    const StepEntity* const placement = entity_of(items[kPlacement]);
    const StepEntity* const shape = entity_of(items[kShape]);
    const bool has_placement =
        placement != nullptr && step_.type(*placement).ends_with("PLACEMENT");
    const bool has_shape = shape != nullptr && step_.type(*shape) == "IFCPRODUCTDEFINITIONSHAPE";
    return row != nullptr || ((has_placement || items[kPlacement] == "$") &&
                              (has_shape || items[kShape] == "$") && (has_placement || has_shape));
  }

  Expected<void> read_product(const StepEntity& entity) {
    const std::string_view type = step_.type(entity);
    const Ifc4Product* const row = ifc4_product(type);
    // Most entities are points and faces, which have fewer attributes.
    if (row == nullptr &&
        (ifc4_rule(type) != nullptr || !step_.arguments(entity).starts_with("('"))) {
      return {};
    }
    const IfcItems items = items_of(entity);
    if (row != nullptr && items.size() <= kTag) {
      return shapes_.refuse(entity, "has too few attributes");
    }
    if (!is_product(type, items, row)) {
      return {};
    }
    constexpr std::string_view kOther = "IFCBUILDINGELEMENTPROXY";
    const std::string_view written = row == nullptr         ? kOther
                                     : row->written.empty() ? type
                                                            : row->written;
    std::string placement = "$";
    if (items[kPlacement] != "$") {
      const auto read = shapes_.read(items[kPlacement], entity, "N");
      RAYLOC_TRY(read);
      if (read->id == 0) {
        note_missing(entity, items, read->cause);
        return {};
      }
      placement = fmt::format("#{}", read->id);
    }
    const auto shape = read_shape(entity, items, written);
    RAYLOC_TRY(shape);
    shapes_.add_as(entity,
                   written,
                   fmt::format("({},{},{},$,$,{},{},${})",
                               items[0],
                               owner_,
                               string_or_none(items[2]),
                               placement,
                               *shape,
                               row == nullptr ? ",$" : row->rest));
    written_.insert(entity.id);
    return {};
  }

  // "#7", or "$".
  Expected<std::string> read_shape(const StepEntity& entity,
                                   const IfcItems& items,
                                   std::string_view written) {
    if (items[kShape] == "$" || written == "IFCSPACE") {
      return "$";
    }
    const auto shape = shapes_.read(items[kShape], entity, "Q");
    RAYLOC_TRY(shape);
    if (!shape->cause.empty() && shape->cause != kNoIfc4Surface) {
      note_missing(entity, items, shape->cause);
    }
    if (shape->id == 0) {
      return "$";
    }
    if (written != "IFCOPENINGELEMENT") {
      shaped_.insert(step_string(items[0]));
      if (!shape->is_swept) {
        uncut_.insert(entity.id);
      }
    } else {
      openings_.insert(entity.id);
    }
    return fmt::format("#{}", shape->id);
  }

  Expected<void> read_relation(const StepEntity& entity) {
    const IfcPartsRelation* relation = row_of(kIfcPartsRelations, step_.type(entity));
    if (relation == nullptr) {
      return {};
    }
    const IfcItems items = items_of(entity);
    if (items.size() <= std::max(relation->whole, relation->parts)) {
      return shapes_.refuse(entity, "has too few attributes");
    }
    std::string parts;
    std::uint64_t bad = 0;
    const std::uint64_t whole = step_reference(items[relation->whole]);
    const auto check = [&](std::uint64_t id) { bad = step_.find(id) ? bad : id; };
    check(whole);
    each_step_reference(items[relation->parts], [&](std::uint64_t id) {
      check(id);
      if (written_.contains(id)) {
        parts += fmt::format("{}#{}", parts.empty() ? "" : ",", id);
      }
    });
    if (bad != 0 || whole == 0) {
      return shapes_.refuse(entity, fmt::format("refers to #{}, which does not exist", bad));
    }
    if (!written_.contains(whole) || parts.empty()) {
      return {};
    }
    const bool is_void = relation->type == "IFCRELVOIDSELEMENT";
    if (is_void && uncut_.contains(whole) && openings_.contains(step_reference(parts))) {
      ++uncut_openings_;
    }
    const std::string list = is_void ? parts : "(" + parts + ")";
    const std::string both = relation->whole < relation->parts ? fmt::format("#{},{}", whole, list)
                                                               : fmt::format("{},#{}", list, whole);
    shapes_.add_as(entity,
                   relation->type,
                   fmt::format("({},{},$,$,{})", string_or_none(items[0]), owner_, both));
    return {};
  }

  // The name of a surface style is the material of an element that states none.
  void read_style(const StepEntity& entity) {
    if (step_.type(entity) != "IFCSTYLEDITEM") {
      return;
    }
    const IfcItems items = items_of(entity);
    const auto item = items.size() > 1 ? step_.find(step_reference(items[0])) : std::nullopt;
    if (!item || shapes_.shape(*item).id != step_.entities()[*item].id) {
      return;
    }
    const std::string_view name = surface_name(step_items(items[1]), true);
    if (name.empty()) {
      return;
    }
    std::string& style = styles_[name];
    if (style.empty()) {
      if (shading_.empty()) {
        const auto grey = shapes_.add(1, "IFCCOLOURRGB", "($,0.5,0.5,0.5)");
        shading_ = fmt::format(
            "#{}", shapes_.add(1, "IFCSURFACESTYLESHADING", fmt::format("(#{})", grey)));
      }
      std::string text(name);
      std::replace(text.begin(), text.end(), ' ', '_');  // assimp removes spaces
      const auto surface = shapes_.add(
          entity.line, "IFCSURFACESTYLE", fmt::format("({},.BOTH.,({}))", text, shading_));
      style = fmt::format(
          "#{}",
          shapes_.add(
              entity.line, "IFCPRESENTATIONSTYLEASSIGNMENT", fmt::format("((#{}))", surface)));
    }
    shapes_.add_as(entity, "IFCSTYLEDITEM", fmt::format("({},({}),$)", items[0], style));
  }

  // With its quotes; empty: none. `may_be_assigned`: the styles may be in an assignment.
  std::string_view surface_name(const IfcItems& styles, bool may_be_assigned) {
    for (const std::string_view one : styles) {
      const auto [name, is_new] = surface_names_.try_emplace(step_reference(one));
      if (is_new) {
        const StepEntity* const style = entity_of(one);
        const std::string_view type = style != nullptr ? step_.type(*style) : "";
        const IfcItems items = style != nullptr ? items_of(*style) : IfcItems{};
        if (type == "IFCSURFACESTYLE" && !items.empty() && items[0].starts_with('\'')) {
          name->second = items[0];
        } else if (type == "IFCPRESENTATIONSTYLEASSIGNMENT" && may_be_assigned && !items.empty()) {
          const std::string_view assigned = surface_name(step_items(items[0]), false);
          surface_names_[step_reference(one)] = assigned;
        }
      }
      if (const std::string_view found = surface_names_[step_reference(one)]; !found.empty()) {
        return found;
      }
    }
    return "";
  }

  void note_missing(const StepEntity& entity, const IfcItems& items, std::string_view cause) {
    Missing& missing = missing_[cause];
    if (missing.count++ == 0) {
      constexpr std::size_t kMaxName = 60;
      std::string name = step_string(items[2]);
      name = name.size() > kMaxName ? "" : name;
      missing.first = fmt::format(
          "#{} {}{}", entity.id, step_.type(entity), name.empty() ? "" : " '" + name + "'");
    }
  }

  std::vector<std::string> remarks() const {
    std::vector<std::string> texts;
    std::size_t count = 0;
    for (const auto& [cause, missing] : missing_) {
      count += missing.count;
      texts.push_back(fmt::format("{} with {} (first {})", missing.count, cause, missing.first));
    }
    std::vector<std::string> remarks;
    if (count > 0) {
      constexpr std::size_t kMaxTypes = 20;
      const std::size_t more = texts.size() - std::min(texts.size(), kMaxTypes);
      texts.resize(texts.size() - more);
      remarks.push_back(fmt::format(
          "warning: elements without their shape, or without a part of it, because of entities "
          "that "
          "are not read: {} ({}{}); export them as faces (IFC 4 Reference View), as IFC 2x3, or as "
          "GLB",
          count,
          fmt::join(texts, ", "),
          more > 0 ? fmt::format(" and {} more types", more) : ""));
    }
    if (uncut_openings_ > 0) {
      remarks.push_back(
          fmt::format("warning: openings that are not cut, because the shape of their element is "
                      "no extrusion: {}; "
                      "export the shapes with their openings (IFC 4 Reference View)",
                      uncut_openings_));
    }
    return remarks;
  }

  const StepText& step_;
  const std::string& file_;
  Ifc4Shapes shapes_;
  std::string owner_;    // "#1"
  std::string shading_;  // same; empty: not yet needed
  std::map<std::string_view, std::string> styles_;
  std::unordered_map<std::uint64_t, std::string_view> surface_names_;  // by the id of the style
  std::unordered_set<std::uint64_t> written_;  // the project and its products
  std::unordered_set<std::uint64_t> uncut_;    // products from which assimp cuts no openings
  std::unordered_set<std::uint64_t> openings_;
  std::size_t uncut_openings_ = 0;
  std::set<std::string, std::less<>> shaped_;
  std::map<std::string_view, Missing> missing_;
};

}  // namespace

bool is_ifc4(const StepText& step) { return step.schema().starts_with("IFC4"); }

Expected<Ifc4Text> ifc4_as_2x3(const StepText& step, const std::string& file) {
  return Ifc4Conversion(step, file).read();
}

}  // namespace rayloc
