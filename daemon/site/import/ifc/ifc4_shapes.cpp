#include "daemon/site/import/ifc/ifc4_shapes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "engine/base/number_text.h"

namespace rayloc {
namespace {

constexpr std::uint32_t kMaxNested = 500;  // references, chosen: as many as ifc_check.cpp
// [bytes], chosen: as much as a file of IFC 2x3 may have.
constexpr std::size_t kMaxBytes = std::size_t{256} << 20U;

constexpr std::string_view kSeveralTypes = "(of several types)";

}  // namespace

std::string step_list(const std::vector<std::uint64_t>& ids) {
  std::string text;
  for (const std::uint64_t id : ids) {
    text += fmt::format("{}#{}", text.empty() ? "(" : ",", id);
  }
  return text + ")";
}

Ifc4Shapes::Ifc4Shapes(const StepText& step, const std::string& file)
    : step_(step), file_(file), out_("IFC2X3"), shapes_(step.entities().size()) {
  for (const StepEntity& entity : step.entities()) {
    next_id_ = std::max(next_id_, entity.id + 1);
  }
}

Expected<Ifc4Shape> Ifc4Shapes::read(std::string_view reference,
                                     const StepEntity& from,
                                     std::string_view kinds) {
  const std::uint64_t id = step_reference(reference);
  const auto found = step_.find(id);
  if (!found) {
    return refuse(from,
                  id == 0 ? "has no reference where one is needed"
                          : fmt::format("refers to #{}, which does not exist", id));
  }
  const StepEntity& entity = step_.entities()[*found];
  Ifc4Shape& known = shapes_[*found];
  if (known.is_open) {
    return refuse(from, "refers to an entity that refers back to it (a cycle)");
  }
  if (known.id == 0 && known.cause.empty()) {
    if (depth_ == kMaxNested) {
      return refuse(from, fmt::format("has references nested more than {} deep", kMaxNested));
    }
    known.is_open = true;
    ++depth_;
    auto made = convert(entity);
    --depth_;
    RAYLOC_TRY(made);
    known = *made;
    RAYLOC_TRY(check_size(entity));
  }
  if (known.kind != '\0' && !kinds.empty() && kinds.find(known.kind) == std::string_view::npos) {
    return refuse(from,
                  fmt::format("refers to #{} {}, which is no {}",
                              id,
                              step_.type(entity),
                              name_of_ifc4_kind(kinds.front())));
  }
  return known;
}

Expected<Ifc4Shape> Ifc4Shapes::convert(const StepEntity& entity) {
  const std::string_view type = step_.type(entity);
  Ifc4Shape unread;
  unread.cause = type.empty() ? kSeveralTypes : type;
  const Ifc4Rule* const rule = ifc4_rule(type);
  const Ifc4Special* special = rule != nullptr ? nullptr : ifc4_indexed(type);
  special = rule != nullptr || special != nullptr ? special : ifc4_solid(type);
  if (rule == nullptr && special == nullptr) {
    return unread;
  }
  const IfcItems items = step_items(step_.arguments(entity));
  if (items.size() < (rule != nullptr ? rule->attributes.size() / 2 : special->attributes)) {
    return refuse(entity, "has too few attributes");
  }
  auto made = rule != nullptr ? by_rule(entity, items, *rule) : special->read(*this, entity, items);
  if (made) {
    made->kind = rule != nullptr ? rule->kind : special->kind;
  }
  return made;
}

Expected<Ifc4Shape> Ifc4Shapes::by_rule(const StepEntity& entity,
                                        const IfcItems& items,
                                        const Ifc4Rule& rule) {
  Ifc4Shape made;
  made.is_swept = rule.type == "IFCEXTRUDEDAREASOLID";
  std::string arguments;
  for (std::size_t i = 0; 2 * i < rule.attributes.size(); ++i) {
    arguments += i == 0 ? '(' : ',';
    const auto part = attribute(rule.attributes.substr(2 * i, 2), items[i], entity, arguments);
    RAYLOC_TRY(part);
    made.cause = made.cause.empty() ? part->cause : made.cause;
    made.is_swept = made.is_swept || part->is_swept;
    if (rule.type == "IFCPOLYLINE") {
      made.count = part->count;
    }
    if (part->id == 0) {
      return made;
    }
  }
  made.id = entity.id;
  add_as(entity, rule.written.empty() ? rule.type : rule.written, arguments + ")");
  return made;
}

// Appends the attribute to `out`; an id of 0 if it is not read.
Expected<Ifc4Shape> Ifc4Shapes::attribute(std::string_view code,
                                          std::string_view item,
                                          const StepEntity& from,
                                          std::string& out) {
  Ifc4Shape read_shape;
  read_shape.id = 1;
  const auto append = [&](Expected<std::string> text) -> Expected<Ifc4Shape> {
    RAYLOC_TRY(text);
    out += *text;
    return read_shape;
  };
  switch (code.front()) {
    case '=':
      return append(std::string(item));
    case '%':
      return append(number(item, from));
    case '^':
      if (item.size() < 3 || item.front() != '.' || item.back() != '.') {
        return refuse(from, fmt::format("has '{}' in place of a keyword", clipped_step(item)));
      }
      return append(std::string(item));
    case '~':
      return append(coordinates(item, from));
    case '|':
      return append(trims(item, from));
    default:
      return reference(code, item, from, out);
  }
}

Expected<Ifc4Shape> Ifc4Shapes::reference(std::string_view code,
                                          std::string_view item,
                                          const StepEntity& from,
                                          std::string& out) {
  Ifc4Shape all;
  all.id = 1;
  const char mode = code.front();
  if (item == "$" && (mode == '?' || mode == '&')) {
    out += mode == '?' ? "$" : origin(code[1]);
    return all;
  }
  const bool is_list = mode == '@';
  const IfcItems items = is_list ? step_items(item) : IfcItems{item};
  if (items.empty()) {
    all.id = 0;
    all.cause = step_.type(from);
    return all;
  }
  // A placement in the plane in the place of one in space, or the reverse, is not read.
  const bool is_either = code[1] == 'Z';
  const std::string_view kinds = code[1] == 'A' || is_either ? "AB"
                                 : code[1] == 'B'            ? "BA"
                                                             : code.substr(1);
  all.count = static_cast<std::uint32_t>(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    auto part = read(items[i], from, kinds);
    RAYLOC_TRY(part);
    if (part->id != 0 && part->kind != code[1] && !is_either) {
      const auto found = step_.find(step_reference(items[i]));
      part->id = 0;
      part->cause = step_.type(step_.entities()[*found]);
    }
    all.cause = all.cause.empty() ? part->cause : all.cause;
    all.is_swept = all.is_swept || ((code[1] == 'M' || code[1] == 'R') && part->is_swept);
    if (part->id == 0) {
      all.id = 0;
      return all;
    }
    out += fmt::format("{}#{}", i > 0 ? "," : is_list ? "(" : "", part->id);
  }
  out += is_list ? ")" : "";
  return all;
}

Expected<std::string> Ifc4Shapes::trims(std::string_view item, const StepEntity& from) {
  std::string text;
  for (const std::string_view one : step_items(item)) {
    text += text.empty() ? '(' : ',';
    if (one.starts_with('#')) {
      const auto point = read(one, from, "P");
      RAYLOC_TRY(point);
      if (point->id == 0) {
        return refuse(from, "has a trim that is no point");
      }
      text += fmt::format("#{}", point->id);
      continue;
    }
    constexpr std::string_view kParameter = "IFCPARAMETERVALUE";
    const IfcItems values =
        one.starts_with(kParameter) ? step_items(one.substr(kParameter.size())) : IfcItems{};
    const auto parameter = number(values.size() == 1 ? values[0] : one, from);
    RAYLOC_TRY(parameter);
    text += fmt::format("{}({})", kParameter, *parameter);
  }
  return text.empty() ? refuse(from, "has no trim") : Expected<std::string>(text + ")");
}

Expected<double> Ifc4Shapes::value(std::string_view item, const StepEntity& from) const {
  std::string_view rest = item;
  const std::optional<double> read = read_number(rest);
  if (!read || !rest.empty() || !std::isfinite(*read)) {
    return refuse(from, fmt::format("has '{}' where a number is needed", clipped_step(item)));
  }
  return *read;
}

// assimp takes a number without a point for another type.
Expected<std::string> Ifc4Shapes::number(std::string_view item, const StepEntity& from) const {
  RAYLOC_TRY(value(item, from));
  std::string text(item);
  const std::size_t exponent = text.find_first_of("eE");
  if (text.find('.') == std::string::npos) {
    text.insert(exponent == std::string::npos ? text.size() : exponent, ".");
  }
  return text;
}

Expected<std::string> Ifc4Shapes::coordinates(std::string_view item, const StepEntity& from) const {
  const IfcItems items = step_items(item);
  if (items.size() != 2 && items.size() != 3) {
    return refuse(from, "has no list of two or three numbers");
  }
  std::string text;
  for (const std::string_view one : items) {
    const auto coordinate = number(one, from);
    RAYLOC_TRY(coordinate);
    text += (text.empty() ? "(" : ",") + *coordinate;
  }
  return text + ")";
}

std::uint64_t Ifc4Shapes::add(std::uint32_t line,
                              std::string_view type,
                              std::string_view arguments) {
  out_.add(next_id_, line, type, arguments);
  return next_id_++;
}

std::uint64_t Ifc4Shapes::add_point(std::uint32_t line, std::span<const double> at) {
  return add(line, "IFCCARTESIANPOINT", fmt::format("(({:.15e}))", fmt::join(at, ",")));
}

std::string Ifc4Shapes::origin(char kind) {
  const bool is_flat = kind == 'B';
  std::string& text = origins_[is_flat ? 1 : 0];
  if (text.empty()) {
    const std::uint64_t point = add(1, "IFCCARTESIANPOINT", is_flat ? "((0.,0.))" : "((0.,0.,0.))");
    text = fmt::format("#{}",
                       is_flat ? add(1, "IFCAXIS2PLACEMENT2D", fmt::format("(#{},$)", point))
                               : add(1, "IFCAXIS2PLACEMENT3D", fmt::format("(#{},$,$)", point)));
  }
  return text;
}

void Ifc4Shapes::set_context(std::uint64_t placement) {
  const std::string at = placement == 0 ? origin('A') : fmt::format("#{}", placement);
  context_ = fmt::format(
      "#{}",
      add(1, "IFCGEOMETRICREPRESENTATIONCONTEXT", fmt::format("($,'Model',3,1.E-5,{},$)", at)));
}

Expected<void> Ifc4Shapes::check_size(const StepEntity& entity) const {
  if (out_.bytes() <= kMaxBytes) {
    return {};
  }
  return refuse(
      entity,
      fmt::format("and the entities before it have shapes of more than {} MiB; export one "
                  "storey, or with fewer details",
                  kMaxBytes >> 20U));
}

Expected<IfcItems> Ifc4Shapes::items_again(const StepEntity& entity, const StepEntity& from) {
  constexpr std::uint64_t kMaxReadAgain = std::uint64_t{16} * kMaxBytes;  // chosen: seconds
  const std::string_view arguments = step_.arguments(entity);
  read_again_ += arguments.size();
  if (read_again_ > kMaxReadAgain) {
    return refuse(from, fmt::format("refers to #{}, as too many entities do", entity.id));
  }
  return step_items(arguments);
}

tl::unexpected<Error> Ifc4Shapes::refuse(const StepEntity& entity, const std::string& what) const {
  return bad_input(fmt::format("{}:{}: #{} {} {}; export it again, or as GLB",
                               file_,
                               entity.line,
                               entity.id,
                               step_.type(entity).empty() ? kSeveralTypes : step_.type(entity),
                               what));
}

}  // namespace rayloc
