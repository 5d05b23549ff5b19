// What is nearest to the pointer.

const reach = 30;  // pixels from the pointer to what it means

/** Of a place in pixels: {point} of a branch, {x, y} of a dot, a curve or a cell; null when nothing is near. */
function nearest(panel, at) {
  const data = panel.data, hasBranch = data.computed.x.length > 0;
  const search = { best: reach * reach, owner: null, k: 0 };
  const look = function (x, y, owner, k) {
    if (x === null || y === null) return;
    const dx = panel.x(x) - at[0], dy = panel.y(y) - at[1], distance = dx * dx + dy * dy;
    if (!(distance < search.best)) return;
    search.best = distance;
    search.owner = owner;
    search.k = k;
  };
  const lookAlong = function (owner) {
    for (let k = 0; k < owner.points.length / 2; ++k) look(owner.points[2 * k], owner.points[2 * k + 1], owner, k);
  };
  data.computed.x.forEach(function (x, k) { look(x, data.computed.y[k], data.computed, k); });
  data.clouds.forEach(lookAlong);
  if (!hasBranch) {
    data.curves.filter(function (curve) { return !curve.background; }).forEach(lookAlong);
    data.markers.forEach(function (marker) { look(marker.x, marker.y, { points: [marker.x, marker.y] }, 0); });
  }
  if (search.owner) return search.owner === data.computed ? { point: search.k } : placeIn(search.owner, search.k);
  return data.field ? cellAt(panel, at) : null;
}

/** Point k of a cloud, a curve or a marker. */
function placeIn(owner, k) {
  return { x: owner.points[2 * k], y: owner.points[2 * k + 1], colour: owner.levels === null ? owner.colour : "",
           level: owner.levels ? owner.levels[k] : null, origin: originOf(owner.from, k) };
}

function cellAt(panel, at) {
  const field = panel.data.field;
  const place = function (value, first, last, count) {
    return count > 1 ? Math.round((value - first) / (last - first) * (count - 1)) : 0;
  };
  const i = place(panel.x.invert(at[0]), field.first[0], field.last[0], field.columns);
  const j = place(panel.y.invert(at[1]), field.first[1], field.last[1], field.rows);
  if (i < 0 || j < 0 || i >= field.columns || j >= field.rows) return null;
  const centre = function (k, first, last, count) {
    return count > 1 ? first + (last - first) * k / (count - 1) : first;
  };
  return { x: rounded(centre(i, field.first[0], field.last[0], field.columns)),
           y: rounded(centre(j, field.first[1], field.last[1], field.rows)),
           level: field.cells[j * field.columns + i], origin: originOf(field.from, j * field.columns + i) };
}

/** The row of a sweep that a dot or a cell is from; null for what is from elsewhere. */
function originOf(from, k) {
  return from && from.rows[k] !== null ? { sweep: from.sweep, row: from.rows[k] } : null;
}

function rounded(value) {
  return Number(value.toPrecision(12));
}
