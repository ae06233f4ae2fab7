// The picture: part, tool, hand, contacts, force.

import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { CUTTING, OTHER, colorOf } from './colors.js';
import { pathLines } from './path.js';

const PART = new THREE.Color('#c9ced4');
const STOCK = new THREE.Color('#d8b98c');
const FORCE = 0xc2410c;
const FEED = 0x0b7a4b;
const RAPID = 0xd08a00;
const MAX_CONTACTS = 4096;
/** Greatest slope of a view of a finding over the plane at right angles to the tool's axis. */
const MAX_RISE = 0.35;
/** Values of a contact in the engine's list. */
export const CONTACT_VALUES = 10;

/** @typedef {{positions: Float32Array, normals: Float32Array, surfaces: Uint32Array}} ToolTriangles */

export class Scene {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setClearColor(0xfbfcfd);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1e5);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = false;
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9aa3ad, 2.6));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.1);
    lamp.position.set(0.3, 0.5, 1);
    this.camera.add(lamp);
    this.scene.add(this.camera);
    this.size = 1;
    this.box = new THREE.Box3();
    /** @type {THREE.Mesh | null} */
    this.part = null;
    this.tool = new THREE.Group();
    this.ghost = new THREE.Group();
    for (const group of [this.tool, this.ghost]) {
      group.matrixAutoUpdate = false;
      this.scene.add(group);
    }
    this.contacts = this.#points();
    // An arrow of length 1 along y, from its base.
    const red = new THREE.MeshBasicMaterial({ color: FORCE, depthTest: false, transparent: true });
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.006, 0.006, 1, 16).translate(0, 0.5, 0), red);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(0.018, 0.05, 20).translate(0, 0.025, 0), red);
    this.arrow = new THREE.Group().add(this.shaft, this.head);
    this.arrow.visible = false;
    this.shaft.renderOrder = this.head.renderOrder = 4;
    this.spring = new THREE.Line(
      new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(new Float32Array(6), 3)),
      new THREE.LineDashedMaterial({ color: 0x16202c, depthTest: false, transparent: true, opacity: 0.7 }),
    );
    this.spring.frustumCulled = false;
    this.spring.renderOrder = 3;
    this.scene.add(this.arrow, this.spring);
    /** The path of a program. */
    this.path = new THREE.Group();
    // Lengths of dashes are in pixels.
    this.dashes = new THREE.LineDashedMaterial({ color: RAPID, dashSize: 7, gapSize: 5 });
    this.scene.add(this.path);
    /** Radius of each surface of the tool about its axis, their names, and the radius of those that cut. @type {number[]} */
    this.radii = [];
    /** @type {string[]} */
    this.surfaces = [];
    this.toolRadius = 0;
    /** The plane before which the part is cut away, if it is; the tool never is. @type {THREE.Plane[]} */
    this.section = [];
    // Steps of the lattice look alike from every side without smooth normals.
    const material = new THREE.MeshLambertMaterial({ color: STOCK, flatShading: true, clippingPlanes: this.section });
    this.stock = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.stock.visible = false;
    this.scene.add(this.stock);
    this.renderer.localClippingEnabled = true;
    // A click turns nothing, and the section stays.
    let isTurning = false;
    this.orbit.addEventListener('start', () => { isTurning = true; });
    this.orbit.addEventListener('end', () => { isTurning = false; });
    this.orbit.addEventListener('change', () => { if (isTurning) this.section.length = 0; });
  }

  /** Sets the distances between which things are drawn. */
  #setRange() {
    const distance = this.camera.position.distanceTo(this.orbit.target);
    this.camera.near = 0.01 * distance;
    this.camera.far = 100 * Math.max(distance, this.size);
    this.camera.updateProjectionMatrix();
  }

  #points() {
    const geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'color']) {
      geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * MAX_CONTACTS), 3));
    }
    geometry.setDrawRange(0, 0);
    const material = new THREE.PointsMaterial({ size: 7, sizeAttenuation: false, vertexColors: true, depthTest: false, transparent: true });
    const points = new THREE.Points(geometry, material);
    points.frustumCulled = false;
    points.renderOrder = 5;
    this.scene.add(points);
    return points;
  }

  /**
   * Shows a part.
   * @param {Float32Array} positions
   */
  setPart(positions) {
    if (this.part) {
      this.scene.remove(this.part);
      this.part.geometry.dispose();
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    const colors = new Float32Array(positions.length);
    for (let k = 0; k < colors.length; k += 3) PART.toArray(colors, k);
    geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
    geometry.computeVertexNormals();
    // A flat face drawn behind its edges.
    const material = new THREE.MeshLambertMaterial({ vertexColors: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, side: THREE.DoubleSide, clippingPlanes: this.section });
    this.part = new THREE.Mesh(geometry, material);
    const edges = new THREE.LineSegments(
      new THREE.EdgesGeometry(geometry, 30),
      new THREE.LineBasicMaterial({ color: 0x5b6775, clippingPlanes: this.section }),
    );
    this.part.add(edges);
    this.scene.add(this.part);
    this.box.setFromBufferAttribute(geometry.getAttribute('position'));
    this.size = this.box.getSize(new THREE.Vector3()).length();
    this.view('corner');
  }

  /**
   * Colours triangles of the part by niceness; `null` for the part's own colour.
   * @param {Iterable<[number, number | null]>} values triangle and niceness
   */
  colorTriangles(values) {
    const colors = this.part?.geometry.getAttribute('color');
    if (!colors) return;
    const color = new THREE.Color();
    for (const [triangle, niceness] of values) {
      if (niceness === null) color.copy(PART);
      else color.setRGB(...colorOf(niceness), THREE.SRGBColorSpace);
      for (let corner = 0; corner < 3; corner++) color.toArray(colors.array, 9 * triangle + 3 * corner);
    }
    colors.needsUpdate = true;
  }

  /**
   * Shows a tool and the hand's ghost of it.
   * @param {ToolTriangles} triangles
   * @param {{name: string, cutting: boolean}[]} surfaces
   */
  setTool(triangles, surfaces) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(triangles.positions, 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(triangles.normals, 3));
    const colors = new Float32Array(triangles.positions.length);
    const palette = surfaces.map(({ cutting }, k) => {
      const same = surfaces.slice(0, k).filter((other) => other.cutting === cutting).length;
      const list = cutting ? CUTTING : OTHER;
      return new THREE.Color(list[same % list.length]);
    });
    triangles.surfaces.forEach((surface, triangle) => {
      for (let corner = 0; corner < 3; corner++) palette[surface].toArray(colors, 9 * triangle + 3 * corner);
    });
    geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
    for (const group of [this.tool, this.ghost]) {
      group.children.forEach((child) => child.geometry.dispose());
      group.clear();
    }
    this.radii = radii(triangles.positions, surfaces.length, triangles.surfaces);
    const cutting = this.radii.filter((_, surface) => surfaces[surface].cutting);
    this.toolRadius = Math.max(...(cutting.length ? cutting : this.radii));
    this.surfaces = surfaces.map(({ name }) => name);
    this.tool.add(new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ vertexColors: true, transparent: true, opacity: 0.82 })));
    // The tool shows through the part where that hides it.
    const hidden = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({
      vertexColors: true, transparent: true, opacity: 0.3, depthFunc: THREE.GreaterDepth, depthWrite: false,
    }));
    // The tool is drawn after it, as it does not hide itself.
    hidden.renderOrder = -1;
    this.tool.add(hidden);
    this.ghost.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0x16202c, transparent: true, opacity: 0.14, depthTest: false, depthWrite: false })));
  }

  /**
   * Shows what remains of the stock.
   * @param {Float32Array} positions of its triangles
   */
  setStock(positions) {
    this.stock.geometry.dispose();
    this.stock.geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(positions, 3));
    this.stock.visible = positions.length > 0;
  }

  /**
   * Shows the path of a program, `null` for none: solid in feed, dashed in rapid traverse.
   * @param {Float32Array | null} positions tips, each with 1 in rapid traverse, else 0
   */
  setPath(positions) {
    for (const line of this.path.children) line.geometry.dispose();
    this.path.clear();
    if (!positions) return;
    const { feed, rapid } = pathLines(positions);
    const line = (ends, material) => {
      const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.BufferAttribute(ends, 3));
      this.path.add(new THREE.LineSegments(geometry, material).computeLineDistances());
    };
    line(feed, new THREE.LineBasicMaterial({ color: FEED, transparent: true, opacity: 0.75 }));
    line(rapid, this.dashes);
  }

  /** Shows or hides the path. */
  showPath(isShown) {
    this.path.visible = isShown;
  }

  /**
   * Looks at a point of the part from outside and from beside the tool, near enough for the tool, and outside the surface of it
   * that is named. The part is cut away where it stands before the point.
   * @param {number[]} point
   * @param {number} triangle of the part
   * @param {number[]} axis of the tool
   * @param {string | null} surface of the tool
   */
  lookAt(point, triangle, axis, surface) {
    const normals = /** @type {any} */ (this.part).geometry.getAttribute('normal');
    const normal = new THREE.Vector3().fromBufferAttribute(normals, 3 * triangle);
    const aside = new THREE.Vector3(-normal.y, normal.x, 0).multiplyScalar(0.7);
    const toward = normal.add(aside).add(new THREE.Vector3(0.1, -0.2, 0.5));
    // A tool that is seen along its axis hides the point, and its holder may reach beyond the camera.
    const up = new THREE.Vector3(...axis);
    const rise = toward.dot(up);
    toward.addScaledVector(up, -rise);
    if (toward.length() < 1e-3) toward.set(0.75, -1, 0).addScaledVector(up, up.y - 0.75 * up.x);
    toward.normalize().addScaledVector(up, Math.min(Math.max(rise, -MAX_RISE), MAX_RISE));
    const radius = this.radii[this.surfaces.indexOf(surface ?? '')] ?? this.toolRadius;
    const extent = Math.max(Math.min(0.6 * this.size, Math.max(12 * this.toolRadius, 0.05 * this.size)), 4 * radius);
    const distance = (0.5 * extent) / Math.tan((this.camera.fov * Math.PI) / 360);
    this.orbit.target.set(...point);
    this.camera.position.copy(this.orbit.target).addScaledVector(toward.normalize(), distance);
    this.orbit.update();
    this.#setRange();
    this.#cutBefore(this.orbit.target, Math.min(2 * this.toolRadius, extent));
  }

  /** Cuts the part away from a distance before a point on, if it stands there. */
  #cutBefore(point, distance) {
    this.section.length = 0;
    const toward = this.camera.position.clone().sub(point);
    const caster = new THREE.Raycaster(this.camera.position, toward.clone().negate().normalize(), 0, 0.999 * toward.length());
    const before = [/** @type {any} */ (this.part), ...(this.stock.visible ? [this.stock] : [])];
    if (!caster.intersectObjects(before, false).length) return;
    const away = toward.negate().normalize();
    this.section.push(new THREE.Plane().setFromNormalAndCoplanarPoint(away, point.clone().addScaledVector(away, -distance)));
  }

  /**
   * Looks at the part from a corner, the front or the top, with room for the tool above it.
   * @param {'corner' | 'front' | 'top'} name
   */
  view(name) {
    const from = { corner: [0.75, -1, 0.62], front: [0, -1, 0.0001], top: [0, -0.0001, 1] }[name];
    const direction = new THREE.Vector3(...from).normalize();
    const target = this.box.getCenter(new THREE.Vector3());
    target.z += 0.12 * this.size;
    // A narrow view needs more distance.
    const narrow = Math.min(1, this.canvas.clientWidth / this.canvas.clientHeight);
    const distance = (0.62 * this.size) / Math.tan((this.camera.fov * Math.PI) / 360) / narrow;
    this.orbit.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.orbit.update();
    this.#setRange();
    this.section.length = 0;
  }

  /**
   * Shows a state of the engine.
   * @param {import('./state.js').State} state
   * @param {Float32Array} contacts
   */
  show(state, contacts) {
    const place = (group, { tip, rotation }) => {
      const [a, b, c, d, e, f, g, h, i] = rotation;
      group.matrix.set(a, d, g, tip[0], b, e, h, tip[1], c, f, i, tip[2], 0, 0, 0, 1);
      group.matrixWorldNeedsUpdate = true;
    };
    place(this.tool, state.tool);
    place(this.ghost, state.hand);
    const apart = Math.hypot(...state.tool.tip.map((value, k) => value - state.hand.tip[k]));
    this.ghost.visible = apart > 0.002 * this.size;
    this.spring.visible = this.ghost.visible;
    this.spring.geometry.getAttribute('position').copyArray([...state.tool.tip, ...state.hand.tip]).needsUpdate = true;

    const count = Math.min(contacts.length / CONTACT_VALUES, MAX_CONTACTS);
    const { position, color } = this.contacts.geometry.attributes;
    const shade = new THREE.Color();
    const centre = new THREE.Vector3();
    for (let k = 0; k < count; k++) {
      const at = CONTACT_VALUES * k;
      position.setXYZ(k, contacts[at], contacts[at + 1], contacts[at + 2]);
      shade.setRGB(...colorOf(contacts[at + 4]), THREE.SRGBColorSpace).toArray(color.array, 3 * k);
      centre.add(new THREE.Vector3(contacts[at], contacts[at + 1], contacts[at + 2]));
    }
    position.needsUpdate = color.needsUpdate = true;
    this.contacts.geometry.setDrawRange(0, count);

    const force = new THREE.Vector3(...state.force);
    const size = force.length();
    this.arrow.visible = size > 0.01;
    if (this.arrow.visible) {
      // From the middle of the contact, 28 pixels per newton.
      this.arrow.position.copy(count ? centre.divideScalar(count) : new THREE.Vector3(...state.tool.tip));
      this.arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), force.divideScalar(size));
      this.arrow.scale.setScalar(560 * this.pixel(this.arrow.position.toArray()));
      const length = 0.05 * Math.min(size, 8);
      this.shaft.scale.y = length;
      this.head.position.y = length;
    }
  }

  /** Draws a picture, at the size that the canvas has. */
  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.dashes.scale = 1 / this.pixel(this.orbit.target.toArray());
    this.renderer.render(this.scene, this.camera);
  }

  /**
   * Returns where a point is on the canvas, in CSS pixels.
   * @param {number[]} point
   */
  project(point) {
    const { x, y } = new THREE.Vector3(...point).project(this.camera);
    return [(0.5 + 0.5 * x) * this.canvas.clientWidth, (0.5 - 0.5 * y) * this.canvas.clientHeight];
  }

  /**
   * Returns the length of a pixel at a point.
   * @param {number[]} point
   */
  pixel(point) {
    const depth = new THREE.Vector3(...point).sub(this.camera.position).dot(this.camera.getWorldDirection(new THREE.Vector3()));
    return (2 * depth * Math.tan((this.camera.fov * Math.PI) / 360)) / this.canvas.clientHeight;
  }

  /**
   * Returns the ray at a position of the canvas.
   * @param {number} x
   * @param {number} y
   */
  ray(x, y) {
    const at = new THREE.Vector2((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    return caster;
  }

  /** Returns the least distance of the tool from the plane before which nothing is drawn; below 0 it is cut there. */
  toolRange() {
    const [mesh] = this.tool.children;
    mesh.geometry.boundingBox ?? mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox;
    const { away } = this.directions();
    // The box stands around the tool in the tool's own frame.
    const corners = Array.from({ length: 8 }, (_, k) => new THREE.Vector3(...['x', 'y', 'z'].map((axis, i) => ((k >> i) & 1 ? max : min)[axis])));
    const depths = corners.map((corner) => corner.applyMatrix4(this.tool.matrix).sub(this.camera.position).dot(away));
    return Math.min(...depths) - this.camera.near;
  }

  /** Returns whether the tool is at a position of the canvas. */
  hits(x, y) {
    return this.ray(x, y).intersectObjects([this.tool, ...(this.ghost.visible ? [this.ghost] : [])], true).length > 0;
  }

  /** Returns the directions of the screen: to the right, up, and away. */
  directions() {
    const right = new THREE.Vector3();
    const up = new THREE.Vector3();
    const back = new THREE.Vector3();
    this.camera.matrixWorld.extractBasis(right, up, back);
    return { right, up, away: back.negate() };
  }
}

/** Returns the radius of each surface about the tool's axis. */
function radii(positions, count, of) {
  const found = new Array(count).fill(0);
  for (let k = 0; k < positions.length; k += 3) {
    const surface = of[Math.floor(k / 9)];
    found[surface] = Math.max(found[surface], Math.hypot(positions[k], positions[k + 1]));
  }
  return found;
}
