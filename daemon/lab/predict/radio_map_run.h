// The radio maps of a site or scene: its access points, the lattice of cells, and their
// computation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/predict/radio_map_report.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/expected.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// The access points of the site with these ids, all of them if `ids` is empty; none for a scene
// without a site. An Error (kUsage) if an id does not exist.
Expected<std::vector<NamedArray>> mapped_access_points(const SceneSource& source,
                                                       const std::vector<std::string>& ids);

// An isotropic antenna at a position [m], "antenna NUMBER", that is not mounted yet.
NamedArray planned_antenna(const Vec3d& position, std::size_t number);

// The cells that cover the room. `stated_height` [m], world, default: that of the site's devices,
// else 1.2 m above the lowest point. `stated_step`: side of a cell [m]; 0: about 10,000 cells. An
// Error (kUsage) for a height outside of the room or for too many cells.
Expected<RadioMapGrid> mapped_grid(const SceneSource& source,
                                   std::optional<double> stated_height,
                                   double stated_step);

// Maps each array, on all cores. The observer receives the share of mapped arrays. REQUIRES: at
// least one array.
RadioMaps compute_radio_maps(const SceneSource& source,
                             std::vector<NamedArray> arrays,
                             const RadioMapGrid& grid,
                             const TraceOptions& options,
                             const Observer& observer = {});

}  // namespace rayloc
