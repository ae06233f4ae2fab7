// The pose asked for: moved by mouse, touch, keys, a gamepad or a SpaceMouse.

import { Quaternion, Vector3 } from 'three';

const STEP = 0.5; // of an arrow key, mm
const TURN = 0.008; // rad per pixel
const MIN_DRAG = 3; // pixels before a press is a drag
const GAMEPAD = { speed: 0.25, turn: 1.2, dead: 0.12 }; // part sizes and rad per second

/** The pose that the hand asks for, and the means to move it. */
export class Hand {
  /** @param {import('./scene.js').Scene} scene */
  constructor(scene) {
    this.scene = scene;
    this.tip = new Vector3(0, 0, 10);
    this.turn = new Quaternion();
    this.millimetre = 1;
    /** The tip of the tool as it stands, `null` if unknown. @type {number[] | null} */
    this.stands = null;
    /** @type {{offset: Vector3, x: number, y: number, pointer: number, moves: boolean} | null} */
    this.drag = null;
    /** Is called when a pointer takes hold of the tool. */
    this.taken = () => {};
    /** Speeds of a SpaceMouse, -1 to 1: three of translation, three of rotation. */
    this.mouse = [0, 0, 0, 0, 0, 0];
    this.#listen(scene.canvas);
  }

  /** @returns {number[]} the pose: tip, and a quaternion x, y, z, w */
  get pose() {
    return [...this.tip.toArray(), ...this.turn.toArray()];
  }

  /** Places the hand. */
  place(tip, turn = new Quaternion()) {
    this.tip.set(...tip);
    this.turn.copy(turn);
    this.stands = null;
    this.#grip();
  }

  #listen(canvas) {
    const at = (event) => [event.offsetX, event.offsetY];
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || this.drag || !this.scene.hits(...at(event))) return;
      const [x, y] = at(event);
      const hit = this.#onPlane(x, y);
      if (!hit) return;
      this.drag = { offset: this.tip.clone().sub(hit), x, y, pointer: event.pointerId, moves: false };
      this.taken();
      this.scene.orbit.enabled = false;
      canvas.setPointerCapture(event.pointerId);
    }, { capture: true });
    canvas.addEventListener('pointermove', (event) => {
      if (this.drag?.pointer !== event.pointerId) return;
      const [x, y] = at(event);
      // A click is no drag, even if the pointer trembles.
      if (!this.drag.moves && Math.hypot(x - this.drag.x, y - this.drag.y) < MIN_DRAG) return;
      const [dx, dy] = [x - this.drag.x, y - this.drag.y];
      Object.assign(this.drag, { x, y, moves: true });
      if (event.shiftKey) {
        const { right, up } = this.scene.directions();
        this.rotate(up, TURN * dx);
        this.rotate(right, TURN * dy);
        this.#grip();
      } else {
        const hit = this.#onPlane(x, y);
        if (hit) this.tip.copy(hit).add(this.drag.offset);
      }
    });
    for (const name of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(name, (event) => {
        if (this.drag?.pointer !== event.pointerId) return;
        const { moves } = this.drag;
        this.drag = null;
        this.scene.orbit.enabled = true;
        if (moves) this.release();
      });
    }
    canvas.addEventListener('wheel', (event) => {
      if (!this.drag && !this.scene.hits(...at(event))) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      const { away } = this.scene.directions();
      this.tip.addScaledVector(away, -event.deltaY * 0.25 * this.scene.pixel(this.tip.toArray()));
      this.#grip();
    }, { capture: true, passive: false });
    canvas.addEventListener('keydown', (event) => {
      const moves = {
        ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0],
        PageUp: [0, 0, 1], PageDown: [0, 0, -1],
      };
      const move = moves[event.key];
      if (!move) return;
      event.preventDefault();
      this.tip.addScaledVector(new Vector3(...move), STEP / this.millimetre);
    });
  }

  /** Lets go: the hand goes where the tool stands. */
  release() {
    if (this.stands) this.tip.set(...this.stands);
  }

  /** Turns the tool about its tip. */
  rotate(axis, angle) {
    this.turn.premultiply(new Quaternion().setFromAxisAngle(axis, angle)).normalize();
  }

  /** Keeps a hand that drags at its place on the tool, which has moved. */
  #grip() {
    const hit = this.drag && this.#onPlane(this.drag.x, this.drag.y);
    if (hit) this.drag.offset.copy(this.tip).sub(hit);
  }

  /** Returns where the ray at a position meets the plane through the tip that is parallel to the screen. */
  #onPlane(x, y) {
    const { ray } = this.scene.ray(x, y);
    const { away } = this.scene.directions();
    const reach = this.tip.clone().sub(ray.origin).dot(away) / ray.direction.dot(away);
    return Number.isFinite(reach) && reach > 0 ? ray.at(reach, new Vector3()) : null;
  }

  /**
   * Moves the hand as gamepad and SpaceMouse demand.
   * @param {number} seconds since the last call
   * @param {number} force on the hand, N, which a gamepad rumbles with
   */
  advance(seconds, force) {
    const pad = navigator.getGamepads?.().find((one) => one?.connected && one.axes.length >= 4);
    const dead = (value) => (Math.abs(value) < GAMEPAD.dead ? 0 : value);
    const speeds = [...this.mouse];
    if (pad) {
      const [x, y, spin, tilt] = pad.axes.map(dead);
      const lift = (pad.buttons[7]?.value ?? 0) - (pad.buttons[6]?.value ?? 0);
      [x, -y, lift, tilt, spin, 0].forEach((value, k) => { speeds[k] += value ?? 0; });
      const strength = Math.min(force / 8, 1);
      if (strength > 0.02 && pad.vibrationActuator && !(performance.now() < this.rumbles)) {
        this.rumbles = performance.now() + 80;
        pad.vibrationActuator.playEffect?.('dual-rumble', { duration: 100, strongMagnitude: strength, weakMagnitude: strength / 2 });
      }
    }
    if (speeds.every((value) => value === 0)) return;
    const { right, up, away } = this.scene.directions();
    const level = (vector) => vector.setZ(0).normalize();
    const forward = Math.abs(up.z) > 0.9 ? level(away.clone()) : level(up.clone());
    const reach = GAMEPAD.speed * this.scene.size * seconds;
    this.tip.addScaledVector(right, speeds[0] * reach).addScaledVector(forward, speeds[1] * reach);
    this.tip.z += speeds[2] * reach;
    const axes = [right, forward, new Vector3(0, 0, 1)];
    axes.forEach((axis, k) => this.rotate(axis, speeds[3 + k] * GAMEPAD.turn * seconds));
  }

  /** Asks for a SpaceMouse and listens to it. Resolves to its name. */
  async connectSpaceMouse() {
    if (!navigator.hid) throw new Error('this browser has no WebHID: take Chromium, Chrome or Edge for a SpaceMouse');
    const filters = [0x256f, 0x046d].map((vendorId) => ({ vendorId, usagePage: 1, usage: 8 }));
    const [device] = await navigator.hid.requestDevice({ filters });
    if (!device) throw new Error('no SpaceMouse was chosen');
    if (!device.opened) await device.open();
    device.addEventListener('inputreport', ({ reportId, data }) => {
      const counts = [0, 2, 4].map((at) => (data.byteLength >= at + 2 ? data.getInt16(at, true) / 350 : 0));
      // x to the right, y toward the user, z down; newer devices send all six in report 1.
      const place = ([x, y, z], from) => { this.mouse.splice(from, 3, x, -y, -z); };
      if (reportId === 1) {
        place(counts, 0);
        if (data.byteLength >= 12) place([6, 8, 10].map((at) => data.getInt16(at, true) / 350), 3);
      } else if (reportId === 2) {
        place(counts, 3);
      }
    });
    return device.productName;
  }
}
