// What a picture has on its canvas: maps, dots, lines, arrows, and the symbols along lines.

function drawField(context, panel) {
  const field = panel.data.field;
  const halfX = halfCell(field.first[0], field.last[0], field.columns);
  const halfY = halfCell(field.first[1], field.last[1], field.rows);
  const x0 = panel.x(field.first[0] - halfX), x1 = panel.x(field.last[0] + halfX);
  const y0 = panel.y(field.first[1] - halfY), y1 = panel.y(field.last[1] + halfY);
  context.save();
  context.imageSmoothingEnabled = false;
  context.translate(x0, y0);
  context.scale((x1 - x0) / field.columns, (y1 - y0) / field.rows);
  context.drawImage(panel.image, 0, 0);
  context.restore();
}

function drawCloud(context, picture, panel, cloud) {
  const points = cloud.points, radius = Math.max(0.7, cloud.size * markerRadius * picture.font * 0.8);
  const box = panel.box, x = panel.x, y = panel.y;
  context.fillStyle = cloud.levels ? "#000" : cloud.colour;
  for (let k = 0; k < points.length; k += 2) {
    const px = x(points[k]), py = y(points[k + 1]);
    if (!isInside(box, px, py, 3)) continue;
    if (cloud.levels) {
      const level = cloud.levels[k / 2];
      if (level === null) continue;
      context.fillStyle = picture.colours(level);
    }
    if (radius < 1.3) context.fillRect(px - radius, py - radius, 2 * radius, 2 * radius);
    else {
      context.beginPath();
      context.arc(px, py, radius, 0, 2 * Math.PI);
      context.fill();
    }
  }
}

function drawCurve(context, picture, panel, curve) {
  const points = curve.points, stroke = curve.stroke;
  const dashScale = curve.dashScale * picture.unit;
  context.strokeStyle = stroke.colour;
  context.lineWidth = Math.max(0.8, stroke.width * picture.unit);
  context.setLineDash(dashLengths[stroke.dash].map(function (length) { return length * dashScale; }));
  context.lineJoin = "round";
  context.beginPath();
  tracePieces(context, panel, points);
  context.stroke();
  context.setLineDash([]);
}

/** The lines from each point to the next; what is far outside the frame costs time and, with dashes, memory. */
function tracePieces(context, panel, points) {
  const box = panel.box, margin = 1000;
  const area = { left: box.left - margin, right: box.left + box.width + margin, top: box.top - margin,
                 bottom: box.top + box.height + margin };
  let x0 = NaN, y0 = NaN, endX = NaN, endY = NaN;
  for (let k = 0; k < points.length; k += 2) {
    const x1 = points[k] === null ? NaN : panel.x(points[k]), y1 = points[k] === null ? NaN : panel.y(points[k + 1]);
    const part = isFinite(x0 + y0 + x1 + y1) ? partInside(x0, y0, x1, y1, area) : null;
    if (part) {
      if (part[0] !== endX || part[1] !== endY) context.moveTo(part[0], part[1]);
      context.lineTo(part[2], part[3]);
      endX = part[2];
      endY = part[3];
    }
    x0 = x1;
    y0 = y1;
  }
}

function drawArrow(context, picture, panel, arrow) {
  const x0 = panel.x(arrow.points[0]), y0 = panel.y(arrow.points[1]);
  const x1 = panel.x(arrow.points[2]), y1 = panel.y(arrow.points[3]);
  const angle = Math.atan2(y1 - y0, x1 - x0), length = 0.6 * picture.font;
  context.fillStyle = arrow.colour;
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x1 - length * Math.cos(angle - 0.32), y1 - length * Math.sin(angle - 0.32));
  context.lineTo(x1 - length * Math.cos(angle + 0.32), y1 - length * Math.sin(angle + 0.32));
  context.fill();
}

function drawPlainSymbol(context, picture, panel, marker) {
  const look = marker.look;
  context.save();
  context.translate(panel.x(marker.x), panel.y(marker.y));
  const path = new Path2D(symbolPath(look, look.size * markerRadius * picture.font));
  context.fillStyle = isFilled(look) ? look.colour : "#fff";
  context.strokeStyle = look.colour;
  context.lineWidth = 1.5;
  context.fill(path);
  context.stroke(path);
  context.restore();
}

/** The part of a line that is inside an area, [x0, y0, x1, y1] (after Liang and Barsky); null when none is. */
function partInside(x0, y0, x1, y1, area) {
  const dx = x1 - x0, dy = y1 - y0;
  let from = 0, to = 1;
  const isOutside = [[-dx, x0 - area.left], [dx, area.right - x0], [-dy, y0 - area.top], [dy, area.bottom - y0]]
      .some(function (edge) {
        const speed = edge[0], room = edge[1];
        if (speed === 0) return room < 0;
        if (speed < 0) from = Math.max(from, room / speed);
        else to = Math.min(to, room / speed);
        return from > to;
      });
  if (isOutside) return null;
  return [from > 0 ? x0 + from * dx : x0, from > 0 ? y0 + from * dy : y0,
          to < 1 ? x0 + to * dx : x1, to < 1 ? y0 + to * dy : y1];
}

function halfCell(first, last, count) {
  return count > 1 ? (last - first) / (count - 1) / 2 : 0.5;
}

/** One pixel for each cell. */
function fieldImage(field, colours) {
  const image = document.createElement("canvas");
  image.width = field.columns;
  image.height = field.rows;
  const context = image.getContext("2d");
  const pixels = context.createImageData(field.columns, field.rows);
  field.cells.forEach(function (cell, k) {
    if (cell === null) return;
    const colour = d3.rgb(colours(cell));
    pixels.data.set([colour.r, colour.g, colour.b, 255], 4 * k);
  });
  context.putImageData(pixels, 0, 0);
  return image;
}
