// AccessPointMap: the observation that one access point of a room expects from a device in every
// cell of a grid, and the likelihood of a burst there: an access point's part of a Localizer's map.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/kept.h"
#include "engine/base/vec3.h"
#include "engine/grid/grid.h"
#include "engine/grid/height_layers.h"
#include "engine/grid/lattice.h"
#include "engine/likelihood/box/moment_projection.h"
#include "engine/likelihood/box/place_box.h"
#include "engine/likelihood/likelihood.h"
#include "engine/likelihood/nearby_likelihood.h"
#include "engine/likelihood/observation_model.h"
#include "engine/likelihood/ray_field.h"
#include "engine/likelihood/received_power.h"
#include "engine/localize/box_lattice.h"
#include "engine/localize/path_grid.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Evaluates a burst at places inside a cell; owns the models that this needs.
class BoxEvaluator {
 public:
  // Log-likelihoods of the places of a lattice about the cell's centre, [x][y], `height` [m] above
  // the centre of the layer.
  std::vector<double> on(const Lattice& lattice, double height) const {
    return nearby_->on(lattice, height);
  }
  // Model of a device displaced by `moved` [m] from the centre of the cell and the layer.
  PlaceModel model_at(const Vec3d& moved) const { return nearby_->model_at(moved); }
  // The same at several heights, [height][x][y].
  using Heights = NearbyLikelihood::Heights;
  std::vector<double> on(const Lattice& lattice, const Heights& heights) const {
    return nearby_->on(lattice, heights);
  }

 private:
  friend class AccessPointMap;
  std::shared_ptr<const PlaceLikelihood> box_;
  std::vector<Ray> rays_;
  std::unique_ptr<const NearbyLikelihood> nearby_;
};

// Places of a box, a multiple of eight in y, and the probabilities of their heights in a layer.
FieldLattice places_of_box(const Grid& grid, double wavelength);
std::vector<HeightSlice> slices_of_box(const Grid& grid, std::size_t layer, double wavelength);

class AccessPointMap {
 public:
  struct Source {
    std::shared_ptr<const RoomModel> room;
    std::size_t access_point;  // index in RoomModel::access_points
    Grid grid;
    LikelihoodKind likelihood = LikelihoodKind::kPartial;
  };
  // Traces the grid, or loads the rays from `store` (null: no store). Takes seconds.
  AccessPointMap(const Source& source, PathGridStore* store);
  ~AccessPointMap();
  AccessPointMap(AccessPointMap&&) noexcept;
  AccessPointMap& operator=(AccessPointMap&&) = delete;

  // The same access point with the same rays, without one of its antennas. It makes the models of
  // its cells on use: a lost datagram of a chain takes that chain from a single moment, which a
  // track compares with few boxes. REQUIRES: at least two antennas.
  const AccessPointMap& without(std::size_t antenna) const;

  const RoomAccessPoint& access_point() const;
  std::size_t number() const { return source_.access_point; }  // index in RoomModel::access_points
  std::size_t antennas() const { return offsets_.size(); }
  std::size_t dimension() const { return model_.dimension(); }  // of the observation

  // h: [antenna][tone], chain gains removed. noise: of the burst (ObservedArray::noise).
  ObservedBurst observe(std::span<const std::complex<double>> h, double noise) const;

  // The same in single precision (MomentProjection). REQUIRES: has_place_boxes().
  ObservedBurst observe_single(std::span<const std::complex<double>> h, double noise) const;

  // For a cell, up to a constant of the burst; coarse: a cheap lower bound with its windows.
  bool is_reachable(std::size_t cell) const;
  Likelihood::Coarse coarse(std::size_t cell, const ObservedBurst& observed) const;
  // Model of a device in a cell; empty for a likelihood that is not Gaussian.
  const PlaceModel& model(std::size_t cell) const { return place(cell).model; }
  std::size_t cells() const { return source_.grid.size(); }
  // Prefetches the data of a cell's likelihood (lane_kernel.h); no-op for a cell out of range.
  void fetch(std::size_t cell) const;
  double log_likelihood(std::size_t cell,
                        const ObservedBurst& observed,
                        std::uint8_t windows) const;
  // Log-likelihood of the received power in every cell, relative to its mean over the reachable
  // cells: it carries no information on a device that may be anywhere. 0 in unreachable cells.
  std::vector<double> power_log_likelihood(const ReceivedPower& received) const;
  // Log-likelihood of the null model (device anywhere): the reference for every place.
  double null_model(const ObservedBurst& observed) const;
  // For a cell and one of its layers of heights. REQUIRES: is_reachable(cell).
  double log_likelihood_in(std::size_t cell,
                           std::size_t layer,
                           const ObservedBurst& observed) const;
  // Evaluates the burst at places in a cell and a layer; null if the likelihood cannot separate
  // them. REQUIRES: is_reachable(cell).
  std::unique_ptr<const BoxEvaluator> evaluator_at(std::size_t cell,
                                                   std::size_t layer,
                                                   const ObservedBurst& observed) const;

  // True if a burst can be compared with the places of boxes by their RayField.
  bool has_fields() const { return source_.likelihood == LikelihoodKind::kPartial; }
  // For a cell and the band of a layer; for a box. REQUIRES: has_fields(), is_reachable(cell).
  std::shared_ptr<const FieldCovariance> field_covariance(std::size_t cell,
                                                          std::size_t layer) const;
  std::shared_ptr<const RayField> field(std::size_t cell,
                                        std::size_t layer,
                                        const FieldCovariance& covariance) const;
  // Number of the band of layers that share a covariance.
  static std::size_t band_of(std::size_t layer) { return layer / kLayersOfBand; }

  // True if a burst can be compared with single places by PlaceBox: kPartial, at most
  // kMaxBoxAntennas and kMaxBoxDimension, a model with noise.
  bool has_place_boxes() const;
  // For a box of box_lattice() and a class of noise (noise_class_of()). A pure function of both;
  // kept while there is room. REQUIRES: has_place_boxes().
  std::shared_ptr<const PlaceBox> place_box(std::uint32_t box, int noise_class) const;
  const BoxLattice& box_lattice() const { return box_lattice_; }

  // Traces the rays of a device at a place.
  std::vector<Ray> rays_to(const Vec3d& position) const;
  // Model of a device at the origin of these rays, a position known to `survey_sigma` [m] on each
  // axis.
  PlaceModel model_of(std::span<const Ray> rays, double survey_sigma) const;
  // For a device at the origin of these rays: log odds that its line of sight to the array is
  // obstructed; empty if there is none, and for likelihoods without this case.
  std::optional<double> obstructed_log_odds(std::span<const Ray> rays,
                                            const ObservedBurst& observed) const;

  // The expected array of a device at the origin of these rays: [antenna][tone].
  std::vector<std::complex<double>> expected(std::span<const Ray> rays) const;

 private:
  struct Tracing;
  AccessPointMap(const Source& source,
                 std::shared_ptr<const Tracing> tracing,
                 std::vector<Vec3d> offsets);
  PlaceLikelihood make_place(std::size_t cell) const;
  const PlaceLikelihood& place(std::size_t cell) const;
  double cell_size() const;
  // A count, chosen: three layers are 0.45 m, over which a ray's angle changes by a few degrees.
  static constexpr std::size_t kLayersOfBand = 3;
  std::vector<Ray> rays_at(std::size_t cell, double height) const;
  ObservationModel::Place field_place(std::span<const Ray> rays) const;
  std::vector<Ray> rays_in(std::size_t cell, std::size_t layer) const;

  Source source_;
  std::vector<Vec3d> offsets_;  // [m], antennas relative to the array's centre
  std::unique_ptr<const Likelihood> likelihood_;
  ObservationModel model_;
  std::shared_ptr<const Tracing> tracing_;  // shared with the maps without an antenna
  PlaceLikelihood null_model_;
  // [cell], the device at any of the heights; one of the two is empty.
  std::vector<PlaceLikelihood> cells_;
  std::vector<Lazy<PlaceLikelihood>> cells_on_use_;
  std::unique_ptr<Kept<PlaceLikelihood>> boxes_;        // the device at one of them, as a whole ...
  std::unique_ptr<Kept<PlaceLikelihood>> close_boxes_;  // ... and for the places of a box
  FieldLattice field_lattice_;
  std::unique_ptr<Kept<FieldCovariance>> covariances_;  // of a cell and a band of layers
  std::unique_ptr<Kept<RayField>> fields_;              // of a box
  BoxLattice box_lattice_;
  std::unique_ptr<const MomentProjection> projection_;          // null without place boxes
  std::unique_ptr<Kept<PlaceBox>> place_boxes_;                 // of a box and a class of noise
  std::vector<double> traced_power_db_;                         // of each cell with a ray
  std::vector<std::unique_ptr<Lazy<AccessPointMap>>> without_;  // [antenna]
};

// Evaluates a burst in the boxes of one cell, layer after layer.
class FieldScan {
 public:
  // The arguments must outlive it. REQUIRES: map.has_fields(), map.is_reachable(cell).
  FieldScan(const AccessPointMap& map, std::size_t cell, const ObservedBurst& observed)
      : map_(map), cell_(cell), observed_(observed) {}

  std::pair<FieldTerms, std::shared_ptr<const RayField>> at(std::size_t layer);

 private:
  const AccessPointMap& map_;
  std::size_t cell_;
  const ObservedBurst& observed_;
  std::size_t band_ = 0;
  std::shared_ptr<const FieldCovariance> covariance_;
  std::optional<FieldBurst> burst_;
};

}  // namespace rayloc
