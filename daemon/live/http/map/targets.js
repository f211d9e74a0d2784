// Targets on the map and in the table.
import {byId, clock, html, number, setText, svg} from './draw.js';
import {placesOf} from './places.js';
import {Methods} from './methods.js';
import {trackStateText} from './words.js';

const LIKELY = 0.2;  // probability from which it is drawn wider
const CLOSE_PX = 12;  // closer hypotheses would be hidden by the mark
const FADING_MS = 4000;  // from one step of a trail to the next (map.css)
const FADED = 4;  // the last step

export class Targets {
  constructor() {
    this.selected = null;
    this.onMap = new Map();
    this.rows = new Map();
    this.methods = new Methods();
  }

  select(key) {
    this.selected = this.selected === key ? null : key;
  }

  show(shown, view) {
    const names = new Set(shown.map(({target}) => target.key));
    for (const [key, one] of this.onMap) {
      if (!names.has(key)) {
        one.parts.forEach((part) => part.remove());
        this.onMap.delete(key);
      }
    }
    for (const [key, row] of this.rows) {
      if (!names.has(key)) {
        row.row.remove();
        this.rows.delete(key);
      }
    }
    for (const one of shown) {
      this.draw(one, view);
      this.write(one);
    }
    byId('no-targets').hidden = shown.length > 0;
  }

  make(target) {
    const trail = svg('g');
    const regions = svg('g');
    const ghosts = svg('g');
    const others = svg('g');
    const dot = svg('circle', {class: 'dot', r: 8});
    const text = svg('text', {x: 13, y: 5});
    const title = svg('title');
    const drop = svg('path', {class: 'drop'});
    const marker = svg('g', {}, [title, drop, dot, text]);
    marker.addEventListener('click', () => this.select(target.key));
    byId('trails').append(trail);
    byId('regions').append(regions);
    byId('ghosts').append(ghosts);
    byId('compared').append(others);
    byId('markers').append(marker);
    return {trail, regions, ghosts, others, marker, drop, text, title, parts: [trail, regions, ghosts, others, marker]};
  }

  draw({target, location, stale, trail, compared = []}, view) {
    if (!this.onMap.has(target.key)) this.onMap.set(target.key, this.make(target));
    const one = this.onMap.get(target.key);
    const classes = `c${target.colour}${stale ? ' stale' : ''}`;
    const chosen = this.selected === target.key;
    const at = location.position || trail[0];
    one.marker.setAttribute('visibility', at ? 'visible' : 'hidden');
    one.marker.setAttribute('class', `target ${classes}${chosen ? ' selected' : ''}`);
    one.marker.setAttribute('data-target', target.key);
    setText(one.text, label(target, location, stale));
    if (at) place(one, at, view);
    setText(one.title, doubts(location).join('; '));
    one.trail.setAttribute('class', `trail ${classes}`);
    one.trail.replaceChildren(...fading(trail, view));
    one.regions.setAttribute('class', classes);
    one.regions.replaceChildren(...regions(location, view));
    one.ghosts.setAttribute('class', classes);
    one.ghosts.replaceChildren(...ghosts(location, view));
    one.others.replaceChildren(...this.methods.marks(target, at, compared, view));
  }

  write({target, location, stale, zones, compared = []}) {
    if (!this.rows.has(target.key)) this.rows.set(target.key, this.makeRow(target));
    const {button, cells, warnings, place, elsewhere, others} = this.rows.get(target.key);
    button.setAttribute('aria-pressed', String(this.selected === target.key));
    const p = location.position;
    const state = stale ? `stale since ${clock(stale)}` : p ? trackStateText(location.track_state) || 'snapshot' : 'no fix';
    setText(cells[0], state);
    cells[0].className = stale || !p ? 'warn' : 'good';
    setText(warnings, doubts(location).join('; '));
    setText(place, p ? coordinates(p) : location.quality.no_fix_reason || '');
    setText(elsewhere, placesOf(location).others.map((one) => `or ${coordinates(one.at)} (${percent(one.weight)})`).join('; '));
    setText(others, this.methods.text(p, compared));
    setText(cells[2], location.accuracy_m === undefined ? ''
      : `${number(location.accuracy_m)} m (${percent(location.accuracy_confidence)})`);
    setText(cells[3], zones.join(', '));
  }

  makeRow(target) {
    const swatch = svg('svg', {class: `swatch c${target.colour}`, viewBox: '0 0 10 10', 'aria-hidden': 'true'},
      [svg('circle', {cx: 5, cy: 5, r: 5})]);
    const button = html('button', {type: 'button', 'aria-pressed': 'false'}, [swatch, target.name]);
    button.addEventListener('click', () => this.select(target.key));
    const cells = [0, 1, 2, 3].map(() => html('td'));
    const warnings = html('p', {class: 'warn'});
    const place = html('span');
    const elsewhere = html('p', {class: 'quiet'});
    const others = html('p', {class: 'quiet'});
    cells[1].append(place, elsewhere, others);
    const row = html('tr', {'data-target': target.key}, [html('th', {scope: 'row'}, [button, warnings]), ...cells]);
    byId('target-rows').append(row);
    return {row, button, cells, warnings, place, elsewhere, others};
  }
}

// In an isometric view a line leads down to the floor.
function place({marker, drop, text}, at, view) {
  marker.setAttribute('transform', view.mark(at.x, at.y, at.z));
  const [x, y] = view.toPixel(at.x, at.y, at.z);
  const down = (view.toPixel(at.x, at.y)[1] - y) / view.unit;
  drop.setAttribute('d', down > 0 ? `M0 0V${down}m-5 0h10` : '');
  const isAtEdge = x + (14 + 8 * text.textContent.length) * view.unit > view.width;
  text.setAttribute('x', isAtEdge ? -13 : 13);
  text.setAttribute('text-anchor', isAtEdge ? 'end' : 'start');
}

// Older parts are thinner and paler: a line for each step of age, joined to the one before.
function fading(trail, view) {
  const stepOf = ({age}) => Math.min(FADED, Math.floor((age ?? 0) / FADING_MS));
  const lines = [];
  trail.forEach((point, i) => {
    const step = stepOf(point);
    if (lines.at(-1)?.step !== step) lines.push({step, points: i > 0 ? [trail[i - 1]] : []});
    lines.at(-1).points.push(point);
  });
  return lines.reverse().map(({step, points}) => svg('polyline', {
    class: `old-${step}`, points: points.map((p) => view.toPixel(p.x, p.y, p.z).join()).join(' ')}));
}

function label(target, location, stale) {
  if (stale) return `${target.name}, stale since ${clock(stale)}`;
  if (!location.position) return `${target.name}: no fix`;
  return doubts(location).length > 0 ? `${target.name}, doubtful` : target.name;
}

// Caveats about its stated position. Hypotheses of one place are not separate places.
function doubts(location) {
  const {position, quality} = location;
  if (!position) return [];
  const elsewhere = quality.ambiguous && placesOf(location).others.length > 0;
  return [...(quality.warnings || []), ...(elsewhere ? ['another place is nearly as likely'] : [])];
}

const percent = (share) => `${number(100 * share, 0)} %`;
const coordinates = ({x, y}) => `${number(x)}, ${number(y)}`;

function drawnRegion({region: {major, minor, angle}, at}, view, name) {
  return svg('ellipse', {
    class: name,
    rx: Math.max(1, major * view.scale),
    ry: Math.max(1, minor * view.scale),
    transform: `${view.flat(at.x, at.y)} rotate(${(-angle * 180) / Math.PI})`,
  });
}

// The outer one is the published one: a circle about the position. The inner one holds half of the
// total stated probability; if this place has less, half of the place's probability.
function regions(location, view) {
  const {position, accuracy_m: radius, accuracy_confidence: confidence} = location;
  const drawn = [];
  if (position && radius !== undefined) {
    const title = svg('title', {}, [`within ${number(radius)} m with ${percent(confidence)}`]);
    drawn.push(svg('circle', {
      class: 'region outer', r: Math.max(1, radius * view.scale), transform: view.flat(position.x, position.y)}, [title]));
  }
  const {mark} = placesOf(location);
  if (mark?.region) {
    const part = mark.holds < 0.5;
    const inner = drawnRegion(mark, view, part ? 'region part' : 'region');
    const of = part ? `, half of the ${percent(mark.weight)} of this place` : '';
    inner.append(svg('title', {}, [`region of ${percent(mark.holds)}${of}`]));
    drawn.push(inner);
  }
  return drawn;
}

// Other possible places, each with its probability and a region of half of it.
function ghosts(location, view) {
  const {mark, others} = placesOf(location);
  const far = ({at}) => view.scale * Math.hypot(at.x - mark.at.x, at.y - mark.at.y) > CLOSE_PX * view.unit;
  return others.map((one) => {
    const title = svg('title', {}, [`${percent(one.weight)} at ${coordinates(one.at)}`]);
    const ring = svg('g', {transform: view.mark(one.at.x, one.at.y)}, [
      svg('circle', {class: 'ghost', r: 11}),
      svg('text', {x: 15, y: 5}, [percent(one.weight)]),
    ]);
    return svg('g', {class: one.weight >= LIKELY ? 'likely' : ''}, [
      title, ...(far(one) ? [ring] : []), ...(one.region ? [drawnRegion(one, view, 'ghost')] : []),
    ]);
  });
}
