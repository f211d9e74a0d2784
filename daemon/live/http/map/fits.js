// Share of the power that the calibrated room explains at each surveyed point: map and table.
import {byId, html, number, svg} from './draw.js';

export const STEPS = 5;  // colours and sizes (map.css), by share explained, in ascending order

// fits: as in /api/v1/calibration. Returns each point's mean over the access points, worst first.
export function pointsOf(fits) {
  const byPoint = new Map();
  for (const fit of fits) {
    const key = fit.position.join();
    if (!byPoint.has(key)) byPoint.set(key, {at: fit.position, values: []});
    byPoint.get(key).values.push(fit.after);
  }
  return [...byPoint.values()]
    .map(({at, values}) => ({at, share: values.reduce((sum, v) => sum + v, 0) / values.length}))
    .sort((a, b) => a.share - b.share);
}

const stepOf = (share) => Math.min(STEPS - 1, Math.max(0, Math.floor(STEPS * share)));
const percent = (share) => `${number(100 * share, 0)} %`;

// The smaller the share, the larger the dot: not every person can distinguish the colours.
export function dotOf({share}) {
  const step = stepOf(share);
  const title = svg('title', {}, [`${percent(share)} of the power explained`]);
  return svg('circle', {class: `residual fit-${step}`, r: 9 - step}, [title]);
}

export function writePoints(points) {
  byId('fits').hidden = points.length === 0;
  byId('fit-rows').replaceChildren(...points.map(({at, share}) => html('tr', {}, [
    html('th', {scope: 'row'}, [at.map((value) => number(value)).join(', ')]),
    html('td', {}, [percent(share)]),
  ])));
}
