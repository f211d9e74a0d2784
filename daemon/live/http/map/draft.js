// The content of the editor: the draft that raylocd sent, with all changes, and undo.
const DEEPEST = 200;  // steps

export class Draft {
  constructor(content, changed) {
    this.content = content;
    this.saved = JSON.stringify(content);
    this.before = [];
    this.after = [];
    this.changed = changed;
  }

  get isChanged() {
    return JSON.stringify(this.content) !== this.saved;
  }

  // One step of a person; an edit without effect is not a step.
  change(edit) {
    const was = JSON.stringify(this.content);
    edit(this.content);
    this.note(was);
  }

  // `was`: the content before a step that consists of many small ones, such as a drag.
  note(was) {
    if (was === JSON.stringify(this.content)) return;
    this.before.push(was);
    if (this.before.length > DEEPEST) this.before.shift();
    this.after = [];
    this.changed();
  }

  undo() {
    this.step(this.before, this.after);
  }

  redo() {
    this.step(this.after, this.before);
  }

  step(from, to) {
    if (from.length === 0) return;
    to.push(JSON.stringify(this.content));
    this.content = JSON.parse(from.pop());
    this.changed();
  }
}

// "ap1", "ap2": the first unused name.
export function freeName(stem, taken) {
  for (let i = 1; ; i += 1) {
    if (!taken.includes(`${stem}${i}`)) return `${stem}${i}`;
  }
}

// Rounds drawn coordinates to the centimetre, the precision of people's measurements.
export const tidy = (value) => Math.round(value * 100) / 100 + 0;
