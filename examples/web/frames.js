// Contents of buffers between the moments and params at which `make` asked for them.

/// Pairs of a buffer's name and its words, for values of all axes and of the one that is whole numbers alone.
export function contents(frames, values) {
  const corners = corners_of(frames.axes, values);
  const { alone } = frames;
  const nearest = alone.values.reduce((best, value, i) =>
    Math.abs(value - values[alone.name]) < Math.abs(alone.values[best] - values[alone.name]) ? i : best, 0);
  return frames.buffers.map(({ name, base, changes, alone }) => {
    const words = Float32Array.from(base);
    const all = corners.map(({ index, weight }) => ({ change: changes[index], weight }));
    // Words that are never other than in the first frame are not listed.
    for (const place of new Set(all.flatMap(({ change }) => change.places))) {
      words[place] = all.reduce((sum, { change, weight }) => {
        const at = change.places.indexOf(place);
        return sum + weight * (at < 0 ? base[place] : change.words[at]);
      }, 0);
    }
    alone[nearest].places.forEach((place, i) => { words[place] = alone[nearest].words[i]; });
    return [name, words];
  });
}

/// The frames around values, each with its weight: linear along each axis.
function corners_of(axes, values) {
  let corners = [{ index: 0, weight: 1 }];
  for (const { name, values: places } of axes) {
    const value = Math.min(Math.max(values[name], places[0]), places.at(-1));
    let low = places.findLastIndex((place) => place <= value);
    low = Math.min(low, Math.max(places.length - 2, 0));
    const span = places.length > 1 ? places[low + 1] - places[low] : 1;
    const part = (value - places[low]) / span;
    corners = corners.flatMap(({ index, weight }) => [
      { index: index * places.length + low, weight: weight * (1 - part) },
      ...(part > 0 ? [{ index: index * places.length + low + 1, weight: weight * part }] : []),
    ]).filter(({ weight }) => weight > 0);
  }
  return corners;
}
