// Markers of special points and their labels, placed anew whenever the view changes.

function placeMarkers(picture, panel) {
  const box = panel.box, taken = [], shown = [];
  panel.markers.each(function (marker) {
    const x = panel.x(marker.x), y = panel.y(marker.y);
    const isShown = isInside(box, x, y, 1);
    const group = d3.select(this).style("display", isShown ? null : "none");
    if (!isShown) return;
    const radius = marker.look.size * markerRadius * picture.font;
    group.attr("transform", "translate(" + x + "," + y + ")");
    group.select(".symbol").attr("d", symbolPath(marker.look, radius)).attr("stroke-width", 1.5)
        .attr("fill", isFilled(marker.look) ? marker.look.colour : "#fff").attr("stroke", marker.look.colour);
    taken.push({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius, of: marker });
    shown.push({ marker: marker, x: x, y: y, radius: radius, text: group.select("text"),
                 leader: group.select(".leader") });
  });
  const labels = [];
  shown.forEach(function (item) { placeLabel(picture, panel, item, taken, labels); });
}

/** Where the picture on paper has the label, else at a free place around the marker; nowhere if there is none. */
function placeLabel(picture, panel, item, taken, labels) {
  if (item.text.empty()) return;
  const size = sizeOfLabel(item), name = plainLabel(item.marker.label);
  const isRepeated = labels.some(function (label) {
    const isNear = Math.abs(label.x - item.x) < 1.2 * size.width && Math.abs(label.y - item.y) < 1.2 * size.height;
    return label.name === name && isNear;
  });
  const best = isRepeated ? null : freePlace(picture, panel, item, size, taken);
  item.text.style("display", best ? null : "none");
  showLeader(item, best);
  if (!best) return;
  taken.push(best.area);
  item.text.attr("x", best.place[0]).attr("y", best.place[1] + 0.35 * labelFont);
  labels.push({ name: name, x: item.x, y: item.y });
}

/** A thin line from the marker to a label that is not beside it. */
function showLeader(item, best) {
  const nearest = function (low, high) { return Math.max(low, Math.min(high, 0)); };
  const x = best ? nearest(best.area.left - item.x, best.area.right - item.x) : 0;
  const y = best ? nearest(best.area.top - item.y, best.area.bottom - item.y) : 0;
  const isFar = Math.sqrt(x * x + y * y) > item.radius + 12;
  item.leader.style("display", isFar ? null : "none").attr("x2", x).attr("y2", y);
}

/** Measured once: the browser takes long for it. */
function sizeOfLabel(item) {
  if (!item.marker.size) {
    const box = item.text.style("display", null).node().getBBox();
    item.marker.size = { width: box.width, height: box.height };
  }
  return item.marker.size;
}

/** {place, area} of a label inside the frame, among the first places and clear of others; null when there is none. */
function freePlace(picture, panel, item, size, taken) {
  let best = null;
  candidates(picture, item, size.width, size.height).forEach(function (place, k) {
    const x = item.x + place[0], y = item.y + place[1], halfHeight = size.height / 2 - 3;
    const area = { left: x - size.width / 2, right: x + size.width / 2, top: y - halfHeight, bottom: y + halfHeight };
    if (!isInside(panel.box, area.left, area.top, -2) || !isInside(panel.box, area.right, area.bottom, -2)) return;
    const room = clearance(area, taken, item.marker);
    const cost = k - Math.min(room, 12);
    if (room > 0 && (!best || cost < best.cost)) best = { place: place, area: area, cost: cost };
  });
  return best;
}

/** The distance from a label to what is nearest of the others; 0 when it covers something. */
function clearance(area, taken, own) {
  return taken.reduce(function (least, other) {
    const dx = Math.max(0, other.left - area.right, area.left - other.right);
    const dy = Math.max(0, other.top - area.bottom, area.top - other.bottom);
    const isTouched = dx === 0 && dy === 0;
    return other.of === own && !isTouched ? least : Math.min(least, Math.sqrt(dx * dx + dy * dy));
  }, Infinity);
}

function candidates(picture, item, width, height) {
  const dx = item.radius + 4 + width / 2, dy = item.radius + 1 + height / 2;
  const around = [[dx, -0.6 * dy], [-dx, -0.6 * dy], [0, -dy], [0, dy], [dx, 0.6 * dy], [-dx, 0.6 * dy], [dx, 0],
                  [-dx, 0], [dx, -1.6 * dy], [-dx, -1.6 * dy], [dx, 1.6 * dy], [-dx, 1.6 * dy]];
  if (!item.marker.offset) return around;
  const size = Math.max(picture.font, labelFont / labelFontRatio);
  return [[item.marker.offset[0] * size, -item.marker.offset[1] * size]].concat(around);
}
