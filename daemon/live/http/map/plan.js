// The static part: walls and furniture, zones, access points, fixed transmitters, and the fits of
// the calibration's surveyed points.
import {byId, setText, svg} from './draw.js';
import {dotOf} from './fits.js';
import {Labels, boxAbout} from './labels.js';
import {drawnOpening} from './openings.js';
import {colouredZones} from './zones.js';

const points = (list) => list.map(([x, y]) => `${x},${y}`).join(' ');
const MARK = 26;  // size of an access point in pixels
const BESIDE = 22;  // from the middle of a mark to that of its name

export function drawnShape(shape) {
  const title = shape.name ? [svg('title', {}, [`${shape.name} (${shape.material})`])] : [];
  if (shape.kind === 'door' || shape.kind === 'window') {
    return svg('g', {class: shape.kind}, [...title, ...drawnOpening(shape)]);
  }
  return svg(shape.area ? 'polygon' : 'polyline', {class: shape.kind, points: points(shape.area || shape.line)}, title);
}

export class Plan {
  constructor(map) {
    this.map = map;
    byId('plan').replaceChildren(...map.plan.map(drawnShape));
    this.zones = colouredZones(map.zones).map(({zone, kind}) => {
      const name = svg('text', {class: 'zone-name', 'text-anchor': 'middle', y: 4.5}, [zone.name]);
      const tag = svg('rect', {class: 'zone-tag', rx: 8, height: 17, y: -8.5});
      return {zone, name, tag, area: svg('polygon', {class: `zone ${kind}`}), label: svg('g', {class: kind}, [tag, name])};
    });
    byId('zones').replaceChildren(...this.zones.flatMap(({area}) => area), ...this.zones.map(({label}) => label));
    this.furniture = furnitureOf(map.plan).map((one) => ({...one, text: svg('text', {class: 'object-name', 'text-anchor': 'middle', y: 4}, [one.name])}));
    byId('names').replaceChildren(...this.furniture.map(({text}) => text));
    this.fixed = [...map.access_points.map((one) => this.accessPoint(one)), ...map.fixed_transmitters.map(fixedTransmitter)];
    byId('fixed').replaceChildren(...this.fixed.map(({group}) => group));
    this.residuals = [];
  }

  accessPoint(one) {
    const arrow = svg('path', {d: 'M16 0 -9 -9 -4 0 -9 9Z'});
    const cross = svg('path', {class: 'cross', d: 'M-8 -8 8 8M-8 8 8 -8', visibility: 'hidden'});
    const text = svg('text', {y: 4.5, 'text-anchor': 'middle'}, [one.id]);
    const group = svg('g', {class: 'access-point', id: `ap-${one.id}`}, [arrow, cross, text]);
    return {group, at: one.position, facing: one.facing, id: one.id, arrow, cross, text};
  }

  place(view) {
    byId('plan').setAttribute('transform', view.matrix());
    for (const {zone, area} of this.zones) area.setAttribute('points', points(zone.polygon.map(([x, y]) => view.toPixel(x, y))));
    for (const {group, at, arrow, facing} of this.fixed) {
      group.setAttribute('transform', view.mark(...at));
      if (arrow) arrow.setAttribute('transform', `rotate(${directionOf(facing, view)})`);
    }
    for (const {dot, at} of this.residuals) {
      dot.setAttribute('transform', view.mark(at[0], at[1]));
    }
    this.name(view);
  }

  // Access points before zones before furniture: the most relevant names are placed first.
  name(view) {
    const labels = new Labels(view);
    for (const {at} of this.fixed) labels.reserve(boxAbout(view.toPixel(...at), MARK * view.unit, MARK * view.unit));
    for (const {text, at} of this.fixed) if (text) placeBeside(text, view.toPixel(...at), labels, view);
    for (const one of this.zones) placeZone(one, labels, view);
    byId('names').classList.toggle('unseen-names', view.isSolid);  // the solid room has its own
    if (!view.isSolid) for (const one of this.furniture) placeFurniture(one, labels, view);
    this.taken = labels.taken;
  }

  // inside: the targets in each zone, by its name.
  showZones(inside) {
    for (const {zone, name} of this.zones) {
      const count = inside.get(zone.name)?.size;
      setText(name, count ? `${zone.name} (${count})` : zone.name);
    }
  }

  // The state of access points is available for the present only.
  showSources(model, isPresent = true) {
    for (const one of this.fixed) {
      if (!one.id) continue;
      if (!isPresent) {
        one.group.setAttribute('class', 'access-point');
        one.cross.setAttribute('visibility', 'hidden');
        setText(one.text, one.id);
        continue;
      }
      const status = model.status(one.id);
      const bad = ['stalled', 'failed', 'no source'].includes(status);
      one.group.setAttribute('class', `access-point ${status === 'receiving' ? 'receiving' : bad ? 'bad' : ''}`);
      one.cross.setAttribute('visibility', bad ? 'visible' : 'hidden');
      setText(one.text, status === 'receiving' ? one.id : `${one.id}: ${status}`);
    }
  }

  // points: of the calibration (fits.js).
  showResiduals(points) {
    this.residuals = points.map((point) => ({at: point.at, dot: svg('g', {}, [dotOf(point)])}));
    byId('residuals').replaceChildren(...this.residuals.map(({dot}) => dot));
  }
}

// [degrees] on the drawing.
function directionOf([x, y], view) {
  const [from, to] = [view.toPixel(0, 0), view.toPixel(x, y)];
  return (Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI;
}

// In the mark's own pixels, around the origin of the text.
function placeBeside(text, [x, y], labels, view) {
  const {width} = labels.sizeOf(text);
  const [up, aside] = [BESIDE * view.unit, 15 * view.unit + width / 2];
  const at = labels.place(text, [[x, y - up], [x, y + up], [x + aside, y], [x - aside, y], [x + aside / 2, y - up],
    [x - aside / 2, y - up], [x + aside / 2, y + up], [x - aside / 2, y + up]]);
  text.setAttribute('transform', `translate(${(at[0] - x) / view.unit} ${(at[1] - y) / view.unit})`);
}

// In a corner of the zone, as a tag; otherwise on its edge or in its middle.
function placeZone({zone, name, tag, label}, labels, view) {
  const around = 7;
  const {width, height} = labels.sizeOf(name, around);
  const corners = zone.polygon.map(([x, y]) => view.toPixel(x, y));
  const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((i) => pick(...corners.map((one) => one[i]))));
  const middle = [0, 1].map((i) => corners.reduce((sum, one) => sum + one[i], 0) / corners.length);
  const gap = 5 * view.unit;
  const [left, right] = [low[0] + gap + width / 2, high[0] - gap - width / 2];
  const [top, bottom] = [low[1] + gap + height / 2, high[1] - gap - height / 2];
  const inside = right >= left && !view.isSolid ? [[left, top], [right, top], [left, bottom], [right, bottom]] : [];
  const at = labels.place(name, [...inside, middle, [middle[0], top], [middle[0], bottom], [middle[0], low[1] - height],
    [middle[0], high[1] + height]], true, around);
  label.setAttribute('transform', `translate(${at.join(' ')}) scale(${view.unit})`);
  tag.setAttribute('width', width / view.unit);
  tag.setAttribute('x', -width / view.unit / 2);
}

// Only if there is room: on the drawing of a whole floor it would be in the way.
function placeFurniture({text, low, high}, labels, view) {
  const [[left, bottom], [right, top]] = [view.toPixel(...low), view.toPixel(...high)];
  const {width, height} = labels.sizeOf(text, 0);
  const fits = right - left > 0.9 * width && bottom - top > 0.8 * height;
  const middle = [(left + right) / 2, (top + bottom) / 2];
  const aside = height * 1.1;
  const at = fits ? labels.place(text, [middle, [middle[0], middle[1] + aside], [middle[0], middle[1] - aside]], false) : null;
  text.setAttribute('visibility', at ? 'visible' : 'hidden');
  if (at) text.setAttribute('transform', `translate(${at.join(' ')}) scale(${view.unit})`);
}

// Adjacent "chair_seat" and "chair_back" are one chair. The largest first.
export function furnitureOf(shapes) {
  const pieces = new Map();
  for (const {kind, name, area} of shapes) {
    if (!name || !area || !kind.includes('furniture')) continue;
    const piece = pieces.get(name) ?? {name, low: [Infinity, Infinity], high: [-Infinity, -Infinity]};
    for (const point of area) include(piece, point);
    pieces.set(name, piece);
  }
  const whole = new Map();
  for (const piece of pieces.values()) {
    const stem = piece.name.replace(/_[^_]*$/, '');
    const others = [...pieces.values()].filter((one) => one !== piece && one.name.startsWith(`${stem}_`) && near(one, piece));
    const name = (others.length > 0 ? stem : piece.name).replaceAll('_', ' ');
    const one = whole.get(name) ?? {name, low: [...piece.low], high: [...piece.high]};
    include(one, piece.low);
    include(one, piece.high);
    whole.set(name, one);
  }
  const size = ({low, high}) => (high[0] - low[0]) * (high[1] - low[1]);
  return [...whole.values()].sort((a, b) => size(b) - size(a));
}

function include(box, point) {
  for (const i of [0, 1]) {
    box.low[i] = Math.min(box.low[i], point[i]);
    box.high[i] = Math.max(box.high[i], point[i]);
  }
}

const NEAR = 0.1;  // [m]
const near = (a, b) => [0, 1].every((i) => a.low[i] < b.high[i] + NEAR && b.low[i] < a.high[i] + NEAR);

function fixedTransmitter(one) {
  const name = one.name || one.mac;
  const group = svg('g', {class: 'fixed'}, [
    svg('rect', {x: -5, y: -5, width: 10, height: 10}),
    svg('title', {}, [`fixed transmitter ${name}`]),
  ]);
  return {group, at: one.position};
}
