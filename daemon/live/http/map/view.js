// The position of the world on the map: metres to pixels of the drawing, y down. From above, or
// isometric from the south-west, as `rayloc scene show` draws (daemon/site/plan/projection.h).
//
// The fitting view shows the bounds of the room with a margin of 0.3 m, centred and as large as the
// drawing allows with 16 free pixels on each side.
const AROUND = 0.3;
const FREE = 16;
const [ACROSS, UP] = [Math.sqrt(1 / 2), Math.sqrt(1 / 6)];
// Direction of a metre along x, y and z on the drawing.
const LOOKS = {
  plan: [[1, 0], [0, -1], [0, 0]],
  solid: [[ACROSS, -UP], [-ACROSS, -UP], [0, -2 * UP]],
};

export class View {
  constructor(element, changed) {
    this.element = element;
    this.changed = changed;
    this.fitting = true;
    this.scale = 100;
    this.unit = 1;  // drawing pixels per mark pixel: large screens are seen from a distance
    this.look = 'plan';
    this.centre = [0, 0];  // [m] on the drawing, y down
    this.bounds = {min: [0, 0, 0], max: [1, 1, 1]};
    this.measure();  // shapes drawn before the observer's first call need a position, too
    new ResizeObserver(() => this.resize()).observe(element);
    this.listen();
  }

  get isSolid() {
    return this.look === 'solid';
  }

  // look: a key of LOOKS.
  turn(look) {
    this.look = look;
    this.shape();
    this.resize();
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
    this.shape();
    this.resize();
  }

  // Height of the drawing relative to its width, for a page as narrow as the drawing (map.css).
  shape() {
    const {low, high} = this.extent();
    this.element.style.setProperty('--tall', (high[1] - low[1]) / (high[0] - low[0]));
  }

  // [m] of the drawing.
  extent() {
    const {min, max} = this.bounds;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => this.drawn(...[0, 1, 2].map((axis) => {
      const around = axis < 2 ? AROUND : 0;
      return corner & (1 << axis) ? (max[axis] ?? 0) + around : (min[axis] ?? 0) - around;
    })));
    const of = (pick) => [0, 1].map((i) => pick(...corners.map((one) => one[i])));
    return {low: of(Math.min), high: of(Math.max)};
  }

  fit() {
    const {low, high} = this.extent();
    this.scale = Math.max(1e-3, Math.min(
      (this.width - 2 * FREE) / (high[0] - low[0]), (this.height - 2 * FREE) / (high[1] - low[1])));
    this.fitScale = this.scale;
    this.centre = [0, 1].map((i) => (low[i] + high[i]) / 2);
    this.fitting = true;
    this.changed();
  }

  drawn(x, y, z) {
    const [right, along, up] = LOOKS[this.look];
    return [0, 1].map((i) => x * right[i] + y * along[i] + z * up[i]);
  }

  toPixel(x, y, z = 0) {
    const [across, down] = this.drawn(x, y, z);
    return [
      this.width / 2 + (across - this.centre[0]) * this.scale,
      this.height / 2 + (down - this.centre[1]) * this.scale,
    ];
  }

  // The point on the floor for a pixel of the window.
  toWorld(clientX, clientY) {
    const box = this.element.getBoundingClientRect();
    const across = this.centre[0] + (clientX - box.left - this.width / 2) / this.scale;
    const down = this.centre[1] + (clientY - box.top - this.height / 2) / this.scale;
    const [[a, b], [c, d]] = LOOKS[this.look];
    const determinant = a * d - b * c;
    return [(d * across - c * down) / determinant, (a * down - b * across) / determinant];
  }

  // Places a mark that is drawn about 0, 0 at that point.
  mark(x, y, z = 0) {
    return `translate(${this.toPixel(x, y, z).join(' ')}) scale(${this.unit})`;
  }

  // Places a shape that is drawn about 0, 0 in pixels, as seen from above, flat on the floor.
  flat(x, y) {
    const [[a, b], [c, d]] = LOOKS[this.look];
    return `matrix(${[a, b, -c, -d, ...this.toPixel(x, y)].join(' ')})`;
  }

  pan(dx, dy) {
    this.fitting = false;
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] - dy / this.scale];
    this.changed();
  }

  // Keeps one pixel fixed.
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const fit = this.fitScale || this.scale;
    const scale = Math.min(fit * 60, Math.max(fit / 8, this.scale * factor));
    const from = [px - this.width / 2, py - this.height / 2];
    this.centre = this.centre.map((middle, i) => middle + from[i] / this.scale - from[i] / scale);
    this.scale = scale;
    this.fitting = false;
    this.changed();
  }

  // The matrix of shapes drawn on the floor in metres, y up.
  matrix() {
    const [[a, b], [c, d]] = LOOKS[this.look];
    return `matrix(${[...[a, b, c, d].map((one) => one * this.scale), ...this.toPixel(0, 0)].join(' ')})`;
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
