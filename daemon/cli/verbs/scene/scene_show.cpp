// `rayloc scene show`: draws a scene, its antennas, and the paths of a link.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "daemon/cli/arguments/link_arguments.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/lab/draw/link_picture.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/draw/scene_picture.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc::cli {
namespace {

struct SceneShowArguments {
  LinkArguments link;
  std::string access_point;
  double range = 40.0;  // [dB]
  std::string out;
  std::string view = "plan";
};

// Checked before anything is traced.
Expected<void> check_ending(const std::string& file) {
  if (!file.ends_with(".svg") && !file.ends_with(".png")) {
    return make_error(ErrorKind::kUsage,
                      "--out " + file + ": pictures are .svg or .png; choose one by the ending");
  }
  return {};
}

// The other end of a link if only one is given: the middle antenna of an access point.
Expected<Vec3d> access_point_of(const SceneSource& source, const std::string& id) {
  if (!source.site) {
    return make_error(ErrorKind::kUsage,
                      "give both --tx and --rx: the scene names no access point that could be the "
                      "other end");
  }
  std::size_t index = 0;
  if (!id.empty()) {
    const auto found = find_access_point(*source.site, id);
    if (!found) {
      return make_error(ErrorKind::kUsage, "--ap: " + found.error().message);
    }
    index = *found;
  }
  const AntennaArray& array = source.site->access_points[index].array;
  return element_position(array, array.element_offset.size() / 2);
}

std::string text_of(const Vec3d& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

// The requested link; empty if only the scene is requested.
Expected<std::optional<Link>> link_of(const SceneShowArguments& arguments,
                                      const SceneSource& source) {
  LinkArguments wanted = arguments.link;
  if (wanted.tx.empty() && wanted.rx.empty()) {
    return std::nullopt;
  }
  for (std::string* end : {&wanted.tx, &wanted.rx}) {
    if (end->empty()) {
      const auto position = access_point_of(source, arguments.access_point);
      RAYLOC_TRY(position);
      *end = text_of(*position);
    }
  }
  const auto link = parse_link(wanted);
  RAYLOC_TRY(link);
  return *link;
}

Expected<void> run_scene_show(const SceneShowArguments& arguments) {
  RAYLOC_TRY(check_ending(arguments.out));
  const auto source = load_scene_source(arguments.link.scene, arguments.link.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  const auto link = link_of(arguments, *source);
  RAYLOC_TRY(link);
  print_scene_notes(*source->scene);
  draw::ScenePicture picture = draw::source_picture(*source);
  std::string note;
  if (*link) {
    draw::add_link({.transmitter = (*link)->transmitter,
                    .receiver = (*link)->receiver,
                    .marks_transmitter = !arguments.link.tx.empty(),
                    .marks_receiver = !arguments.link.rx.empty(),
                    .options = arguments.link.options,
                    .range_db = arguments.range},
                   *source,
                   picture);
    note = note_on_ends(*source->scene, **link);
    note += picture.paths.empty() ? (note.empty() ? "no path" : "; no path") : "";
  }
  if (!note.empty()) {
    std::fprintf(stderr, "rayloc scene show: %s\n", note.c_str());
  }
  const auto view = arguments.view == "plan" ? draw::View::kPlan : draw::View::k3d;
  const auto bytes = draw::picture_bytes(draw::draw_scene(picture, view), arguments.out);
  return bytes ? write_file(arguments.out, *bytes) : tl::make_unexpected(bytes.error());
}

}  // namespace

RunVerb declare_scene_show(OptionParser& app) {
  const auto arguments = std::make_shared<SceneShowArguments>();
  declare_link(app, arguments->link);
  declare_antennas(app, arguments->link);
  app.add_option("--ap",
                 arguments->access_point,
                 "The other end of the link where only --tx or only --rx is given; default: the "
                 "site's first access point");
  app.add_option("--range", arguments->range, "Draw the paths this much below the strongest [dB]")
      ->check(in_range(1.0, 300.0))
      ->capture_default_str();
  app.add_option("--view", arguments->view, "From above, or isometric from the south-west")
      ->check(one_of({"plan", "3d"}))
      ->capture_default_str();
  app.add_option("--out", arguments->out, "The picture, .svg or .png")->required();
  app.footer(
      "Example:\n"
      "  rayloc scene show tests/data/sites/meeting_room --tx 0.6,0.3,1.2 --out room.svg\n"
      "  rayloc scene show office/scene.xml --tx 1,1,1.2 --rx 4,3,2 --view 3d --out room.png");
  return [arguments] { return run_scene_show(*arguments); };
}

}  // namespace rayloc::cli
