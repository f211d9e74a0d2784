// The methods that locate at the site: its own, and those that are compared with it ([engine]
// method with several). Each of the others has a colour and a shape; a single method has no list.
import {byId, html, number, svg} from './draw.js';

const SHAPES = ['M0-9L9 0L0 9L-9 0Z', 'M0-9L9 7H-9Z', 'M-7-7H7V7H-7Z'];
const CLOSE_PX = 30;  // names of marks closer than this are placed below one another
const LINE_PX = 16;

export class Methods {
  constructor() {
    this.names = [];
  }

  // names: the site's method, then the others; absent if the daemon does not send them.
  show(names = []) {
    this.names = names;
    const list = byId('methods');
    list.hidden = names.length < 2;
    list.replaceChildren(...(list.hidden ? [] : names.map((name, i) => html('li', {}, [
      svg('svg', {class: `swatch ${i === 0 ? 'c0' : `m${i - 1}`}`, viewBox: '-10 -10 20 20', 'aria-hidden': 'true'},
        [i === 0 ? svg('circle', {r: 9}) : svg('path', {class: 'shape', d: SHAPES[i - 1]})]),
      ` ${name}${i === 0 ? ', a colour for each target' : ''}`,
    ]))));
  }

  // at: the target's position by the site's method; compared: as in Model.at().
  marks(target, at, compared, view) {
    return compared.flatMap((one) => {
      const shape = this.names.indexOf(one.method) - 1;
      return shape < 0 || !one.location.position ? [] : [drawn(target, at, one, shape, view)];
    });
  }

  // "spotfi: 1.20, 3.40 (0.52 m away)"
  text(at, compared) {
    return compared.filter(({method}) => this.names.indexOf(method) > 0).map(({method, location: {position: p}}) => {
      if (!p) return `${method}: no fix`;
      const away = at ? ` (${number(Math.hypot(p.x - at.x, p.y - at.y))} m away)` : '';
      return `${method}: ${number(p.x)}, ${number(p.y)}${away}`;
    }).join('; ');
  }
}

function drawn(target, at, {method, location, stale}, shape, view) {
  const {position: p, accuracy_m: radius} = location;
  const parts = [svg('title', {}, [`${target.name} by ${method}`])];
  const [x, y] = view.toPixel(p.x, p.y, p.z);
  let below = 0;
  if (at) {
    const [x1, y1] = view.toPixel(at.x, at.y, at.z);
    parts.push(svg('line', {class: 'tie', x1, y1, x2: x, y2: y}));
    below = Math.hypot(x - x1, y - y1) < CLOSE_PX * view.unit ? (shape + 1) * LINE_PX : 0;
  }
  if (radius !== undefined) {
    parts.push(svg('circle', {class: 'ring', r: Math.max(1, radius * view.scale), transform: view.flat(p.x, p.y)}));
  }
  const isAtEdge = x + (14 + 8 * method.length) * view.unit > view.width;
  parts.push(svg('g', {transform: view.mark(p.x, p.y, p.z)}, [
    svg('path', {class: 'shape', d: SHAPES[shape]}),
    svg('text', {x: isAtEdge ? -13 : 13, y: 5 + below, 'text-anchor': isAtEdge ? 'end' : 'start'}, [method]),
  ]));
  return svg('g', {class: `compared m${shape}${stale ? ' stale' : ''}`, 'data-method': method}, parts);
}
