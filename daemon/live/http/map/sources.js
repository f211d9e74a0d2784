// The tables of access points and of events, and the daemon's messages about itself.
import {byId, clock, html, number, setText} from './draw.js';
import {seconds} from './words.js';

const rows = new Map();

function rowOf(id) {
  if (!rows.has(id)) {
    const cells = [0, 1, 2, 3, 4].map(() => html('td'));
    const row = html('tr', {'data-source': id}, [html('th', {scope: 'row'}, [id]), ...cells]);
    byId('source-rows').append(row);
    rows.set(id, {row, cells});
  }
  return rows.get(id);
}

// Datagrams and frames that were received or sent and are in no estimate, as in `rayloc top`
// (daemon/live/http/ROUTES.md). Datagrams rejected as no CSI and partial frames are counted separately.
const LOSSES = {kernel_drops: 'dropped by the kernel', ring_dropped: 'dropped here', late: 'late', frames_dropped: 'frames dropped'};

// "0", or "3 (late 2, frames dropped 1)".
function named(kinds) {
  const counts = Object.entries(kinds).map(([name, n]) => [name, Number(n)]).filter(([, n]) => n > 0);
  const sum = counts.reduce((total, [, n]) => total + n, 0);
  return sum === 0 ? '0' : `${sum} (${counts.map(([name, n]) => `${name.replaceAll('_', ' ')} ${n}`).join(', ')})`;
}

const lost = (counters) => named(Object.fromEntries(Object.entries(LOSSES).map(([key, name]) => [name, counters[key]])));

export function showSources(model, isPresent = true) {
  const {sources} = model;
  setText(byId('sources'), isPresent ? 'Access points' : 'Access points, now');
  for (const [id, {row}] of rows) {
    if (!sources.has(id)) {
      row.remove();
      rows.delete(id);
    }
  }
  for (const [id, source] of sources) {
    const {cells} = rowOf(id);
    const status = model.status(id);
    const silent = status === 'stalled' ? ` for ${number(seconds(source.state.age), 0)} s` : '';
    const why = source.state.detail && !model.quiet ? `: ${source.state.detail}` : '';
    setText(cells[0], (status === 'stalled' ? `silent${silent}` : status) + why);
    cells[0].className = status === 'receiving' ? 'good' : ['stalled', 'failed'].includes(status) ? 'bad' : 'warn';
    setText(cells[1], source.rate === null || model.quiet ? '' : number(source.rate, source.rate < 10 ? 1 : 0));
    const {counters} = source.state;
    setText(cells[2], String(counters.frames_partial));
    setText(cells[3], named(counters.rejected || {}));
    setText(cells[4], lost(counters));
  }
}

export function showDaemon(heartbeat) {
  if (!heartbeat) return;
  const warnings = [...(heartbeat.warnings || []), ...(heartbeat.calibration_warnings || [])];
  const list = byId('warnings');
  if (list.dataset.shown !== JSON.stringify(warnings)) {
    list.dataset.shown = JSON.stringify(warnings);
    list.replaceChildren(...warnings.map((text) => html('li', {}, [text])));
  }
  list.hidden = warnings.length === 0;
  const fixes = heartbeat.estimation ? heartbeat.estimation.fixes : 0;
  setText(byId('daemon'), `raylocd ${heartbeat.software_version}, ${fixes} fixes since ${clock(Date.parse(heartbeat.started))}`);
}

const items = new Map();  // items of the list, by event

// Only new items are written: existing ones are not read out again, and keep their selection.
export function showEvents(events) {
  const list = byId('event-rows');
  const kept = new Set(events);
  for (const [event, item] of items) {
    if (!kept.has(event)) {
      item.remove();
      items.delete(event);
    }
  }
  events.forEach((event, i) => {
    if (!items.has(event)) {
      items.set(event, html('li', {}, [html('span', {class: 'quiet'}, [`${clock(event.sent)} `]), event.text]));
    }
    const item = items.get(event);
    if (list.children[i] !== item) list.insertBefore(item, list.children[i] ?? null);
  });
}
