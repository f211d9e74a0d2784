// The tables of access points and of events, and what the daemon says of itself.
import {byId, clock, html, number, setText} from './draw.js';
import {seconds} from './model.js';

const rows = new Map();

function rowOf(id) {
  if (!rows.has(id)) {
    const cells = [0, 1, 2].map(() => html('td'));
    const row = html('tr', {'data-source': id}, [html('th', {scope: 'row'}, [id]), ...cells]);
    byId('source-rows').append(row);
    rows.set(id, {row, cells});
  }
  return rows.get(id);
}

function losses({state, lost}) {
  if (lost === 0) return '0';
  const {counters} = state;
  const kinds = {...counters.rejected, 'dropped by the kernel': counters.kernel_drops, 'dropped here': counters.ring_dropped,
    late: counters.late, 'frames dropped': counters.frames_dropped};
  const named = Object.entries(kinds).filter(([, n]) => Number(n) > 0).map(([name, n]) => `${name.replaceAll('_', ' ')} ${n}`);
  return `${lost} (${named.join(', ')})`;
}

export function showSources(model) {
  const {sources} = model;
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
    setText(cells[2], losses(source));
  }
}

export function showDaemon(heartbeat) {
  if (!heartbeat) return;
  const warnings = heartbeat.calibration_warnings || [];
  const list = byId('warnings');
  if (list.dataset.shown !== JSON.stringify(warnings)) {
    list.dataset.shown = JSON.stringify(warnings);
    list.replaceChildren(...warnings.map((text) => html('li', {}, [text])));
  }
  list.hidden = warnings.length === 0;
  const fixes = heartbeat.estimation ? heartbeat.estimation.fixes : 0;
  setText(byId('daemon'), `raylocd ${heartbeat.software_version}, ${fixes} fixes since ${clock(Date.parse(heartbeat.started))}`);
}

const items = new Map();  // of the list, by event

// Only what is new is written: what stands there is not read again, and keeps its selection.
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
