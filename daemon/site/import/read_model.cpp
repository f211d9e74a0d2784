#include "daemon/site/import/read_model.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <spdlog/fmt/fmt.h>
#include <assimp/Importer.hpp>

#include "daemon/site/import/ifc/ifc4.h"
#include "daemon/site/import/ifc/ifc_check.h"
#include "daemon/site/import/ifc/ifc_materials.h"
#include "daemon/site/import/ifc/ifc_units.h"
#include "daemon/site/import/listed.h"
#include "daemon/site/model/site_copy.h"
#include "engine/scene/bounds.h"
#include "engine/scene/read/mesh_reader.h"

namespace rayloc {
namespace {

constexpr std::size_t kMaxTriangles = 5'000'000;  // chosen: 2 GiB in memory
// Heights of rooms [m], chosen.
constexpr double kLowRoom = 1.9;
constexpr double kHighRoom = 4.5;
constexpr std::string_view kNoIfcMaterial = "<IFCDefault>";  // of assimp

// Only files in the same folder or below: a glTF may name any file of the machine.
class FilesBeside final : public Assimp::DefaultIOSystem {
 public:
  explicit FilesBeside(const std::filesystem::path& file)
      : folder_(std::filesystem::weakly_canonical(file).parent_path()) {}

  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return is_below(folder_, file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  }
  bool Exists(const char* file) const override {
    return is_below(folder_, file) && DefaultIOSystem::Exists(file);
  }

 private:
  std::filesystem::path folder_;
};

Vec3d point_of(const aiVector3D& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// Content of an IFC file that assimp does not report.
struct IfcContent {
  std::string text;  // for assimp
  std::map<std::string, IfcElement, std::less<>> elements;
  double metres = 1.0;  // per unit of length that assimp returns
  std::vector<std::string> remarks;
  std::set<std::string, std::less<>> shaped;  // GlobalIds of elements that must have faces (IFC 4)
};

class Collector {
 public:
  // `ifc`: empty for a model of another format.
  Collector(const aiScene& scene, const std::optional<IfcContent>& ifc)
      : scene_(scene), ifc_(ifc) {}

  // `element`: the node above that is an element of IFC; its shapes may be in nodes below it.
  void add(const aiNode& node, const aiMatrix4x4& above, const aiNode* element = nullptr) {
    const aiMatrix4x4 here = above * node.mTransformation;
    const aiNode* const its = element_of(node) != nullptr ? &node : element;
    for (unsigned i = 0; i < node.mNumMeshes && triangles_ <= kMaxTriangles; ++i) {
      add_mesh(its != nullptr ? *its : node, *scene_.mMeshes[node.mMeshes[i]], here);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      add(*node.mChildren[i], here, its);
    }
  }
  std::vector<ModelPart> finish() { return std::move(parts_); }
  std::size_t triangles() const { return triangles_; }
  // Names of the elements of IFC 4 with a shape of which assimp made no face.
  std::vector<std::string> without_faces() const {
    std::vector<std::string> names;
    if (!ifc_) {
      return names;
    }
    for (const std::string& id : ifc_->shaped) {
      if (!with_faces_.contains(id)) {
        const auto found = ifc_->elements.find(id);
        const bool is_named = found != ifc_->elements.end() && !found->second.name.empty();
        names.push_back(is_named ? found->second.name : id);
      }
    }
    return names;
  }
  bool is_finite() const { return is_finite_; }

 private:
  // By the end of a name that assimp made: CLASS_NAME_GLOBALID. Null: none.
  const IfcElement* element_of(const aiNode& node) const {
    const std::string_view id = global_id_of(node);
    if (!ifc_ || id.empty()) {
      return nullptr;
    }
    const auto found = ifc_->elements.find(id);
    return found == ifc_->elements.end() ? nullptr : &found->second;
  }

  static std::string_view global_id_of(const aiNode& node) {
    const std::string_view name(node.mName.C_Str(), node.mName.length);
    return name.size() <= kIfcGlobalId ? "" : name.substr(name.size() - kIfcGlobalId);
  }

  void set_names(const IfcElement& element, ModelPart& part) const {
    const std::string class_name = part.name.substr(0, part.name.find('_'));
    part.name = class_name + "_" + (element.name.empty() ? "Unnamed" : element.name);
    if (!element.material.empty()) {
      part.material = element.material;
    } else if (part.material == kNoIfcMaterial) {
      part.material.clear();
    }
  }

  void add_mesh(const aiNode& node, const aiMesh& mesh, const aiMatrix4x4& here) {
    ModelPart part;
    part.name = node.mName.length > 0 ? node.mName.C_Str() : mesh.mName.C_Str();
    if (mesh.mMaterialIndex < scene_.mNumMaterials) {
      part.material = scene_.mMaterials[mesh.mMaterialIndex]->GetName().C_Str();
    }
    if (const IfcElement* const element = element_of(node)) {
      set_names(*element, part);
    }
    std::map<std::tuple<double, double, double>, std::uint32_t> known;
    std::vector<std::uint32_t> index(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const Vec3d p = point_of(here * mesh.mVertices[i]);
      is_finite_ = is_finite_ && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      if (!is_finite_) {
        return;  // a map cannot order it; the file is refused
      }
      const auto next = static_cast<std::uint32_t>(part.mesh.vertices.size());
      const auto [found, added] = known.try_emplace({p.x, p.y, p.z}, next);
      if (added) {
        part.mesh.vertices.push_back(p);
      }
      index[i] = found->second;
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices == 3) {
        part.mesh.triangles.push_back(
            {index[face.mIndices[0]], index[face.mIndices[1]], index[face.mIndices[2]]});
      }
    }
    triangles_ += part.mesh.triangles.size();
    if (!part.mesh.triangles.empty()) {
      parts_.push_back(std::move(part));
      with_faces_.emplace(global_id_of(node));
    }
  }

  const aiScene& scene_;
  const std::optional<IfcContent>& ifc_;
  std::vector<ModelPart> parts_;
  std::set<std::string, std::less<>> with_faces_;  // GlobalIds
  std::size_t triangles_ = 0;
  bool is_finite_ = true;
};

bool is_height_of_rooms(double metres) { return metres >= kLowRoom && metres <= kHighRoom; }

struct RecognisedUnit {
  double metres = 1.0;
  std::string name;
  std::string why;
};

// The unit in which an object has the height of a room; else
// the largest in which the whole is no larger than a storey.
RecognisedUnit recognised_unit(const Bounds& bounds) {
  const std::array<RecognisedUnit, 3> all = {
      {{1.0, "metres", ""}, {0.01, "centimetres", ""}, {0.001, "millimetres", ""}}};
  const Vec3d size = bounds.size();
  const double largest = std::max({size.x, size.y, size.z});
  std::vector<RecognisedUnit> possible;
  for (const RecognisedUnit& one : all) {
    if (largest * one.metres <= kLargestStorey &&
        (is_height_of_rooms(size.y * one.metres) || is_height_of_rooms(size.z * one.metres))) {
      possible.push_back(one);
    }
  }
  RecognisedUnit found = all.back();
  if (possible.size() == 1) {
    found = possible.front();
    found.why = "by the height of rooms";
    return found;
  }
  for (const RecognisedUnit& one : all) {
    if (largest * one.metres <= kLargestStorey) {
      found = one;
      break;
    }
  }
  found.why = "by the size of the whole";
  return found;
}

bool is_named(const ModelPart& part, std::string_view word) {
  std::string name = part.name;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return name.find(word) != std::string::npos;
}

// The axis along which a floor or ceiling is thin, else the one with the extent of a room's height.
std::pair<char, std::string> recognised_up(const Model& model,
                                           const Bounds& bounds,
                                           double metres) {
  for (const ModelPart& part : model.parts) {
    if (is_named(part, "floor") || is_named(part, "ceiling")) {
      const Vec3d size = bounds_of(part.mesh).size();
      return {size.y < size.z ? 'y' : 'z', "by '" + part.name + "'"};
    }
  }
  const auto is_height = [&](double extent) { return is_height_of_rooms(extent * metres); };
  const Vec3d size = bounds.size();
  if (is_height(size.y) != is_height(size.z)) {
    return {is_height(size.y) ? 'y' : 'z', "by the height of rooms"};
  }
  return {'\0', ""};
}

void apply(double metres, bool y_up, Model& model) {
  for (ModelPart& part : model.parts) {
    for (Vec3d& v : part.mesh.vertices) {
      v = metres * (y_up ? Vec3d{v.x, -v.z, v.y} : v);
    }
  }
}

// `ifc_metres`: the unit of IFC.
void set_units(ModelFormat format, const ModelUnits& units, double ifc_metres, Model& model) {
  const Bounds bounds = bounds_of(model);
  const bool by_standard = format == ModelFormat::kGlb || format == ModelFormat::kGltf;
  double metres = units.metres;
  if (metres > 0.0) {
    model.remarks.push_back(fmt::format("a unit is {} m, by --unit", metres));
  } else if (by_standard) {
    metres = 1.0;
    model.remarks.emplace_back("metres, as glTF states");
  } else if (format == ModelFormat::kIfc) {
    metres = ifc_metres;
    model.remarks.push_back(metres == 1.0
                                ? "units of the file, as IFC states them"
                                : fmt::format("a unit is {} m, as the file states", metres));
  } else {
    const RecognisedUnit unit = recognised_unit(bounds);
    metres = unit.metres;
    model.remarks.push_back(unit.name + ", " + unit.why + " (--unit states another)");
  }
  char up = units.up;
  if (up != '\0') {
    model.remarks.push_back(fmt::format("{} is up, by --up", up));
  } else if (by_standard) {
    up = 'y';
    model.remarks.emplace_back("y is up, as glTF states");
  } else {
    auto [axis, why] = recognised_up(model, bounds, metres);
    if (axis == '\0') {
      // The IFC reader has already rotated the model.
      axis = format == ModelFormat::kObj || format == ModelFormat::kIfc ? 'y' : 'z';
      why = std::string("as programs write ") + name_of(format) + " by default";
    }
    up = axis;
    model.remarks.push_back(fmt::format("{} is up, {} (--up states another)", up, why));
  }
  apply(metres, up == 'y', model);
}

// assimp reads a missing z as 0 and ignores numbers beyond the counts.
Expected<void> check_counts(const std::filesystem::path& file, Model& model) {
  const auto bytes = read_file(file);
  RAYLOC_TRY(bytes);
  std::vector<SceneNote> notes;
  auto checked = check_ply(*bytes, file.string(), notes);
  for (SceneNote& note : notes) {
    model.remarks.push_back(std::move(note.message));
  }
  return checked;
}

Expected<IfcContent> checked_ifc(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  RAYLOC_TRY(bytes);
  const auto step = StepText::parse(*bytes, file.string());
  RAYLOC_TRY(step);
  if (!is_ifc4(*step)) {
    RAYLOC_TRY(check_ifc(*step, file.string()));
    return IfcContent{plain_ifc(*step), ifc_elements(*step), ifc_metres(*step), {}, {}};
  }
  auto made = ifc4_as_2x3(*step, file.string());
  RAYLOC_TRY(made);
  RAYLOC_TRY(check_ifc(made->step, file.string()));
  return IfcContent{plain_ifc(made->step),
                    ifc_elements(*step),
                    ifc_metres(made->step),
                    std::move(made->remarks),
                    std::move(made->shaped)};
}

// Content of an IFC 4 file that no face shows.
void add_ifc_remarks(const Collector& collector, const IfcContent& ifc, Model& model) {
  model.remarks.insert(model.remarks.end(), ifc.remarks.begin(), ifc.remarks.end());
  const auto names = collector.without_faces();
  if (!names.empty()) {
    model.remarks.push_back(fmt::format(
        "warning: elements with a shape of which no face could be made, or outside every storey: "
        "{} ({}); export them as faces (IFC 4 Reference View), or as GLB",
        names.size(),
        listed(names)));
  }
}

// Null: not read, for the reason that the importer states.
const aiScene* read_scene(const std::filesystem::path& file,
                          const std::optional<IfcContent>& ifc,
                          Assimp::Importer& importer) {
  importer.SetIOHandler(new FilesBeside(file));  // owned by the importer
  // Reads only shapes: other attributes would keep corners at one place apart.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_COLORS | aiComponent_TEXCOORDS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                  aiComponent_ANIMATIONS | aiComponent_BONEWEIGHTS);
  const unsigned steps = aiProcess_RemoveComponent | aiProcess_Triangulate;
  const aiScene* const scene =
      ifc ? importer.ReadFileFromMemory(ifc->text.data(), ifc->text.size(), steps, "ifc")
          : importer.ReadFile(file.string(), steps);
  return scene != nullptr && scene->mRootNode != nullptr ? scene : nullptr;
}

}  // namespace

Expected<Model> read_model(const std::filesystem::path& file,
                           ModelFormat format,
                           const ModelUnits& units) {
  Model model;
  if (format == ModelFormat::kPly) {
    RAYLOC_TRY(check_counts(file, model));
  }
  std::optional<IfcContent> ifc;
  if (format == ModelFormat::kIfc) {
    auto checked = checked_ifc(file);
    RAYLOC_TRY(checked);
    ifc = *std::move(checked);
  }
  Assimp::Importer importer;
  const aiScene* const scene = read_scene(file, ifc, importer);
  const std::string place = file.string() + ": ";
  if (scene == nullptr) {
    return bad_input(place + "cannot be read as " + name_of(format) + ": " +
                     importer.GetErrorString() + "; export it again");
  }
  Collector collector(*scene, ifc);
  collector.add(*scene->mRootNode, aiMatrix4x4());
  if (!collector.is_finite()) {
    return bad_input(place + "has a coordinate that is not a finite number; export it again");
  }
  if (collector.triangles() > kMaxTriangles) {
    return bad_input(
        fmt::format("{}has {} triangles, more than the {} that are read; export a "
                    "scan of fewer",
                    place,
                    collector.triangles(),
                    kMaxTriangles));
  }
  if (ifc) {
    add_ifc_remarks(collector, *ifc, model);
  }
  model.parts = collector.finish();
  if (model.parts.empty()) {
    return bad_input(place + "has no faces (" + name_of(format) +
                     (model.remarks.empty() ? "" : "; " + model.remarks.front()) +
                     "); a cloud of points must be made a mesh first, an empty layer be chosen "
                     "anew");
  }
  set_units(format, units, ifc ? ifc->metres : 1.0, model);
  return model;
}

}  // namespace rayloc
