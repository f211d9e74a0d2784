// SiteDraft: what the editor shows and changes of a site, as plain values.
//
// The page gets one, changes it and sends it back whole. What it was in the file when it was read
// travels along as `was`, so that a thing that was renamed is no new one.
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
  int core = 0;
  Vec3d offset;  // [m], local frame

  bool operator==(const DraftAntenna& other) const;
};

struct DraftAccessPoint {
  std::string was;  // its id in the file; empty: it is new
  std::string id;
  std::string model;                // of a preset, for the comment of a new one
  Vec3d position;                   // [m]
  std::array<double, 3> degrees{};  // yaw, pitch, roll
  std::vector<DraftAntenna> antennas;
};

struct DraftZone {
  std::string was;  // its name in the file; empty: it is new
  std::string name;
  std::vector<FloorPoint> polygon;  // [m]
};

struct DraftDevice {
  std::string was;  // its address as the file writes it; empty: it is new
  std::string mac;
  std::string name;    // empty: none
  bool fixed = false;  // shown, and named; its place is not changed here
};

// kBox: a cube that was scaled, turned about z and moved. kWall: a sheet that stands upright.
// kMesh: anything else, which can be moved and taken out.
enum class DraftForm { kBox, kWall, kMesh };

struct DraftObject {
  std::string was = {};  // the id of its shape in the file; empty: it is new
  std::string name;
  std::string material;     // as its <bsdf> is called without "mat-", or of ITU-R P.2040-4
  double thickness = 0.02;  // [m], of a material that the file does not have yet
  DraftForm form = DraftForm::kMesh;
  Vec3d centre = {};              // [m], of a box
  Vec3d size = {};                // [m], of a box
  double yaw_deg = 0.0;           // of a box
  FloorPoint from{};              // [m], of a wall
  FloorPoint to{};                // [m]
  double bottom = 0.0;            // [m]
  double height = 0.0;            // [m]
  std::array<double, 2> moved{};  // [m], of a mesh, since it was read
};

struct SiteDraft {
  std::string revision;  // of the files that it was read from
  std::vector<DraftAccessPoint> access_points;
  std::vector<DraftZone> zones;
  std::vector<DraftDevice> devices;
  std::vector<DraftObject> objects;
};

nlohmann::ordered_json json_of(const SiteDraft& draft);
// An Error where the text is no draft.
Expected<SiteDraft> parse_draft(const std::string& text);

}  // namespace rayloc
