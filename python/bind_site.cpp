// load_site: the room of a site as the localizer models it.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site.h"
#include "engine/trace/radio_device.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

// The antenna of a fixed transmitter; None for a device, which may be anywhere.
py::object antenna_of(const SiteTransmitter& stated) {
  if (!stated.position) {
    return py::none();
  }
  return py::cast(Transmitter{{*stated.position, {}, stated.pattern, stated.polarization}});
}

py::dict transmitter_of(const SiteTransmitter& stated) {
  py::dict values;
  values["name"] = stated.name;
  values["antenna"] = antenna_of(stated);
  values["height"] = stated.height;
  values["height_sigma"] = stated.height_sigma;
  values["constant_power"] = stated.constant_power;
  return values;
}

py::dict load_modelled_site(const std::filesystem::path& folder) {
  Site site;
  RoomModel room;
  {
    const py::gil_scoped_release unlocked;
    site = value_of(load_site(folder));
    room = value_of(load_room_model(site));
  }
  py::dict access_points;
  py::dict rx_chains;
  for (const RoomAccessPoint& ap : room.access_points) {
    access_points[py::str(ap.id)] = array_elements<Receiver>(ap.array);
    rx_chains[py::str(ap.id)] = std::vector<int>(ap.rx_chains.begin(), ap.rx_chains.end());
  }
  py::dict transmitters;
  for (const SiteTransmitter& stated : site.transmitters) {
    transmitters[py::str(to_string(stated.mac))] = transmitter_of(stated);
  }
  py::dict values;
  values["name"] = site.name;
  values["directory"] = site.directory;
  values["scene"] = SceneHandle{site.name, room.scene};
  values["grid"] = room.grid;
  values["access_points"] = std::move(access_points);
  values["rx_chains"] = std::move(rx_chains);
  values["transmitters"] = std::move(transmitters);
  values["depth"] = room.trace.max_depth;
  values["transmission"] = room.trace.transmission;
  values["calibration"] = room.calibration_id;
  return values;
}

}  // namespace

void bind_site(py::module_& module) {
  module.def("load_site", load_modelled_site, py::arg("site"));
}

}  // namespace rayloc::python
