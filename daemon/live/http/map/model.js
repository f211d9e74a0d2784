// The state of the map: targets with their past, sources, the daemon. The feed fills it; queries
// give a moment: the present, or one under review.
//
// All times are of the daemon's clock [ms]; `now()` advances it from the last message on.
import {isPerson, seconds, sourceText, statusText, targetName, trackText, zoneText} from './words.js';

const PAST_MS = 10 * 60_000;    // for review
const PAST = 30_000;            // estimates kept, of all targets together
const GHOSTS = 8;               // hypotheses kept of each estimate
const TRAIL_MS = 20_000;
const FORGET_MS = 10 * 60_000;  // a target without a message for this long is removed from the map
const FORGET_LOST_MS = 60_000;  // a person whose track was lost: its number is not reused
const PREFER_FILTERED_MS = 1000;
const FRESH_MS = 5000;          // older events are not announced
const SLACK_MS = 700;           // of transmission delay, before an estimate counts as stale
const EVENTS = 100;
const ZONE_EVENTS = 1000;       // kept for each zone, for review
const BEAT_MS = 1000;           // between heartbeats, before two have arrived
const QUIET_MS = 3000;          // without a message: the state of raylocd is then unknown
const QUIET_BEATS = 2.5;        // or this many heartbeats, if these are rarer

const keyOf = (target) => target.mac || target.hashed_mac || `person-${target.track}`;

export class Model {
  // told(text): announces a text to the person. restarted(): earlier state is void.
  constructor(told, restarted) {
    this.told = told;
    this.restarted = restarted;
    this.events = [];
    this.clear();
  }

  clear() {
    this.epoch = null;
    this.offset = null;
    this.heard = null;  // time of the last message, by performance.now()
    this.beatMs = BEAT_MS;
    this.targets = new Map();
    this.sources = new Map();
    this.zones = new Map();  // their events, by name
    this.heartbeat = null;
    this.playback = null;
    this.colours = 0;
    this.first = null;
    this.latest = null;
    this.nobody = null;
  }

  // Identifies the room of the messages: different for each start of raylocd, and of the site by a
  // reload; null before the first message.
  get start() {
    return this.epoch === null ? null : `${this.epoch} ${this.heartbeat?.started ?? ''}`;
  }

  now() {
    return this.offset === null ? Date.now() : performance.now() + this.offset;
  }

  // The time without messages [ms], and whether it is so long that the state is out of date.
  get silence() {
    return this.heard === null ? 0 : performance.now() - this.heard;
  }

  get patience() {
    return Math.max(QUIET_MS, QUIET_BEATS * this.beatMs);
  }

  get quiet() {
    return this.silence > this.patience;
  }

  // The activity of an access point, as currently known from messages.
  status(id) {
    if (this.quiet) return 'not known';
    const source = this.sources.get(id);
    return source ? statusText(source.state.status) : 'no source';
  }

  snapshot(body) {
    const restarted = this.epoch !== null && body.epoch !== this.epoch;
    if (body.epoch !== this.epoch) {
      this.clear();
      this.epoch = body.epoch;
    }
    this.update(body);
    if (restarted) {
      this.event('raylocd was started again', Date.parse(body.now));
      this.restarted();
    }
  }

  update(body) {
    this.heard = performance.now();
    this.offset = Date.parse(body.now) - this.heard;
    for (const message of body.messages) {
      const sent = Date.parse(message.sent);
      if (message.location) this.location(message.location, sent);
      else if (message.compared) this.compared(message.compared, sent);
      else if (message.source) this.source(message.source, sent);
      else if (message.heartbeat) this.beat(message.heartbeat, sent);
      else if (message.track) this.event(trackText(message.track), sent);
      else if (message.zone) this.zone(message.zone, sent);
      else if (message.goodbye) this.event(`raylocd stops: ${message.goodbye.reason}`, sent);
    }
    this.forget();
  }

  beat(heartbeat, sent) {
    if (this.heartbeat && sent > this.heartbeat.sent) this.beatMs = sent - this.heartbeat.sent;
    if (this.heartbeat && heartbeat.started !== this.heartbeat.started) this.event('the site was prepared anew', sent);
    if (this.heartbeat) this.chains(this.heartbeat.chains || [], heartbeat.chains || [], sent);
    this.heartbeat = {...heartbeat, sent};
    if (heartbeat.playback) this.play(heartbeat.playback, sent);
  }

  // The state of receive chains has changed, as in heartbeat.proto.
  chains(before, now, sent) {
    for (const {access_point: id, knowledge} of now) {
      const known = before.find((one) => one.access_point === id)?.knowledge ?? 'CHAIN_KNOWLEDGE_AS_CALIBRATED';
      if (knowledge === known) continue;
      if (knowledge === 'CHAIN_KNOWLEDGE_LEARNING') this.event(`${id} was switched on anew: its phases are being learned`, sent);
      if (knowledge === 'CHAIN_KNOWLEDGE_LEARNED') this.event(`the phases of ${id} are learned`, sent);
    }
  }

  // playback: as in a heartbeat, valid at that time. One sent before a person's change is older
  // than the answer to it.
  play(playback, at) {
    if (this.playback && at < this.playback.at) return;
    const begin = Date.parse(playback.begin);
    this.playback = {
      at,
      begin,
      playing: playback.state === 'PLAYBACK_STATE_PLAYING',
      ended: playback.state === 'PLAYBACK_STATE_ENDED',
      speed: playback.speed,
      skipped: (playback.skipped || []).map((gap) => [gap.begin, gap.end].map((time) => (Date.parse(time) - begin) / 1000)),
    };
    this.playback.position = this.played((Date.parse(playback.position) - begin) / 1000);
    this.playback.length = this.played((Date.parse(playback.end) - begin) / 1000);
  }

  // [s] after the beginning of the recordings, without skipped periods; and back.
  played(recorded) {
    return this.playback.skipped.reduce((time, [from, to]) => time - Math.max(0, Math.min(recorded, to) - from), recorded);
  }

  recorded(played) {
    return this.playback.skipped.reduce((time, [from, to]) => (time < from ? time : time + to - from), played);
  }

  // A paused recording does not age.
  get held() {
    const {playback} = this;
    return playback && !playback.playing && !playback.ended ? this.latest : null;
  }

  // The name of the target with this key.
  nameOf(key) {
    return this.targets.get(key)?.name ?? key;
  }

  // The events up to that time, the latest first.
  eventsAt(time) {
    return this.events.filter(({sent}) => sent <= time);
  }

  // The reason why no target is shown. An empty room is reported each second, as an absent person.
  absence(isPresent = true) {
    if (!isPresent) return 'No target had been located by then.';
    const {nobody} = this;
    return nobody && this.now() - nobody.sent < FRESH_MS ? `No person is located: ${nobody.reason}.`
      : 'No target has been located yet.';
  }

  location(location, sent) {
    if (!location.position && isPerson(location.target)) {
      this.nobody = {reason: location.quality?.no_fix_reason || 'no reason is given', sent};
      return;
    }
    const key = keyOf(location.target);
    let target = this.targets.get(key);
    if (!target) {
      target = {key, name: targetName(location.target), colour: this.colours++ % 8, past: [], filtered: -Infinity, compared: new Map()};
      this.targets.set(key, target);
      if (this.now() - sent < FRESH_MS) this.told(`${target.name} appeared`);
    }
    target.last = sent;
    if (this.keep(target, location, sent)) this.latest = Math.max(this.latest ?? sent, sent);
  }

  // From a method compared with the site's own: its position for a target that the latter located.
  compared(location, sent) {
    const methods = this.targets.get(keyOf(location.target))?.compared;
    const method = location.quality?.method;
    if (!methods || !method) return;
    if (!methods.has(method)) methods.set(method, {past: [], filtered: -Infinity});
    this.keep(methods.get(method), location, sent);
  }

  // of: {past, filtered}. Returns false for a snapshot beside estimates of a tracker.
  keep(of, location, sent) {
    // A recording that is played slowly sends its position less often.
    const pace = Math.min(1, this.playback?.speed || 1);
    if (location.kind === 'LOCATION_KIND_FILTERED') of.filtered = Math.max(of.filtered, sent);
    else if (sent - of.filtered < PREFER_FILTERED_MS / pace) return false;
    const until = sent + (1000 * seconds(location.valid_for)) / pace;
    insert(of.past, {id: location.event_id, sent, until, location: drawn(location)});
    return true;
  }

  zone(event, sent) {
    this.event(zoneText(event), sent);
    if (!this.zones.has(event.zone)) this.zones.set(event.zone, []);
    const past = this.zones.get(event.zone);
    insert(past, {id: event.event_id, sent, inside: new Set((event.inside || []).map(keyOf))});
    if (past.length > ZONE_EVENTS) past.shift();
    this.latest = Math.max(this.latest ?? sent, sent);
  }

  // The people in each zone at that time, by its last event; a Map of Sets of keys of targets.
  inside(time) {
    return new Map([...this.zones].map(([name, past]) => [name, past[latest(past, time)]?.inside ?? new Set()]));
  }

  source(state, sent) {
    const before = this.sources.get(state.access_point);
    const {counters} = state;
    const frames = Number(counters.frames_complete) + Number(counters.frames_partial);
    const source = {state, sent, frames, rate: null};
    if (before) {
      const apart = (sent - before.sent) / 1000;
      source.rate = apart > 0.2 ? Math.max(0, frames - before.frames) / apart : before.rate;
      if (before.state.status !== state.status) {
        this.event(sourceText(state.access_point, before.state.status, state.status, state.detail), sent);
      }
    }
    this.sources.set(state.access_point, source);
  }

  event(text, sent) {
    if (this.events.some((one) => one.sent === sent && one.text === text)) return;
    this.events.push({text, sent});
    this.events.sort((a, b) => b.sent - a.sent);
    this.events.length = Math.min(this.events.length, EVENTS);
    if (this.now() - sent < FRESH_MS) this.told(text);
  }

  forget() {
    const now = this.held ?? this.now();
    for (const [key, target] of this.targets) {
      if (now - target.last > (isGone(target) ? FORGET_LOST_MS : FORGET_MS)) this.targets.delete(key);
    }
    const compared = [...this.targets.values()].flatMap((target) => [...target.compared.values()]);
    const share = Math.max(1, Math.floor(PAST / (this.targets.size + compared.length)));
    this.first = null;
    for (const {past} of [...this.targets.values(), ...compared]) {
      // The last one before is kept: it has the target's position when that time began.
      const old = Math.max(latest(past, now - PAST_MS), past.length - share);
      if (old > 0) past.splice(0, old);
      if (past.length > 0) this.first = Math.min(this.first ?? now, Math.max(past[0].sent, now - PAST_MS));
    }
  }

  // Each target in its state at that time: its latest estimate, whether that was stale, its trail,
  // its zones, and the latest estimate of each method that is compared.
  at(time) {
    const shown = [];
    const inside = [...this.inside(time)];
    for (const target of this.targets.values()) {
      const end = latest(target.past, time);
      if (end < 0) continue;
      const {location, sent} = target.past[end];
      const trail = [];
      let track;  // a snapshot between two estimates of the tracker has none
      for (let i = end; i >= 0 && target.past[i].sent > sent - TRAIL_MS; --i) {
        const {position, target: before} = target.past[i].location;
        if (track && before.track && before.track !== track) break;  // a new track, or a seek
        track ||= before.track;
        if (position) trail.push({...position, age: sent - target.past[i].sent});
      }
      const zones = inside.filter(([, keys]) => keys.has(target.key)).map(([name]) => name);
      shown.push({target, location, sent, stale: staleSince(target.past[end], time), trail, zones, compared: comparedAt(target, time)});
    }
    return shown;
  }
}

function comparedAt(target, time) {
  return [...target.compared].map(([method, {past}]) => [method, past[latest(past, time)]])
    .filter(([, entry]) => entry)
    .map(([method, entry]) => ({method, location: entry.location, stale: staleSince(entry, time)}));
}

const isLost = (location) => location.track_state === 'TRACK_STATE_LOST';

function isGone({past}) {
  const last = past.at(-1);
  return Boolean(last) && isPerson(last.location.target) && isLost(last.location);
}

// The displayed fields of an estimate: thousands are kept.
function drawn(location) {
  const {target, track_state, position, position_covariance, accuracy_m, accuracy_confidence, quality} = location;
  const {warnings, ambiguous, no_fix_reason} = quality || {};
  return {
    target, track_state, position, position_covariance, accuracy_m, accuracy_confidence,
    quality: {warnings, ambiguous, no_fix_reason},
    hypotheses: (location.hypotheses || []).slice(0, GHOSTS),
  };
}

function staleSince({location, sent, until}, time) {
  if (isLost(location)) return sent;
  return time > until + SLACK_MS ? until : null;
}

// In order of time: after a reconnection they may arrive out of order, or be repeated.
function insert(past, entry) {
  let at = past.length;
  while (at > 0 && past[at - 1].sent > entry.sent) --at;
  if (at === 0 || past[at - 1].id !== entry.id) past.splice(at, 0, entry);
}

function latest(past, time) {
  let low = 0;
  let high = past.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (past[middle].sent <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
