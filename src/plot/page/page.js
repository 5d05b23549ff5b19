// The page: pictures, the point that is chosen, keys.

const data = JSON.parse(document.getElementById("data").textContent);
const details = document.getElementById("details");
const tip = document.getElementById("tip");
const keys = document.getElementById("keys");
const help = document.getElementById("help");
const pictures = [];
let current = null;  // {picture, panel, point} that is open

function placeOf(panel, point) {
  const computed = panel.data.computed;
  return { branch: computed.branch[point], section: computed.section[point], row: computed.row[point] };
}

function describeMarker(panel, marker) {
  const facts = factsOf(data, placeOf(panel, marker.point));
  return facts.title + ", " + facts.section.columns[0] + " = " + shortNumber(facts.section.values[0][facts.row], 8);
}

// Values under the pointer --------------------------------------------------------------------------------------------

function showTip(panel, found, x, y) {
  tip.textContent = "";
  tip.appendChild(tipContent(panel, found));
  tip.hidden = false;
  const box = tip.getBoundingClientRect();
  const isRight = x + 18 + box.width < window.innerWidth;
  tip.style.left = Math.max(2, isRight ? x + 18 : x - 12 - box.width) + "px";
  tip.style.top = Math.max(2, Math.min(y + 14, window.innerHeight - box.height - 4)) + "px";
}

function hideTip() {
  tip.hidden = true;
}

function tipContent(panel, found) {
  const host = element("div");
  if (found.point === undefined) {
    host.appendChild(valueTable(rowsOfPlace(panel, found)));
    return host;
  }
  const place = placeOf(panel, found.point), facts = factsOf(data, place);
  if (data.branches.length > 1) host.appendChild(element("div", "", facts.branch.name));
  if (facts.label && facts.label.type) {
    const meaning = facts.label.type ? facts.label.meaning : "";
    const strong = host.appendChild(element("strong", "", facts.title));
    strong.className = "tip-title";
    if (meaning) host.appendChild(element("div", "", meaning.split(/[:;]/)[0]));
  }
  const rows = [[panel.data.x.label, fullNumber(panel.data.computed.x[found.point])],
                [panel.data.y.label, fullNumber(panel.data.computed.y[found.point])],
                ["point", String(facts.section.point[facts.row])]];
  if (wordsOfStability(facts)) rows.push(["stability", wordsOfStability(facts)]);
  host.appendChild(valueTable(rows));
  return host;
}

/** Of a dot, a point of a curve, or a cell. */
function rowsOfPlace(panel, found) {
  const figure = pictures.length ? pictureOf(panel).figure : data.figures[0];
  const rows = [[panel.data.x.label, fullNumber(found.x)], [panel.data.y.label, fullNumber(found.y)]];
  if (found.level === undefined || found.level === null) {
    const name = found.colour && nameOfColour(figure, found.colour);
    if (name) rows.push(["of", name]);
    return rows;
  }
  const colour = figure.palette ? d3.rgb(paletteColour(figure.palette)(found.level)).toString() : "";
  const name = nameOfColour(figure, colour);
  if (name) rows.push(["colour", name]);
  else rows.push([figure.palette.label.t ? figure.palette.label : "value", fullNumber(found.level)]);
  return rows;
}

/** What a colour means by the key; "" when it is not in it. */
function nameOfColour(figure, colour) {
  const entry = figure.key.find(function (one) { return one.marker && one.marker.colour === colour; });
  return entry ? plainLabel(entry.text) : "";
}

function pictureOf(panel) {
  return pictures.find(function (picture) { return picture.panels.indexOf(panel) >= 0; });
}

// The chosen point ----------------------------------------------------------------------------------------------------

function openPoint(picture, panel, point) {
  hideTip();
  pictures.forEach(function (other) { if (other !== picture) other.choose(null); });
  picture.choose(panel, point);
  current = { picture: picture, panel: panel, point: point };
  const hadFocus = details.contains(document.activeElement);
  const facts = showPoint(data, details, placeOf(panel, point), closePoint);
  if (hadFocus) details.focus({ preventScroll: true });
  details.scrollTop = 0;
  document.getElementById("spoken").textContent = [facts.title, wordsOfStability(facts)].filter(Boolean).join(", ");
  if (isStacked()) details.scrollIntoView({ block: "start" });
}

/** The values of a dot or a curve, kept beside the diagram. */
function pinPlace(picture, panel, found) {
  hideTip();
  current = null;
  pictures.forEach(function (other) { other.choose(null); });
  details.textContent = "";
  const top = details.appendChild(element("div", "top"));
  top.appendChild(element("h2", "", "Values"));
  top.appendChild(button("Close", closePoint));
  details.appendChild(valueTable(rowsOfPlace(panel, found), "values point-values"));
  if (found.origin) showSweepRow(data.sweeps[found.origin.sweep], details, found.origin.row);
  document.getElementById("spoken").textContent = "Values of the chosen place";
  if (isStacked()) details.scrollIntoView({ block: "start" });
}

function closePoint() {
  const before = current;
  current = null;
  pictures.forEach(function (picture) { picture.choose(null); });
  showOverview(data, details, openPlace, labelledPlaces());
  if (before) before.picture.plot.focus({ preventScroll: !isStacked() });
}

function isStacked() {
  return window.matchMedia("(max-width: 900px)").matches;
}

/** All markers of labels, in the order of the pictures. */
function markedPoints() {
  const marked = [];
  pictures.forEach(function (picture) {
    picture.panels.forEach(function (panel) {
      const rows = {};
      panel.data.markers.forEach(function (marker) {
        if (marker.point === null) return;
        const place = placeOf(panel, marker.point), key = place.branch + " " + place.section + " " + place.row;
        if (!rows[key]) marked.push({ picture: picture, panel: panel, point: marker.point, place: place });
        rows[key] = true;
      });
    });
  });
  return marked;
}

/** Each once, though several panels may mark it. */
function labelledPlaces() {
  const places = markedPoints().map(function (marked) { return marked.place; });
  return places.filter(function (place, k) {
    return places.findIndex(function (other) { return samePlace(place, other); }) === k;
  });
}

function openPlace(place) {
  const found = markedPoints().find(function (marked) { return samePlace(marked.place, place); });
  openPoint(found.picture, found.panel, found.point);
  document.querySelector("#details h2").scrollIntoView({ block: "nearest" });
}

// Keys ----------------------------------------------------------------------------------------------------------------

function stepLabel(by) {
  const marked = markedPoints();
  if (!marked.length) return;
  const at = marked.findIndex(function (one) {
    return current && one.panel === current.panel && samePlace(one.place, placeOf(current.panel, current.point));
  });
  const next = at >= 0 ? at + by : nextFromPoint(marked, by);
  const chosen = marked[(next + marked.length) % marked.length];
  openPoint(chosen.picture, chosen.panel, chosen.point);
}

/** From a point without label to the marked one behind it, or before it. */
function nextFromPoint(marked, by) {
  if (!current) return by > 0 ? 0 : -1;
  const behind = marked.findIndex(function (one) { return one.panel === current.panel && one.point > current.point; });
  const first = behind < 0 ? marked.length : behind;
  return by > 0 ? first : first - 1;
}

function samePlace(a, b) {
  return a.branch === b.branch && a.section === b.section && a.row === b.row;
}

function stepPoint(by) {
  const picture = current ? current.picture : pictures[0], panel = current ? current.panel : picture.panels[0];
  const count = panel.data.computed.x.length;
  if (!count) return;
  const next = current ? current.point + by : 0;
  openPoint(picture, panel, Math.max(0, Math.min(count - 1, next)));
}

function activePicture() {
  const focused = pictures.find(function (picture) { return picture.plot.contains(document.activeElement); });
  return focused || (current ? current.picture : pictures[0]);
}

function toggleKeys(isShown) {
  keys.hidden = !isShown;
  help.setAttribute("aria-expanded", String(isShown));
  resizeAll();
}

function escape() {
  if (!keys.hidden) toggleKeys(false);
  else if (current || !details.querySelector(".labels")) closePoint();
}

const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

const keyActions = {
  "+": function () { activePicture().zoomBy(1.5); },
  "=": function () { activePicture().zoomBy(1.5); },
  "-": function () { activePicture().zoomBy(1 / 1.5); },
  "0": function () { activePicture().reset(); },
  Home: function () { activePicture().reset(); },
  "?": function () { toggleKeys(keys.hidden); },
  Escape: escape,
  ArrowRight: function () { stepLabel(1); },
  ArrowLeft: function () { stepLabel(-1); },
  ArrowUp: function () { stepPoint(1); },
  ArrowDown: function () { stepPoint(-1); }
};

function pressKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const isChoice = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName);
  if (isChoice && event.key !== "Escape" && event.key !== "?") return;
  const arrow = event.shiftKey && arrows[event.key];
  const move = function () { activePicture().moveBy(0.15 * arrow[0], 0.15 * arrow[1]); };
  const action = arrow ? move : keyActions[event.key];
  if (!action || (details.contains(event.target) && /^(Arrow(Up|Down)|Home)$/.test(event.key))) return;
  event.preventDefault();
  action();
}

// Start ---------------------------------------------------------------------------------------------------------------

function resizeAll() {
  pictures.forEach(function (picture) { picture.resize(); });
}

function start() {
  appendTitle();
  const host = document.getElementById("pictures");
  data.figures.forEach(function (figure) {
    const place = host.appendChild(element("figure"));
    place.style.margin = "0";
    pictures.push(makePicture(figure, place, {
      open: openPoint, pin: pinPlace, tip: showTip, hideTip: hideTip, describe: describeMarker
    }));
  });
  document.querySelector("main").classList.toggle("alone", !data.branches.length && !data.sweeps.length);
  resizeAll();
  showOverview(data, details, openPlace, labelledPlaces());
  document.getElementById("zoom-in").addEventListener("click", keyActions["+"]);
  document.getElementById("zoom-out").addEventListener("click", keyActions["-"]);
  document.getElementById("reset").addEventListener("click", keyActions["0"]);
  help.addEventListener("click", keyActions["?"]);
  document.addEventListener("keydown", pressKey);
  window.addEventListener("resize", resizeAll);
  if (document.fonts && document.fonts.ready) document.fonts.ready.then(resizeAll);
  window.tchat = { pictures: pictures };  // for tests, and for whoever looks at the numbers in the console
  requestAnimationFrame(function () {  // of the next frame: what has been drawn is on the screen behind it
    setTimeout(function () { document.documentElement.dataset.drawn = performance.now().toFixed(1); }, 0);
  });
}

function appendTitle() {
  const title = document.getElementById("title");
  const names = data.branches.map(function (branch) { return branch.name; });
  const isNamed = data.title.t || data.figures.some(function (figure) { return figure.title.t; }) || names.length < 2;
  appendLabel(title, data.title.t ? data.title : { t: isNamed ? document.title : names.join(", ") });
}

start();
