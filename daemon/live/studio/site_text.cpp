#include "daemon/live/studio/site_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/live/studio/toml_text.h"

namespace rayloc {
namespace {

constexpr double kRounding = 1e-3;  // [m, degrees], above the rounding of a written number
constexpr std::array<const char*, 3> kAngles = {"yaw_deg", "pitch_deg", "roll_deg"};

// ---- Reading -----------------------------------------------------------------------------------
std::string text_at(const toml::table& table, std::string_view key) {
  return table[key].value_or<std::string>("");
}

std::vector<double> numbers_of(const toml::node* node) {
  std::vector<double> numbers;
  if (const toml::array* const array = node != nullptr ? node->as_array() : nullptr) {
    numbers.reserve(array->size());
    for (const toml::node& one : *array) {
      numbers.push_back(one.value_or(0.0));
    }
  }
  return numbers;
}

Vec3d vector_at(const toml::table& table, std::string_view key) {
  std::vector<double> v = numbers_of(table.get(key));
  v.resize(3);
  return {v[0], v[1], v[2]};
}

std::vector<const toml::table*> tables_at(const toml::table& table, std::string_view key) {
  std::vector<const toml::table*> tables;
  if (const toml::array* const array = table[key].as_array()) {
    tables.reserve(array->size());
    for (const toml::node& one : *array) {
      if (one.is_table()) {
        tables.push_back(one.as_table());
      }
    }
  }
  return tables;
}

DraftAccessPoint read_access_point(const toml::table& table) {
  DraftAccessPoint one;
  one.was = one.id = text_at(table, "id");
  one.position = vector_at(table, "position");
  for (std::size_t i = 0; i < kAngles.size(); ++i) {
    one.degrees.at(i) = table[kAngles.at(i)].value_or(0.0);
  }
  for (const toml::table* antenna : tables_at(table, "antenna")) {
    one.antennas.push_back({(*antenna)["core"].value_or(0), vector_at(*antenna, "offset")});
  }
  return one;
}

DraftZone read_zone(const toml::table& table) {
  DraftZone one;
  one.was = one.name = text_at(table, "name");
  if (const toml::array* const polygon = table["polygon"].as_array()) {
    one.polygon.reserve(polygon->size());
    for (const toml::node& corner : *polygon) {
      std::vector<double> v = numbers_of(&corner);
      v.resize(2);
      one.polygon.push_back({v[0], v[1]});
    }
  }
  return one;
}

SiteDraft read_root(const toml::table& root) {
  SiteDraft draft;
  for (const toml::table* table : tables_at(root, "access_point")) {
    draft.access_points.push_back(read_access_point(*table));
  }
  for (const toml::table* table : tables_at(root, "zone")) {
    draft.zones.push_back(read_zone(*table));
  }
  for (const toml::table* table : tables_at(root, "transmitter")) {
    const std::string mac = text_at(*table, "mac");
    draft.devices.push_back(
        {mac, mac, text_at(*table, "name"), text_at(*table, "role") == "fixed"});
  }
  return draft;
}

// ---- Writing -----------------------------------------------------------------------------------
std::string vector_text(const Vec3d& v) {
  return fmt::format("[{}, {}, {}]", number_text(v.x), number_text(v.y), number_text(v.z));
}

std::string polygon_text(const std::vector<FloorPoint>& polygon) {
  std::string text;
  for (const FloorPoint& p : polygon) {
    text +=
        fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", number_text(p[0]), number_text(p[1]));
  }
  return "[" + text + "]";
}

std::string antenna_text(const DraftAntenna& antenna) {
  return fmt::format("[[access_point.antenna]]\ncore = {}\noffset = {}\n",
                     antenna.rx_chain,
                     vector_text(antenna.offset));
}

std::string block_of(const DraftAccessPoint& one) {
  std::string text = fmt::format("\n[[access_point]]{}\nid = {}\nposition = {}\nyaw_deg = {}\n",
                                 one.model.empty() ? "" : "  # " + one.model,
                                 toml_string(one.id),
                                 vector_text(one.position),
                                 number_text(one.degrees[0]));
  for (std::size_t i = 1; i < kAngles.size(); ++i) {
    if (one.degrees.at(i) != 0.0) {
      text += fmt::format("{} = {}\n", kAngles.at(i), number_text(one.degrees.at(i)));
    }
  }
  for (const DraftAntenna& antenna : one.antennas) {
    text += antenna_text(antenna);
  }
  return text;
}

std::string block_of(const DraftZone& one) {
  return fmt::format(
      "\n[[zone]]\nname = {}\npolygon = {}\n", toml_string(one.name), polygon_text(one.polygon));
}

std::string block_of(const DraftDevice& one) {
  std::string text =
      fmt::format("\n[[transmitter]]\nrole = \"device\"\nmac = {}\n", toml_string(one.mac));
  return one.name.empty() ? text : text + fmt::format("name = {}\n", toml_string(one.name));
}

class SiteEditing {
 public:
  explicit SiteEditing(TomlText& text) : text_(text) {}

  // Changes the tables of `kind` to the requested ones. `change`: applied to one that stays.
  template <typename One>
  void edit(std::string_view kind,
            const std::vector<One>& is,
            const std::vector<One>& wanted,
            void (SiteEditing::*change)(const toml::table&, const One&, const One&)) {
    const std::vector<const toml::table*> tables = tables_at(text_.root(), kind);
    for (std::size_t i = 0; i < is.size() && i < tables.size(); ++i) {
      const auto found = std::find_if(wanted.begin(), wanted.end(), [&](const One& one) {
        return !one.was.empty() && one.was == is[i].was;
      });
      if (found == wanted.end()) {
        note(text_.erase_table(*tables[i]));
      } else {
        (this->*change)(*tables[i], is[i], *found);
      }
    }
    for (const One& one : wanted) {
      if (one.was.empty()) {
        text_.append_after(tables.empty() ? nullptr : tables.back(), block_of(one));
      }
    }
  }

  void change_access_point(const toml::table& table,
                           const DraftAccessPoint& is,
                           const DraftAccessPoint& wanted) {
    set_if(is.id != wanted.id, table, "id", toml_string(wanted.id));
    set_if(
        norm(is.position - wanted.position) > 0.0, table, "position", vector_text(wanted.position));
    for (std::size_t i = 0; i < kAngles.size(); ++i) {
      set_if(is.degrees.at(i) != wanted.degrees.at(i),
             table,
             kAngles.at(i),
             number_text(wanted.degrees.at(i)));
    }
    change_antennas(table, is.antennas, wanted.antennas);
  }

  void change_zone(const toml::table& table, const DraftZone& is, const DraftZone& wanted) {
    set_if(is.name != wanted.name, table, "name", toml_string(wanted.name));
    set_if(is.polygon != wanted.polygon, table, "polygon", polygon_text(wanted.polygon));
  }

  void change_device(const toml::table& table, const DraftDevice& is, const DraftDevice& wanted) {
    set_if(is.mac != wanted.mac, table, "mac", toml_string(wanted.mac));
    if (wanted.name.empty()) {
      text_.erase(table, "name");
    } else {
      set_if(is.name != wanted.name, table, "name", toml_string(wanted.name));
    }
  }

  // The first edit that failed, if any.
  const std::optional<Error>& error() const { return error_; }

 private:
  void change_antennas(const toml::table& table,
                       const std::vector<DraftAntenna>& is,
                       const std::vector<DraftAntenna>& wanted) {
    if (is == wanted) {
      return;
    }
    const std::vector<const toml::table*> tables = tables_at(table, "antenna");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      if (i >= wanted.size()) {
        note(text_.erase_table(*tables[i]));
        continue;
      }
      set_if(is[i].rx_chain != wanted[i].rx_chain,
             *tables[i],
             "core",
             std::to_string(wanted[i].rx_chain));
      set_if(norm(is[i].offset - wanted[i].offset) > 0.0,
             *tables[i],
             "offset",
             vector_text(wanted[i].offset));
    }
    for (std::size_t i = tables.size(); i < wanted.size(); ++i) {
      text_.append_after(&table, antenna_text(wanted[i]));
    }
  }

  void set_if(bool differs,
              const toml::table& table,
              std::string_view key,
              const std::string& value) {
    if (differs) {
      note(text_.set(table, key, value));
    }
  }

  void note(const Expected<void>& done) {
    if (!done && !error_) {
      error_ = done.error();
    }
  }

  TomlText& text_;
  std::optional<Error> error_;
};

// ---- Verification of the result
// ----------------------------------------------------------------------
bool near(const Vec3d& a, const Vec3d& b) { return norm(a - b) < kRounding; }

bool same(const DraftAccessPoint& a, const DraftAccessPoint& b) {
  bool equal =
      a.id == b.id && near(a.position, b.position) && a.antennas.size() == b.antennas.size();
  for (std::size_t i = 0; i < 3; ++i) {
    equal = equal && std::abs(a.degrees.at(i) - b.degrees.at(i)) < kRounding;
  }
  for (std::size_t i = 0; equal && i < a.antennas.size(); ++i) {
    equal = a.antennas[i].rx_chain == b.antennas[i].rx_chain &&
            near(a.antennas[i].offset, b.antennas[i].offset);
  }
  return equal;
}

bool same(const DraftZone& a, const DraftZone& b) {
  bool equal = a.name == b.name && a.polygon.size() == b.polygon.size();
  for (std::size_t i = 0; equal && i < a.polygon.size(); ++i) {
    equal = std::abs(a.polygon[i][0] - b.polygon[i][0]) < kRounding &&
            std::abs(a.polygon[i][1] - b.polygon[i][1]) < kRounding;
  }
  return equal;
}

bool same(const DraftDevice& a, const DraftDevice& b) { return a.mac == b.mac && a.name == b.name; }

template <typename One>
bool same_all(const std::vector<One>& written, const std::vector<One>& wanted) {
  return written.size() == wanted.size() &&
         std::all_of(wanted.begin(), wanted.end(), [&](const One& one) {
           return std::any_of(
               written.begin(), written.end(), [&](const One& other) { return same(other, one); });
         });
}

bool printable_text(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20U || static_cast<unsigned char>(c) == 0x7FU;
  });
}

// Refuses texts with characters that would end a line of the file.
Expected<void> check_texts(const SiteDraft& draft) {
  std::vector<std::string> texts;
  for (const DraftAccessPoint& one : draft.access_points) {
    texts.insert(texts.end(), {one.id, one.model});
  }
  for (const DraftZone& one : draft.zones) {
    texts.push_back(one.name);
  }
  for (const DraftDevice& one : draft.devices) {
    texts.insert(texts.end(), {one.mac, one.name});
  }
  return std::all_of(texts.begin(), texts.end(), printable_text)
             ? Expected<void>()
             : bad_input("a name has a control character; write names of one line");
}

}  // namespace

std::string number_text(double value) {
  constexpr double kPerUnit = 1e4;
  return fmt::format("{}", std::round(value * kPerUnit) / kPerUnit + 0.0);
}

Expected<SiteDraft> read_site_text(const std::string& text, const std::filesystem::path& file) {
  const auto parsed = TomlText::parse(text, file);
  return parsed ? Expected<SiteDraft>(read_root(parsed->root()))
                : tl::make_unexpected(parsed.error());
}

Expected<std::string> edit_site_text(const std::string& text,
                                     const std::filesystem::path& file,
                                     const SiteDraft& draft) {
  RAYLOC_TRY(check_texts(draft));
  auto parsed = TomlText::parse(text, file);
  RAYLOC_TRY(parsed);
  const SiteDraft is = read_root(parsed->root());
  SiteEditing editing(*parsed);
  editing.edit(
      "access_point", is.access_points, draft.access_points, &SiteEditing::change_access_point);
  editing.edit("transmitter", is.devices, draft.devices, &SiteEditing::change_device);
  editing.edit("zone", is.zones, draft.zones, &SiteEditing::change_zone);
  if (editing.error()) {
    return make_error(editing.error()->kind, file.string() + ": " + editing.error()->message);
  }
  std::string edited = parsed->edited();
  const auto written = read_site_text(edited, file);
  if (!written || !same_all(written->access_points, draft.access_points) ||
      !same_all(written->zones, draft.zones) || !same_all(written->devices, draft.devices)) {
    return make_error(ErrorKind::kInternal,
                      file.string() +
                          ": it is written in a way that cannot be changed here; "
                          "nothing was written. Edit the file itself");
  }
  return edited;
}

}  // namespace rayloc
