// The live map: the messages of raylocd (/events) on the floor plan of its site (/api/v1/map).
import {ask} from './ask.js';
import {byId, setText} from './draw.js';
import {Feed} from './feed.js';
import {Heat} from './heat.js';
import {Model} from './model.js';
import {showCalibration, showFits, watchChannel} from './panels.js';
import {Plan} from './plan.js';
import {Playback} from './playback.js';
import {Solid} from './solid.js';
import {showDaemon, showEvents, showSources} from './sources.js';
import {Targets} from './targets.js';
import {offerThemes} from './theme.js';
import {Timeline} from './timeline.js';
import {View} from './view.js';
import {offerSites} from './choice.js';

const ANNOUNCE_MS = 1500;
const DRAW_MS = 250;  // maximum interval: ages grow without a message
const AGAIN_MS = 5000;
const REOPEN_MS = 10_000;  // of silence before the stream is reopened
const HIDDEN_MS = 10_000;
const PLAN_MS = 60_000;  // the plan of a large scene takes long over a slow line

const announcements = [];
// A past under review is discarded when raylocd is restarted.
const model = new Model((text) => announcements.push(text), () => timeline.present());
const targets = new Targets();
const timeline = new Timeline(model);
const playback = new Playback(model);
const view = new View(byId('map'), () => { stirred = true; });
const heat = new Heat(() => { stirred = true; });
const solid = new Solid(view, () => { stirred = true; });
let plan = null;
let mapOf = null;  // the start of the site that the plan was fetched for
let stirred = true;
let drawn = 0;
let link = null;  // 'open', 'lost' or 'refused', from the first answer on

// Repeats the request until it is answered; the tables work without the plan.
async function fetchPlan(start) {
  mapOf = start;
  try {
    const [map, report] = await Promise.all([ask('api/v1/map', {}, PLAN_MS), ask('api/v1/calibration')]);
    if (mapOf === start) showPlan(map, report);
  } catch (error) {
    if (mapOf !== start) return;  // another start is being requested meanwhile
    if (!plan) setText(byId('empty'), `The floor plan is not known: ${error.message}. Trying again.`);
    setTimeout(() => { if (mapOf === start) fetchPlan(start); }, AGAIN_MS);
  }
}

function showPlan(map, report) {
  setText(byId('site'), map.site);
  document.title = `${map.site}: RayLoc live map`;
  targets.methods.show(map.methods);
  if (map.available === false) {
    plan = null;
    setText(byId('empty'), `There is no floor plan: ${map.reason}.`);
  } else {
    const moved = !plan || JSON.stringify(plan.map.bounds) !== JSON.stringify(map.bounds);
    plan = new Plan(map);
    solid.forget();
    if (moved) view.show(map.bounds);
  }
  showCalibration(report);
  if (plan) showFits(plan);
  stirred = true;
}

function told(kind) {
  return (body) => {
    model[kind](body);
    const start = model.start;
    if (start !== null && mapOf !== start) fetchPlan(start);
    stirred = true;
  };
}

function connection(state) {
  link = state;
  showConnection();
}

function showConnection() {
  if (!link) return;
  const {quiet} = model;
  byId('connection').classList.toggle('lost', quiet || link !== 'open');
  setText(byId('connection-text'), quiet && link === 'open' ? 'No word from raylocd' : {
    open: 'Connected',
    lost: 'Connection lost: trying again',
    refused: 'No stream: raylocd gives none (it may have too many viewers); trying again',
  }[link]);
  // Read out once and not each second: it is not part of a live region.
  setText(byId('connection-age'), quiet ? ` for ${Math.round(model.silence / 1000)} s` : '');
}

function watchFeed() {
  if (feed.closed) return;
  const since = performance.now() - Math.max(feed.opened, model.heard ?? 0);
  if (since > Math.max(REOPEN_MS, model.patience)) feed.reopen();
}

function draw(time) {
  requestAnimationFrame(draw);
  const elapsed = time - drawn;
  if (!stirred && !timeline.running && elapsed < DRAW_MS) return;
  showConnection();
  playback.show();
  drawn = time;
  stirred = false;
  const moment = model.held ?? timeline.step(elapsed);
  const isPresent = timeline.isPresent || model.held !== null;
  showRoom(moment, isPresent);
  setText(byId('no-targets'), model.absence(isPresent));
  targets.show(model.at(moment), view);
  showSources(model, isPresent);
  showDaemon(model.heartbeat);
  showEvents(isPresent ? model.events : model.eventsAt(moment));
  showChannel(isPresent);
}

// Without a plan no object has a position on the drawing.
function showRoom(moment, isPresent) {
  byId('map').classList.toggle('planless', !plan);
  byId('empty').hidden = Boolean(plan);
  byId('scale').hidden = !plan;
  if (!plan) return;
  plan.showSources(model, isPresent);
  plan.showZones(model.inside(moment));
  plan.place(view);  // after the names, which may have become longer
  heat.place(view);
  solid.place(targets.selected, isPresent, plan.taken);
  showScale();
}

function showScale() {
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200];
  const scale = view.scale * (view.isSolid ? Math.sqrt(2 / 3) : 1);  // along each axis
  const metres = steps.find((m) => m * scale >= 60 * view.unit) || 500;
  byId('scale-bar').style.width = `${metres * scale}px`;
  setText(byId('scale-text'), `${metres} m`);
}

function announce() {
  if (announcements.length > 0) {
    setText(byId('announcer'), announcements.splice(0).slice(-4).join('; '));
  }
}

byId('zoom-in').addEventListener('click', () => view.zoom(1.25));
byId('zoom-out').addEventListener('click', () => view.zoom(0.8));
byId('fit').addEventListener('click', () => view.fit());
byId('show-residuals').addEventListener('change', () => {
  if (plan) showFits(plan);
  stirred = true;
});
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') targets.selected = null;
  stirred = true;
});
document.addEventListener('input', () => { stirred = true; });
document.addEventListener('click', () => { stirred = true; });

offerThemes();
offerSites(() => model.quiet);
const showChannel = watchChannel(targets, model);
setInterval(announce, ANNOUNCE_MS);
setInterval(watchFeed, 1000);
const feed = new Feed('events', {snapshot: told('snapshot'), update: told('update'), state: connection});
requestAnimationFrame(draw);

// A browser has six connections to one server, all its tabs together, and raylocd has sixteen
// viewers: a hidden page closes its own.
let hiding = null;
function noticeHiding() {
  clearTimeout(hiding);
  if (document.hidden) hiding = setTimeout(() => feed.close(), HIDDEN_MS);
  else if (feed.closed) feed.open();
}
document.addEventListener('visibilitychange', noticeHiding);
noticeHiding();
