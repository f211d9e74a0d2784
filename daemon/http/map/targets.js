// Targets on the map and in the table.
import {byId, clock, ellipse, html, number, setText, svg} from './draw.js';
import {trackStateText} from './model.js';

const LEAST_WEIGHT = 0.01;
const CLOSE_PX = 12;  // what is nearer to the mark would only hide it

export class Targets {
  constructor() {
    this.selected = null;
    this.onMap = new Map();
    this.rows = new Map();
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
    const trail = svg('polyline');
    const regions = svg('g');
    const ghosts = svg('g');
    const dot = svg('circle', {class: 'dot', r: 8});
    const text = svg('text', {x: 13, y: 5});
    const title = svg('title');
    const marker = svg('g', {}, [title, dot, text]);
    marker.addEventListener('click', () => this.select(target.key));
    byId('trails').append(trail);
    byId('regions').append(regions);
    byId('ghosts').append(ghosts);
    byId('markers').append(marker);
    return {trail, regions, ghosts, marker, text, title, parts: [trail, regions, ghosts, marker]};
  }

  draw({target, location, stale, trail}, view) {
    if (!this.onMap.has(target.key)) this.onMap.set(target.key, this.make(target));
    const one = this.onMap.get(target.key);
    const classes = `c${target.colour}${stale ? ' stale' : ''}`;
    const chosen = this.selected === target.key;
    const at = location.position || trail[0];
    one.marker.setAttribute('visibility', at ? 'visible' : 'hidden');
    one.marker.setAttribute('class', `target ${classes}${chosen ? ' selected' : ''}`);
    one.marker.setAttribute('data-target', target.key);
    if (at) one.marker.setAttribute('transform', `translate(${view.toPixel(at.x, at.y).join(' ')})`);
    setText(one.text, label(target, location, stale));
    setText(one.title, doubts(location).join('; '));
    one.trail.setAttribute('class', `trail ${classes}`);
    one.trail.setAttribute('points', trail.map((p) => view.toPixel(p.x, p.y).join()).join(' '));
    one.regions.setAttribute('class', classes);
    one.regions.replaceChildren(...regions(location, view));
    one.ghosts.setAttribute('class', classes);
    one.ghosts.replaceChildren(...ghosts(location, view));
  }

  write({target, location, stale, zones}) {
    if (!this.rows.has(target.key)) this.rows.set(target.key, this.makeRow(target));
    const {button, cells, warnings} = this.rows.get(target.key);
    button.setAttribute('aria-pressed', String(this.selected === target.key));
    const p = location.position;
    const state = stale ? `stale since ${clock(stale)}` : p ? trackStateText(location.track_state) || 'snapshot' : 'no fix';
    setText(cells[0], state);
    cells[0].className = stale || !p ? 'warn' : 'good';
    setText(warnings, doubts(location).join('; '));
    setText(cells[1], p ? `${number(p.x)}, ${number(p.y)}` : location.quality.no_fix_reason || '');
    setText(cells[2], location.accuracy_m === undefined ? ''
      : `${number(location.accuracy_m)} m (${number(100 * location.accuracy_confidence, 0)} %)`);
    setText(cells[3], zones.join(', '));
  }

  makeRow(target) {
    const swatch = svg('svg', {class: `swatch c${target.colour}`, viewBox: '0 0 10 10', 'aria-hidden': 'true'},
      [svg('circle', {cx: 5, cy: 5, r: 5})]);
    const button = html('button', {type: 'button', 'aria-pressed': 'false'}, [swatch, target.name]);
    button.addEventListener('click', () => this.select(target.key));
    const cells = [0, 1, 2, 3].map(() => html('td'));
    const warnings = html('p', {class: 'warn'});
    const row = html('tr', {'data-target': target.key}, [html('th', {scope: 'row'}, [button, warnings]), ...cells]);
    byId('target-rows').append(row);
    return {row, button, cells, warnings};
  }
}

function label(target, location, stale) {
  if (stale) return `${target.name}, stale since ${clock(stale)}`;
  if (!location.position) return `${target.name}: no fix`;
  return doubts(location).length > 0 ? `${target.name}, doubtful` : target.name;
}

// What a person should know of where it is said to be.
function doubts({position, quality}) {
  if (!position) return [];
  return [...(quality.warnings || []), ...(quality.ambiguous ? ['another place is nearly as likely'] : [])];
}

function drawnEllipse(position, covariance, probability, view, attributes) {
  const {major, minor, angle} = ellipse(covariance, probability);
  const [x, y] = view.toPixel(position.x, position.y);
  return svg('ellipse', {
    ...attributes,
    rx: Math.max(1, major * view.scale),
    ry: Math.max(1, minor * view.scale),
    transform: `translate(${x} ${y}) rotate(${(-angle * 180) / Math.PI})`,
  });
}

// Of 50 and 95 %. The covariance of all places together would say that it is between them: where there
// are several, that of the likeliest alone.
function regions({position, position_covariance: covariance, hypotheses}, view) {
  const several = hypotheses.length > 1;
  const of = several ? hypotheses[0] : {position, position_covariance: covariance};
  if (!position || of.position_covariance?.length !== 9) return [];
  const place = several ? ` of the likeliest place, which has ${number(100 * of.weight, 0)} %` : '';
  return [[0.95, 'region outer'], [0.5, 'region']].map(([probability, name]) => {
    const drawn = drawnEllipse(of.position, of.position_covariance, probability, view, {class: name});
    drawn.append(svg('title', {}, [`region of ${100 * probability} %${place}`]));
    return drawn;
  });
}

// Other places where it may be than the likeliest: each with its own region of 50 %, the fainter the less likely.
function ghosts({hypotheses, position}, view) {
  const apart = (one) => !position
    || view.scale * Math.hypot(one.position.x - position.x, one.position.y - position.y) > CLOSE_PX;
  const others = hypotheses.slice(1).filter((one) => one.weight >= LEAST_WEIGHT && apart(one));
  return others.map((one) => {
    const opacity = 0.25 + 0.75 * one.weight;
    const [cx, cy] = view.toPixel(one.position.x, one.position.y);
    const title = svg('title', {}, [`${number(100 * one.weight, 0)} %`]);
    return svg('g', {'stroke-opacity': opacity}, [
      title,
      svg('circle', {class: 'ghost', cx, cy, r: 11}),
      ...(one.position_covariance?.length === 9
        ? [drawnEllipse(one.position, one.position_covariance, 0.5, view, {class: 'ghost'})] : []),
    ]);
  });
}
