// Transmitter, Receiver and OfdmGrid.
#include <array>
#include <cmath>
#include <cstdint>

#include <pybind11/stl.h>

#include "engine/trace/radio_device.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using Triple = std::array<double, 3>;

Vec3d vector_from(const Triple& v, const char* what) {
  for (const double x : v) {
    if (!std::isfinite(x)) {
      refuse(std::string(what) + ": three finite numbers are needed");
    }
  }
  return {v[0], v[1], v[2]};
}

Polarization polarization_of(const std::string& name) {
  if (name != "V" && name != "H") {
    refuse("polarization '" + name + "': write V or H");
  }
  return name == "V" ? Polarization::kVertical : Polarization::kHorizontal;
}

AntennaPattern pattern_of(const std::string& name) {
  const auto pattern = parse_antenna_pattern(name);
  if (!pattern) {
    refuse("there is no antenna pattern '" + name +
           "': half_wave_dipole, dipole, isotropic or tr38901");
  }
  return *pattern;
}

template <typename Device>
Device device_of(const Triple& position,
                 const Triple& orientation,
                 const std::string& pattern,
                 const std::string& polarization,
                 const Triple& lever) {
  const Vec3d turn = vector_from(orientation, "orientation");
  return Device{{vector_from(position, "position"),
                 {turn.x, turn.y, turn.z},
                 pattern_of(pattern),
                 polarization_of(polarization),
                 vector_from(lever, "lever")}};
}

Triple triple_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

template <typename Device>
void bind_device(py::module_& module, const char* name, const std::string& doc) {
  py::class_<Device>(module, name, doc.c_str())
      .def(py::init(&device_of<Device>),
           py::arg("position"),
           py::arg("orientation") = Triple{},
           py::arg("pattern") = "isotropic",
           py::arg("polarization") = "V",
           py::arg("lever") = Triple{},
           "Args as the attributes of the class.")
      .def_property_readonly(
          "position",
          [](const Device& device) { return triple_of(device.position); },
          "Position of the antenna [m], world.")
      .def_property_readonly(
          "orientation",
          [](const Device& device) {
            return Triple{
                device.orientation.yaw, device.orientation.pitch, device.orientation.roll};
          },
          "Yaw, pitch, roll about z, y, x [rad]; world from device.")
      .def_property_readonly(
          "pattern",
          [](const Device& device) { return std::string(to_string(device.pattern)); },
          "Name of the antenna pattern.")
      .def_property_readonly(
          "polarization",
          [](const Device& device) {
            return std::string(device.polarization == Polarization::kVertical ? "V" : "H");
          },
          "V or H of the antenna's frame.")
      .def_property_readonly(
          "lever",
          [](const Device& device) { return triple_of(device.lever); },
          "From the origin of the array that it belongs to [m], device frame.")
      .def("__repr__", [name](const Device& device) {
        return py::str("{}(({:.6g}, {:.6g}, {:.6g}))")
            .format(name, device.position.x, device.position.y, device.position.z);
      });
}

// `what`: the first sentence; `turn`: the parameter that rotates the device's array.
std::string device_doc(const std::string& what, const std::string& turn) {
  return what + R"(

Args:
    position: x, y, z [m].
    orientation: yaw, pitch, roll about z, y, x [rad]; R = Rz Ry Rx, boresight local +x.
    pattern: half_wave_dipole, dipole, isotropic or tr38901.
    polarization: V (along theta of its frame) or H (along phi).
    lever: from the origin of its array [m], device frame; for )" +
         turn + R"( alone.

Shapes: triples. Units: metres, radians. Frame: world, right-handed, z up.
Errors: rayloc.Error for a number that is not finite and for an unknown name.
Source: engine/trace/radio_device.h, engine/em/antenna_pattern.h.)";
}

OfdmGrid make_ofdm_grid(double centre, double spacing, std::vector<std::int16_t> tones) {
  if (!(std::isfinite(centre) && std::isfinite(spacing) && spacing > 0.0)) {
    refuse("OfdmGrid: centre and spacing are finite, in Hz, and the spacing is above 0");
  }
  for (std::size_t i = 1; i < tones.size(); ++i) {
    if (tones[i] <= tones[i - 1]) {
      refuse("OfdmGrid: tone_index ascends");
    }
  }
  return {centre, spacing, std::move(tones)};
}

OfdmGrid grid_of_count(double centre, double spacing, int count) {
  constexpr int kMost = 65'536;  // as `rayloc trace --cfr`: the range of 16-bit numbers
  if (count < 1 || count > kMost) {
    refuse("OfdmGrid.of: count is from 1 to 65536");
  }
  std::vector<std::int16_t> tones;
  tones.reserve(static_cast<std::size_t>(count));
  for (int j = 0; j < count; ++j) {
    tones.push_back(static_cast<std::int16_t>(j - count / 2));
  }
  return make_ofdm_grid(centre, spacing, std::move(tones));
}

void bind_grid(py::module_& module) {
  py::class_<OfdmGrid>(module, "OfdmGrid", R"(The tones at which a channel is wanted.

Tone j is at centre + tone_index[j] * spacing.

Args:
    centre: centre frequency of the channel [Hz].
    spacing: distance of neighbouring tones [Hz].
    tone_index: whole numbers that ascend; 0 is the centre.

Shapes: `frequencies` is (tones,). Units: hertz. Frame: none.
Errors: rayloc.Error where a number is not finite or the tones do not ascend.
Source: engine/channel/ofdm_grid.h.)")
      .def(py::init(&make_ofdm_grid), py::arg("centre"), py::arg("spacing"), py::arg("tone_index"))
      .def_static("of",
                  grid_of_count,
                  py::arg("centre"),
                  py::arg("spacing") = 312'500.0,
                  py::arg("count") = 128,
                  "The tones centre + (j - count // 2) * spacing [Hz], as 802.11 numbers them.")
      .def_readonly("centre", &OfdmGrid::centre_hz, "[Hz]")
      .def_readonly("spacing", &OfdmGrid::spacing_hz, "[Hz]")
      .def_property_readonly(
          "tone_index",
          [](const OfdmGrid& grid) {
            return array_of(std::vector<std::int16_t>(grid.tone_index), {size_of(grid.size())});
          },
          "(tones,), int16.")
      .def_property_readonly(
          "frequencies",
          [](const OfdmGrid& grid) {
            std::vector<double> values;
            for (std::size_t j = 0; j < grid.size(); ++j) {
              values.push_back(grid.frequency_hz(j));
            }
            return array_of(std::move(values), {size_of(grid.size())});
          },
          "(tones,) [Hz].")
      .def("__len__", &OfdmGrid::size);
}

}  // namespace

void bind_devices(py::module_& module) {
  bind_device<Transmitter>(
      module, "Transmitter", device_doc("An antenna that sends.", "tx_array_turn"));
  bind_device<Receiver>(module,
                        "Receiver",
                        device_doc("An antenna that listens; as a Transmitter.", "rx_array_turn"));
  bind_grid(module);
}

}  // namespace rayloc::python
