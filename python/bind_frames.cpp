// read_frames: the frames of recordings, as arrays and for a Localizer.
#include <filesystem>
#include <optional>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "capture/assemble/csi_receiver.h"
#include "capture/decode/decoder_registry.h"
#include "capture/source/recorded_source.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/frame_arrays.h"
#include "daemon/lab/recordings/recorded_frames.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/frame_table.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using SharedTable = std::shared_ptr<FrameTable>;

void read_of_site(const Site& site, const std::vector<std::string>& captures, FrameTable& table) {
  table.access_points = access_point_ids(site);
  const auto resolved =
      value_of(resolve_captures(captures, table.access_points, PerAccessPoint::kSeveral));
  for (const RecordingArgument& recording : recordings_of(resolved)) {
    if (auto read = for_each_frame(
            site,
            recording,
            [&](CsiFrame&& frame) { table.frames.push_back(std::move(frame)); },
            table.notes);
        !read) {
      throw Raised{std::move(read.error())};
    }
  }
}

void read_recording(const RecordingArgument& recording,
                    const std::string& format,
                    FrameTable& table) {
  auto source = value_of(RecordedSource::open(recording.files, as_stamped_options()));
  CsiReceiverOptions options;
  options.access_point = table.access_points.size();
  options.format = format;
  table.access_points.push_back(recording.access_point.empty() ? recording.files.front()
                                                               : recording.access_point);
  CsiReceiver receiver(options);
  DatagramBatch batch;
  while (!batch.ended) {
    if (auto read = source->read(batch, std::chrono::seconds(1)); !read) {
      throw Raised{std::move(read.error())};
    }
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, table.frames);
    }
    if (batch.ended) {
      receiver.flush(table.frames);
    }
  }
  note_recording(*source, receiver.counters(), table.access_points.back(), table.notes);
}

SharedTable read(const std::vector<std::string>& captures,
                 const std::optional<std::filesystem::path>& site,
                 const std::string& format) {
  if (!format.empty() && !is_wire_format(format)) {
    refuse("read_frames: there is no wire format '" + format + "'");
  }
  if (site && !format.empty()) {
    refuse(
        "read_frames: with a site, format is that of the access points in its site.toml; leave "
        "one of the two out");
  }
  const py::gil_scoped_release unlocked;
  auto table = std::make_shared<FrameTable>();
  if (site) {
    read_of_site(value_of(load_site(*site)), captures, *table);
  } else {
    for (const RecordingArgument& recording : recordings_of_any(captures)) {
      read_recording(recording, format, *table);
    }
  }
  return table;
}

template <typename T>
py::array_t<T> sized_array(std::vector<T>&& values, const std::vector<std::size_t>& shape) {
  return python::array_of(std::move(values), Shape(shape.begin(), shape.end()));
}

// An array over a vector's bytes, interpreted as another numpy type.
template <typename T>
py::array seen_as(std::vector<T>&& values, const py::dtype& type, const Shape& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* first = kept->data();
  const py::capsule owner(kept.get(),
                          [](void* them) { delete static_cast<std::vector<T>*>(them); });
  static_cast<void>(kept.release());
  return py::array(type, shape, first, owner);
}

py::dict stream_arrays(const FrameTable& table, std::size_t stream) {
  FrameArrays arrays;
  {
    const py::gil_scoped_release unlocked;
    arrays = frame_arrays(table.frames, stream);
  }
  const auto shape = arrays.shape();
  const Shape whole(shape.begin(), shape.end());
  const auto header =
      py::dtype::from_args(py::module_::import("ast").attr("literal_eval")(kFrameHeaderDescr));
  py::dict result;
  result["csi"] = sized_array(std::move(arrays.csi), shape);
  result["mask"] = seen_as(std::move(arrays.mask), py::dtype("bool"), whole);
  result["headers"] = seen_as(std::move(arrays.headers), header, {whole[0]});
  result["power_dbm"] = sized_array(std::move(arrays.power_dbm), {shape[0], shape[1]});
  result["cores"] = sized_array(std::move(arrays.rx_chains), {shape[1]});
  result["tone_index"] = sized_array(std::move(arrays.tone_index), {shape[2]});
  return result;
}

// The frames with these numbers, in the given order.
SharedTable taken(const FrameTable& table, const std::vector<std::size_t>& numbers) {
  auto some = std::make_shared<FrameTable>();
  some->access_points = table.access_points;
  some->notes = table.notes;
  for (const std::size_t number : numbers) {
    if (number >= table.frames.size()) {
      refuse("there are " + std::to_string(table.frames.size()) + " frames, and no number " +
             std::to_string(number));
    }
    some->frames.push_back(table.frames[number]);
  }
  return some;
}

}  // namespace

void bind_frames(py::module_& module) {
  py::class_<FrameTable, SharedTable>(
      module, "FrameTable", "Frames as the engine has them; rayloc.Frames holds one.")
      .def("arrays", stream_arrays, py::arg("stream"), "By name, as rayloc.Frames has them.")
      .def("taken", taken, py::arg("numbers"), "The frames of these numbers.")
      .def_readonly("access_points", &FrameTable::access_points, "Names that headers count.")
      .def_readonly("notes", &FrameTable::notes, "Notes on the recordings, for people.")
      .def("__len__", [](const FrameTable& table) { return table.frames.size(); });
  module.def("read_frame_table",
             read,
             py::arg("captures"),
             py::arg("site"),
             py::arg("format"),
             "As rayloc.read_frames.");
}

}  // namespace rayloc::python
