// The controls of the page, its legend, and the values at a picked point.

const digits = (x, unit) => { // enough digits to resolve steps of `unit`
    const places = Math.max(0, Math.min(12, -Math.floor(Math.log10(unit || 1))));
    return Math.abs(x) >= 1e7 || unit >= 1e6 || unit < 1e-9 ? x.toPrecision(7) : x.toFixed(places);
};
const rounded = (x, digits) => String(Number(x.toPrecision(digits)));
const number = (x) => rounded(x, 6);

class Page {
    constructor(scene, drawing) {
        this.scene = scene;
        this.drawing = drawing;
        this.canvas = drawing.canvas;
        this.setUpControls();
        this.setUpKeys();
        this.setUpPointer();
        this.showMap(scene.map);
        this.showSpacing();
        this.showFront();
    }

    // ---- controls ----

    setUpControls() {
        const scene = this.scene, on = (id, event, act) => byId(id).addEventListener(event, act);
        this.spacings = niceSpacings(scene);
        byId("spacing").max = this.spacings.length - 1;
        byId("spacing").value = Math.max(0, this.spacings.indexOf(scene.spacing));
        for (const name of Object.keys(scene.maps)) byId("map").add(new Option(name, name, false, name === scene.map));
        byId("colorBy").options[0].text = scene.quantity;
        byId("cellsRow").hidden = scene.labelNames.length < 2;
        byId("growth").hidden = !scene.grows;
        byId("controls").hidden = false;
        for (const id of ["spacing", "front", "play", "map"]) byId(id).disabled = !scene.any;
        on("spacing", "input", () => this.showSpacing());
        on("front", "input", () => { this.stop(); this.showFront(); });
        on("play", "click", () => (this.playing ? this.stop() : this.play()));
        on("map", "change", () => this.showMap(byId("map").value));
        on("shade", "change", () => { this.set("shade", byId("shade").checked ? 1 : 0); });
        on("colorBy", "change", () => this.showLegend());
        on("reset", "click", () => this.drawing.firstView());
        on("copy", "click", () => copy(byId("seed")));
    }

    set(uniform, value) {
        this.drawing.uniforms[uniform].value = value;
        this.drawing.ask();
    }

    showSpacing() {
        const spacing = this.spacings[byId("spacing").value] || 0, input = byId("spacing");
        const text = spacing > 0 ? `every ${rounded(spacing, 4)}` : "none";
        byId("spacingValue").textContent = text;
        input.setAttribute("aria-valuetext", text);
        this.set("spacing", this.scene.range > 0 ? spacing / this.scene.range : 0);
    }

    showFront() {
        const share = byId("front").value / 1000, at = this.scene.low + share * this.scene.range;
        const text = share < 1 ? `to ${number(at)}` : "all";
        byId("frontValue").textContent = text;
        byId("front").setAttribute("aria-valuetext", text);
        this.set("front", share < 1 ? share : 2);
    }

    play() {
        const seconds = 6, input = byId("front");
        const from = input.value < 1000 ? input.value / 1000 : 0, begin = performance.now();
        const step = (now) => {
            if (!this.playing) return;
            const share = Math.min(1, from + Math.max(0, now - begin) / (1000 * seconds));
            input.value = 1000 * share;
            this.showFront();
            if (share < 1) requestAnimationFrame(step); else this.stop();
        };
        this.playing = true;
        this.sayPlaying();
        requestAnimationFrame(step);
    }

    stop() {
        this.playing = false;
        this.sayPlaying();
    }

    sayPlaying() {
        byId("play").textContent = this.playing ? "Stop" : "Grow";
        byId("play").setAttribute("aria-pressed", String(Boolean(this.playing)));
    }

    showMap(name) {
        this.drawing.setMap(this.scene.maps[name]);
        const colors = this.scene.maps[name].match(/.{6}/g).map((hex) => "#" + hex);
        byId("bar").style.background = `linear-gradient(to right, ${colors.join(",")})`;
        this.showLegend();
    }

    // ---- legend ----

    showLegend() {
        const scene = this.scene, cells = byId("colorBy").value === "label";
        this.set("cells", cells ? 1 : 0);
        byId("legend").hidden = cells || !scene.any;
        byId("legend").setAttribute("aria-label", scene.any ?
            `Colors from ${number(scene.low)} to ${number(scene.high)} ${scene.unit}` : "");
        byId("ticks").replaceChildren(...ticksOf(scene).map((x) => {
            const item = element("li", number(x));
            item.style.left = `${100 * (scene.range > 0 ? (x - scene.low) / scene.range : 0)}%`;
            return item;
        }));
        const rows = cells ? scene.labelNames.map((name, k) => ["#" + labelColor(k).getHexString(), name]) : [];
        if (scene.unreached > 0) rows.push(["#b7b7b7", `${scene.rest}, ${percent(scene.unreached)} of the surface`]);
        if (scene.blocked > 0) rows.push(["#793426", `in an obstacle, ${percent(scene.blocked)}`]);
        byId("swatches").replaceChildren(...rows.slice(0, 200).map(([color, text]) => {
            const item = element("li", ""), swatch = element("i", "");
            swatch.style.background = color;
            item.append(swatch, text);
            return item;
        }));
    }

    // ---- keys and pointer ----

    setUpKeys() {
        const turn = Math.PI / 36, drawing = this.drawing;
        const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
        this.canvas.addEventListener("keydown", (event) => {
            const arrow = arrows[event.key];
            if (event.ctrlKey || event.altKey || event.metaKey) return;
            if (arrow && event.shiftKey) drawing.move(...arrow);
            else if (arrow) drawing.turn(arrow[0] * turn, -arrow[1] * turn);
            else if (event.key === "+" || event.key === "=") drawing.zoom(1 / 1.15);
            else if (event.key === "-") drawing.zoom(1.15);
            else if (event.key === "0" || event.key === "Home") drawing.firstView();
            else if (event.key === "Enter" || event.key === " ") this.keep(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
            else return;
            event.preventDefault();
        });
        // The cross in the middle is for use by keys.
        const byKeys = (yes) => document.body.classList.toggle("keys", yes);
        this.canvas.addEventListener("keyup", () => byKeys(true));
        for (const event of ["blur", "pointerdown", "pointermove"]) this.canvas.addEventListener(event, () => byKeys(false));
    }

    setUpPointer() {
        const canvas = this.canvas;
        let down = null, next = null;
        canvas.addEventListener("pointerdown", (event) => { down = {x: event.clientX, y: event.clientY}; });
        canvas.addEventListener("pointerup", (event) => {
            const still = down && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 5;
            down = null;
            const {left, top} = canvas.getBoundingClientRect();
            if (still && event.button === 0) this.keep(event.clientX - left, event.clientY - top);
        });
        canvas.addEventListener("pointermove", (event) => {
            if (event.buttons || event.pointerType === "touch") return;
            const {left, top} = canvas.getBoundingClientRect(), first = !next;
            next = [event.clientX - left, event.clientY - top];
            if (first) requestAnimationFrame(() => { this.read(...next); next = null; });
        });
    }

    // ---- the picked point ----

    read(x, y) {
        const hit = this.drawing.at(x, y), scene = this.scene;
        if (!hit) return this.readout([]), null;
        const world = toWorld(scene, hit.local), step = scene.side * 1e-5, rows = [];
        const distance = hit.share === null ? null : scene.low + hit.share * scene.range;
        "xyz".split("").forEach((axis, k) => rows.push([axis, digits(world[k], step)]));
        rows.push([scene.quantity, hit.state === "blocked" ? "in an obstacle" :
                   distance === null ? scene.rest : digits(distance, scene.range * 1e-5)]);
        if (scene.labelNames.length > 1 && hit.label) rows.push(["seed", scene.labelNames[hit.label - 1]]);
        const vertex = nearestNumbered(scene, hit.local);
        if (vertex >= 0) rows.push(["nearest vertex", String(vertex)]);
        if (scene.voxel) rows.push(["voxel", scene.voxel.map((row) => Math.round(
            row[0] * world[0] + row[1] * world[1] + row[2] * world[2] + row[3])).join(" ")]);
        const near = this.thingAt(x, y, hit);
        if (near) rows.push(["here", near.name]);
        this.readout(rows);
        return world;
    }

    thingAt(x, y, hit) {
        const {clientWidth: width, clientHeight: height} = this.canvas, at = new THREE.Vector3();
        return [...this.scene.seeds, ...this.scene.targets].find((thing) => {
            const local = toLocal(this.scene, thing.at);
            at.fromArray(local).project(this.drawing.camera);
            return Math.hypot((at.x + 1) * width / 2 - x, (1 - at.y) * height / 2 - y) < 10 &&
                   Math.hypot(...local.map((v, k) => v - hit.local[k])) < 0.05;
        });
    }

    readout(rows) {
        const parts = rows.map(([name, text]) => [element("dt", name), element("dd", text)]);
        byId("readout").replaceChildren(...parts.flat());
        if (rows.length) return;
        byId("readout").append(element("dt", "No surface there."));
        byId("readout").firstChild.className = "hint";
    }

    keep(x, y) {
        const world = this.read(x, y);
        byId("pick").hidden = !world;
        if (world) byId("seed").value = `--seed ${world.map((v) => digits(v, this.scene.side * 1e-5)).join(",")}`;
    }
}

// ---- helpers ----

function element(name, text) {
    const made = document.createElement(name);
    made.textContent = text;
    return made;
}

const percent = (share) => `${Number((100 * share).toPrecision(share < 0.995 ? 2 : 3))} %`;

// None, then 1, 2 and 5 times the powers of ten that give 2 to 200 lines, and the requested one.
function niceSpacings(scene) {
    const list = [0];
    if (scene.spacing > 0) list.push(scene.spacing);
    for (let power = -15; scene.range > 0 && power < 16; ++power)
        for (const digit of [1, 2, 5]) {
            const spacing = Number(`${digit}e${power}`), lines = scene.range / spacing;
            if (lines >= 2 && lines <= 200 && Math.abs(spacing / scene.spacing - 1) > 1e-9) list.push(spacing);
        }
    return list.sort((a, b) => a - b);
}

function ticksOf(scene) {
    if (!(scene.range > 0)) return scene.any ? [scene.low] : [];
    const raw = scene.range / 4, ten = 10 ** Math.floor(Math.log10(raw));
    const step = ten * [1, 2, 5, 10].find((digit) => digit * ten >= raw * 0.999), ticks = [];
    for (let k = Math.ceil(scene.low / step - 1e-9); k * step <= scene.high * (1 + 1e-9); ++k) ticks.push(k * step);
    return ticks;
}

async function copy(input) {
    input.select();
    try {
        await navigator.clipboard.writeText(input.value);
    } catch {
        document.execCommand("copy"); // where the page has no access to the clipboard
    }
    byId("copy").textContent = "Copied";
    setTimeout(() => { byId("copy").textContent = "Copy"; }, 1500);
}

// Runs without drawing.
function showWords(scene) {
    const fill = (id, texts) => byId(id).replaceChildren(...texts.map((text) => element("li", text)));
    byId("facts").textContent = scene.any ? `${scene.quantity} from ${number(scene.low)} to ${number(scene.high)}, ${scene.unit}` :
        `No part of the surface has a ${scene.quantity}: ${scene.rest}.`;
    fill("notes", scene.notes);
    const things = [...scene.seeds, ...scene.targets].map((thing) => `${thing.name}: ${thing.at.map(number).join(", ")}` +
        (thing.distance === undefined ? "" : thing.distance === null ? `, ${scene.rest}` : `, ${scene.quantity} ${number(thing.distance)}`));
    things.push(...scene.lines.curves.map((line) => line.name + (line.count ? "" : `: ${scene.rest}`)));
    const list = byId("things");
    list.hidden = things.length === 0;
    list.querySelector("summary").textContent = `Seeds, targets and lines (${things.length})`;
    list.querySelector("ul").replaceChildren(...things.slice(0, 500).map((text) => element("li", text)));
}

async function start() {
    const message = byId("message");
    message.textContent = "Unpacking the surface.";
    try {
        if (typeof DecompressionStream === "undefined")
            throw new Error("This browser is too old to unpack the page: Chrome 80, Firefox 113 and Safari 16.4 can.");
        const library = document.createElement("script");
        library.textContent = new TextDecoder().decode(await inflate(byId("library").textContent, "gzip"));
        document.head.append(library);
        const scene = await unpackScene();
        showWords(scene);
        const drawing = new Drawing(byId("canvas"), scene);
        new Page(scene, drawing);
        drawing.draw();
        document.body.classList.add("drawn");
        drawing.resize();
        drawing.firstView();
        performance.mark("drawn");
    } catch (error) {
        const words = JSON.parse(byId("scene").textContent);
        showWords({...words, any: words.high >= words.low});
        message.textContent = `${error.message} This is a picture of what the page shows.`;
        byId("readout").replaceChildren();
    }
}

start();
