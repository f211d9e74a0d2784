#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "engine/scene/mesh_reader.h"

namespace rayloc {
namespace {

void append(const aiMesh& part, Mesh& mesh) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices.push_back(
        {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)});
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    for (unsigned corner = 2; corner < face.mNumIndices; ++corner) {
      mesh.triangles.push_back({base + face.mIndices[0],
                                base + face.mIndices[corner - 1],
                                base + face.mIndices[corner]});
    }
  }
}

}  // namespace

Expected<Mesh> read_obj(std::string_view bytes, const std::string& name) {
  Assimp::Importer importer;
  // The importer owns the scene. No node of an OBJ file has a transformation.
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, "obj");
  if (scene == nullptr) {
    return bad_input(name + ": the OBJ file cannot be read: " + importer.GetErrorString());
  }
  Mesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    append(*scene->mMeshes[i], mesh);
  }
  if (mesh.triangles.empty()) {
    return bad_input(name + ": the mesh has no face");
  }
  return mesh;
}

}  // namespace rayloc
