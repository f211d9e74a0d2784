// What does not move: walls and furniture, zones, access points, fixed transmitters, and how well
// the surveyed points of the calibration fit.
import {byId, number, setText, svg} from './draw.js';

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
      name.setAttribute('x', middle[0]);
      name.setAttribute('y', middle[1]);
    }
    for (const {group, at} of this.fixed) {
      group.setAttribute('transform', `translate(${view.toPixel(at[0], at[1]).join(' ')})`);
    }
    for (const {dot, at} of this.residuals) {
      const [x, y] = view.toPixel(at[0], at[1]);
      dot.setAttribute('cx', x);
      dot.setAttribute('cy', y);
    }
  }

  // inside: the targets in each zone, by its name.
  showZones(inside) {
    for (const {zone, name} of this.zones) {
      const count = inside.get(zone.name)?.size;
      setText(name, count ? `${zone.name} (${count})` : zone.name);
    }
  }

  showSources(model) {
    for (const one of this.fixed) {
      if (!one.id) continue;
      const status = model.status(one.id);
      const bad = ['stalled', 'failed', 'no source'].includes(status);
      one.group.setAttribute('class', `access-point ${status === 'receiving' ? 'receiving' : bad ? 'bad' : ''}`);
      one.cross.setAttribute('visibility', bad ? 'visible' : 'hidden');
      setText(one.text, status === 'receiving' ? one.id : `${one.id}: ${status}`);
    }
  }

  // fits: as in /api/v1/calibration; the mean over the access points of each point.
  showResiduals(fits) {
    const byPoint = new Map();
    for (const fit of fits) {
      const key = fit.position.join();
      if (!byPoint.has(key)) byPoint.set(key, {at: fit.position, values: []});
      byPoint.get(key).values.push(fit.after);
    }
    this.residuals = [...byPoint.values()].map(({at, values}) => {
      const share = values.reduce((sum, v) => sum + v, 0) / values.length;
      // From blue (all explained) to orange (nothing): also told apart by who sees no red.
      const mix = [[20, 90, 190], [225, 120, 0]].map((c, i) => c.map((v) => v * (i ? 1 - share : share)));
      const colour = mix[0].map((v, i) => Math.round(v + mix[1][i]));
      const title = svg('title', {}, [`${number(100 * share, 0)} % of the power explained`]);
      return {at, dot: svg('circle', {class: 'residual', r: 6, fill: `rgb(${colour.join()})`}, [title])};
    });
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
