// The panels that are asked for: what the calibration found, and the channel.
import {ask} from './ask.js';
import {byId, html, number, setText, svg} from './draw.js';

let fits = [];  // of the calibration shown: how well each surveyed point is explained

// report: as in /api/v1/calibration.
export function showCalibration(report) {
  fits = (report.available && report.fits) || [];
  byId('show-residuals').disabled = fits.length === 0;
  setText(byId('calibration-text'), report.available ? summary(report) : `Nothing to show: ${report.reason}.`);
  byId('moved-rows').replaceChildren(...(report.moved || []).slice(0, 12).map((one) => html('tr', {}, [
    html('th', {scope: 'row'}, [one.name]),
    html('td', {}, [`${Number(one.by.toPrecision(3))} ${one.unit}`]),
    html('td', {}, [one.prior_sigmas === null ? '' : `${number(one.prior_sigmas, 1)} σ`]),
  ])));
}

function summary(report) {
  const parts = Object.entries(report.heldout || {}).filter(([, fit]) => fit.after !== null).map(([ap, fit]) =>
    `${ap} ${fit.before === null ? '' : `${number(100 * fit.before, 0)} → `}${number(100 * fit.after, 0)} %`);
  return `Method ${report.method}, ${report.points} points. Power explained at the points held out, median: `
    + `${parts.join(', ') || 'not known'}.`;
}

// On the map, where that is wanted.
export function showFits(plan) {
  plan.showResiduals(byId('show-residuals').checked ? fits : []);
}

const CHANNEL_MS = 1000;
const WIDE = 300;
const HIGH = 90;

// While its panel is open: the channel of the selected target, else of the one heard last.
export function watchChannel(targets) {
  const panel = byId('csi');
  let next = null;
  const look = async () => {
    clearTimeout(next);
    if (!panel.open) return;
    try {
      showChannel(await ask('/api/v1/channel'), targets.selected);
    } catch {
      setText(byId('csi-text'), 'raylocd does not answer.');
    }
    next = setTimeout(look, CHANNEL_MS);
  };
  panel.addEventListener('toggle', look);
}

function showChannel(channels, selected) {
  const channel = channels.find((one) => one.target === selected) || channels[0];
  if (!channel) {
    setText(byId('csi-text'), 'No device has been located since this panel was opened.');
    byId('csi-charts').replaceChildren();
    return;
  }
  const agreement = channel.access_points.map((ap) => `${ap.id} ${number(100 * ap.correlation, 0)} %`);
  setText(byId('csi-text'), `${channel.target}: amplitude over the tones of each antenna, measured (line) and simulated `
    + `at the estimated position (dashed). Power explained: ${agreement.join(', ')}.`);
  byId('csi-charts').replaceChildren(...channel.access_points.flatMap((ap) =>
    ap.antennas.flatMap((antenna, i) => {
      const name = `${ap.id}, antenna ${i + 1}`;
      return [html('p', {class: 'chart-name'}, [name]), chart(name, channel.tones, antenna)];
    })));
}

function chart(name, tones, {measured, simulated}) {
  const top = 1.05 * Math.max(...measured, ...simulated, 1e-9);
  const [first, last] = [tones[0], tones[tones.length - 1]];
  const line = (values, kind) => svg('polyline', {
    class: kind,
    points: values.map((v, i) => `${(WIDE * (tones[i] - first)) / Math.max(1, last - first)},${HIGH * (1 - v / top)}`).join(' '),
    'vector-effect': 'non-scaling-stroke',
  });
  return svg('svg', {
    class: 'chart', viewBox: `0 0 ${WIDE} ${HIGH}`, preserveAspectRatio: 'none', role: 'img',
    'aria-label': `${name}: amplitude from tone ${first} to ${last}, measured and simulated`,
  }, [svg('rect', {class: 'frame', width: WIDE, height: HIGH}), line(measured, 'measured'), line(simulated, 'simulated')]);
}
