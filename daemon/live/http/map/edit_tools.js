// The pointer's actions in the editor: it drags the selected object, or draws with a tool.
import {tidy} from './draft.js';

const STILL = 4;  // pixels: a press that moves less is a click
const ON_PICTURE = ['measure', 'carry'];  // places in a picture are kept to the pixel
const tidied = ([x, y]) => [tidy(x), tidy(y)];

export class Tools {
  // editor: {draft, selected, select(kind, at), draw(tool, points), sketch(points), stirred()}
  constructor(view, editor) {
    this.view = view;
    this.editor = editor;
    this.name = 'select';
    this.corners = [];  // corners of a zone that is being drawn
    const listen = (event, handler) => view.element.addEventListener(event, (told) => {
      if (handler(told)) told.stopImmediatePropagation();
    }, true);
    listen('pointerdown', (event) => this.press(event));
    listen('pointermove', (event) => this.move(event));
    listen('pointerup', (event) => this.release(event));
    listen('pointercancel', () => { this.held = null; });
  }

  choose(name) {
    this.name = name;
    this.corners = [];
    this.editor.sketch([]);
  }

  // A zone is closed with three corners or more.
  close() {
    if (this.corners.length > 2) this.editor.draw('zone', this.corners);
    this.corners = [];
    this.editor.sketch([]);
  }

  press(event) {
    const at = this.view.toWorld(event.clientX, event.clientY);
    const {kind, at: place} = event.target.dataset;
    const hold = kind ? {kind, at: Number(place)} : null;
    const {selected} = this.editor;
    const takes = hold && (kind === 'corner' || kind === 'turn' || (selected?.kind === kind && selected.at === hold.at));
    this.held = {
      at, hold, from: [event.clientX, event.clientY], moved: false, takes: this.name === 'select' && takes,
      was: JSON.stringify(this.editor.draft.content)};
    const ours = this.name !== 'select' || this.held.takes;
    if (ours) this.view.element.setPointerCapture?.(event.pointerId);
    return ours;
  }

  move(event) {
    const {held} = this;
    const now = this.view.toWorld(event.clientX, event.clientY);
    if (!held) {
      if (this.corners.length > 0) this.editor.sketch([...this.corners, tidied(now)]);
      return false;
    }
    held.moved ||= Math.hypot(event.clientX - held.from[0], event.clientY - held.from[1]) > STILL;
    if (held.moved && held.takes) this.drag(held, now);
    if (held.moved && this.name !== 'select') this.editor.sketch(this.outline(held.at, now));
    return this.name !== 'select' || held.takes;
  }

  release(event) {
    const {held} = this;
    this.held = null;
    if (!held) return false;
    const at = this.view.toWorld(event.clientX, event.clientY);
    const now = ON_PICTURE.includes(this.name) ? at : tidied(at);
    if (held.takes) {
      this.editor.draft.note(held.was);
      return true;
    }
    if (this.name === 'select') {
      if (!held.moved) this.editor.select(held.hold?.kind, held.hold?.at);
      return false;
    }
    this.editor.sketch([]);
    if (held.moved && this.name !== 'place') this.editor.draw(this.name, this.outline(held.at, now));
    else this.click(now);
    return true;
  }

  // A rectangle by its diagonal; a wall, and two places of a picture, by their ends.
  outline(from, to) {
    if (ON_PICTURE.includes(this.name)) return [from, to];
    const [a, b] = [tidied(from), tidied(to)];
    return this.name === 'wall' ? [a, b] : [a, [b[0], a[1]], b, [a[0], b[1]]];
  }

  // Points one by one, without dragging: wall and picture two, furniture two corners, zone any.
  click(at) {
    if (this.name === 'place' || this.name === 'stand') return this.editor.draw(this.name, [at]);
    const first = this.corners[0];
    const near = first && Math.hypot(at[0] - first[0], at[1] - first[1]) * this.view.scale < 12;
    if (this.name === 'zone' && near) return this.close();
    this.corners.push(at);
    if (this.name !== 'zone' && this.corners.length === 2) {
      const [from, to] = this.corners;
      this.corners = [];
      return this.editor.draw(this.name, this.outline(from, to));
    }
    return this.editor.sketch(this.corners);
  }

  drag(held, now) {
    const {content} = this.editor.draft;
    const {selected} = this.editor;
    const by = [now[0] - held.at[0], now[1] - held.at[1]];
    const was = JSON.parse(held.was);
    const moved = ([x, y, ...more]) => [tidy(x + by[0]), tidy(y + by[1]), ...more];
    const one = content[selected.kind][selected.at];
    const before = was[selected.kind][selected.at];
    if (held.hold.kind === 'turn') {
      const [x, y] = one.position;
      one.degrees[0] = Math.round((Math.atan2(now[1] - y, now[0] - x) * 180) / Math.PI);
    } else if (held.hold.kind === 'corner') {
      one.polygon[held.hold.at] = tidied(now);
    } else if (selected.kind === 'access_points') {
      one.position = moved(before.position);
    } else if (selected.kind === 'zones') {
      one.polygon = before.polygon.map(moved);
    } else if (one.form === 'box') {
      one.centre = moved(before.centre);
    } else if (one.form === 'wall') {
      one.from = moved(before.from);
      one.to = moved(before.to);
    } else {
      one.moved = moved(before.moved);
    }
    this.editor.stirred();
  }
}
