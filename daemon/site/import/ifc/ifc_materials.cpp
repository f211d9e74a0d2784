#include "daemon/site/import/ifc/ifc_materials.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "daemon/site/import/ifc/ifc_units.h"
#include "daemon/site/import/ifc/row_of.h"

namespace rayloc {
namespace {

constexpr int kMaxWholes = 8;  // of a part, chosen
// The limit of a material's name, chosen: the standard allows 255 characters. Each element has a
// copy of it.
constexpr std::size_t kMaxNameBytes = 1024;

enum class Choice { kOnly, kFirst, kLargest };

// The next entity on the path to a material: the place of it, or of a list, among the attributes.
struct Member {
  std::string_view type;
  std::size_t at;
  Choice choice;
};
constexpr std::array kMembers = {
    Member{"IFCMATERIALLAYERSETUSAGE", 0, Choice::kOnly},
    Member{"IFCMATERIALLAYER", 0, Choice::kOnly},
    Member{"IFCMATERIALLAYERWITHOFFSETS", 0, Choice::kOnly},
    Member{"IFCMATERIALLAYERSET", 0, Choice::kLargest},
    Member{"IFCMATERIALLIST", 0, Choice::kFirst},
    // IFC 4
    Member{"IFCMATERIALCONSTITUENTSET", 2, Choice::kLargest},
    Member{"IFCMATERIALCONSTITUENT", 2, Choice::kOnly},
    Member{"IFCMATERIALPROFILESETUSAGE", 0, Choice::kOnly},
    Member{"IFCMATERIALPROFILESETUSAGETAPERING", 0, Choice::kOnly},
    Member{"IFCMATERIALPROFILESET", 2, Choice::kFirst},
    Member{"IFCMATERIALPROFILE", 2, Choice::kOnly},
    Member{"IFCMATERIALPROFILEWITHOFFSETS", 2, Choice::kOnly},
};

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
      elements.try_emplace(step_string(items[0]),
                           IfcElement{step_string(items[2]), material_name(material(entity.id))});
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

  // Many elements have the same material.
  const std::string& material_name(std::uint64_t id) {
    const auto [name, is_new] = names_.try_emplace(id);
    if (is_new) {
      name->second = read_name(id);
    }
    return name->second;
  }

  std::string read_name(std::uint64_t id) {
    constexpr int kDeepest = 4;  // usage, set, layer, material
    for (int depth = 0; depth < kDeepest; ++depth) {
      const auto found = step_.find(id);
      if (!found) {
        return "";
      }
      const StepEntity& entity = step_.entities()[*found];
      if (step_.type(entity) == "IFCMATERIAL") {
        const auto items = step_items(step_.arguments(entity));
        std::string name = items.empty() ? "" : step_string(items[0]);
        return name.size() <= kMaxNameBytes ? name : "";
      }
      const auto [member, is_new] = member_of_.try_emplace(id);
      if (is_new) {
        member->second = read_member(entity);
      }
      id = member->second;
    }
    return "";
  }

  // The entity that has the name; 0: none.
  std::uint64_t read_member(const StepEntity& entity) {
    const Member* const row = row_of(kMembers, step_.type(entity));
    const auto items = step_items(step_.arguments(entity));
    if (row == nullptr || items.size() <= row->at) {
      return 0;
    }
    if (row->choice == Choice::kOnly) {
      return step_reference(items[row->at]);
    }
    const auto members = step_items(items[row->at]);
    if (row->choice == Choice::kFirst) {
      return members.empty() ? 0 : step_reference(members[0]);
    }
    return largest(members);
  }

  std::uint64_t largest(const std::vector<std::string_view>& members) {
    double most = -1.0;
    std::uint64_t largest = 0;
    for (const std::string_view member : members) {
      const std::uint64_t id = step_reference(member);
      const auto [size, is_new] = size_of_.try_emplace(id);
      if (is_new) {
        size->second = read_size(id);
      }
      if (size->second > most) {
        most = size->second;
        largest = id;
      }
    }
    return largest;
  }

  // The thickness of a layer, the fraction of a constituent (0 if it is not stated). Below any of
  // these if the entity is neither, or air: without a material.
  double read_size(std::uint64_t id) const {
    constexpr double kNone = -2.0;
    const auto found = step_.find(id);
    const std::string_view type = found ? step_.type(step_.entities()[*found]) : "";
    const bool is_constituent = type == "IFCMATERIALCONSTITUENT";
    if (!is_constituent && type != "IFCMATERIALLAYER" && type != "IFCMATERIALLAYERWITHOFFSETS") {
      return kNone;
    }
    const std::size_t material = is_constituent ? 2 : 0;
    const auto items = step_items(step_.arguments(step_.entities()[*found]));
    if (items.size() < material + 2 || step_reference(items[material]) == 0) {
      return kNone;
    }
    return ifc_measure(items[material + 1]);
  }

  const StepText& step_;
  Relations material_of_;
  Relations type_of_;
  Relations whole_of_;
  // Each entity is read once, for files with many references to a long one.
  std::unordered_map<std::uint64_t, std::string> names_;
  Relations member_of_;
  std::unordered_map<std::uint64_t, double> size_of_;
};

}  // namespace

std::map<std::string, IfcElement, std::less<>> ifc_elements(const StepText& step) {
  return MaterialReader(step).read();
}

}  // namespace rayloc
