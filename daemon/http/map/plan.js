// What does not move: walls and furniture, zones, access points, fixed transmitters, and how well
// the surveyed points of the calibration fit.
import {byId, setText, svg} from './draw.js';
import {dotOf} from './fits.js';

const points = (list) => list.map(([x, y]) => `${x},${y}`).join(' ');

export class Plan {
  constructor(map) {
    this.map = map;
    byId('plan').replaceChildren(...map.plan.map((shape) => {
      const element = svg(shape.area ? 'polygon' : 'polyline',
        {class: shape.kind, points: points(shape.area || shape.line)});
      if (shape.name) element.append(svg('title', {}, [`${shape.name} (${shape.material})`]));
      return element;
    }));
    this.zones = map.zones.map((zone) => ({
      zone, area: svg('polygon', {class: 'zone'}), name: svg('text', {class: 'zone-name', 'text-anchor': 'middle'}, [zone.name]),
    }));
    byId('zones').replaceChildren(...this.zones.flatMap(({area, name}) => [area, name]));
    this.fixed = [...map.access_points.map((one) => this.accessPoint(one)), ...map.fixed_transmitters.map(fixedTransmitter)];
    byId('fixed').replaceChildren(...this.fixed.map(({group}) => group));
    this.residuals = [];
  }

  accessPoint(one) {
    const arrow = svg('path', {d: 'M16 0 -9 -9 -4 0 -9 9Z'});
    const cross = svg('path', {class: 'cross', d: 'M-8 -8 8 8M-8 8 8 -8', visibility: 'hidden'});
    const text = svg('text', {x: 0, y: -14, 'text-anchor': 'middle'}, [one.id]);
    const group = svg('g', {class: 'access-point', id: `ap-${one.id}`}, [arrow, cross, text]);
    const degrees = (-Math.atan2(one.facing[1], one.facing[0]) * 180) / Math.PI;
    arrow.setAttribute('transform', `rotate(${degrees})`);
    return {group, at: one.position, id: one.id, cross, text};
  }

  place(view) {
    byId('plan').setAttribute('transform', view.matrix());
    for (const {zone, area, name} of this.zones) {
      const corners = zone.polygon.map(([x, y]) => view.toPixel(x, y));
      area.setAttribute('points', points(corners));
      const middle = [0, 1].map((i) => corners.reduce((sum, c) => sum + c[i], 0) / corners.length);
      name.setAttribute('transform', `translate(${middle.join(' ')}) scale(${view.unit})`);
    }
    for (const {group, at} of this.fixed) {
      group.setAttribute('transform', view.mark(at[0], at[1]));
    }
    for (const {dot, at} of this.residuals) {
      dot.setAttribute('transform', view.mark(at[0], at[1]));
    }
  }

  // inside: the targets in each zone, by its name.
  showZones(inside) {
    for (const {zone, name} of this.zones) {
      const count = inside.get(zone.name)?.size;
      setText(name, count ? `${zone.name} (${count})` : zone.name);
    }
  }

  // What access points do is known of the present alone.
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

function fixedTransmitter(one) {
  const name = one.name || one.mac;
  const group = svg('g', {class: 'fixed'}, [
    svg('rect', {x: -5, y: -5, width: 10, height: 10}),
    svg('title', {}, [`fixed transmitter ${name}`]),
  ]);
  return {group, at: one.position};
}
