"use strict";
// The drawing on the page of a result: unpacks the scene, draws it with three.js and picks the point at a pixel.
// Packed positions are in world units; for the drawing they are moved and scaled to a box of side 1.

const byId = (id) => document.getElementById(id);
const BLOCKED = 65534, UNREACHED = 65535; // codes of values

// ---- the scene ----

async function inflate(base64, format = "deflate") {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Numbers as packed by page_numbers.cpp: in planes of bytes, as many as the first byte says.
async function unpackPlain(base64) {
    const bytes = await inflate(base64), planes = bytes[0], n = (bytes.length - 1) / planes;
    const numbers = new Uint32Array(n);
    for (let plane = 0, at = 1; plane < planes; ++plane)
        for (let k = 0; k < n; ++k) numbers[k] |= bytes[at++] << 8 * plane;
    return numbers;
}

// The same of differences, their signs in the lowest bit.
async function unpack(base64) {
    const numbers = await unpackPlain(base64);
    for (let k = 0, last = 0; k < numbers.length; ++k)
        numbers[k] = last = last + ((numbers[k] >>> 1) ^ -(numbers[k] & 1)) | 0;
    return numbers;
}

// Fans of triangles: a middle, and a row of other vertices less the middle.
async function unpackTriangles(fans) {
    const [middle, count, rim] = await Promise.all([unpack(fans.middle), unpackPlain(fans.count), unpackPlain(fans.rim)]);
    const triangle = new Uint32Array(3 * (rim.length - middle.length));
    for (let fan = 0, at = 0, to = 0; fan < middle.length; ++fan, ++at)
        for (const end = at + count[fan]; at < end; ++at) {
            triangle[to++] = middle[fan];
            triangle[to++] = middle[fan] + rim[at];
            triangle[to++] = middle[fan] + rim[at + 1];
        }
    return triangle;
}

async function unpackPoints(packed) {
    const axes = await Promise.all([packed.x, packed.y, packed.z].map(unpack));
    const points = new Float32Array(3 * axes[0].length);
    for (let k = 0; k < axes[0].length; ++k)
        for (let axis = 0; axis < 3; ++axis) points[3 * k + axis] = axes[axis][k] / 65535;
    return points;
}

async function unpackScene() {
    const scene = JSON.parse(byId("scene").textContent);
    scene.position = await unpackPoints(scene.points);
    scene.value = await unpack(scene.values);
    scene.label = scene.labels ? await unpack(scene.labels) : null;
    scene.number = scene.numbers ? await unpack(scene.numbers) : null;
    scene.triangle = await unpackTriangles(scene.triangles);
    scene.linePoint = await unpackPoints(scene.lines);
    scene.range = scene.high - scene.low;
    scene.any = scene.value.some((code) => code < BLOCKED);
    return scene;
}

const toWorld = (scene, local) => scene.corner.map((low, axis) => low + local[axis] * scene.side);
const toLocal = (scene, world) => scene.corner.map((low, axis) => (world[axis] - low) / scene.side);
const shareOf = (scene, code) => code / (BLOCKED - 1);

// ---- geometry ----

// Corners at an edge of more than 30 degrees get separate points, so that shading shows the edge.
function splitAtCreases(position, triangle) {
    const cosine = Math.cos(Math.PI / 6), faces = triangle.length / 3, points = position.length / 3;
    const face = new Float32Array(3 * faces), area = new Float32Array(faces);
    for (let f = 0; f < faces; ++f) {
        const [a, b, c] = [0, 1, 2].map((k) => 3 * triangle[3 * f + k]);
        const u = [0, 1, 2].map((k) => position[b + k] - position[a + k]);
        const v = [0, 1, 2].map((k) => position[c + k] - position[a + k]);
        const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        area[f] = Math.hypot(...n);
        for (let k = 0; k < 3; ++k) face[3 * f + k] = n[k] / (area[f] || 1);
    }
    const start = new Uint32Array(points + 1);
    for (const p of triangle) ++start[p + 1];
    for (let p = 0; p < points; ++p) start[p + 1] += start[p];
    const corners = new Uint32Array(triangle.length), next = start.slice();
    triangle.forEach((p, corner) => { corners[next[p]++] = corner; });

    const index = new Uint32Array(triangle.length), origin = [], normal = [];
    for (let p = 0; p < points; ++p) {
        const groups = []; // groups of smooth corners: the sum of their normals, and a number
        for (let i = start[p]; i < start[p + 1]; ++i) {
            const f = Math.floor(corners[i] / 3), n = face.subarray(3 * f, 3 * f + 3);
            let group = groups.find((g) => g.sum[0] * n[0] + g.sum[1] * n[1] + g.sum[2] * n[2] >=
                                           cosine * Math.hypot(...g.sum));
            if (!group) groups.push(group = {sum: [0, 0, 0], number: origin.push(p) - 1});
            for (let k = 0; k < 3; ++k) group.sum[k] += (area[f] + 1e-20) * n[k];
            index[corners[i]] = group.number;
        }
        for (const g of groups) normal.push(...g.sum.map((x) => x / (Math.hypot(...g.sum) || 1)));
    }
    return {index, origin: Uint32Array.from(origin), normal: Float32Array.from(normal)};
}

const labelColor = (label) => new THREE.Color().setHSL((0.58 + label * 0.381966) % 1, 0.5, label % 2 ? 0.62 : 0.48);

function surfaceGeometry(scene) {
    const split = splitAtCreases(scene.position, scene.triangle), n = split.origin.length;
    const position = new Float32Array(3 * n), value = new Float32Array(n), state = new Float32Array(2 * n);
    const cell = new Uint8Array(3 * n), colors = [];
    for (let i = 0; i < n; ++i) {
        const p = split.origin[i], code = scene.value[p], label = scene.label ? scene.label[p] : 0;
        position.set(scene.position.subarray(3 * p, 3 * p + 3), 3 * i);
        if (code < BLOCKED) value[i] = shareOf(scene, code), state[2 * i] = 1;
        if (code === BLOCKED) state[2 * i + 1] = 1;
        if (!label) continue;
        colors[label] = colors[label] || labelColor(label - 1).toArray().map((c) => 255 * c);
        cell.set(colors[label], 3 * i);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(split.index, 1));
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(split.normal, 3));
    geometry.setAttribute("value", new THREE.BufferAttribute(value, 1));
    geometry.setAttribute("state", new THREE.BufferAttribute(state, 2));
    geometry.setAttribute("cell", new THREE.BufferAttribute(cell, 3, true));
    return geometry;
}

// Four corners per segment; the shader spreads them to a ribbon.
function ribbonGeometry(scene) {
    const position = [], other = [], corner = [], index = [];
    let first = 0;
    for (const line of scene.lines.curves) {
        for (let k = first; k + 1 < first + line.count; ++k) {
            const a = scene.linePoint.subarray(3 * k, 3 * k + 3), b = scene.linePoint.subarray(3 * k + 3, 3 * k + 6);
            const v = position.length / 3;
            position.push(...a, ...a, ...b, ...b);
            other.push(...b, ...b, ...a, ...a);
            corner.push(-1, 1, 1, 1, -1, -1, 1, -1);
            index.push(v, v + 1, v + 2, v + 2, v + 1, v + 3);
        }
        first += line.count;
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(index), 1));
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(position, 3));
    geometry.setAttribute("other", new THREE.Float32BufferAttribute(other, 3));
    geometry.setAttribute("corner", new THREE.Float32BufferAttribute(corner, 2));
    return geometry;
}

// The nearest triangle along a ray: {at: weights of its corners, corners, t}, or null. Moeller and Trumbore.
function firstHit(scene, from, dir) {
    const P = scene.position, T = scene.triangle;
    let best = null;
    for (let i = 0; i < T.length; i += 3) {
        const a = 3 * T[i], b = 3 * T[i + 1], c = 3 * T[i + 2], ax = P[a], ay = P[a + 1], az = P[a + 2];
        const ux = P[b] - ax, uy = P[b + 1] - ay, uz = P[b + 2] - az;
        const vx = P[c] - ax, vy = P[c + 1] - ay, vz = P[c + 2] - az;
        const px = dir.y * vz - dir.z * vy, py = dir.z * vx - dir.x * vz, pz = dir.x * vy - dir.y * vx;
        const det = ux * px + uy * py + uz * pz;
        if (det === 0) continue;
        const sx = from.x - ax, sy = from.y - ay, sz = from.z - az, u = (sx * px + sy * py + sz * pz) / det;
        if (u < 0 || u > 1) continue;
        const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
        const v = (dir.x * qx + dir.y * qy + dir.z * qz) / det;
        if (v < 0 || u + v > 1) continue;
        const t = (vx * qx + vy * qy + vz * qz) / det;
        if (t > 0 && (!best || t < best.t)) best = {t, at: [1 - u - v, u, v], corners: [T[i], T[i + 1], T[i + 2]]};
    }
    return best;
}

// The nearest vertex of the file, or -1.
function nearestNumbered(scene, local) {
    let best = Infinity, number = -1;
    for (let p = 0; scene.number && p < scene.number.length; ++p) {
        if (scene.number[p] === 0) continue;
        const x = scene.position[3 * p] - local[0], y = scene.position[3 * p + 1] - local[1];
        const z = scene.position[3 * p + 2] - local[2], square = x * x + y * y + z * z;
        if (square < best) best = square, number = scene.number[p] - 1;
    }
    return number;
}

// ---- shaders ----

const COLOR = `
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toScreen(vec3 c) { return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
`;
const SURFACE_VERTEX = `
attribute float value; attribute vec2 state; attribute vec3 cell;
varying float vValue; varying vec2 vState; varying vec3 vCell, vNormal, vEye;
void main() {
    vValue = value; vState = state; vCell = cell; vNormal = normalMatrix * normal;
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    vEye = -p.xyz;
    gl_Position = projectionMatrix * p;
}`;
const SURFACE_FRAGMENT = COLOR + `
uniform sampler2D map;
uniform float spacing, start, front, shade, cells, halfLine; // lengths as shares of the largest value
varying float vValue; varying vec2 vState; varying vec3 vCell, vNormal, vEye;
float isoline() {
    if (spacing <= 0.0) return 0.0;
    float s = (vValue + start) / spacing, level = floor(s + 0.5), width = fwidth(s);
    if (level * spacing <= start) return 0.0;
    return clamp(halfLine + 0.5 - abs(s - level) / width, 0.0, 1.0) * (1.0 - smoothstep(0.12, 0.35, width));
}
vec3 known() {
    vec3 c = toLinear(cells > 0.5 ? vCell : texture2D(map, vec2((clamp(vValue, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb);
    float edge = abs(vValue - front) / max(fwidth(vValue), 1e-9);
    if (front < 1.0 && edge < 1.5 * halfLine + 0.5) return vec3(0.02);
    if (vValue > front) return vec3(0.72);
    vec3 line = dot(c, vec3(0.2126, 0.7152, 0.0722)) < 0.18 ? 0.3 * c + 0.7 : 0.12 * c;
    return mix(c, line, isoline());
}
void main() {
    vec3 c = known();
    if (vState.x < 0.999) c = vec3(0.48);
    if (vState.y > 0.5) c = vec3(0.19, 0.035, 0.02);
    vec3 n = normalize(vNormal), eye = normalize(vEye);
    if (dot(n, eye) < 0.0) n = -n;
    vec3 key = normalize(vec3(-0.55, 0.75, 0.75)), fill = normalize(vec3(0.9, 0.1, 0.5));
    float wrapped = max(0.0, (dot(n, key) + 0.35) / 1.35), rim = pow(1.0 - min(dot(n, eye), 1.0), 3.0);
    float light = (0.42 + 0.62 * wrapped * wrapped + 0.14 * max(0.0, dot(n, fill))) * (1.0 - 0.3 * rim);
    float shine = 0.05 * pow(max(0.0, dot(n, normalize(key + eye))), 30.0);
    gl_FragColor = vec4(toScreen(clamp(mix(c, light * c + shine, shade), 0.0, 1.0)), 1.0);
}`;
// Lines and dots lie on the surface: they move toward the eye by their width, so that the surface does not hide them.
const RIBBON_VERTEX = `
attribute vec3 other; attribute vec2 corner;
uniform vec2 size; uniform float halfWidth, pixel, lift;
void main() {
    float nearer = 1.0 - lift * pixel;
    vec4 p = projectionMatrix * vec4(nearer * (modelViewMatrix * vec4(position, 1.0)).xyz, 1.0);
    vec4 q = projectionMatrix * vec4(nearer * (modelViewMatrix * vec4(other, 1.0)).xyz, 1.0);
    vec2 along = (q.xy / q.w - p.xy / p.w) * size;
    along = dot(along, along) > 0.0 ? normalize(along) * corner.y : vec2(1.0, 0.0);
    vec2 off = halfWidth * (vec2(-along.y, along.x) * corner.x - 0.5 * along * corner.y);
    gl_Position = p + vec4(2.0 * off / size * p.w, 0.0, 0.0);
}`;
const DOT_VERTEX = `
attribute float radius; attribute vec3 ink; attribute vec3 paper;
uniform float pixel, ratio;
varying vec3 vInk, vPaper;
void main() {
    vInk = ink; vPaper = paper;
    vec3 p = (1.0 - 2.0 * radius * ratio * pixel) * (modelViewMatrix * vec4(position, 1.0)).xyz;
    gl_Position = projectionMatrix * vec4(p, 1.0);
    gl_PointSize = 2.0 * radius * ratio;
}`;
const DOT_FRAGMENT = `
varying vec3 vInk, vPaper;
void main() {
    float r = 2.0 * length(gl_PointCoord - 0.5);
    if (r > 1.0) discard;
    gl_FragColor = vec4(r > 0.7 ? vInk : vPaper, 1.0);
}`;

// ---- the drawing ----

// Antialiasing is free on a graphics card, and doubles the time of software rendering.
function contextOf(canvas) {
    const probe = document.createElement("canvas").getContext("webgl");
    const name = probe ? probe.getParameter(probe.RENDERER) : "";
    const masked = /^webkit/i.test(name) && probe.getExtension("WEBGL_debug_renderer_info"); // as in Chromium
    const full = masked ? probe.getParameter(masked.UNMASKED_RENDERER_WEBGL) : name;
    const slow = /swiftshader|llvmpipe|software/i.test(full);
    const attributes = {antialias: !slow, alpha: false};
    return canvas.getContext("webgl2", attributes) || canvas.getContext("webgl", attributes);
}

class Drawing {
    constructor(canvas, scene) {
        this.canvas = canvas;
        this.scene = scene;
        const context = contextOf(canvas);
        if (!context) throw new Error("This browser draws nothing in 3D: WebGL is missing or switched off.");
        this.renderer = new THREE.WebGLRenderer({canvas, context});
        this.renderer.setClearColor(0xffffff);
        this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 10);
        this.camera.up.fromArray(scene.up);
        this.controls = new THREE.OrbitControls(this.camera, canvas);
        Object.assign(this.controls, {enableKeys: false, screenSpacePanning: true, rotateSpeed: 0.8, minDistance: 0.005});
        this.controls.addEventListener("change", () => this.ask());
        this.world = new THREE.Scene();
        this.addSurface();
        this.addLines();
        this.addDots();
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
        this.resize();
        this.firstView();
    }

    addSurface() {
        const table = new THREE.DataTexture(new Uint8Array(4 * 256).fill(255), 256, 1, THREE.RGBAFormat);
        table.minFilter = table.magFilter = THREE.LinearFilter;
        table.generateMipmaps = false;
        const low = this.scene.range > 0 ? this.scene.low / this.scene.range : 0;
        this.uniforms = {map: {value: table}, spacing: {value: 0}, start: {value: low}, front: {value: 1},
                         shade: {value: 1}, cells: {value: 0}, halfLine: {value: 1}};
        const geometry = surfaceGeometry(this.scene);
        geometry.computeBoundingBox();
        geometry.computeBoundingSphere();
        this.box = geometry.boundingBox;
        this.world.add(new THREE.Mesh(geometry, new THREE.ShaderMaterial({
            vertexShader: SURFACE_VERTEX, fragmentShader: SURFACE_FRAGMENT, uniforms: this.uniforms,
            side: THREE.DoubleSide, extensions: {derivatives: true}})));
    }

    addLines() {
        this.onScreen = {size: {value: new THREE.Vector2(1, 1)}, pixel: {value: 0}, ratio: {value: 1}};
        const geometry = ribbonGeometry(this.scene);
        if (geometry.index.count === 0) return;
        // The rim writes no depth, so that it cannot hide the line inside it.
        for (const [halfWidth, lift, color] of [[3, 4, "vec3(0.09)"], [1.6, 5, "vec3(1.0)"]]) {
            const width = {value: halfWidth};
            const ribbon = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
                vertexShader: RIBBON_VERTEX, fragmentShader: `void main() { gl_FragColor = vec4(${color}, 1.0); }`,
                uniforms: {...this.onScreen, lift: {value: lift}, halfWidth: width},
                side: THREE.DoubleSide, depthWrite: halfWidth < 2}));
            ribbon.renderOrder = lift;
            ribbon.onBeforeRender = () => { width.value = halfWidth * this.onScreen.ratio.value; };
            ribbon.frustumCulled = false;
            this.world.add(ribbon);
        }
    }

    addDots() {
        const dots = [...this.scene.seeds.map((dot) => ({...dot, look: [8, 0.09, 1]})),
                      ...this.scene.targets.map((dot) => ({...dot, look: [5.5, 1, 0.09]}))];
        if (dots.length === 0) return;
        const geometry = new THREE.BufferGeometry(), three = (x) => [x, x, x];
        const put = (name, size, value) => geometry.setAttribute(
            name, new THREE.Float32BufferAttribute([].concat(...dots.map(value)), size));
        put("position", 3, (dot) => toLocal(this.scene, dot.at));
        put("radius", 1, (dot) => dot.look[0]);
        put("ink", 3, (dot) => three(dot.look[1]));
        put("paper", 3, (dot) => three(dot.look[2]));
        const points = new THREE.Points(geometry, new THREE.ShaderMaterial({
            vertexShader: DOT_VERTEX, fragmentShader: DOT_FRAGMENT, uniforms: this.onScreen}));
        points.frustumCulled = false;
        points.renderOrder = 10;
        this.world.add(points);
    }

    setMap(hex) {
        const colors = hex.match(/../g).map((two) => parseInt(two, 16)), last = colors.length / 3 - 1;
        const data = this.uniforms.map.value.image.data;
        for (let k = 0; k < 256; ++k)
            for (let c = 0; c < 3; ++c) {
                const x = k / 255 * last, i = Math.min(Math.floor(x), last - 1);
                data[4 * k + c] = Math.round(colors[3 * i + c] + (x - i) * (colors[3 * i + 3 + c] - colors[3 * i + c]));
            }
        this.uniforms.map.value.needsUpdate = true;
        this.ask();
    }

    // Shows all of the surface, from the direction given in the scene.
    firstView() {
        const middle = this.box.getCenter(new THREE.Vector3()), back = new THREE.Vector3().fromArray(this.scene.eye);
        const right = new THREE.Vector3().crossVectors(this.camera.up, back).normalize();
        const up = new THREE.Vector3().crossVectors(back, right), tan = Math.tan(Math.PI / 12) / 1.06;
        let depth = 0;
        const P = this.scene.position, p = new THREE.Vector3();
        for (let k = 0; k < P.length; k += 3) {
            p.fromArray(P, k).sub(middle);
            depth = Math.max(depth, p.dot(back) + Math.max(Math.abs(p.dot(up)) / tan,
                                                           Math.abs(p.dot(right)) / (tan * this.camera.aspect)));
        }
        this.controls.target.copy(middle);
        this.camera.position.copy(middle).addScaledVector(back, depth);
        this.controls.update();
        this.ask();
    }

    turn(theta, phi) {
        const upright = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
        const offset = this.camera.position.clone().sub(this.controls.target).applyQuaternion(upright);
        const at = new THREE.Spherical().setFromVector3(offset);
        at.theta += theta, at.phi += phi;
        offset.setFromSpherical(at.makeSafe()).applyQuaternion(upright.conjugate());
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
        this.ask();
    }

    move(right, up) {
        const step = 0.04 * this.camera.position.distanceTo(this.controls.target);
        const by = new THREE.Vector3(right * step, up * step, 0).applyQuaternion(this.camera.quaternion);
        this.camera.position.add(by), this.controls.target.add(by);
        this.controls.update();
        this.ask();
    }

    zoom(factor) {
        this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
        this.controls.update();
        this.ask();
    }

    resize() {
        const {clientWidth: width, clientHeight: height} = this.canvas.parentElement;
        if (!width || !height) return;
        const ratio = Math.min(window.devicePixelRatio || 1, 2), portrait = this.camera.aspect;
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.onScreen.size.value.set(width * ratio, height * ratio);
        this.onScreen.ratio.value = ratio;
        this.onScreen.pixel.value = 2 * Math.tan(Math.PI / 12) / (height * ratio);
        this.uniforms.halfLine.value = 0.6 * ratio;
        if (portrait < 1 !== this.camera.aspect < 1) this.firstView();
        this.ask();
    }

    ask() {
        if (this.asked) return;
        this.asked = true;
        requestAnimationFrame(() => { this.asked = false; this.draw(); });
    }

    draw() {
        const away = this.camera.position.distanceTo(this.box.getCenter(new THREE.Vector3()));
        this.camera.near = Math.max(away - 2, away / 100);
        this.camera.far = away + 2;
        this.camera.updateProjectionMatrix();
        this.renderer.render(this.world, this.camera);
        this.canvas.dataset.frames = Number(this.canvas.dataset.frames || 0) + 1;
    }

    // The point at a pixel of the canvas: {local, share, label, state}, or null.
    at(x, y) {
        const pointer = new THREE.Vector2(2 * x / this.canvas.clientWidth - 1, 1 - 2 * y / this.canvas.clientHeight);
        const rays = new THREE.Raycaster();
        this.camera.updateMatrixWorld();
        rays.setFromCamera(pointer, this.camera);
        const hit = firstHit(this.scene, rays.ray.origin, rays.ray.direction);
        if (!hit) return null;
        const codes = hit.corners.map((p) => this.scene.value[p]), blend = (f) => hit.at.reduce((s, w, k) => s + w * f(k), 0);
        const nearest = hit.corners[hit.at.indexOf(Math.max(...hit.at))], code = this.scene.value[nearest];
        const known = codes.every((c) => c < BLOCKED);
        return {local: [0, 1, 2].map((axis) => blend((k) => this.scene.position[3 * hit.corners[k] + axis])),
                share: known ? blend((k) => shareOf(this.scene, codes[k])) : null,
                state: known ? "known" : code === BLOCKED ? "blocked" : "unreached",
                label: this.scene.label ? this.scene.label[nearest] : 0};
    }
}
