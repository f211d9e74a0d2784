// The sites of a raylocd that has several: each with its state, and a link to its map.
import {ask} from './ask.js';
import {byId, html, setText} from './draw.js';

const AGAIN_MS = 2000;
const rows = new Map();

function rowOf(site) {
  if (!rows.has(site.name)) {
    const cells = [0, 1, 2, 3].map(() => html('td'));
    const link = html('a', {href: site.path}, [site.name]);
    const row = html('tr', {'data-site': site.name}, [html('th', {scope: 'row'}, [link]), ...cells]);
    byId('site-rows').append(row);
    rows.set(site.name, {row, cells});
  }
  return rows.get(site.name);
}

function show(sites) {
  const names = new Set(sites.map((site) => site.name));
  for (const [name, {row}] of rows) {
    if (!names.has(name)) {
      row.remove();
      rows.delete(name);
    }
  }
  for (const site of sites) {
    const {cells} = rowOf(site);
    const why = [...site.reasons, ...site.warnings];
    setText(cells[0], (site.ready ? 'ready' : 'not ready') + (why.length > 0 ? `: ${why.join('; ')}` : ''));
    cells[0].className = site.ready ? (why.length > 0 ? 'warn' : 'good') : 'bad';
    setText(cells[1], `${site.sources_receiving} of ${site.sources}`);
    setText(cells[2], site.located ? String(site.tracks) : site.running ? 'nothing is located here' : '');
    setText(cells[3], String(site.fixes));
  }
}

async function look() {
  try {
    const sites = await ask('api/v1/sites');
    show(sites);
    setText(byId('state'), `${sites.filter((site) => site.ready).length} of ${sites.length} ready`);
  } catch (error) {
    setText(byId('state'), `Not known: ${error.message}. Trying again.`);
  }
  setTimeout(look, AGAIN_MS);
}

look();
