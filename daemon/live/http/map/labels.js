// Names on the drawing that do not overlap: each takes the first of its places that is free.
const HIGH = 17;  // height of a line [pixels of a mark]

export const boxAbout = ([x, y], width, height) => ({left: x - width / 2, top: y - height / 2, right: x + width / 2, bottom: y + height / 2});

const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

const widths = new Map();  // widths of texts, by their kind and content

function widthOf(text) {
  const key = `${text.getAttribute('class')} ${text.textContent}`;
  if (!widths.has(key)) {
    const width = text.getComputedTextLength();
    if (!(width > 0)) return 8 * text.textContent.length;  // not drawn yet
    if (widths.size > 500) widths.clear();
    widths.set(key, width);
  }
  return widths.get(key);
}

export class Labels {
  constructor(view) {
    this.view = view;
    this.taken = [];
  }

  // size: {width, height} of the text, in pixels of the drawing.
  sizeOf(text, around = 3) {
    const {unit} = this.view;
    return {width: (widthOf(text) + 2 * around) * unit, height: HIGH * unit};
  }

  reserve(box) {
    this.taken.push(box);
  }

  // places: middles [pixels]. If none is free, the first is used, or none if `must` is false.
  place(text, places, must = true, around = 3) {
    const {width, height} = this.sizeOf(text, around);
    const boxes = places.map((at) => ({at, box: boxAbout(at, width, height)}));
    const inside = ({box}) => box.left >= 0 && box.top >= 0 && box.right <= this.view.width && box.bottom <= this.view.height;
    const free = ({box}) => !this.taken.some((other) => meet(box, other));
    const found = boxes.find((one) => inside(one) && free(one)) ?? (must ? boxes.find(inside) ?? boxes[0] : null);
    if (found) this.taken.push(found.box);
    return found?.at ?? null;
  }
}
