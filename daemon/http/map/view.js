// Where the world is on the map: metres, y up, to pixels of the drawing, y down.
//
// The fitting view shows the bounds of the room with 0.3 m around them, as large as they go into the
// drawing with 16 pixels left free on each side, in its middle.
const AROUND = 0.3;
const FREE = 16;

export class View {
  constructor(element, changed) {
    this.element = element;
    this.changed = changed;
    this.fitting = true;
    this.scale = 100;
    this.unit = 1;  // pixels of the drawing that a mark's own pixel takes: large screens are seen from afar
    this.centre = [0, 0];
    this.bounds = {min: [0, 0], max: [1, 1]};
    this.measure();  // what is drawn before the observer's first word has a place, too
    new ResizeObserver(() => this.resize()).observe(element);
    this.listen();
  }

  measure() {
    const box = this.element.getBoundingClientRect();
    this.width = box.width;
    this.height = box.height;
    this.unit = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
  }

  resize() {
    this.measure();
    if (this.fitting) this.fit();
    this.changed();
  }

  show(bounds) {
    this.bounds = bounds;
    this.resize();
  }

  fit() {
    const {min, max} = this.bounds;
    const size = [0, 1].map((i) => max[i] - min[i] + 2 * AROUND);
    this.scale = Math.max(1e-3, Math.min((this.width - 2 * FREE) / size[0], (this.height - 2 * FREE) / size[1]));
    this.fitScale = this.scale;
    this.centre = [0, 1].map((i) => (min[i] + max[i]) / 2);
    this.fitting = true;
    this.changed();
  }

  toPixel(x, y) {
    return [
      this.width / 2 + (x - this.centre[0]) * this.scale,
      this.height / 2 - (y - this.centre[1]) * this.scale,
    ];
  }

  // Puts a mark there that is drawn about 0, 0.
  mark(x, y) {
    return `translate(${this.toPixel(x, y).join(' ')}) scale(${this.unit})`;
  }

  pan(dx, dy) {
    this.fitting = false;
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
    this.changed();
  }

  // About a pixel that stays where it is.
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const fit = this.fitScale || this.scale;
    const scale = Math.min(fit * 60, Math.max(fit / 8, this.scale * factor));
    const dx = px - this.width / 2;
    const dy = py - this.height / 2;
    this.centre = [
      this.centre[0] + dx / this.scale - dx / scale,
      this.centre[1] - dy / this.scale + dy / scale,
    ];
    this.scale = scale;
    this.fitting = false;
    this.changed();
  }

  matrix() {
    const [x, y] = this.toPixel(0, 0);
    return `matrix(${this.scale} 0 0 ${-this.scale} ${x} ${y})`;
  }

  listen() {
    const keys = {
      ArrowLeft: () => this.pan(60, 0),
      ArrowRight: () => this.pan(-60, 0),
      ArrowUp: () => this.pan(0, 60),
      ArrowDown: () => this.pan(0, -60),
      '+': () => this.zoom(1.25),
      '=': () => this.zoom(1.25),
      '-': () => this.zoom(0.8),
      '0': () => this.fit(),
    };
    this.element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      keys[event.key]();
      event.preventDefault();
    });
    this.element.addEventListener('wheel', (event) => {
      const box = this.element.getBoundingClientRect();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.clientX - box.left, event.clientY - box.top);
      event.preventDefault();
    }, {passive: false});
    this.listenToPointers();
  }

  // One finger or the mouse moves, two fingers zoom.
  listenToPointers() {
    const down = new Map();
    this.element.addEventListener('pointerdown', (event) => {
      down.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ['pointerup', 'pointercancel', 'pointerleave']) {
      this.element.addEventListener(end, (event) => down.delete(event.pointerId));
    }
    this.element.addEventListener('pointermove', (event) => {
      const before = down.get(event.pointerId);
      if (!before) return;
      const now = [event.clientX, event.clientY];
      const other = [...down].find(([id]) => id !== event.pointerId);
      down.set(event.pointerId, now);
      if (other) {
        const apart = (p) => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]);
        const box = this.element.getBoundingClientRect();
        this.zoom(apart(now) / Math.max(1, apart(before)), (now[0] + other[1][0]) / 2 - box.left,
          (now[1] + other[1][1]) / 2 - box.top);
      } else {
        this.pan(now[0] - before[0], now[1] - before[1]);
      }
    });
  }
}
