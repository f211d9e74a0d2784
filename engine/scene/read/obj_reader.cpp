// A separate reader instead of assimp's, which keeps vertices as float, silently drops unknown
// elements and reports no place in its errors.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/base/number_text.h"
#include "engine/scene/read/mesh_materials.h"
#include "engine/scene/read/mesh_reader.h"
#include "engine/scene/read/polygon_list.h"

namespace rayloc {
namespace {

// No effect on faces: names, materials, normals, lines, points, display.
constexpr std::array<std::string_view, 20> kPassedOver{
    "vn",        "vt",    "vp",       "g",        "o",      "s",    "mg",
    "l",         "p",     "mtllib",   "usemap",   "maplib", "lod",  "shadow_obj",
    "trace_obj", "bevel", "c_interp", "d_interp", "ctech",  "stech"};
// Wavefront's keywords for curves and curved surfaces.
constexpr std::array<std::string_view, 4> kCurved{"curv", "curv2", "surf", "cstype"};

constexpr std::string_view kObjBlank = " \t\r\f\v";  // separators of words within a line

template <std::size_t N>
bool is_keyword_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {
    // U+FEFF in UTF-8: some exporters begin with it.
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (bytes_.starts_with(kByteOrderMark)) {
      bytes_.remove_prefix(kByteOrderMark.size());
    }
  }

  Expected<Mesh> read(std::vector<SceneNote>& notes) {
    while (!bytes_.empty()) {
      RAYLOC_TRY(read_statement(next_statement()));
    }
    if (faces_.size() == 0) {
      return bad_input(name_ + ": the mesh has no face");
    }
    mesh_.rounding = precision_.rounding();
    auto cut = faces_.append_to(
        mesh_, [&](std::size_t i) { return name_ + ":" + std::to_string(line_of_face_[i]); });
    RAYLOC_TRY(cut);
    note_materials(materials_, name_, notes);
    return std::move(mesh_);
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  // A line without its comment; with '\' at its end joined with the next one.
  std::string next_statement() {
    std::string statement;
    line_ = next_line_;
    for (bool goes_on = true; goes_on && !bytes_.empty();) {
      const std::size_t end = std::min(bytes_.find('\n'), bytes_.size());
      std::string_view line = bytes_.substr(0, end);
      bytes_.remove_prefix(std::min(end + 1, bytes_.size()));
      ++next_line_;
      line = line.substr(0, line.find('#'));
      line = line.substr(0, line.find_last_not_of(kObjBlank) + 1);
      goes_on = line.ends_with('\\');
      statement += line.substr(0, line.size() - (goes_on ? 1 : 0));
      statement += ' ';
    }
    return statement;
  }

  // Removes and returns the next word of the statement; empty at its end.
  static std::string_view next_word(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kObjBlank), rest.size()));
    const std::string_view word = rest.substr(0, rest.find_first_of(kObjBlank));
    rest.remove_prefix(word.size());
    return word;
  }

  Expected<void> read_statement(const std::string& statement) {
    std::string_view rest = statement;
    const std::string_view keyword = next_word(rest);
    if (keyword == "v") {
      return read_vertex(rest);
    }
    if (keyword == "f" || keyword == "fo") {
      return read_face(rest);
    }
    if (keyword == "usemtl") {
      rest.remove_prefix(std::min(rest.find_first_not_of(kObjBlank), rest.size()));
      material_ = rest.substr(0, rest.find_last_not_of(kObjBlank) + 1);  // Blender's have blanks
      return {};
    }
    if (keyword.empty() || is_keyword_of(keyword, kPassedOver)) {
      return {};
    }
    if (is_keyword_of(keyword, kCurved)) {
      return refuse("'" + std::string(keyword) +
                    "' begins a curved surface; export the mesh as polygons");
    }
    return refuse("'" + std::string(keyword.substr(0, 40)) + "' is no statement of an OBJ file");
  }

  // v x y z; a fourth number is a weight, three more after x y z are a colour.
  Expected<void> read_vertex(std::string_view rest) {
    std::vector<double> numbers;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const std::string_view text = word;
      const auto number = read_number(word);
      if (number && numbers.size() < 3) {
        precision_.note(text, *number);
      }
      if (!number || !word.empty() || !std::isfinite(*number)) {
        return refuse("a coordinate of vertex " + std::to_string(mesh_.vertices.size() + 1) +
                      " is not a finite number");
      }
      numbers.push_back(*number);
    }
    if (numbers.size() < 3) {
      return refuse("vertex " + std::to_string(mesh_.vertices.size() + 1) +
                    " must have three coordinates");
    }
    const double weight = numbers.size() == 4 ? numbers[3] : 1.0;
    if (weight == 0.0) {
      return refuse("the weight of vertex " + std::to_string(mesh_.vertices.size() + 1) +
                    " is 0: it has no place");
    }
    mesh_.vertices.push_back({numbers[0] / weight, numbers[1] / weight, numbers[2] / weight});
    return {};
  }

  // f v v v, f v/vt v/vt v/vt, f v/vt/vn ..., f v//vn ...; from 1, or backwards from -1.
  Expected<void> read_face(std::string_view rest) {
    std::size_t corners = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const std::string_view vertex = word.substr(0, word.find('/'));
      std::int64_t number = 0;
      const char* const end = vertex.data() + vertex.size();
      const auto [stop, status] = std::from_chars(vertex.data(), end, number);
      const auto known = static_cast<std::int64_t>(mesh_.vertices.size());
      const std::int64_t index = number < 0 ? known + number : number - 1;
      if (status != std::errc() || stop != end || number == 0 || index < 0 ||
          index > std::int64_t{0xffffffff}) {
        return refuse("'" + std::string(word.substr(0, 40)) +
                      "' is no corner of a face; corners are numbers of vertices, from 1 on or "
                      "backwards from -1, as in 'f 1 2 3'");
      }
      faces_.add_corner(static_cast<std::uint32_t>(index));
      ++corners;
    }
    if (corners < 3) {
      return refuse("a face has " + std::to_string(corners) + " corners, three or more are needed");
    }
    faces_.end_face();
    materials_.insert(material_.empty() ? "no material" : "'" + material_ + "'");
    line_of_face_.push_back(line_);
    return {};
  }

  std::string_view bytes_;  // the unread part
  const std::string& name_;
  std::size_t line_ = 1;
  std::size_t next_line_ = 1;
  Mesh mesh_;
  TextPrecision precision_;
  PolygonList faces_;
  std::vector<std::size_t> line_of_face_;
  std::string material_;             // of the following faces
  std::set<std::string> materials_;  // of faces
};

}  // namespace

Expected<Mesh> read_obj(std::string_view bytes,
                        const std::string& name,
                        std::vector<SceneNote>& notes) {
  return ObjReader(bytes, name).read(notes);
}

}  // namespace rayloc
