#include "daemon/site/import/room_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/site/import/scanned_room.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

using Json = nlohmann::json;

constexpr std::array<int, 2> kVersions = {1, 2};
constexpr double kRigid = 0.01;          // chosen: axes, deviation from unit length and square
constexpr double kFarthest = 1000.0;     // [m], chosen: distance from the start of the scan
constexpr std::size_t kMaxParts = 5000;  // count, chosen: per list
// Keys that are read, and keys without information on the shape of the room.
constexpr std::array<std::string_view, 6> kLists = {
    "walls", "doors", "windows", "openings", "floors", "objects"};
constexpr std::array<std::string_view, 8> kNoShape = {"identifier",
                                                      "version",
                                                      "story",
                                                      "coreModel",
                                                      "referenceOriginTransform",
                                                      "sections",
                                                      "rooms",
                                                      "confidence"};

// In the scan y points up.
Vec3d upright_point(double x, double y, double z) { return {x, -z, y}; }

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

// {"door": {"isOpen": true}}, or "door".
std::string category_of(const Json& item) {
  const auto found = item.find("category");
  if (found == item.end() || !found->is_object() || found->empty()) {
    return text_of(item, "category");
  }
  return found->begin().key();
}

bool is_open_door(const Json& item) {
  const auto category = item.find("category");
  if (category == item.end() || !category->is_object() || !category->contains("door")) {
    return false;
  }
  const Json& door = category->at("door");
  const auto open = door.find("isOpen");
  return door.is_object() && open != door.end() && open->is_boolean() && open->get<bool>();
}

bool is_low(const Json& item) {
  const auto confidence = item.find("confidence");
  return confidence != item.end() &&
         (*confidence == "low" || (confidence->is_object() && confidence->contains("low")));
}

class RoomScanReader {
 public:
  explicit RoomScanReader(const std::filesystem::path& file) : file_(file.string()) {}

  Expected<Model> read(const Json& json) {
    if (!json.is_object() || !json.contains("walls")) {
      return refuse(
          "is JSON, but neither glTF, which has \"asset\", nor the scan of a room, which has "
          "\"walls\"");
    }
    for (const std::string_view list : kLists) {
      if (const auto found = json.find(list); found != json.end()) {
        RAYLOC_TRY(read_list(list, *found));
      }
    }
    add_remarks(json);
    auto model = scanned_room(room_);
    if (!model) {
      return refuse(model.error().message);
    }
    model->remarks.insert(model->remarks.begin(), remarks_.begin(), remarks_.end());
    return model;
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(file_ + ": " + what);
  }

  Expected<void> read_list(std::string_view list, const Json& items) {
    if (!items.is_array() || items.size() > kMaxParts) {
      return refuse(fmt::format("its '{}' is no list of at most {}", list, kMaxParts));
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Json& item = items[i];
      const std::string place = fmt::format("{}[{}]", list, i);
      auto box = read_box(item, place);
      RAYLOC_TRY(box);
      if (is_low(item)) {
        low_.push_back(place);
      }
      if (const auto curve = item.find("curve"); curve != item.end() && !curve->is_null()) {
        bent_.push_back(place);
      }
      add(list, item, *std::move(box));
    }
    return {};
  }

  void add(std::string_view list, const Json& item, ScannedBox box) {
    if (list == "walls") {
      box.name = "wall";
      room_.walls.push_back(std::move(box));
    } else if (list == "floors") {
      read_floor(item, box);
    } else if (list == "objects") {
      box.name = box.name.empty() ? "object" : box.name;
      room_.objects.push_back(std::move(box));
    } else {
      box.is_open = list == "openings" || is_open_door(item);
      box.name = list == "windows" ? "window" : "door";
      room_.openings.push_back(std::move(box));
    }
  }

  // Uses the largest: in a structure each room has one, and the ceiling is one as well.
  void read_floor(const Json& item, const ScannedBox& box) {
    const auto corners = item.find("polygonCorners");
    std::vector<FloorPoint> outline;
    if (corners != item.end() && corners->is_array()) {
      for (const Json& corner : *corners) {
        const auto at = numbers<3>(corner);
        if (!at) {
          return;
        }
        const Vec3d p = box.centre + (*at)[0] * box.x + (*at)[1] * box.y + (*at)[2] * box.z;
        outline.push_back({p.x, p.y});
      }
    }
    ++floors_;
    if (outline.size() > 2 && (room_.floor.empty() || std::abs(signed_area(outline)) >
                                                          std::abs(signed_area(room_.floor)))) {
      room_.floor = std::move(outline);
    }
  }

  template <std::size_t kCount>
  static std::optional<std::array<double, kCount>> numbers(const Json& json) {
    std::array<double, kCount> values{};
    if (!json.is_array() || json.size() != kCount) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      if (!json[i].is_number()) {
        return std::nullopt;
      }
      values.at(i) = json[i].get<double>();
      if (!(std::abs(values.at(i)) <= kFarthest)) {
        return std::nullopt;
      }
    }
    return values;
  }

  Expected<ScannedBox> read_box(const Json& item, const std::string& place) const {
    const auto member = [&](const char* key) {
      return item.is_object() && item.contains(key) ? item.at(key) : Json();
    };
    const auto size = numbers<3>(member("dimensions"));
    if (!size || *std::min_element(size->begin(), size->end()) < 0.0) {
      return refuse(place + ": its 'dimensions' are no three lengths in metres");
    }
    const auto m = numbers<16>(member("transform"));
    if (!m) {
      return refuse(place + ": its 'transform' is no list of 16 numbers");
    }
    const auto column = [&](std::size_t i) {
      return upright_point((*m)[4 * i], (*m)[4 * i + 1], (*m)[4 * i + 2]);
    };
    ScannedBox box{category_of(item),
                   text_of(item, "identifier"),
                   text_of(item, "parentIdentifier"),
                   column(3),
                   column(0),
                   column(1),
                   column(2),
                   {(*size)[0], (*size)[1], (*size)[2]}};
    const bool is_affine = std::abs((*m)[3]) + std::abs((*m)[7]) + std::abs((*m)[11]) < kRigid &&
                           std::abs((*m)[15] - 1.0) < kRigid;
    const bool is_long = std::abs(norm(box.x) - 1.0) < kRigid &&
                         std::abs(norm(box.y) - 1.0) < kRigid &&
                         std::abs(norm(box.z) - 1.0) < kRigid;
    const bool is_square =
        std::abs(dot(box.x, box.y)) + std::abs(dot(box.y, box.z)) + std::abs(dot(box.z, box.x)) <
        kRigid;
    if (!is_affine || !is_long || !is_square) {
      return refuse(place +
                    ": its 'transform' does more than turn and move; RoomPlan writes it column by "
                    "column, the move in its last four numbers");
    }
    return box;
  }

  void add_remarks(const Json& json) {
    remarks_.emplace_back("metres, y is up, as RoomPlan states");
    const auto version = json.find("version");
    const bool is_known =
        version != json.end() && version->is_number_integer() &&
        std::find(kVersions.begin(), kVersions.end(), version->get<int>()) != kVersions.end();
    if (!is_known) {
      remarks_.push_back(fmt::format(
          "warning: it {}; it is read as version 2",
          version == json.end() ? "states no version"
                                : "is of version " + version->dump() + ", which is not known"));
    }
    std::vector<std::string> left_out;
    for (const auto& member : json.items()) {
      const auto is_in = [&](std::span<const std::string_view> names) {
        return std::find(names.begin(), names.end(), member.key()) != names.end();
      };
      if (!is_in(kLists) && !is_in(kNoShape)) {
        left_out.push_back(member.key());
      }
    }
    const auto list = [&](const char* what, const std::vector<std::string>& names) {
      if (!names.empty()) {
        remarks_.push_back(fmt::format("{}: {}", what, fmt::join(names, ", ")));
      }
    };
    list("left out, as it is not known here", left_out);
    list("bent, of which the chord was taken", bent_);
    list("seen with low confidence, check them", low_);
    if (floors_ > 1) {
      remarks_.push_back(
          fmt::format("the largest of {} floors is the floor and the ceiling", floors_));
    }
  }

  std::string file_;
  ScannedRoom room_;
  std::vector<std::string> bent_;
  std::vector<std::string> low_;
  std::vector<std::string> remarks_;
  int floors_ = 0;
};

}  // namespace

Expected<Model> read_room_scan(const std::filesystem::path& file) {
  const auto text = read_file(file);
  RAYLOC_TRY(text);
  const Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) {
    return bad_input(file.string() + ": is cut off, or no JSON; export it again");
  }
  return RoomScanReader(file).read(json);
}

}  // namespace rayloc
