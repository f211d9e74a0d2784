#include "daemon/site/scene/scene_files.h"

#include <spdlog/fmt/fmt.h>

namespace rayloc {
namespace {

// Objects of a scene that was read may have any name, such as "a/b" and "..\\b".
std::string mesh_file(const StatedObject& object, std::size_t index) {
  return "meshes/" + (is_object_name(object.name) ? object.name : fmt::format("object.{}", index)) +
         ".ply";
}

std::string attribute(std::string_view text) {
  std::string quoted;
  for (const char c : text) {
    switch (c) {
      case '&':
        quoted += "&amp;";
        break;
      case '<':
        quoted += "&lt;";
        break;
      case '"':
        quoted += "&quot;";
        break;
      default:
        quoted += c;
    }
  }
  return quoted;
}

// Text, readable by a person and editable by a script. `{}` of a double is the shortest text that
// reads back as the same number.
std::string ply(const Mesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(),
      mesh.triangles.size());
  for (const Vec3d& v : mesh.vertices) {
    text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  }
  for (const auto& t : mesh.triangles) {
    text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  }
  return text;
}

std::string bsdf(const StatedMaterial& material) {
  const auto number = [](const char* name, double value) {
    return fmt::format("        <float name=\"{}\" value=\"{}\"/>\n", name, value);
  };
  std::string text = fmt::format("    <bsdf type=\"{}\" id=\"mat-{}\">\n",
                                 material.itu.empty() ? "radio-material" : "itu-radio-material",
                                 attribute(material.name));
  if (material.itu.empty()) {
    text += number("relative_permittivity", material.relative_permittivity) +
            number("conductivity", material.conductivity);
  } else {
    text += fmt::format("        <string name=\"type\" value=\"{}\"/>\n", material.itu);
  }
  text += number("thickness", material.thickness);
  if (const SurfaceScattering& rough = material.scattering; rough.is_rough()) {
    text += number("scattering_coefficient", rough.scattering_coefficient) +
            number("xpd_coefficient", rough.xpd_coefficient) +
            fmt::format("        <string name=\"scattering_pattern\" value=\"{}\"/>\n",
                        kScatteringPatternNames.at(static_cast<std::size_t>(rough.pattern))) +
            number("alpha_r", rough.alpha_r) + number("alpha_i", rough.alpha_i) +
            number("lambda_", rough.lambda);
  }
  return text + "    </bsdf>\n";
}

std::string shape(const StatedObject& object, const std::string& file) {
  return fmt::format(
      "    <shape type=\"ply\" id=\"mesh-{}\">\n"
      "        <string name=\"filename\" value=\"{}\"/>\n"
      "        <boolean name=\"face_normals\" value=\"true\"/>\n"
      "        <ref id=\"mat-{}\" name=\"bsdf\"/>\n"
      "    </shape>\n",
      attribute(object.name),
      file,
      attribute(object.material));
}

}  // namespace

bool is_object_name(std::string_view text) {
  return !text.empty() && text.find_first_not_of(
                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") ==
                              std::string_view::npos;
}

std::map<std::string, std::string> scene_files(const StatedScene& scene) {
  std::map<std::string, std::string> files;
  std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<scene version=\"2.1.0\">\n";
  for (const StatedMaterial& material : scene.materials) {
    xml += bsdf(material);
  }
  for (const StatedObject& object : scene.objects) {
    const std::string file = mesh_file(object, files.size());
    xml += shape(object, file);
    files[file] = ply(object.mesh);
  }
  files["scene.xml"] = xml + "</scene>\n";
  return files;
}

}  // namespace rayloc
