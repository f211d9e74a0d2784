#include "daemon/live/studio/site_draft.h"

#include <cmath>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 3> kForms = {"box", "wall", "mesh"};

Json json_of(const Vec3d& v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const DraftAccessPoint& one) {
  Json antennas = Json::array();
  for (const DraftAntenna& antenna : one.antennas) {
    antennas.push_back({{"core", antenna.rx_chain}, {"offset", json_of(antenna.offset)}});
  }
  return {{"was", one.was},
          {"id", one.id},
          {"position", json_of(one.position)},
          {"degrees", one.degrees},
          {"antennas", std::move(antennas)}};
}

Json json_of(const DraftObject& one) {
  Json json = {{"was", one.was},
               {"name", one.name},
               {"material", one.material},
               {"form", kForms.at(static_cast<std::size_t>(one.form))}};
  if (one.form == DraftForm::kBox) {
    json.update(
        {{"centre", json_of(one.centre)}, {"size", json_of(one.size)}, {"yaw_deg", one.yaw_deg}});
  } else if (one.form == DraftForm::kWall) {
    json.update(
        {{"from", one.from}, {"to", one.to}, {"bottom", one.bottom}, {"height", one.height}});
  } else {
    json["moved"] = one.moved;
  }
  return json;
}

// From the page; missing values or wrong types throw, which parse_draft() catches.
Vec3d json_vector(const Json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

DraftAccessPoint access_point_of(const Json& json) {
  DraftAccessPoint one;
  one.was = json.at("was");
  one.id = json.at("id");
  one.model = json.value("model", "");
  one.position = json_vector(json.at("position"));
  one.degrees = json.at("degrees");
  for (const Json& antenna : json.at("antennas")) {
    one.antennas.push_back({antenna.at("core"), json_vector(antenna.at("offset"))});
  }
  return one;
}

DraftObject object_of(const Json& json) {
  DraftObject one;
  one.was = json.at("was");
  one.name = json.at("name");
  one.material = json.at("material");
  one.thickness = json.value("thickness", one.thickness);
  const auto form = json.at("form").get<std::string>();
  if (form == "box") {
    one.form = DraftForm::kBox;
    one.centre = json_vector(json.at("centre"));
    one.size = json_vector(json.at("size"));
    one.yaw_deg = json.at("yaw_deg");
  } else if (form == "wall") {
    one.form = DraftForm::kWall;
    one.from = json.at("from");
    one.to = json.at("to");
    one.bottom = json.at("bottom");
    one.height = json.at("height");
  } else {
    one.moved = json.at("moved");
  }
  return one;
}

SiteDraft draft_of(const Json& json) {
  SiteDraft draft;
  draft.revision = json.at("revision");
  for (const Json& one : json.at("access_points")) {
    draft.access_points.push_back(access_point_of(one));
  }
  for (const Json& one : json.at("zones")) {
    draft.zones.push_back({one.at("was"), one.at("name"), one.at("polygon")});
  }
  for (const Json& one : json.at("devices")) {
    draft.devices.push_back(
        {one.at("was"), one.at("mac"), one.at("name"), one.value("fixed", false)});
  }
  for (const Json& one : json.at("objects")) {
    draft.objects.push_back(object_of(one));
  }
  return draft;
}

}  // namespace

bool DraftAntenna::operator==(const DraftAntenna& other) const {
  return rx_chain == other.rx_chain && offset.x == other.offset.x && offset.y == other.offset.y &&
         offset.z == other.offset.z;
}

Json json_of(const SiteDraft& draft) {
  Json json = {{"revision", draft.revision},
               {"access_points", Json::array()},
               {"zones", Json::array()},
               {"devices", Json::array()},
               {"objects", Json::array()}};
  for (const DraftAccessPoint& one : draft.access_points) {
    json["access_points"].push_back(json_of(one));
  }
  for (const DraftZone& one : draft.zones) {
    json["zones"].push_back({{"was", one.was}, {"name", one.name}, {"polygon", one.polygon}});
  }
  for (const DraftDevice& one : draft.devices) {
    json["devices"].push_back(
        {{"was", one.was}, {"mac", one.mac}, {"name", one.name}, {"fixed", one.fixed}});
  }
  for (const DraftObject& one : draft.objects) {
    json["objects"].push_back(json_of(one));
  }
  return json;
}

Expected<SiteDraft> parse_draft(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    return bad_input("the draft is no JSON");
  }
  try {
    return draft_of(json);
  } catch (const nlohmann::json::exception& error) {
    return bad_input(std::string("the draft is not as the editor sends it: ") + error.what());
  }
}

}  // namespace rayloc
