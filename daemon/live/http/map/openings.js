// Doors and windows as architects draw them: a door with its leaf open and the arc of its swing, a
// window with the line of its pane. In metres, y up, for a group that is placed as a whole.
import {svg} from './draw.js';

const path = (name, d) => svg('path', {class: name, d});

// shape: kind `door` or `window`, of api/v1/map: its area begins at the hinge, on the room's side.
export function drawnOpening(shape) {
  const [hinge, latch, far, back] = shape.area;
  const gap = svg('polygon', {class: 'gap', points: shape.area.map((one) => one.join()).join(' ')});
  const between = (a, b) => [0, 1].map((i) => (a[i] + b[i]) / 2).join(' ');
  if (shape.kind === 'window') {
    return [gap, path('pane', `M${between(hinge, back)} L${between(latch, far)}`)];
  }
  const [dx, dy] = [0, 1].map((i) => hinge[i] - back[i]);  // towards the room
  const [ax, ay] = [0, 1].map((i) => latch[i] - hinge[i]);
  const wide = Math.hypot(ax, ay);
  const deep = Math.hypot(dx, dy) || 1;
  const tip = [hinge[0] + (dx / deep) * wide, hinge[1] + (dy / deep) * wide];
  const sweep = dx * ay - dy * ax > 0 ? 1 : 0;
  return [
    gap, path('swing', `M${tip.join(' ')} A${wide} ${wide} 0 0 ${sweep} ${latch.join(' ')}`),
    path('leaf', `M${hinge.join(' ')} L${tip.join(' ')}`),
  ];
}
