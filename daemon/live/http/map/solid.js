// The room in three dimensions, isometric, as `rayloc scene show` draws it; and the propagation
// paths from the device received last, or the selected one, to the access points.
import {ask} from './ask.js';
import {byId, setText, svg} from './draw.js';
import {Labels} from './labels.js';

const ASK_MS = 1000;
const ROOM_MS = 60_000;
const STEPS = [-3, -8, -14];  // [dB] below the strongest; map.css has one class more

export class Solid {
  constructor(view, changed) {
    this.view = view;
    this.changed = changed;
    this.names = null;  // names of the drawn room
    this.channels = [];
    byId('solid-look').addEventListener('click', () => this.toggle());
    byId('map').addEventListener('keydown', (event) => {
      if (event.key === '3' && !event.ctrlKey && !event.metaKey && !event.altKey) this.toggle();
    });
  }

  toggle() {
    const solid = !this.view.isSolid;
    this.view.turn(solid ? 'solid' : 'plan');
    byId('map').classList.toggle('solid', solid);
    byId('solid-look').setAttribute('aria-pressed', String(solid));
    if (!solid) {
      byId('rays').replaceChildren();
      return;
    }
    if (!this.names || this.failed) this.fetch();
    this.look();
  }

  // Called when the room changes.
  forget() {
    this.names = null;
    if (this.view.isSolid) this.fetch();
  }

  async fetch() {
    const number = this.asked = (this.asked ?? 0) + 1;  // answers to older requests are obsolete
    try {
      const room = await ask('api/v1/solid', {}, ROOM_MS);
      if (number !== this.asked) return;
      this.failed = false;
      this.show(room);
    } catch (error) {
      if (number !== this.asked) return;
      this.failed = true;
      this.room = null;
      byId('solid').replaceChildren();
      this.names = [{text: svg('text', {'text-anchor': 'middle'}, [`The room cannot be drawn: ${error.message}`]), at: [0, 0, 0]}];
      byId('solid').append(this.names[0].text);
    }
    this.changed();
  }

  show({faces = [], open = [], names = []}) {
    const at = (corner) => this.view.drawn(...corner).map((one) => one.toFixed(4)).join();
    const edgesOf = ({corners, edges}) => edges.map((i) => `M${at(corners[i])}L${at(corners[(i + 1) % corners.length])}`).join('');
    const drawn = faces.flatMap((face) => [
      svg('polygon', {points: face.corners.map(at).join(' '), fill: face.colour, 'fill-opacity': face.opacity}),
      svg('path', {class: 'edge', d: edgesOf(face)})]);
    this.room = svg('g', {}, [...drawn, svg('path', {class: 'edge open', d: open.map(edgesOf).join('')})]);
    this.names = wholeNames(names).map(({name, at}) => ({at, text: svg('text', {class: 'object-name', 'text-anchor': 'middle', y: 4}, [name])}));
    byId('solid').replaceChildren(this.room, ...this.names.map(({text}) => text));
  }

  // Called while the view is visible.
  async look() {
    clearTimeout(this.next);
    if (!this.view.isSolid) return;
    try {
      this.channels = document.hidden ? [] : await ask('api/v1/channel');
    } catch {
      this.channels = [];  // the map itself reports that raylocd does not answer
    }
    this.changed();
    this.next = setTimeout(() => this.look(), ASK_MS);
  }

  // selected: the key of a target, or null. Paths: present only. taken: places of existing names.
  place(selected, isPresent, taken = []) {
    if (!this.view.isSolid || !this.names) return;
    const {view} = this;
    const [x, y] = view.toPixel(0, 0);
    this.room?.setAttribute('transform', `matrix(${view.scale} 0 0 ${view.scale} ${x} ${y})`);
    const labels = new Labels(view);
    for (const box of taken) labels.reserve(box);
    for (const {at, text} of this.names) {
      const place = view.toPixel(...at);
      const free = labels.place(text, [place, [place[0], place[1] - 14 * view.unit]], false);
      text.setAttribute('visibility', free ? 'visible' : 'hidden');
      if (free) text.setAttribute('transform', `translate(${free.join(' ')}) scale(${view.unit})`);
    }
    const channel = this.channels.find((one) => one.target === selected) ?? (selected ? null : this.channels[0]);
    const ways = isPresent && channel ? channel.access_points.flatMap((one) => (one.paths ?? []).map((path) => ({id: one.id, ...path}))) : [];
    ways.sort((a, b) => a.level_db - b.level_db);  // the strongest over the others
    byId('rays').replaceChildren(...ways.map((way) => drawnWay(way, view)));
  }
}

const TOGETHER = 1;  // [m]

// Pieces of an object ("chair_seat" and "chair_back") have one name, on the highest of them.
export function wholeNames(names) {
  const whole = new Map();
  for (const {name, at} of names) {
    const stem = name.replace(/_[^_]*$/, '');
    const near = (other) => Math.hypot(...[0, 1].map((i) => other.at[i] - at[i])) < TOGETHER;
    const isPiece = names.some((other) => other.name !== name && other.name.startsWith(`${stem}_`) && near(other));
    const key = (isPiece ? stem : name).replaceAll('_', ' ');
    if (!whole.has(key) || whole.get(key)[2] < at[2]) whole.set(key, at);
  }
  return [...whole].map(([name, at]) => ({name, at}));
}

function drawnWay({id, points, level_db: level}, view) {
  const step = STEPS.filter((limit) => level < limit).length;
  const title = svg('title');
  setText(title, `to ${id}: ${points.length - 2} turns or passages, ${level} dB`);
  return svg('polyline', {class: `ray ray-${step}`, points: points.map((one) => view.toPixel(...one).join()).join(' ')}, [title]);
}
