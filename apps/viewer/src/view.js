// The camera: a direction, a distance and a point that it looks at, in the common frame (the reference model's box
// lies in [-1, 1]³, as in parbake's own views).
import { PerspectiveCamera, Vector3 } from './vendor.js';

export const FOV = 43.602818;
const FAR = 400, NEAR = 0.02, UP = 1.55;

export class View {
  constructor() {
    this.camera = new PerspectiveCamera(FOV, 1, 0.05, 50);
    this.azimuth = 0.5;
    this.elevation = 0.3;
    this.distance = 3.5;
    this.target = new Vector3();
    this.radius = 1;
  }

  /** Half the angle of the view's shorter side. */
  halfAngle() { return (FOV / 2) * (Math.PI / 180); }

  /** Turns by angles in radians. */
  orbit(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.min(UP, Math.max(-UP, this.elevation + elevation));
  }

  zoom(factor) { this.distance = Math.min(FAR, Math.max(NEAR, this.distance * factor)); }

  /** Moves along the picture, by shares of its shorter side. */
  pan(x, y) {
    const length = 2 * Math.tan(this.halfAngle()) * this.distance;
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    this.target.addScaledVector(right, -x * length).addScaledVector(up, y * length);
  }

  /** The whole model, from where it is seen now. */
  fit() {
    this.target.set(0, 0, 0);
    this.distance = (this.radius / Math.sin(this.halfAngle())) * 1.08;
  }

  /** Pixels that the model's bounding sphere spans on a screen whose shorter side has so many. */
  pixels(shorter) {
    const d = Math.max(this.distance, this.radius * 1.0001);
    return (shorter * this.radius) / (Math.tan(this.halfAngle()) * Math.sqrt(d * d - this.radius * this.radius));
  }

  /** Stands where the model spans so many pixels. */
  setPixels(pixels, shorter) {
    const k = shorter / (pixels * Math.tan(this.halfAngle()));
    this.distance = this.radius * Math.sqrt(1 + k * k);
  }

  /** three.js's camera for a picture of this aspect. */
  at(aspect) {
    const { camera, distance } = this;
    const direction = new Vector3(
      Math.sin(this.azimuth) * Math.cos(this.elevation), Math.sin(this.elevation),
      Math.cos(this.azimuth) * Math.cos(this.elevation),
    );
    camera.aspect = aspect;
    // The angle is that of the shorter side, so that models fit on upright screens.
    camera.fov = aspect >= 1 ? FOV : 2 * Math.atan(Math.tan(this.halfAngle()) / aspect) * (180 / Math.PI);
    camera.position.copy(this.target).addScaledVector(direction, distance);
    camera.lookAt(this.target);
    const reach = this.radius * 1.5 + this.target.length();
    camera.near = Math.max(distance - reach, distance * 0.01, 1e-3);
    camera.far = distance + reach;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    return camera;
  }
}
