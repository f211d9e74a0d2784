// The fields of the selected object.
import {byId, html} from './draw.js';

// Keeps the focus for a person who moves from field to field.
function replace(element, children) {
  const {field} = element.contains(document.activeElement) ? document.activeElement.dataset : {};
  element.replaceChildren(...children);
  if (field) [...element.querySelectorAll('[data-field]')].find((one) => one.dataset.field === field)?.focus();
}

function field(name, value, put, more = {}) {
  const input = html('input', {type: typeof value === 'number' ? 'number' : 'text', step: 'any', 'data-field': name, ...more});
  input.value = value;
  input.addEventListener('change', () => {
    const now = typeof value === 'number' ? Number(input.value) : input.value.trim();
    if (typeof now === 'number' && (input.value === '' || !Number.isFinite(now))) input.value = value;
    else put(now);
  });
  return html('label', {}, [html('span', {}, [name]), input]);
}

function choice(name, values, value, put) {
  const select = html('select', {'data-field': name}, values.map((one) => html('option', {value: one}, [one])));
  select.value = value;
  select.addEventListener('change', () => put(select.value));
  return html('label', {}, [html('span', {}, [name]), select]);
}

// put(change): a step that changes the object.
function ofAccessPoint(one, put, state) {
  const models = ['as it is', ...state.presets.map((preset) => preset.model)];
  const axes = ['x [m]', 'y [m]', 'height [m]'];
  return [
    field('name', one.id, (id) => put((it) => { it.id = id; })),
    ...axes.map((axis, i) => field(axis, one.position[i], (v) => put((it) => { it.position[i] = v; }))),
    field('faces [°, from +x to +y]', one.degrees[0], (v) => put((it) => { it.degrees[0] = v; })),
    choice('antennas of', models, 'as it is', (model) => put((it) => {
      const preset = state.presets.find((each) => each.model === model);
      if (preset) it.antennas = structuredClone(preset.antennas);
    })),
    ...one.antennas.map((antenna, i) => field(`core of antenna ${i + 1} from the right`, antenna.core,
      (v) => put((it) => { it.antennas[i].core = v; }))),
  ];
}

function ofObject(one, put, state) {
  const names = [...new Set([one.material, ...state.materials.map((each) => each.name)])];
  const fields = [
    field('name', one.name, (name) => put((it) => { it.name = name; })),
    choice('material', names, one.material, (material) => put((it) => { it.material = material; })),
  ];
  if (!state.materials.some((each) => each.there && [one.material, `itu_${one.material}`].includes(each.name))) {
    fields.push(field('thickness of its faces [m]', one.thickness ?? 0.02, (v) => put((it) => { it.thickness = v; })));
  }
  if (one.form === 'box') {
    fields.push(...['width [m]', 'depth [m]', 'height [m]'].map((name, i) => field(name, one.size[i], (v) => put((it) => {
      if (i === 2) it.centre[2] += (v - it.size[2]) / 2;
      it.size[i] = v;
    }))));
    fields.push(field('rotated [°]', one.yaw_deg, (v) => put((it) => { it.yaw_deg = v; })));
  } else if (one.form === 'wall') {
    fields.push(field('height [m]', one.height, (v) => put((it) => { it.height = v; })));
  }
  return fields;
}

function ofZone(one, put) {
  return [field('name', one.name, (name) => put((it) => { it.name = name; }))];
}

export function showForm(draft, selected, state, said) {
  const form = byId('form');
  const one = selected && draft.content[selected.kind]?.[selected.at];
  const shown = one ? JSON.stringify([selected, one]) : '';
  if (form.dataset.shown === shown) return;
  form.dataset.shown = shown;
  byId('delete').disabled = !one;
  if (!one) {
    replace(form, [html('p', {class: 'quiet'}, [said])]);
    return;
  }
  const put = (change) => draft.change((content) => change(content[selected.kind][selected.at]));
  const make = {access_points: ofAccessPoint, zones: ofZone, objects: ofObject}[selected.kind];
  replace(form, make(one, put, state));
}

// Devices have names but no positions.
export function showDevices(draft) {
  const table = byId('device-rows');
  const shown = JSON.stringify(draft.content.devices);
  if (table.dataset.shown === shown) return;
  table.dataset.shown = shown;
  const rows = draft.content.devices.map((one, at) => html('tr', {}, [
    html('td', {}, [one.mac + (one.fixed ? ' (fixed)' : '')]),
    html('td', {}, [field(`name of ${one.mac}`, one.name, (name) => draft.change((content) => { content.devices[at].name = name; }))]),
  ]));
  replace(table, rows);
}
