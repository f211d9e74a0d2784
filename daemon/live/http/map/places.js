// Possible places of a target: the hypotheses of a location, merged to places that are separate.
//
// A hypothesis is the part within 0.3 m of a peak, so that one broad peak is split into several,
// and one may consist of a narrow core and a broad foot. The first hypothesis is the heaviest,
// which need not be that of the position: the position is the highest peak.
const SAME = 0.3;  // [m]: closer hypotheses are one place
const TOUCH = 0.65;  // [m]: and up to that, if their spreads meet
const SPREADS = 2.3;  // [sigma]; adjacent pieces are 1.5 to 2 apart, separate peaks 3 and more
const LEAST_WEIGHT = 0.01;  // smallest weight of another place that is shown
const SAMPLES = 128;
const GOLDEN = Math.PI * (3 - Math.sqrt(5));

const known = new WeakMap();  // by location: needed for every picture

// {mark, others}: the place of the position, or null, and the others, the likeliest first. A place
// has `weight`, `at` and `region`: the ellipse (half axes [m], direction [rad]) about it that
// contains the target with probability `holds`; null if the method states no uncertainty.
export function placesOf(location) {
  if (!known.has(location)) known.set(location, makePlaces(location));
  return known.get(location);
}

function makePlaces({position, position_covariance: covariance, hypotheses}) {
  if (!position) return {mark: null, others: []};
  const stated = hypotheses.filter(({weight}) => weight > 0);
  const all = stated.length > 0 ? stated : [{position, position_covariance: covariance, weight: 1}];
  const nearest = all.reduce((a, b) => (distance(b.position, position) < distance(a.position, position) ? b : a));
  const places = together(all).map((members) => placeOf(members, members.includes(nearest) ? position : null));
  places.sort((a, b) => b.weight - a.weight);
  const mark = places.find(({isMark}) => isMark);
  return {mark, others: places.filter((one) => one !== mark && one.weight >= LEAST_WEIGHT)};
}

// Hypotheses that are linked, directly or through others, are one group.
function together(hypotheses) {
  const groups = [];
  for (const one of hypotheses) {
    const linked = groups.filter((group) => group.some((other) => isSame(one, other)));
    for (const group of linked) groups.splice(groups.indexOf(group), 1);
    groups.push([one, ...linked.flat()]);
  }
  return groups;
}

function isSame(a, b) {
  const apart = distance(a.position, b.position);
  if (apart < SAME) return true;
  const direction = [(b.position.x - a.position.x) / apart, (b.position.y - a.position.y) / apart];
  return apart < TOUCH && apart < SPREADS * (sigma(a, direction) + sigma(b, direction));
}

// position: of the location, if it belongs to this place. Its region holds half of the total stated
// probability, if the place has as much; any other region holds half of its place's own.
function placeOf(members, position) {
  const weight = members.reduce((sum, one) => sum + one.weight, 0);
  const mean = (axis) => members.reduce((sum, one) => sum + one.weight * one.position[axis], 0) / weight;
  const at = position || {x: mean('x'), y: mean('y')};
  const holds = position && weight > 0.5 ? 0.5 : weight / 2;
  return {isMark: Boolean(position), weight, at, holds, region: regionOf(members, weight, at, holds)};
}

const distance = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

// xx, xy and yy [m^2].
function plane({position_covariance: covariance}) {
  return covariance?.length === 9 ? [covariance[0], covariance[1], covariance[4]] : null;
}

function sigma(hypothesis, [x, y]) {
  const [xx, xy, yy] = plane(hypothesis) || [0, 0, 0];
  return Math.sqrt(Math.max(0, xx * x * x + 2 * xy * x * y + yy * y * y));
}

function regionOf(members, weight, centre, holds) {
  if (!members.every(plane)) return null;
  const shape = shapeAbout(members, weight, centre);
  const [xx, xy, yy] = shape;
  const determinant = xx * yy - xy * xy;
  const squared = ([x, y]) => (yy * x * x - 2 * xy * x * y + xx * y * y) / determinant;
  const points = members.flatMap((one) => samples(one, centre).map((point) => [squared(point), one.weight / SAMPLES]));
  points.sort((a, b) => a[0] - b[0]);
  return axes(shape, Math.sqrt(quantile(points, holds)));
}

// Covariance of all members together; never flat.
function shapeAbout(members, weight, centre) {
  const sums = [1e-8, 0, 1e-8];
  for (const one of members) {
    const [dx, dy] = [one.position.x - centre.x, one.position.y - centre.y];
    const own = plane(one);
    [dx * dx, dx * dy, dy * dy].forEach((value, i) => { sums[i] += (one.weight * (own[i] + value)) / weight; });
  }
  return sums;
}

// Points of equal probability of a normal distribution, from the centre.
function samples({position, position_covariance: covariance}, centre) {
  const {major, minor, angle} = axes([covariance[0], covariance[1], covariance[4]], 1);
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return Array.from({length: SAMPLES}, (_, i) => {
    const radius = Math.sqrt(-2 * Math.log(1 - (i + 0.5) / SAMPLES));
    const [u, v] = [major * radius * Math.cos(i * GOLDEN), minor * radius * Math.sin(i * GOLDEN)];
    return [position.x - centre.x + u * cos - v * sin, position.y - centre.y + u * sin + v * cos];
  });
}

// points: [value, weight], in order.
function quantile(points, wanted) {
  let sum = 0;
  for (const [value, weight] of points) {
    sum += weight;
    if (sum >= wanted) return value;
  }
  return points.at(-1)[0];
}

function axes([xx, xy, yy], factor) {
  const mean = (xx + yy) / 2;
  const apart = Math.hypot((xx - yy) / 2, xy);
  return {
    major: factor * Math.sqrt(Math.max(0, mean + apart)),
    minor: factor * Math.sqrt(Math.max(0, mean - apart)),
    angle: Math.atan2(2 * xy, xx - yy) / 2,
  };
}
