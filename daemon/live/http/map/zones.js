// Neighbouring zones have different colours, and different dashes for readers who see no colours.
const KINDS = 4;  // map.css
const NEAR = 1;   // [m]

const boxOf = ({polygon}) => [Math.min, Math.max].map((pick) => [0, 1].map((i) => pick(...polygon.map((point) => point[i]))));

function near([aLow, aHigh], [bLow, bHigh]) {
  return [0, 1].every((i) => aLow[i] < bHigh[i] + NEAR && bLow[i] < aHigh[i] + NEAR);
}

// Assigns each the first kind that no earlier neighbour has: {zone, kind}.
export function colouredZones(zones) {
  const boxes = zones.map(boxOf);
  const kinds = [];
  zones.forEach((_, i) => {
    const taken = kinds.filter((_kind, other) => near(boxes[i], boxes[other]));
    const free = Array.from({length: KINDS}, (_kind, kind) => kind).find((kind) => !taken.includes(kind));
    kinds.push(free ?? i % KINDS);
  });
  return zones.map((zone, i) => ({zone, kind: `z${kinds[i]}`}));
}
