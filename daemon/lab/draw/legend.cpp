#include "daemon/lab/draw/legend.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/plan/palette.h"

namespace rayloc::draw {
namespace {

constexpr double kLegendLineHeight = 17.0;
constexpr double kLegendTextSize = 10.5;
constexpr std::size_t kMaxMaterials = 16;

Polygon rectangle(const PagePoint& corner, double width, double height, const Colour& fill) {
  return {{corner,
           {corner.x + width, corner.y},
           {corner.x + width, corner.y + height},
           {corner.x, corner.y + height}},
          fill};
}

Line frame(const PagePoint& corner, double width, double height) {
  return {{corner,
           {corner.x + width, corner.y},
           {corner.x + width, corner.y + height},
           {corner.x, corner.y + height},
           corner},
          {kFaintInk, 0.7}};
}

// Writes from top to bottom.
class Column {
 public:
  explicit Column(const PagePoint& corner) : at_(corner), top_(corner.y) {}

  void heading(const std::string& text) {
    at_.y += at_.y > top_ ? 8.0 : 0.0;
    Text heading{{at_.x, at_.y + 11.0}, text, kLegendTextSize, kInk};
    heading.bold = true;
    legend_.shapes.emplace_back(std::move(heading));
    at_.y += kLegendLineHeight + 2.0;
  }
  void material(const std::string& name) {
    constexpr double kWidth = 20.0;
    constexpr double kHeight = 11.0;
    legend_.shapes.emplace_back(rectangle(at_, kWidth, kHeight, material_colour(name)));
    legend_.shapes.emplace_back(frame(at_, kWidth, kHeight));
    line(name);
  }
  void mark(MarkKind kind, const std::string& name) {
    for (Shape& shape : draw_antenna({at_.x + 10.0, at_.y + 6.0}, kind)) {
      legend_.shapes.push_back(std::move(shape));
    }
    line(name);
  }
  // A bar from the strongest (above) to the weakest.
  void powers(double strongest_db, double weakest_db) {
    constexpr double kHeight = 96.0;
    constexpr double kWidth = 14.0;
    constexpr int kBands = 24;
    for (int i = 0; i < kBands; ++i) {
      const double share = 1.0 - (i + 0.5) / kBands;
      legend_.shapes.emplace_back(rectangle(
          {at_.x, at_.y + i * kHeight / kBands}, kWidth, kHeight / kBands, power_colour(share)));
    }
    legend_.shapes.emplace_back(frame(at_, kWidth, kHeight));
    for (int i = 0; i <= 3; ++i) {
      const double part = i / 3.0;
      const double y = at_.y + part * kHeight;
      legend_.shapes.emplace_back(
          Line{{{at_.x + kWidth, y}, {at_.x + kWidth + 4.0, y}}, {kFaintInk, 0.7}});
      legend_.shapes.emplace_back(
          Text{{at_.x + kWidth + 8.0, y + 3.5},
               fmt::format("{:.0f} dB", strongest_db + part * (weakest_db - strongest_db)),
               kLegendTextSize,
               kInk});
    }
    at_.y += kHeight + 10.0;
  }
  void scale_bar(double pixels_per_metre, const std::string& unit) {
    constexpr double kLongest = 120.0;
    constexpr std::array<double, 9> kLengths = {100, 50, 20, 10, 5, 2, 1, 0.5, 0.1};
    const double metres = *std::find_if(kLengths.begin(), kLengths.end() - 1, [&](double length) {
      return length * pixels_per_metre <= kLongest;
    });
    const double end = at_.x + metres * pixels_per_metre;
    const double y = at_.y + 8.0;
    const Pen pen{kInk, 1.4};
    legend_.shapes.emplace_back(Line{{{at_.x, y}, {end, y}}, pen});
    for (const double x : {at_.x, end}) {
      legend_.shapes.emplace_back(Line{{{x, y - 4.0}, {x, y + 4.0}}, pen});
    }
    legend_.shapes.emplace_back(
        Text{{at_.x, y + 17.0}, fmt::format("{:g} {}", metres, unit), kLegendTextSize, kInk});
    at_.y += 32.0;
  }

  Legend finish() {
    legend_.height = at_.y - top_;
    return std::move(legend_);
  }

 private:
  void line(const std::string& text) {
    legend_.shapes.emplace_back(Text{{at_.x + 28.0, at_.y + 10.0}, text, kLegendTextSize, kInk});
    at_.y += kLegendLineHeight;
  }

  Legend legend_;
  PagePoint at_;
  double top_;
};

}  // namespace

std::vector<Shape> draw_antenna(const PagePoint& at, MarkKind kind) {
  const Pen rim{{255, 255, 255, 1.0}, 1.2};
  switch (kind) {
    case MarkKind::kAccessPoint:
      return {Circle{at, 3.4, kReceiverInk, rim}};
    case MarkKind::kReceiver:
      return {Circle{at, 5.0, kReceiverInk, rim}};
    case MarkKind::kTransmitter:
      break;
  }
  return {Circle{at, 5.0, kTransmitterInk, rim}};
}

Legend draw_legend(const ScenePicture& picture,
                   View view,
                   double pixels_per_metre,
                   const PagePoint& corner) {
  Column column(corner);
  column.heading("Scale");
  column.scale_bar(pixels_per_metre, view == View::kPlan ? "m" : "m along x, y, z");
  if (!picture.paths.empty()) {
    column.heading("Power of a path");
    column.powers(picture.strongest_db, picture.weakest_db);
  }
  std::set<MarkKind> kinds;
  for (const Mark& mark : picture.marks) {
    kinds.insert(mark.kind);
  }
  if (!kinds.empty()) {
    column.heading("Antennas");
  }
  for (const MarkKind kind : kinds) {
    constexpr std::array<const char*, 3> kNames = {"access point", "transmitter", "receiver"};
    column.mark(kind, kNames.at(static_cast<std::size_t>(kind)));
  }
  column.heading("Materials");
  const auto& materials = picture.scene->materials();
  for (std::size_t i = 0; i < std::min(materials.size(), kMaxMaterials); ++i) {
    column.material(materials[i].name);
  }
  return column.finish();
}

}  // namespace rayloc::draw
