#include "daemon/lab/draw/png.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include <cairo.h>

namespace rayloc::draw {
namespace {

using Image = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// Neighbouring polygons overlap by this much, to hide the page between them.
constexpr double kSeam = 0.3;

class Painter {
 public:
  explicit Painter(cairo_t* cairo) : cairo_(cairo) {
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
  }

  void operator()(const Polygon& polygon) const {
    trace(polygon.corners);
    cairo_close_path(cairo_);
    set(polygon.fill);
    cairo_fill_preserve(cairo_);
    stroke({polygon.fill, polygon.fill.opacity < 1.0 ? 0.0 : kSeam});
  }
  void operator()(const Line& line) const {
    trace(line.points);
    stroke(line.pen);
  }
  void operator()(const Circle& circle) const {
    cairo_new_path(cairo_);
    cairo_arc(cairo_, circle.centre.x, circle.centre.y, circle.radius, 0.0, 2.0 * std::numbers::pi);
    set(circle.fill);
    cairo_fill_preserve(cairo_);
    if (circle.outline) {
      stroke(*circle.outline);
    }
  }
  void operator()(const Text& text) const {
    cairo_select_font_face(cairo_,
                           "DejaVu Sans",
                           CAIRO_FONT_SLANT_NORMAL,
                           text.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_, text.size);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_, text.text.c_str(), &extents);
    constexpr std::array<double, 3> kShares = {0.0, 0.5, 1.0};
    cairo_save(cairo_);
    cairo_translate(cairo_, text.at.x, text.at.y);
    cairo_rotate(cairo_, -text.degrees * std::numbers::pi / 180.0);
    cairo_move_to(
        cairo_, -kShares.at(static_cast<std::size_t>(text.anchor)) * extents.x_advance, 0.0);
    cairo_text_path(cairo_, text.text.c_str());
    if (text.halo) {
      set({255, 255, 255, 1.0});
      cairo_set_line_width(cairo_, 2.5);
      cairo_set_dash(cairo_, nullptr, 0, 0.0);
      cairo_stroke_preserve(cairo_);
    }
    fill(text.colour);
    cairo_restore(cairo_);
  }

 private:
  void trace(const std::vector<PagePoint>& points) const {
    cairo_new_path(cairo_);
    for (const PagePoint& p : points) {
      cairo_line_to(cairo_, p.x, p.y);
    }
  }
  void set(const Colour& colour) const {
    cairo_set_source_rgba(
        cairo_, colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0, colour.opacity);
  }
  void fill(const Colour& colour) const {
    set(colour);
    cairo_fill(cairo_);
  }
  void stroke(const Pen& pen) const {
    constexpr std::array<double, 2> kDashes = {4.0, 3.0};
    set(pen.colour);
    cairo_set_line_width(cairo_, pen.width);
    cairo_set_dash(cairo_, kDashes.data(), pen.dashed ? 2 : 0, 0.0);
    cairo_stroke(cairo_);
  }

  cairo_t* cairo_;
};

cairo_status_t append_bytes(void* bytes, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

tl::unexpected<Error> failed(cairo_status_t status) {
  return make_error(
      ErrorKind::kInternal,
      std::string("the picture cannot be painted: ") + cairo_status_to_string(status));
}

}  // namespace

Expected<std::string> to_png(const Drawing& drawing, double scale) {
  const Image image(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                               static_cast<int>(std::ceil(drawing.width * scale)),
                                               static_cast<int>(std::ceil(drawing.height * scale))),
                    cairo_surface_destroy);
  const Context context(cairo_create(image.get()), cairo_destroy);
  cairo_scale(context.get(), scale, scale);
  cairo_set_source_rgb(context.get(), 1.0, 1.0, 1.0);
  cairo_paint(context.get());
  const Painter painter(context.get());
  for (const Shape& shape : drawing.shapes) {
    std::visit(painter, shape);
  }
  if (const cairo_status_t status = cairo_status(context.get()); status != CAIRO_STATUS_SUCCESS) {
    return failed(status);
  }
  std::string bytes;
  const cairo_status_t status =
      cairo_surface_write_to_png_stream(image.get(), append_bytes, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) {
    return failed(status);
  }
  return bytes;
}

}  // namespace rayloc::draw
