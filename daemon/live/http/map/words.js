// Texts of events, for a reader without knowledge of tracks and sources.
export const seconds = (duration) => (duration ? parseFloat(duration) : 0);

export const isPerson = (target) => !target.mac && !target.hashed_mac;

export function targetName(target) {
  return target.name || target.mac || target.hashed_mac || `person ${target.track ?? ''}`.trim();
}

// "0.4 s", "4 s", "3 min", "2 h 5 min".
export function stayText(stay) {
  if (stay < 1) return `${Math.max(stay, 0.1).toFixed(1)} s`;
  if (stay < 89.5) return `${Math.round(stay)} s`;
  const all = Math.round(stay / 60);
  if (all < 90) return `${all} min`;
  return `${Math.floor(all / 60)} h${all % 60 ? ` ${all % 60} min` : ''}`;
}

const word = (name, prefix) => (name || '').replace(prefix, '').toLowerCase().replaceAll('_', ' ');

export const statusText = (status) => word(status, 'SOURCE_STATUS_');

const STATES = {tentative: 'just noticed', confirmed: 'located', coasting: 'silent', lost: 'gone'};
export const trackStateText = (state) => STATES[word(state, 'TRACK_STATE_')] ?? '';

export function trackText({target, state, reason}) {
  const name = targetName(target);
  const because = reason ? `: ${reason}` : '';
  return {
    tentative: `${name} is detected for the first time`,
    confirmed: `${name} is located`,
    coasting: `${name} is not detected at the moment`,
    lost: `${name} is gone${because}`,
  }[word(state, 'TRACK_STATE_')] ?? `${name}${because}`;
}

// The reason for counting as outside despite being located there is for the log.
const isUsual = (reason) => !reason || reason.startsWith('its probability was');

export function zoneText(event) {
  const name = targetName(event.target);
  const kind = word(event.kind, 'ZONE_EVENT_KIND_');
  const stay = event.dwell ? stayText(seconds(event.dwell)) : '';
  if (kind === 'dwelled') return `${name} has been in ${event.zone} for ${stay}`;
  const because = isUsual(event.reason) ? '' : `: ${event.reason}`;
  return `${name} ${kind} ${event.zone}${stay ? ` after ${stay}` : ''}${because}`;
}

// was, is: statuses of an access point.
export function sourceText(id, was, is, detail) {
  return {
    waiting: `nothing has come from ${id} yet`,
    receiving: statusText(was) === 'stalled' || statusText(was) === 'failed' ? `${id} sends again` : `${id} sends`,
    stalled: `${id} has fallen silent`,
    ended: `the recording of ${id} has come to its end`,
    failed: `${id} failed${detail ? `: ${detail}` : ''}`,
  }[statusText(is)] ?? `${id}: ${statusText(is)}`;
}
