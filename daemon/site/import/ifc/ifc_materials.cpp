#include "daemon/site/import/ifc/ifc_materials.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace rayloc {
namespace {

constexpr int kMaxWholes = 8;  // of a part, chosen

class MaterialReader {
 public:
  explicit MaterialReader(const StepText& step) : step_(step) {}

  std::map<std::string, IfcElement, std::less<>> read() {
    for (const StepEntity& entity : step_.entities()) {
      const std::string_view type = step_.type(entity);
      if (type == "IFCRELASSOCIATESMATERIAL") {
        relate(entity, 4, 5, material_of_);
      } else if (type == "IFCRELDEFINESBYTYPE") {
        relate(entity, 4, 5, type_of_);
      } else if (type == "IFCRELAGGREGATES") {
        relate(entity, 5, 4, whole_of_);
      }
    }
    std::map<std::string, IfcElement, std::less<>> elements;
    for (const StepEntity& entity : step_.entities()) {
      // An element has a GlobalId, an owner and a name.
      const auto items = step_items(step_.arguments(entity));
      if (items.size() < 3 || items[0].size() != kIfcGlobalId + 2 || items[0].front() != '\'') {
        continue;
      }
      elements.try_emplace(
          step_string(items[0]),
          IfcElement{step_string(items[2]), material_name(material(entity.id), 0)});
    }
    return elements;
  }

 private:
  using Relations = std::unordered_map<std::uint64_t, std::uint64_t>;

  // The first relation of an element counts.
  void relate(const StepEntity& entity, std::size_t from, std::size_t to, Relations& relations) {
    const auto items = step_items(step_.arguments(entity));
    if (items.size() <= std::max(from, to)) {
      return;
    }
    const std::uint64_t target = step_reference(items[to]);
    each_step_reference(items[from], [&](std::uint64_t id) { relations.try_emplace(id, target); });
  }

  static std::uint64_t related(const Relations& relations, std::uint64_t id) {
    const auto found = relations.find(id);
    return found == relations.end() ? 0 : found->second;
  }

  // 0: none.
  std::uint64_t material(std::uint64_t element) const {
    for (int above = 0; above <= kMaxWholes && element != 0; ++above) {
      if (const std::uint64_t own = related(material_of_, element); own != 0) {
        return own;
      }
      if (const std::uint64_t its = related(material_of_, related(type_of_, element)); its != 0) {
        return its;
      }
      element = related(whole_of_, element);
    }
    return 0;
  }

  std::string material_name(std::uint64_t id, int depth) const {
    constexpr int kDeepest = 4;  // usage, set, layer, material
    const auto found = step_.find(id);
    if (!found || depth >= kDeepest) {
      return "";
    }
    const StepEntity& entity = step_.entities()[*found];
    const std::string_view type = step_.type(entity);
    const auto items = step_items(step_.arguments(entity));
    if (items.empty()) {
      return "";
    }
    if (type == "IFCMATERIAL") {
      return step_string(items[0]);
    }
    if (type == "IFCMATERIALLAYERSETUSAGE" || type == "IFCMATERIALLAYER") {
      return material_name(step_reference(items[0]), depth + 1);
    }
    const auto members = step_items(items[0]);
    if (members.empty()) {
      return "";
    }
    if (type == "IFCMATERIALLIST") {
      return material_name(step_reference(members[0]), depth + 1);
    }
    return type == "IFCMATERIALLAYERSET" ? material_name(thickest(members), depth + 1) : "";
  }

  std::uint64_t thickest(const std::vector<std::string_view>& layers) const {
    double most = -1.0;
    std::uint64_t thickest = 0;
    for (const std::string_view layer : layers) {
      const auto found = step_.find(step_reference(layer));
      const auto items = found ? step_items(step_.arguments(step_.entities()[*found]))
                               : std::vector<std::string_view>();
      double thickness = 0.0;
      if (items.size() < 2 || step_reference(items[0]) == 0) {
        continue;  // a layer without a material is air
      }
      std::from_chars(items[1].data(), items[1].data() + items[1].size(), thickness);
      if (thickness > most) {
        most = thickness;
        thickest = step_reference(layer);
      }
    }
    return thickest;
  }

  const StepText& step_;
  Relations material_of_;
  Relations type_of_;
  Relations whole_of_;
};

}  // namespace

std::map<std::string, IfcElement, std::less<>> ifc_elements(const StepText& step) {
  return MaterialReader(step).read();
}

}  // namespace rayloc
