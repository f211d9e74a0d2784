// A picture under the drawing: a person's floor plan as PNG, or a page of a PDF, which the server
// converts. The picture stays in this page and is not written.
//
// place: {corner, pixel}: its lower left corner on the floor, and the length of a pixel [m].
import {byId, setText, svg} from './draw.js';
import {isPdf, pageOf} from './pdf_page.js';

const USUAL = 0.5;  // initial opacity

// Scales it to the given `length` between two places of the floor; the first place is fixed.
export function scaled({corner, pixel}, [from, to], length) {
  const by = length / Math.hypot(to[0] - from[0], to[1] - from[1]);
  return {pixel: pixel * by, corner: corner.map((one, i) => from[i] + (one - from[i]) * by)};
}

// Scales a picture of `size` about its middle, to pixels of the given length [m].
export function resized({corner, pixel}, size, length) {
  return {pixel: length, corner: corner.map((one, i) => one + (size[i] * (pixel - length)) / 2)};
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
    this.picture = null;  // {url, size}; of a PDF also {file, page, pages, millimetres}
    this.between = null;  // two places of the floor whose distance is requested
    this.wanted = null;   // the file that is being read
    byId('underlay-file').addEventListener('change', ({target}) => {
      if (target.files[0]) this.take(target.files[0]);
      target.value = '';
    });
    byId('underlay-page').addEventListener('change', ({target}) => this.take(this.picture.file, target.value));
    byId('underlay-drawn').addEventListener('change', ({target}) => this.draw(Number(target.value)));
    byId('underlay-length').addEventListener('change', ({target}) => this.tell(Number(target.value)));
    byId('underlay-shown').addEventListener('input', () => editor.stirred());
    byId('underlay-scale').addEventListener('click', () => editor.chooseTool('measure'));
    byId('underlay-move').addEventListener('click', () => editor.chooseTool('carry'));
    byId('underlay-remove').addEventListener('click', () => {
      this.wanted = null;
      this.remove();
    });
  }

  // `page`: of a PDF.
  async take(file, page = 1) {
    const {say} = this.editor;
    const wanted = {};
    const isWanted = () => this.wanted === wanted;
    this.wanted = wanted;
    try {
      if (!await isPdf(file)) {
        await this.lay(file, {name: file.name}, isWanted);
        return;
      }
      say(`Reading page ${page} of ${file.name}`);
      const read = await pageOf(file, page, isWanted);
      if (!read) return;
      const {blob, ...about} = read;
      await this.lay(blob, {name: file.name, file, ...about}, isWanted);
    } catch (error) {
      if (isWanted()) {
        say(`${file.name}: ${error.message}`, 'bad');
        this.offer();  // the page that is shown
      }
    }
  }

  // `about`: the properties of the picture besides its content.
  async lay(content, about, isWanted) {
    const url = URL.createObjectURL(content);
    const image = new Image();
    image.src = url;
    const size = await image.decode().then(() => [image.naturalWidth, image.naturalHeight], () => [0, 0]);
    if (!isWanted() || !(size[0] > 0 && size[1] > 0)) {
      URL.revokeObjectURL(url);
      if (isWanted()) throw new Error('it is no picture that this browser reads: take a PNG or a JPEG');
      return;
    }
    const old = this.picture;
    const isSameSheet = old?.file && old.file === about.file && old.size.join() === size.join() && old.millimetres === about.millimetres;
    this.remove();
    this.picture = {url, size, ...about};
    if (!isSameSheet) {  // else another page of it lies in the same place
      this.place = fitted(size, this.editor.bounds());
      byId('underlay-drawn').value = '';
      byId('underlay-shown').value = USUAL;
    }
    this.offer();
    this.editor.chooseTool(isSameSheet ? 'select' : 'measure');
    const sheet = about.pages > 1 ? `${about.name}, page ${about.page} of ${about.pages},` : about.name;
    const next = isSameSheet ? '' : `: ${about.file ? 'write its scale, or ' : ''}click two places in it at a known distance`;
    this.editor.say(`${sheet} lies under the drawing${next}${about.remark ? ` (${about.remark})` : ''}`);
  }

  // A scale of the paper, 1 to `scale`.
  draw(scale) {
    const {picture} = this;
    if (!(scale > 0)) {
      this.editor.say('A scale is 1 to a number of more than 0', 'bad');
      return;
    }
    this.place = resized(this.place, picture.size, (picture.millimetres / 1000) * scale);
    this.between = null;
    this.editor.sketch([]);
    this.offer();
    this.editor.chooseTool('select');
    this.report(`At 1:${scale} the picture is`, '; “Two places” check a known distance');
  }

  report(begin, end = '') {
    const sides = this.picture.size.map((one) => (one * this.place.pixel).toFixed(2)).join(' x ');
    this.editor.say(`${begin} ${sides} m. Now “Move the picture” to where it belongs${end}`, 'good');
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
    byId('underlay-drawn').value = '';
    this.report('The picture is');
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
    const {page, pages, millimetres} = this.picture ?? {};
    byId('underlay-fields').hidden = !this.picture;
    byId('underlay-page-field').hidden = !(pages > 1);
    byId('underlay-page').max = pages ?? 1;
    byId('underlay-page').value = page ?? 1;
    byId('underlay-drawn-field').hidden = !millimetres;
    byId('underlay-length').disabled = !this.between;
    setText(byId('underlay-text'), this.picture
      ? 'It stays in this page: nothing of it is written.'
      : 'A floor plan as PNG, JPEG or PDF lies under the drawing, to be drawn over. First make a room as large as its outer walls.');
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
