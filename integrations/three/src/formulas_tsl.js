// The formulas of the format as nodes of three.js' shading language; in GLSL they are in glsl.js, with what they are for.
// All vectors are in view space.
import { dFdx, dFdy, float, sign, texture, vec2, vec3, vec4 } from 'three/tsl';

/** The line of sight in the frame [tangent, bitangent, normal]: the same from either of its ends. */
export function line(toViewer, frame) {
  const w = vec3(...frame.map((axis) => toViewer.dot(axis))).toVar();
  return w.z.lessThan(0).select(w.negate(), w);
}

/** Four pairs of coefficients, of x, y, xz and yz. */
export function shift([first, second], w, limit) {
  const pairs = first.add(second.mul(w.z)).toVar();
  return pairs.xy.mul(w.x).add(pairs.zw.mul(w.y)).div(w.z.max(limit));
}

/** Twelve coefficients, of functions that are orthonormal over the hemisphere. */
export function opacity([a, b, c], w) {
  const { x, y, z } = w, square = z.mul(z);
  const two = vec2(x.mul(x).sub(y.mul(y)), x.mul(y).mul(2)).toVar();
  const three = vec2(x.mul(two.x).sub(y.mul(two.y)), x.mul(two.y).add(y.mul(two.x)));
  const rings = vec4(
    1, z.mul(2).sub(1), square.sub(z).mul(6).add(1), z.mul(20).sub(30).mul(square).add(z.mul(12)).sub(1),
  );
  const first = vec4(w.xy, w.xy.mul(z.sub(0.375)));
  return a.mul(vec4(1, 1.7320508, 2.236068, 2.6457513)).dot(rings)
    .add(b.mul(vec4(1.7320508, 1.7320508, 7.108338, 7.108338)).dot(first))
    .add(c.mul(vec4(1.9364917, 1.9364917, 2.0916501, 2.0916501)).dot(vec4(two, three)));
}

/** How much of the map is left under a pixel that spans these gradients; z brings them to what they are face on. */
export const fade = (dx, dy, z, footprint) => float(2).sub(z.mul(dx.length().max(dy.length())).div(footprint)).clamp(0, 1);

/** Coefficients of an image at t. Layers lie one below the other; `rows` are those of a layer and of the image. */
export function coefficients(image, t, rows, scale, offset) {
  return scale.map((factor, layer) => {
    const row = t.y.mul(rows.x).clamp(0.5, rows.x.sub(0.5)).add(rows.x.mul(layer));
    return texture(image, vec2(t.x, row.div(rows.y)), 0).mul(factor).add(offset[layer]);
  });
}

/** A tangent along u, against v, which grows downwards, and the normal, of how the picture's coordinates change. */
export function derivedFrame(n, position, uv) {
  const [px, py, ux, uy] = [dFdx(position), dFdy(position), dFdx(uv), dFdy(uv)].map((node) => node.toVar());
  const side = sign(ux.x.mul(uy.y).sub(uy.x.mul(ux.y)));
  const alongU = px.mul(uy.y).sub(py.mul(ux.y)).mul(side), alongV = py.mul(ux.x).sub(px.mul(uy.x)).mul(side);
  const t = alongU.sub(n.mul(n.dot(alongU))).toVar();
  const unit = t.mul(t.dot(t).max(1e-30).inverseSqrt()).toVar();
  const across = n.cross(unit).toVar();
  return [unit, across.dot(alongV).greaterThan(0).select(across.negate(), across), n];
}

/** The same with the tangent of the vertices, and their handedness. */
export function vertexFrame(n, tangent, side) {
  const unit = tangent.sub(n.mul(n.dot(tangent))).normalize().toVar();
  return [unit, n.cross(unit).mul(side), n];
}
