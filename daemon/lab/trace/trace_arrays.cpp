#include "daemon/lab/trace/trace_arrays.h"

#include <algorithm>
#include <complex>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "daemon/base/arrays/npz_file.h"
#include "engine/trace/interactions/interaction.h"

namespace rayloc {
namespace {

struct Columns {
  std::size_t depth = 0;
  std::vector<std::complex<double>> a;
  std::vector<double> tau;
  std::vector<double> angles;              // [path][4]
  std::vector<std::uint8_t> interactions;  // [interaction][path]
  std::vector<std::uint32_t> objects;      // [interaction][path]
  std::vector<double> vertices;            // [interaction][path][3]
};

Columns columns_of(const Paths& paths) {
  Columns columns;
  for (const Path& path : paths) {
    columns.depth = std::max(columns.depth, path.interactions.size());
    columns.a.emplace_back(path.a.re, path.a.im);
    columns.tau.push_back(path.tau);
    columns.angles.insert(columns.angles.end(),
                          {path.theta_t(), path.phi_t(), path.theta_r(), path.phi_r()});
  }
  const std::size_t cells = columns.depth * paths.size();
  columns.interactions.assign(cells, 0);
  columns.objects.assign(cells, std::numeric_limits<std::uint32_t>::max());
  columns.vertices.assign(3 * cells, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t k = 0; k < paths[i].interactions.size(); ++k) {
      const Interaction& one = paths[i].interactions[k];
      const std::size_t cell = k * paths.size() + i;
      columns.interactions[cell] = static_cast<std::uint8_t>(letter_of(one.kind));
      columns.objects[cell] = one.object;
      columns.vertices[3 * cell] = one.position.x;
      columns.vertices[3 * cell + 1] = one.position.y;
      columns.vertices[3 * cell + 2] = one.position.z;
    }
  }
  return columns;
}

void add_channel(const LinkTrace& traced, NpzFile& file) {
  if (traced.cfr) {
    std::vector<double> frequencies;
    for (std::size_t j = 0; j < traced.tones.size(); ++j) {
      frequencies.push_back(traced.tones.frequency_hz(j));
    }
    file.add("frequencies", frequencies, {traced.tones.size()});
    file.add("cfr", *traced.cfr, {traced.tones.size()});
  }
  if (traced.power) {
    std::vector<std::string> names;
    std::vector<double> values;
    for (const auto& [name, value] : traced.gradient) {
      names.push_back(name);
      values.push_back(value);
    }
    file.add("power", std::vector<double>{*traced.power}, {});
    file.add_texts("gradient_names", names);
    file.add("gradient", values, {values.size()});
  }
}

}  // namespace

Expected<void> write_npz(const LinkTrace& traced, const Scene& scene, const std::string& path) {
  auto file = NpzFile::create(path);
  RAYLOC_TRY(file);
  const Columns columns = columns_of(traced.paths);
  const std::size_t count = traced.paths.size();
  std::vector<std::string> names;
  for (const SceneObject& object : scene.objects()) {
    names.push_back(object.name);
  }
  file->add("a", columns.a, {count});
  file->add("tau", columns.tau, {count});
  file->add("angles", columns.angles, {count, 4});
  file->add("interactions", columns.interactions, {columns.depth, count});
  file->add("objects", columns.objects, {columns.depth, count});
  file->add("vertices", columns.vertices, {columns.depth, count, 3});
  file->add_texts("object_names", names);
  file->add("frequency", std::vector<double>{scene.carrier_hz()}, {});
  add_channel(traced, *file);
  return file->close();
}

}  // namespace rayloc
