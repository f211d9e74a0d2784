// A picture under the drawing: a person's floor plan as PNG. It stays in this page; no part of it
// is sent or written.
//
// place: {corner, pixel}: its lower left corner on the floor, and the length of a pixel [m].
import {byId, setText, svg} from './draw.js';

const USUAL = 0.5;  // initial opacity
const PDF = '%PDF';

// Scales it to the given `length` between two places of the floor; the first place is fixed.
export function scaled({corner, pixel}, [from, to], length) {
  const by = length / Math.hypot(to[0] - from[0], to[1] - from[1]);
  return {pixel: pixel * by, corner: corner.map((one, i) => from[i] + (one - from[i]) * by)};
}

// Moves the content at the first place to the second.
export const carried = ({corner, pixel}, [from, to]) => ({pixel, corner: corner.map((one, i) => one + to[i] - from[i])});

// Before a length is given: around the middle of the room, and within it.
export function fitted([width, height], {min, max}) {
  const pixel = Math.min((max[0] - min[0]) / width, (max[1] - min[1]) / height);
  return {pixel, corner: [width, height].map((one, i) => (min[i] + max[i] - one * pixel) / 2)};
}

export class Underlay {
  // editor: {bounds(), chooseTool(name), sketch(points), stirred(), say(text, kind)}
  constructor(editor) {
    this.editor = editor;
    this.picture = null;  // {url, size}
    this.between = null;  // two places of the floor whose distance is requested
    byId('underlay-file').addEventListener('change', ({target}) => {
      if (target.files[0]) this.take(target.files[0]);
      target.value = '';
    });
    byId('underlay-length').addEventListener('change', ({target}) => this.tell(Number(target.value)));
    byId('underlay-shown').addEventListener('input', () => editor.stirred());
    byId('underlay-scale').addEventListener('click', () => editor.chooseTool('measure'));
    byId('underlay-move').addEventListener('click', () => editor.chooseTool('carry'));
    byId('underlay-remove').addEventListener('click', () => this.remove());
  }

  async take(file) {
    const {say} = this.editor;
    if (await file.slice(0, PDF.length).text() === PDF) {
      say(`${file.name}: browsers give no picture of a PDF: export the page as PNG (pdftoppm -r 150 -png does), and take that`, 'bad');
      return;
    }
    const url = URL.createObjectURL(file);
    const image = new Image();
    image.src = url;
    const size = await image.decode().then(() => [image.naturalWidth, image.naturalHeight], () => [0, 0]);
    if (!(size[0] > 0 && size[1] > 0)) {
      URL.revokeObjectURL(url);
      say(`${file.name} is no picture that this browser reads: take a PNG or a JPEG`, 'bad');
      return;
    }
    this.remove();
    this.picture = {url, size};
    this.place = fitted(size, this.editor.bounds());
    byId('underlay-shown').value = USUAL;
    this.offer();
    this.editor.chooseTool('measure');
    say(`${file.name} lies under the drawing: click two places in it at a known distance`);
  }

  // Two places were clicked.
  measure(places) {
    if (!this.picture) return;
    this.between = places;
    this.editor.sketch(places);
    byId('underlay-length').value = '';
    this.offer();
    byId('underlay-length').focus();
    this.editor.say('How far is it between these places? Write the metres, and press Enter');
  }

  tell(length) {
    const {say} = this.editor;
    if (!this.between) return;
    if (!(length > 0) || this.between[0].every((one, i) => one === this.between[1][i])) {
      say('A scale needs two places that are apart, and a length of more than 0 m', 'bad');
      return;
    }
    this.place = scaled(this.place, this.between, length);
    this.between = null;
    this.editor.sketch([]);
    this.offer();
    say(`The picture is ${this.picture.size.map((one) => (one * this.place.pixel).toFixed(2)).join(' x ')} m. `
      + 'Now “Move the picture” to where it belongs', 'good');
  }

  carry(places) {
    if (!this.picture) return;
    this.place = carried(this.place, places);
    this.editor.stirred();
  }

  remove() {
    if (this.picture) URL.revokeObjectURL(this.picture.url);
    this.picture = this.between = null;
    this.editor.sketch([]);
    this.offer();
  }

  offer() {
    byId('underlay-fields').hidden = !this.picture;
    byId('underlay-length').disabled = !this.between;
    setText(byId('underlay-text'), this.picture
      ? 'It stays in this page alone: nothing of it is written.'
      : 'A floor plan as PNG or JPEG lies under the drawing, to be drawn over. First make a room as large as its outer walls.');
    this.editor.stirred();
  }

  // On the drawing, below all other shapes.
  show(matrix) {
    const group = byId('underlay-picture');
    byId('map').classList.toggle('over-picture', Boolean(this.picture));
    if (!this.picture) {
      group.replaceChildren();
      return;
    }
    const {url, size: [width, height]} = this.picture;
    const {corner: [x, y], pixel} = this.place;
    const image = group.firstElementChild ?? svg('image');
    for (const [key, value] of Object.entries({
      href: url, width, height, transform: `translate(${x} ${y + height * pixel}) scale(${pixel} ${-pixel})`})) {
      image.setAttribute(key, value);
    }
    group.setAttribute('transform', matrix);
    group.setAttribute('opacity', byId('underlay-shown').value);
    if (!group.firstElementChild) group.append(image);
  }
}
