#include "daemon/site/import/ifc/ifc_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_set>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/ifc/ifc_types.h"
#include "daemon/site/import/ifc/ifc_units.h"
#include "daemon/site/import/ifc/row_of.h"

namespace rayloc {
namespace {

constexpr std::uint32_t kMaxDepth = 500;  // of references, chosen: fits into a stack of 8 MiB
constexpr double kMaxElements = 1e6;      // read from one file, chosen

// Entities with an attribute that IFC 2x3 derives and that is written as '*'.
constexpr std::array<std::string_view, 3> kDerived = {
    "IFCSIUNIT", "IFCGEOMETRICREPRESENTATIONSUBCONTEXT", "IFCORIENTEDEDGE"};

// The kinds of a representation, which assimp casts to without a check.
constexpr std::array<std::string_view, 4> kRepresentations = {"IFCREPRESENTATION",
                                                              "IFCSHAPEREPRESENTATION",
                                                              "IFCSTYLEDREPRESENTATION",
                                                              "IFCTOPOLOGYREPRESENTATION"};

// Entities of shapes, by a part of their type. In one of them a number above kMaxNumber makes
// assimp work without an end, or end the process.
constexpr std::array<std::string_view, 13> kShapes = {"CARTESIAN",
                                                      "PROFILEDEF",
                                                      "SOLID",
                                                      "CIRCLE",
                                                      "ELLIPSE",
                                                      "DIRECTION",
                                                      "VECTOR",
                                                      "CURVE",
                                                      "SURFACE",
                                                      "BLOCK",
                                                      "CYLINDER",
                                                      "SPHERE",
                                                      "MEASUREWITHUNIT"};
constexpr double kMaxNumber = 1e11;  // chosen: national coordinates in millimetres are below 1e10

// assimp makes segments of a revolved solid in proportion to its angle times the unit of angles.
constexpr double kMaxAngle = 1e3;       // chosen: a full circle is 360 degrees or 400 gon
constexpr double kMaxAngleUnit = 10.0;  // [rad], chosen: a full circle is below 7

bool is_curve_type(std::string_view type) { return type.find("CURVE") != std::string_view::npos; }

// The first number outside strings above `limit`; empty: none.
std::string_view large_number(std::string_view arguments, double limit) {
  for (std::size_t at = 0; at < arguments.size();) {
    if (arguments[at] == '\'') {
      at = step_string_end(arguments, at);
      continue;
    }
    const std::size_t end = std::min(arguments.find_first_of("(),'", at), arguments.size());
    std::string_view value = arguments.substr(at, end - at);
    value.remove_prefix(value.starts_with('+') ? 1 : 0);
    double number = 0.0;
    const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
    if (read.ec == std::errc::result_out_of_range || !(std::abs(number) <= limit)) {
      return value;
    }
    at = std::max(end, at + 1);
  }
  return "";
}

// Directed graph of entities, by their index: the edges of i are at begin[i] to begin[i + 1].
struct ReferenceGraph {
  std::vector<std::uint32_t> begin;
  std::vector<std::uint32_t> to;
};

struct GraphFault {
  enum class Kind { kCycle, kDeep, kRepeated } kind;
  std::uint32_t at;  // the entity with the edge that closes the cycle, or the entity over the limit
};

// Depth-first search without recursion: a file may be deeper than the stack.
class GraphSearch {
 public:
  explicit GraphSearch(const ReferenceGraph& graph)
      : graph_(graph), states_(graph.begin.size() - 1) {}

  // Repeated: from one entity, more than kMaxElements are reached, each as often as there are
  // paths to it.
  std::optional<GraphFault> fault(bool counts_paths) {
    for (std::uint32_t root = 0; root < states_.size(); ++root) {
      if (states_[root].depth != 0) {
        continue;
      }
      open(root);
      while (!stack_.empty()) {
        const std::uint32_t at = stack_.back();
        State& own = states_[at];
        if (own.next < graph_.begin[at + 1]) {
          const std::uint32_t next = graph_.to[own.next++];
          if (states_[next].depth == 0) {
            open(next);
          } else if (states_[next].is_open) {
            return GraphFault{GraphFault::Kind::kCycle, at};
          } else {
            join(own, states_[next]);
          }
          continue;
        }
        if (own.depth > kMaxDepth) {
          return GraphFault{GraphFault::Kind::kDeep, at};
        }
        if (counts_paths && own.paths > kMaxElements) {
          return GraphFault{GraphFault::Kind::kRepeated, at};
        }
        own.is_open = false;
        stack_.pop_back();
        if (!stack_.empty()) {
          join(states_[stack_.back()], own);
        }
      }
    }
    return std::nullopt;
  }

 private:
  struct State {
    double paths = 1.0;
    std::uint32_t depth = 0;  // 0: not yet visited
    std::uint32_t next = 0;
    bool is_open = false;
  };
  void open(std::uint32_t at) {
    states_[at].depth = 1;
    states_[at].next = graph_.begin[at];
    states_[at].is_open = true;
    stack_.push_back(at);
  }
  static void join(State& above, const State& below) {
    above.depth = std::max(above.depth, below.depth + 1);
    above.paths += below.paths;
  }

  const ReferenceGraph& graph_;
  std::vector<State> states_;
  std::vector<std::uint32_t> stack_;
};

class IfcCheck {
 public:
  IfcCheck(const StepText& step, const std::string& file) : step_(step), file_(file) {}

  Expected<void> check_schema() const {
    constexpr std::string_view kSchema = "IFC2X3";  // and its corrections, IFC2X3_TC1
    if (!step_.schema().starts_with(kSchema)) {
      return bad_input(file_ + ": is of the schema '" + clipped_step(step_.schema()) +
                       "', and only IFC 2x3 and IFC 4 are read; export it as IFC 4 (Reference "
                       "View) or IFC 2x3 (Coordination View), or as GLB");
    }
    return {};
  }

  // Sets the graph of references.
  Expected<void> check_references() {
    for (const StepEntity& entity : step_.entities()) {
      graph_.begin.push_back(static_cast<std::uint32_t>(graph_.to.size()));
      if (!is_ifc2x3_type(step_.type(entity))) {
        continue;  // not read: only a reference to it is a fault
      }
      const std::string_view arguments = step_.arguments(entity);
      std::uint64_t bad = 0;
      bool is_bad = false;
      each_step_reference(arguments, [&](std::uint64_t id) {
        const auto found = step_.find(id);
        if (found && is_ifc2x3_type(step_.type(step_.entities()[*found]))) {
          graph_.to.push_back(static_cast<std::uint32_t>(*found));
        } else if (!is_bad) {
          is_bad = true;
          bad = id;
        }
      });
      if (is_bad) {
        return refuse_reference(entity, bad);
      }
      RAYLOC_TRY(check_derived(entity));
      RAYLOC_TRY(check_representations(entity));
      RAYLOC_TRY(check_numbers(entity));
      RAYLOC_TRY(check_angles(entity));
    }
    graph_.begin.push_back(static_cast<std::uint32_t>(graph_.to.size()));
    return {};
  }

  Expected<void> check_reference_graph() const {
    const auto fault = GraphSearch(graph_).fault(false);
    if (!fault) {
      return {};
    }
    return refuse(fault->at,
                  fault->kind == GraphFault::Kind::kCycle
                      ? "refers to an entity that refers back to it (a cycle)"
                      : fmt::format("has references nested more than {} deep", kMaxDepth));
  }

  // assimp converts a curve again for each curve that has it as a part.
  Expected<void> check_curves() const {
    const auto is_curve = [&](std::uint32_t at) {
      return is_curve_type(step_.type(step_.entities()[at]));
    };
    ReferenceGraph curves;
    for (std::uint32_t at = 0; at < step_.entities().size(); ++at) {
      curves.begin.push_back(static_cast<std::uint32_t>(curves.to.size()));
      if (is_curve(at)) {
        std::copy_if(graph_.to.begin() + graph_.begin[at],
                     graph_.to.begin() + graph_.begin[at + 1],
                     std::back_inserter(curves.to),
                     is_curve);
      }
    }
    curves.begin.push_back(static_cast<std::uint32_t>(curves.to.size()));
    const auto fault = GraphSearch(curves).fault(true);
    return fault ? refuse(fault->at, "has the same curves many times") : Expected<void>();
  }

  // Containment is stated by relations, which no cycle of references shows.
  Expected<void> check_parts() const {
    std::vector<std::vector<std::uint32_t>> parts(step_.entities().size());
    for (const StepEntity& entity : step_.entities()) {
      const IfcPartsRelation* relation = row_of(kIfcPartsRelations, step_.type(entity));
      if (relation == nullptr) {
        continue;
      }
      const auto items = step_items(step_.arguments(entity));
      if (items.size() <= std::max(relation->whole, relation->parts)) {
        return refuse_entity(entity, "has too few attributes");
      }
      const auto whole = step_.find(step_reference(items[relation->whole]));
      if (!whole) {
        return refuse_entity(entity, "names no entity that has the parts");
      }
      each_step_reference(items[relation->parts], [&](std::uint64_t id) {
        parts[*whole].push_back(static_cast<std::uint32_t>(*step_.find(id)));
      });
    }
    ReferenceGraph graph;
    for (const auto& own : parts) {
      graph.begin.push_back(static_cast<std::uint32_t>(graph.to.size()));
      graph.to.insert(graph.to.end(), own.begin(), own.end());
    }
    graph.begin.push_back(static_cast<std::uint32_t>(graph.to.size()));
    const auto fault = GraphSearch(graph).fault(true);
    if (!fault) {
      return {};
    }
    return refuse(fault->at,
                  fault->kind == GraphFault::Kind::kCycle  ? "is a part of its own part (a cycle)"
                  : fault->kind == GraphFault::Kind::kDeep ? "has parts nested too deeply"
                                                           : "has the same parts many times");
  }

 private:
  tl::unexpected<Error> refuse_entity(const StepEntity& entity, const std::string& what) const {
    return bad_input(fmt::format("{}:{}: #{} {} {}; export it again, or as GLB",
                                 file_,
                                 entity.line,
                                 entity.id,
                                 step_.type(entity),
                                 what));
  }
  tl::unexpected<Error> refuse(std::uint32_t at, const std::string& what) const {
    return refuse_entity(step_.entities()[at], what);
  }
  tl::unexpected<Error> refuse_reference(const StepEntity& entity, std::uint64_t id) const {
    const auto found = step_.find(id);
    if (!found) {
      return refuse_entity(entity, fmt::format("refers to #{}, which does not exist", id));
    }
    const std::string_view type = step_.type(step_.entities()[*found]);
    return bad_input(fmt::format(
        "{}:{}: #{} {} refers to #{}, whose type {} is not in IFC 2x3; export it as IFC 2x3 "
        "(Coordination View), or as GLB",
        file_,
        entity.line,
        entity.id,
        step_.type(entity),
        id,
        type.empty() ? "(of several)" : clipped_step(type)));
  }
  Expected<void> check_derived(const StepEntity& entity) const {
    if (std::find(kDerived.begin(), kDerived.end(), step_.type(entity)) != kDerived.end()) {
      return {};
    }
    for (const std::string_view item : step_items(step_.arguments(entity))) {
      if (item == "*") {
        return refuse_entity(entity, "has '*' in place of an attribute");
      }
    }
    return {};
  }

  Expected<void> check_representations(const StepEntity& entity) const {
    constexpr std::size_t kItems = 2;  // the place of the representations among the attributes
    const std::string_view type = step_.type(entity);
    if (type != "IFCPRODUCTDEFINITIONSHAPE" && type != "IFCPRODUCTREPRESENTATION") {
      return {};
    }
    const auto items = step_items(step_.arguments(entity));
    if (items.size() <= kItems) {
      return refuse_entity(entity, "has too few attributes");
    }
    for (const std::string_view one : step_items(items[kItems])) {
      const auto found = step_.find(step_reference(one));
      const std::string_view kind = found ? step_.type(step_.entities()[*found]) : "";
      if (std::find(kRepresentations.begin(), kRepresentations.end(), kind) ==
          kRepresentations.end()) {
        return refuse_entity(entity, fmt::format("has {} for a representation", clipped_step(one)));
      }
    }
    return {};
  }

  Expected<void> check_numbers(const StepEntity& entity) const {
    const std::string_view type = step_.type(entity);
    if (std::none_of(kShapes.begin(), kShapes.end(), [&](std::string_view part) {
          return type.find(part) != std::string_view::npos;
        })) {
      return {};
    }
    const std::string_view large = large_number(step_.arguments(entity), kMaxNumber);
    if (large.empty()) {
      return {};
    }
    return refuse_entity(
        entity, fmt::format("has the number {}, too large for a shape", clipped_step(large)));
  }

  Expected<void> check_angles(const StepEntity& entity) {
    constexpr std::size_t kAngle = 3;   // its place among the attributes
    constexpr std::size_t kFactor = 3;  // same
    const std::string_view type = step_.type(entity);
    const bool is_revolved = type == "IFCREVOLVEDAREASOLID";
    if (!is_revolved && type != "IFCCONVERSIONBASEDUNIT") {
      return {};
    }
    const auto items = step_items(step_.arguments(entity));
    if (is_revolved) {
      const std::string_view large =
          items.size() > kAngle ? large_number(items[kAngle], kMaxAngle) : "";
      return large.empty() ? Expected<void>()
                           : refuse_entity(entity,
                                           fmt::format("has the angle {}, too large for a shape",
                                                       clipped_step(large)));
    }
    const bool is_angle = items.size() > kFactor && items[1] == ".PLANEANGLEUNIT.";
    return is_angle ? check_angle_unit(step_reference(items[kFactor])) : Expected<void>();
  }

  // Each factor is read once: many units may have the same one.
  Expected<void> check_angle_unit(std::uint64_t factor) {
    const auto found = step_.find(factor);
    if (!found || !angle_units_.insert(factor).second) {
      return {};
    }
    const StepEntity& entity = step_.entities()[*found];
    if (step_.type(entity) != "IFCMEASUREWITHUNIT") {
      return {};
    }
    const auto items = step_items(step_.arguments(entity));
    const double value = items.empty() ? 0.0 : ifc_measure(items[0]);
    if (value > 0.0 && value <= kMaxAngleUnit) {
      return {};
    }
    return refuse_entity(
        entity,
        fmt::format("has no value above 0 and up to {} for a unit of angles", kMaxAngleUnit));
  }

  const StepText& step_;
  const std::string& file_;
  ReferenceGraph graph_;
  std::unordered_set<std::uint64_t> angle_units_;
};

// A string for assimp, which removes spaces and searches the whole line for '#' and ')'.
std::string plain_string(std::string_view value) {
  std::string text = step_string(value);
  std::replace_if(
      text.begin(),
      text.end(),
      [](char c) { return std::string_view("#\\()'\";,=*").find(c) != std::string_view::npos; },
      '_');
  return "'" + text + "'";
}

void append_plain(std::string_view arguments, std::string& out) {
  for (std::size_t at = 0; at < arguments.size();) {
    if (arguments[at] != '\'') {
      out += arguments[at++];
      continue;
    }
    const std::size_t end = step_string_end(arguments, at);
    out += plain_string(arguments.substr(at, end - at));
    at = end;
  }
}

}  // namespace

Expected<void> check_ifc(const StepText& step, const std::string& file) {
  IfcCheck check(step, file);
  RAYLOC_TRY(check.check_schema());
  RAYLOC_TRY(check.check_references());
  RAYLOC_TRY(check.check_reference_graph());
  RAYLOC_TRY(check.check_curves());
  return check.check_parts();
}

std::string plain_ifc(const StepText& step) {
  std::string out = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n";
  for (const StepEntity& entity : step.entities()) {
    if (!is_ifc2x3_type(step.type(entity))) {
      continue;
    }
    out += fmt::format("#{}={}", entity.id, step.type(entity));
    append_plain(step.arguments(entity), out);
    out += ";\n";
  }
  return out + "ENDSEC;\nEND-ISO-10303-21;\n";
}

}  // namespace rayloc
