// SiteDraft: the parts of a site that the editor shows and changes, as plain values.
//
// The page gets a draft, changes it and sends it back whole. The original name of each thing in the
// file is kept as `was`, so that a renamed thing is not treated as new.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/base/expected.h"
#include "engine/base/outline.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct DraftAntenna {
  int rx_chain = 0;
  Vec3d offset;  // [m], local frame

  bool operator==(const DraftAntenna& other) const;
};

struct DraftAccessPoint {
  std::string was;  // its id in the file; empty: new
  std::string id;
  std::string model;                // preset name, for the comment of a new one
  Vec3d position;                   // [m]
  std::array<double, 3> degrees{};  // yaw, pitch, roll
  std::vector<DraftAntenna> antennas;
};

struct DraftZone {
  std::string was;  // its name in the file; empty: new
  std::string name;
  std::vector<FloorPoint> polygon;  // [m]
};

struct DraftDevice {
  std::string was;  // its address as written in the file; empty: new
  std::string mac;
  std::string name;    // empty: none
  bool fixed = false;  // shown with its name; its place is not changed here
};

// kBox: a cube that was scaled, rotated about z and moved. kWall: an upright sheet. kMesh: any
// other shape, which can be moved and removed.
enum class DraftForm { kBox, kWall, kMesh };

struct DraftObject {
  std::string was = {};  // the id of its shape in the file; empty: new
  std::string name;
  std::string material;     // name of its <bsdf> without "mat-", or from ITU-R P.2040-4
  double thickness = 0.02;  // [m], for a material that the file does not have
  DraftForm form = DraftForm::kMesh;
  Vec3d centre = {};              // [m], for a box
  Vec3d size = {};                // [m], for a box
  double yaw_deg = 0.0;           // for a box
  FloorPoint from{};              // [m], for a wall
  FloorPoint to{};                // [m]
  double bottom = 0.0;            // [m]
  double height = 0.0;            // [m]
  std::array<double, 2> moved{};  // [m], for a mesh, since it was read
};

struct SiteDraft {
  std::string revision;  // revision of the files it was read from
  std::vector<DraftAccessPoint> access_points;
  std::vector<DraftZone> zones;
  std::vector<DraftDevice> devices;
  std::vector<DraftObject> objects;
};

nlohmann::ordered_json json_of(const SiteDraft& draft);
// Returns an Error if the text is no draft.
Expected<SiteDraft> parse_draft(const std::string& text);

}  // namespace rayloc
