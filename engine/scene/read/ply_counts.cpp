#include "engine/scene/read/ply_counts.h"

#include <cmath>

#include "engine/scene/read/mesh_reader.h"
#include "engine/scene/read/ply_body.h"

namespace rayloc {
namespace {

constexpr double kMinCorners = 3.0;

struct PlyCount {
  std::size_t element = 0;  // index in PlyHeader::elements
  std::size_t count = 0;    // matching the body
};

class CountSearch {
 public:
  CountSearch(std::string_view bytes, const PlyHeader& header)
      : header_(header), body_(bytes, header) {
    // Entries, chosen: a few times those of the file. Most trials end at their first face.
    constexpr std::size_t kTrials = 8;
    work_left_ = kTrials * (bytes.size() + 1);
    for (const PlyElement& element : header.elements) {
      vertices_ += element.name == "vertex" ? element.count : 0;
    }
  }

  bool fits_as_counted() { return fits(body_, 0); }

  std::optional<PlyCount> find() {
    std::optional<PlyCount> found;
    // The last element may just be longer, so it is tried before those that all others depend on.
    for (std::size_t i = header_.elements.size(); i-- > 0 && !found;) {
      found = find(i);
    }
    return found;
  }

 private:
  // With another count for that element, and the header's counts for all others.
  std::optional<PlyCount> find(std::size_t changed) {
    PlyBody body = body_;
    for (std::size_t i = 0; i < changed; ++i) {
      if (!skip(body, header_.elements[i], header_.elements[i].count)) {
        return std::nullopt;
      }
    }
    const PlyElement& element = header_.elements[changed];
    const std::size_t stated = vertices_;
    std::optional<PlyCount> found;
    for (std::size_t count = 0; !found; ++count) {
      if (element.name == "vertex") {
        vertices_ = stated - element.count + count;
      }
      if (count > 0 && count != element.count && fits(body, changed + 1)) {
        found = PlyCount{changed, count};
      }
      const std::size_t before = body.bytes_left();
      if (!skip(body, element, 1) || body.bytes_left() == before) {
        break;
      }
    }
    vertices_ = stated;
    return found;
  }

  // True if the body from here to its end consists of the elements from `first` on.
  bool fits(PlyBody body, std::size_t first) {
    for (std::size_t i = first; i < header_.elements.size(); ++i) {
      if (!skip(body, header_.elements[i], header_.elements[i].count)) {
        return false;
      }
    }
    return body.is_at_end();
  }

  bool skip(PlyBody& body, const PlyElement& element, std::size_t count) {
    if (element.properties.empty()) {
      return true;  // any number of them, they take no byte
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!skip_entry(body, element)) {
        return false;
      }
    }
    return true;
  }

  bool skip_entry(PlyBody& body, const PlyElement& element) {
    bool is_first = true;
    const auto next = [&](PlyType type) -> std::optional<double> {
      if (work_left_ == 0) {
        return std::nullopt;
      }
      --work_left_;
      const auto value = body.next(type);
      const bool is_misplaced = body.is_text() && body.begins_line() != is_first;
      is_first = false;
      return is_misplaced ? std::nullopt : value;
    };
    for (const PlyProperty& property : element.properties) {
      const bool is_face = use_of(element, property) == PlyUse::kFace;
      const auto length = property.count_type ? next(*property.count_type) : std::optional(1.0);
      if (!length || !(*length >= (is_face ? kMinCorners : 0.0)) ||
          *length > static_cast<double>(body.bytes_left())) {
        return false;
      }
      for (auto k = static_cast<std::size_t>(*length); k > 0; --k) {
        const auto value = next(property.type);
        if (!value || (is_face && !is_vertex(*value))) {
          return false;
        }
      }
    }
    return true;
  }

  bool is_vertex(double value) const {
    return value >= 0.0 && value < static_cast<double>(vertices_) && value == std::floor(value);
  }

  const PlyHeader& header_;
  PlyBody body_;  // at its beginning
  std::size_t vertices_ = 0;
  std::size_t work_left_ = 0;  // [numbers]
};

}  // namespace

bool has_regular_body(std::string_view bytes, const PlyHeader& header) {
  return CountSearch(bytes, header).fits_as_counted();
}

std::optional<PlyMiscount> find_miscount(std::string_view bytes,
                                         const std::string& name,
                                         const PlyHeader& header) {
  const auto found = CountSearch(bytes, header).find();
  if (!found) {
    return std::nullopt;
  }
  const PlyElement& element = header.elements[found->element];
  const bool is_left_over =
      found->element + 1 == header.elements.size() && found->count > element.count;
  return PlyMiscount{name + ":" + std::to_string(element.line) + ": the header counts " +
                         std::to_string(element.count) + " of element '" + element.name +
                         "', the file holds " + std::to_string(found->count) +
                         (is_left_over ? ": the others are left out" : "") +
                         "; correct the header, or export the mesh again",
                     is_left_over};
}

Expected<void> check_ply(std::string_view bytes,
                         const std::string& name,
                         std::vector<SceneNote>& notes) {
  const auto header = read_ply_header(bytes, name);
  RAYLOC_TRY(header);
  if (has_regular_body(bytes, *header)) {
    return {};
  }
  const auto miscount = find_miscount(bytes, name, *header);
  if (miscount && !miscount->is_left_over) {
    return bad_input(miscount->message);
  }
  if (miscount) {
    notes.push_back({"mesh_count", {}, miscount->message});
  }
  return {};
}

}  // namespace rayloc
