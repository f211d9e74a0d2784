// The draft on the floor plan. Shapes that can be dragged have data-kind and data-at, the index in
// the draft's list of that kind.
import {byId, svg} from './draw.js';
import {drawnOpening} from './openings.js';
import {colouredZones} from './zones.js';

const points = (list) => list.map(([x, y]) => `${x},${y}`).join(' ');
const turned = ([x, y], angle) => [
  x * Math.cos(angle) - y * Math.sin(angle), x * Math.sin(angle) + y * Math.cos(angle)];

export function cornersOf(object) {
  const [x, y] = object.centre;
  const [w, d] = object.size.map((one) => one / 2);
  const angle = (object.yaw_deg * Math.PI) / 180;
  return [[-w, -d], [w, -d], [w, d], [-w, d]].map((one) => {
    const [u, v] = turned(one, angle);
    return [x + u, y + v];
  });
}

const middleOf = (corners) => [0, 1].map((i) => corners.reduce((sum, one) => sum + one[i], 0) / corners.length);

export class Shapes {
  constructor(view) {
    this.view = view;
  }

  // selected: {kind, at}; ghost: points of the shape being drawn.
  show(state, content, selected, ghost) {
    const is = (kind, at) => selected?.kind === kind && selected.at === at;
    byId('plan').setAttribute('transform', this.view.matrix());
    byId('plan').replaceChildren(...this.background(state.plan ?? [], content, is));
    byId('drawn').setAttribute('transform', this.view.matrix());
    byId('drawn').replaceChildren(
      ...content.objects.flatMap((one, at) => this.object(one, at, is('objects', at))),
      ...colouredZones(content.zones).map(({zone, kind}, at) => svg('polygon', {
        class: `zone ${kind}${is('zones', at) ? ' selected' : ''}`, points: points(zone.polygon), 'data-kind': 'zones', 'data-at': at})),
      ...(ghost.length > 1 ? [svg('polyline', {class: 'sketch', points: points(ghost)})] : []));
    byId('marks').replaceChildren(
      ...colouredZones(content.zones).map(({zone, kind}) => this.label(middleOf(zone.polygon), zone.name, `zone-name ${kind}`)),
      ...content.objects.flatMap((one) => one.form === 'box' ? [this.label(one.centre, one.name, 'object-name')] : []),
      ...ghost.map((one) => this.corner(one, {})),
      ...(selected?.kind === 'zones' && content.zones[selected.at] ? content.zones[selected.at].polygon.map(
        (one, corner) => this.corner(one, {'data-kind': 'corner', 'data-at': corner})) : []),
      ...content.access_points.map((one, at) => this.accessPoint(one, at, is('access_points', at))));
  }

  // The scene as seen from above, without the objects that the draft draws itself or has removed.
  background(plan, content, is) {
    const places = new Map(content.objects.map((one, at) => [one.was.replace(/^mesh-/, ''), at]));
    const gone = (shape) => this.known.has(shape.name) && !places.has(shape.name);
    return plan.flatMap((shape) => {
      const at = places.get(shape.name);
      const object = content.objects[at];
      if (gone(shape) || (object && object.form !== 'mesh')) return [];
      const hold = object && shape.kind !== 'floor' ? {'data-kind': 'objects', 'data-at': at} : {};
      const [dx, dy] = object?.moved ?? [0, 0];
      const corners = (shape.area || shape.line).map(([x, y]) => [x + dx, y + dy]);
      const [element, ...more] = shape.kind === 'door' || shape.kind === 'window' ? drawnOpening({...shape, area: corners})
        : [svg(shape.area ? 'polygon' : 'polyline', {class: shape.kind, points: points(corners)})];
      for (const [key, value] of Object.entries(hold)) element.setAttribute(key, value);
      if (object && is('objects', at)) element.classList.add('selected');
      if (shape.name) element.append(svg('title', {}, [`${shape.name} (${shape.material})`]));
      return [element, ...more];
    });
  }

  // The objects in the files: those that are no longer in the draft were removed.
  remember(content) {
    this.known = new Set(content.objects.map((one) => one.was.replace(/^mesh-/, '')));
  }

  object(one, at, isSelected) {
    if (one.form === 'mesh') return [];
    const hold = {'data-kind': 'objects', 'data-at': at};
    const name = svg('title', {}, [`${one.name} (${one.material})`]);
    const mark = isSelected ? ' selected' : '';
    return [one.form === 'box'
      ? svg('polygon', {class: `furniture${mark}`, points: points(cornersOf(one)), ...hold}, [name])
      : svg('polyline', {class: `cut${mark}`, points: points([one.from, one.to]), ...hold}, [name])];
  }

  label([x, y], text, kind) {
    return svg('text', {class: kind, 'text-anchor': 'middle', transform: this.view.mark(x, y)}, [text]);
  }

  corner([x, y], hold) {
    return svg('g', {transform: this.view.mark(x, y)}, [svg('circle', {class: 'corner', r: 7, ...hold})]);
  }

  accessPoint(one, at, isSelected) {
    const hold = {'data-kind': 'access_points', 'data-at': at};
    const turn = {transform: `rotate(${-one.degrees[0]})`};
    const parts = [
      svg('g', turn, [svg('path', {d: 'M16 0 -9 -9 -4 0 -9 9Z', ...hold})]),
      svg('text', {x: 0, y: -16, 'text-anchor': 'middle', ...hold}, [one.id]),
    ];
    if (isSelected) {
      parts.unshift(svg('g', turn, [
        svg('line', {class: 'sketch', x1: 16, y1: 0, x2: 44, y2: 0}),
        svg('circle', {class: 'corner', cx: 44, cy: 0, r: 8, 'data-kind': 'turn', 'data-at': at}),
      ]));
    }
    return svg('g', {class: `access-point${isSelected ? ' selected' : ''}`, transform: this.view.mark(one.position[0], one.position[1])}, parts);
  }
}
