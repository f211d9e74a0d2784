#include "engine/person/person_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/grid/grid.h"

namespace rayloc {
namespace {

// Sample places are at most this far apart, in wavelengths.
constexpr double kSampleStep = 0.125;
// Cells along each side for which the rays are traced together.
constexpr std::size_t kBlock = 2;
// Shares of the power that are tried for a change that no person causes.
constexpr std::array<double, 8> kChanges = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

class PersonCellsBuilder {
 public:
  PersonCellsBuilder(const RoomModel& room, const PersonReference& reference, double cell)
      : room_(room),
        reference_(reference),
        person_cells_{
            make_walkable_area(room, reference.person.body, reference.area, cell), 0, {}} {}

  Expected<PersonCells> build(int depth);

 private:
  Expected<PersonLinkMap> make_link_map(const PersonLink& link, int depth) const;
  void build_block(std::size_t block_x, std::size_t block_y);

  const RoomModel& room_;
  const PersonReference& reference_;
  PersonCells person_cells_;
};

Expected<PersonLinkMap> PersonCellsBuilder::make_link_map(const PersonLink& link, int depth) const {
  RAYLOC_TRY(check_link(room_, link));
  const RoomAccessPoint& ap = room_.access_points[link.access_point];
  auto scattering = PersonScattering::create(
      room_, link.access_point, reference_.transmitter, reference_.person.body, depth);
  RAYLOC_TRY(scattering);
  PersonLikelihood likelihood(room_.grid,
                              ap.rx_chains.size(),
                              link,
                              norm(ap.array.pose.position - reference_.transmitter.position));
  PersonLinkMap map{std::move(likelihood), *std::move(scattering), {}, {}, {}};
  map.cells.resize(person_cells_.walkable.grid.size());
  map.no_person = map.likelihood.no_person(reference_.person);
  for (const double share : kChanges) {
    map.changed.push_back(map.likelihood.changed(share, reference_.person));
  }
  return map;
}

// The rays are traced once, in the middle of a block of cells.
void PersonCellsBuilder::build_block(std::size_t block_x, std::size_t block_y) {
  WalkableArea& walkable = person_cells_.walkable;
  const Grid& grid = walkable.grid;
  std::vector<std::size_t> cells;
  for (std::size_t x = block_x; x < std::min(block_x + kBlock, grid.count_x); ++x) {
    for (std::size_t y = block_y; y < std::min(block_y + kBlock, grid.count_y); ++y) {
      if (walkable.free[x * grid.count_y + y] != 0) {
        cells.push_back(x * grid.count_y + y);
      }
    }
  }
  if (cells.empty()) {
    return;
  }
  Vec3d middle;
  for (const std::size_t cell : cells) {
    middle = middle + (1.0 / static_cast<double>(cells.size())) * grid.centre(cell);
  }
  for (std::size_t number = 0; number < person_cells_.links.size(); ++number) {
    PersonLinkMap& link = person_cells_.links[number];
    const auto rays = link.scattering.at({middle.x, middle.y});
    for (const std::size_t cell : cells) {
      if (!rays) {  // the body would contain a device
        walkable.free[cell] = 0;
        continue;
      }
      const Vec3d offset = grid.centre(cell) - middle;
      const PatchPlan plan{
          offset.x, offset.y, std::max(grid.step_x, grid.step_y), person_cells_.samples};
      const PersonModel& person = reference_.person;
      link.cells[cell] =
          link.likelihood.place(link.likelihood.patch(*rays, plan, person.front_offset_sigma),
                                reference_.links[number].scale,
                                person);
    }
  }
}

Expected<PersonCells> PersonCellsBuilder::build(int depth) {
  for (const PersonLink& link : reference_.links) {
    auto map = make_link_map(link, depth);
    RAYLOC_TRY(map);
    person_cells_.links.push_back(*std::move(map));
  }
  const Grid& grid = person_cells_.walkable.grid;
  const double wavelength = kSpeedOfLight / room_.grid.centre_hz;
  person_cells_.samples = static_cast<std::size_t>(
      std::ceil(std::max(grid.step_x, grid.step_y) / (kSampleStep * wavelength)));
  const std::size_t blocks_x = (grid.count_x + kBlock - 1) / kBlock;
  const std::size_t blocks_y = (grid.count_y + kBlock - 1) / kBlock;
  parallel_for(blocks_x * blocks_y, 1, [&](std::size_t block) {
    build_block(block / blocks_y * kBlock, block % blocks_y * kBlock);
  });
  return std::move(person_cells_);
}

}  // namespace

Lattice PersonCells::lattice() const {
  const Grid& grid = walkable.grid;
  const PatchPlan plan{0.0, 0.0, std::max(grid.step_x, grid.step_y), samples};
  return {samples, samples, plan.step(), plan.step()};
}

Vec3d PersonCells::place_of(const PersonSample& sample) const {
  return walkable.grid.centre(sample.cell) +
         lattice().offset(sample.sample / samples, sample.sample % samples);
}

Expected<PersonCells> make_person_cells(const RoomModel& room,
                                        const PersonReference& reference,
                                        double cell,
                                        int depth) {
  return PersonCellsBuilder(room, reference, cell).build(depth);
}

}  // namespace rayloc
