// The panels opened on demand: the result of the calibration, and the channel.
import {ask} from './ask.js';
import {byId, html, number, setText, svg} from './draw.js';
import {pointsOf, writePoints} from './fits.js';
import {minutes} from './playback.js';

const MOVED = 12;  // rows listed here; the report has all

let points = [];  // points of the calibration shown, with the share explained

// report: as in /api/v1/calibration.
export function showCalibration(report) {
  points = pointsOf((report.available && report.fits) || []);
  byId('show-residuals').disabled = points.length === 0;
  writePoints(points);
  setText(byId('calibration-text'), report.available ? summary(report) : `Nothing to show: ${report.reason}.`);
  const moved = report.moved || [];
  setText(byId('moved-more'), moved.length > MOVED ? `And ${moved.length - MOVED} more in report.html of the calibration.` : '');
  byId('moved-rows').replaceChildren(...moved.slice(0, MOVED).map((one) => html('tr', {}, [
    html('th', {scope: 'row'}, [one.name]),
    html('td', {}, [`${Number(one.by.toPrecision(3))} ${one.unit}`]),
    html('td', {}, [one.prior_sigmas === null ? '' : `${number(one.prior_sigmas, 1)} σ`]),
  ])));
}

function summary(report) {
  if (!report.heldout && report.expectation) return report.expectation;  // calibrated without a survey
  const parts = Object.entries(report.heldout || {}).filter(([, fit]) => fit.after !== null).map(([ap, fit]) =>
    `${ap} ${fit.before === null ? '' : `${number(100 * fit.before, 0)} → `}${number(100 * fit.after, 0)} %`);
  return `Method ${report.method}, ${report.points} points. Power explained at the points held out, median: `
    + `${parts.join(', ') || 'not known'}.`;
}

// Shown on the map on demand.
export function showFits(plan) {
  plan.showResiduals(byId('show-residuals').checked ? points : []);
}

const CHANNEL_MS = 1000;
const WIDE = 300;
const HIGH = 90;

// While its panel is open: the channel of the selected target, or of the one received last. Returns
// the function that redraws it, called with every picture: selection and moment change.
export function watchChannel(targets, model) {
  const panel = byId('csi');
  let next = null;
  let known = null;  // the answer since the panel was opened
  const look = async (first) => {
    clearTimeout(next);
    if (!panel.open) return;
    try {
      const answer = await ask('api/v1/channel');
      // The answer belongs to the previous request: the first one is from an earlier viewing.
      known = first ? [] : answer;
    } catch (error) {
      known = null;
      showNoChannel(`It is not known: ${error.message}.`);
    }
    next = setTimeout(look, CHANNEL_MS);
  };
  panel.addEventListener('toggle', () => {
    known = null;
    look(true);
  });
  return (isPresent) => {
    if (panel.open && known) showChannel(known, targets.selected, model, isPresent);
  };
}

let drawn = null;  // the channel of the charts on the page

function showNoChannel(why) {
  drawn = null;
  setText(byId('csi-text'), why);
  byId('csi-charts').replaceChildren();
}

// Reception time of its burst, which is never now: it is requested, and takes long to compute.
function heardText(time, model) {
  const {playback} = model;
  if (playback) return `${minutes(model.played((time - playback.begin) / 1000))} into the recording`;
  return `received ${number(Math.max(0, model.now() - time) / 1000, 0)} s ago`;
}

// All text and charts are of one burst, and of the position at which it was located: a moving
// target has left that position, and the map shows its current one.
export function showChannel(channels, selected, model, isPresent = true) {
  const channel = channels.find((one) => one.target === selected) || channels[0];
  if (!channel) return showNoChannel('No device has been located since this panel was opened.');
  const other = selected && selected !== channel.target ? `${model.nameOf(selected)} has no channel yet. ` : '';
  const then = isPresent ? '' : 'Not of the moment that the map shows. ';
  const heard = heardText(Date.parse(channel.time), model);
  const [x, y] = channel.position;
  const agreement = channel.access_points.map((ap) => `${ap.id} ${number(100 * ap.correlation, 0)} %`);
  setText(byId('csi-text'), `${then}${other}${channel.name || channel.target} at ${number(x)}, ${number(y)}, ${heard}: `
    + 'amplitude over the tones of each antenna, measured (line) and simulated there (dashed). '
    + `Power explained: ${agreement.join(', ')}.`);
  if (channel === drawn) return;
  drawn = channel;
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
