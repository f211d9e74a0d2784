// The editor of a site: draws the content of its files as read by raylocd or `rayloc studio`
// (api/v1/edit), changes it, and sends it back to be checked and written.
import {ask} from './ask.js';
import {Calibration} from './calibrate.js';
import {Draft, freeName, tidy} from './draft.js';
import {byId, html, setText} from './draw.js';
import {showDevices, showForm} from './edit_form.js';
import {Shapes} from './edit_shapes.js';
import {Tools} from './edit_tools.js';
import {Survey} from './survey.js';
import {offerThemes} from './theme.js';
import {Underlay} from './underlay.js';
import {View} from './view.js';

const PATIENCE_MS = 60_000;  // a scan is read and checked
const HINTS = {
  select: 'Click an object to change it; then drag it. Arrows move the plan, Delete removes the object, Ctrl+Z undoes.',
  place: 'Click where the access point is; then drag the dot to turn it.',
  zone: 'Drag a rectangle, or click corner by corner; Enter or the first corner closes it.',
  furniture: 'Drag from corner to corner.',
  wall: 'Drag from end to end.',
  measure: 'Click two places in the picture at a known distance; then write it at “how far they are apart”.',
  carry: 'Click a place in the picture, then where it belongs.',
  stand: 'Tap your place, and stay there until enough frames are counted.',
};

let state = null;
let stirred = true;
let ghost = [];
const view = new View(byId('map'), () => { stirred = true; });
const shapes = new Shapes(view);
const editor = {
  draft: null,
  selected: null,
  select(kind, at) {
    this.selected = kind === undefined || kind === 'corner' || kind === 'turn' ? null : {kind, at};
    stirred = true;
  },
  sketch(points) {
    ghost = points;
    stirred = true;
  },
  stirred() { stirred = true; },
  draw: (tool, points) => draw[tool](points),
};
const tools = new Tools(view, editor);
const survey = new Survey(view, say);
const underlay = new Underlay({
  bounds: () => state.bounds, chooseTool, say, sketch: (points) => editor.sketch(points), stirred: () => editor.stirred()});
const calibration = new Calibration(say, () => Boolean(editor.draft?.isChanged));

function say(text, kind = '') {
  setText(byId('said'), text);
  byId('said').className = kind;
}

function add(kind, one) {
  editor.draft.change((content) => content[kind].push(one));
  editor.select(kind, editor.draft.content[kind].length - 1);
  chooseTool('select');
}

const draw = {
  place([at]) {
    const {min, max} = state.bounds;
    const preset = state.presets.find((one) => one.model === byId('model').value);
    const to = [0, 1].map((i) => (min[i] + max[i]) / 2 - at[i]);
    add('access_points', {
      was: '', id: freeName('ap', editor.draft.content.access_points.map((one) => one.id)), model: preset.model,
      position: [...at, tidy(Math.min(min[2] + 2.2, max[2] - 0.3))],
      degrees: [Math.round((Math.atan2(to[1], to[0]) * 180) / Math.PI), 0, 0], antennas: structuredClone(preset.antennas)});
  },
  zone(polygon) {
    add('zones', {was: '', name: freeName('zone', editor.draft.content.zones.map((one) => one.name)), polygon});
  },
  furniture(corners) {
    const size = [0, 1].map((i) => tidy(Math.abs(corners[2][i] - corners[0][i])));
    const height = 0.75;
    add('objects', {
      was: '', name: freeName('furniture', editor.draft.content.objects.map((one) => one.name)), material: 'wood', thickness: 0.02, form: 'box',
      centre: [...[0, 1].map((i) => (corners[0][i] + corners[2][i]) / 2), state.bounds.min[2] + height / 2], size: [...size, height], yaw_deg: 0});
  },
  wall([from, to]) {
    const {min, max} = state.bounds;
    add('objects', {
      was: '', name: freeName('wall', editor.draft.content.objects.map((one) => one.name)), material: 'plasterboard', thickness: 0.0125,
      form: 'wall', from, to, bottom: min[2], height: tidy(max[2] - min[2])});
  },
  measure(places) {
    chooseTool('select');
    underlay.measure(places);
  },
  carry(places) {
    underlay.carry(places);
    chooseTool('select');
  },
  stand([at]) {
    survey.stand(at, Number(byId('survey-height').value));
    chooseTool('select');
  },
};

function chooseTool(name) {
  tools.choose(name);
  for (const button of document.querySelectorAll('[data-tool]')) {
    button.setAttribute('aria-pressed', String(button.dataset.tool === name));
  }
  setText(byId('tool-hint'), HINTS[name]);
}

function erase() {
  const {selected} = editor;
  if (!selected) return;
  editor.draft.change((content) => content[selected.kind].splice(selected.at, 1));
  editor.select();
}

// The content that was read replaces the whole drawing.
function take(told) {
  const first = !state || state.empty;
  state = told;
  byId('begin').hidden = !state.empty;
  byId('underlay').hidden = Boolean(state.empty);
  setText(byId('folder'), state.folder);
  byId('model').replaceChildren(...state.presets.map((one) => html('option', {title: one.remark}, [one.model])));
  byId('map').classList.toggle('planless', Boolean(state.empty));
  if (state.empty) return;
  setText(byId('site'), state.site);
  document.title = `${state.site}: RayLoc editor`;
  editor.draft = new Draft(state.draft, () => { stirred = true; });
  editor.select();
  shapes.remember(state.draft);
  if (first && state.bounds) view.show(state.bounds);
  showProblems(state.problems);
  stirred = true;
}

function showProblems(list) {
  const lines = list.length > 0 ? list : ['Nothing: raylocd can work with it.'];
  byId('problems').replaceChildren(...lines.flatMap((one) => one.split('\n')).map((one) => html('li', {}, [one])));
}

async function send(path, type, body) {
  return ask(path, {method: 'POST', headers: {'X-RayLoc-Control': '1', 'Content-Type': type}, body}, PATIENCE_MS);
}

async function read() {
  try {
    take(await ask('api/v1/edit', {}, PATIENCE_MS));
    say(state.empty ? 'Nothing is here yet' : 'As the files are');
  } catch (error) {
    say(`The site cannot be read: ${error.message}`, 'bad');
  }
}

// A rejected draft remains drawn.
async function save() {
  byId('save').disabled = true;
  say('Checking');
  try {
    const {said, warnings} = await send('api/v1/edit', 'application/json', JSON.stringify(editor.draft.content));
    take(await ask('api/v1/edit', {}, PATIENCE_MS));
    showProblems(warnings);
    say(said, 'good');
  } catch (error) {
    const [first, ...more] = error.message.split('\n');
    say(`Not saved: ${first}`, 'bad');
    showProblems([first, ...more]);
    stirred = true;
  }
}

async function begin(path, type, body) {
  say('Reading');
  try {
    const told = await send(path, type, body);
    take(told);
    say([`${state.site} is begun`, ...(told.said ?? [])].join('; '), 'good');
  } catch (error) {
    say(error.message, 'bad');
  }
}

const quoted = (text) => JSON.stringify(text);

function makeRoom() {
  const [x, y, z] = ['x', 'y', 'z'].map((axis) => Number(byId(`room-${axis}`).value));
  const plan = `name = ${quoted(byId('room-name').value)}\nsize = [${x}, ${y}, ${z}]\nfloor = "concrete"\n`
    + `ceiling = "ceiling_board"\nwalls = ${quoted(byId('room-walls').value)}\n`;
  return begin('api/v1/edit/room', 'application/json', JSON.stringify({plan}));
}

function show() {
  requestAnimationFrame(show);
  if (!stirred || !editor.draft) return;
  stirred = false;
  const {draft} = editor;
  shapes.show(state, draft.content, editor.selected, ghost);
  survey.place();
  underlay.show(view.matrix());
  byId('undo').disabled = draft.before.length === 0;
  byId('redo').disabled = draft.after.length === 0;
  byId('save').disabled = !draft.isChanged;
  showForm(draft, editor.selected, state, 'Nothing: click an access point, a zone, a wall or a piece of furniture.');
  showDevices(draft);
}

function press(event) {
  if (['INPUT', 'SELECT'].includes(event.target.tagName) || !editor.draft) return;
  const meta = event.ctrlKey || event.metaKey;
  if (meta && event.key === 'z') editor.draft.undo();
  else if (meta && (event.key === 'y' || event.key === 'Z')) editor.draft.redo();
  else if (event.key === 'Delete' || event.key === 'Backspace') erase();
  else if (event.key === 'Enter' && event.target.id === 'map') tools.close();
  else if (event.key === 'Escape') {
    chooseTool('select');
    editor.select();
  } else return;
  event.preventDefault();
}

for (const button of document.querySelectorAll('[data-tool]')) {
  button.addEventListener('click', () => chooseTool(button.dataset.tool));
}
byId('undo').addEventListener('click', () => editor.draft.undo());
byId('redo').addEventListener('click', () => editor.draft.redo());
byId('delete').addEventListener('click', erase);
byId('save').addEventListener('click', save);
byId('make-room').addEventListener('click', makeRoom);
// Statements on the file, for the options of `rayloc scene import` of the same names; --walls is given once for each layer.
const STATED = ['unit', 'scale', 'walls', 'height'];
const statedOfImport = () => STATED.flatMap((key) => {
  const {value} = byId(`import-${key}`);
  const values = key === 'walls' ? value.split(',') : [value];
  return values.map((one) => one.trim()).filter(Boolean).map((one) => [key, one]);
});
// A field whose content is no number has an empty value.
const invalidOfImport = () => STATED.map((key) => byId(`import-${key}`)).find((field) => !field.checkValidity());

byId('import').addEventListener('change', async ({target}) => {
  const [file] = target.files;
  const invalid = invalidOfImport();
  if (invalid) {
    say(`${invalid.previousElementSibling.textContent}: ${invalid.validationMessage}`, 'bad');
  } else if (file) {
    const query = new URLSearchParams([['name', file.name], ...statedOfImport()]);
    await begin(`api/v1/edit/import?${query}`, 'application/octet-stream', file);
  }
  target.value = '';
});
byId('add-device').addEventListener('click', () => {
  const mac = byId('device-mac').value.trim().toLowerCase();
  if (mac) editor.draft.change((content) => content.devices.push({was: '', mac, name: '', fixed: false}));
  byId('device-mac').value = '';
});
byId('zoom-in').addEventListener('click', () => view.zoom(1.25));
byId('zoom-out').addEventListener('click', () => view.zoom(0.8));
byId('fit').addEventListener('click', () => view.fit());
document.addEventListener('keydown', press);
addEventListener('beforeunload', (event) => {
  if (editor.draft?.isChanged) event.preventDefault();
});
offerThemes();
chooseTool('select');
await read();
survey.begin();
calibration.look();
requestAnimationFrame(show);
