// The formulas of PARBAKE_materials_parallax, version 2, in WGSL. All functions are pure but for fetches from the
// maps; vectors are in any one space, texture coordinates have v downwards.
#define_import_path parbake::parallax

/// The extension's numbers. Without a cutout its are not used; without a fade the footprint is a large number.
struct Parallax {
    shift_scale: array<vec4<f32>, 2>,
    shift_offset: array<vec4<f32>, 2>,
    cutout_scale: array<vec4<f32>, 3>,
    cutout_offset: array<vec4<f32>, 3>,
    limit: f32,
    fade_footprint: f32,
}

/// The line of sight in the frame (tangent, bitangent, normal): the same from either of its ends. tangent.w is negated
/// where the node mirrors; the normal is the vertices', whatever side is seen.
fn line_of_sight(to_viewer: vec3<f32>, normal: vec3<f32>, tangent: vec4<f32>) -> vec3<f32> {
    let n = normalize(normal);
    let t = normalize(tangent.xyz - n * dot(n, tangent.xyz));
    let b = cross(n, t) * tangent.w;
    let line = vec3<f32>(dot(to_viewer, t), dot(to_viewer, b), dot(to_viewer, n));
    return select(line, -line, line.z < 0.0);
}

/// Four pairs of coefficients, of x, y, xz and yz, in texture widths and heights.
fn shift_of(first: vec4<f32>, second: vec4<f32>, line: vec3<f32>, limit: f32) -> vec2<f32> {
    let pairs = first + second * line.z;
    return (pairs.xy * line.x + pairs.zw * line.y) / max(line.z, limit);
}

/// Twelve coefficients, of functions that are orthonormal over the hemisphere.
fn opacity_of(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, line: vec3<f32>) -> f32 {
    let z = line.z;
    let square = z * z;
    let two = vec2<f32>(line.x * line.x - line.y * line.y, 2.0 * line.x * line.y);
    let three = vec2<f32>(line.x * two.x - line.y * two.y, line.x * two.y + line.y * two.x);
    let rings = vec4<f32>(
        1.0,
        1.7320508 * (2.0 * z - 1.0),
        2.236068 * (6.0 * (square - z) + 1.0),
        2.6457513 * ((20.0 * z - 30.0) * square + 12.0 * z - 1.0),
    );
    let wave = vec4<f32>(1.7320508 * line.xy, 7.108338 * (z - 0.375) * line.xy);
    let waves = vec4<f32>(1.9364917 * two, 2.09165 * three);
    return dot(a, rings) + dot(b, wave) + dot(c, waves);
}

/// How much of the maps is left under a pixel with these gradients of the coordinate; z makes them those of a surface
/// that is seen face on.
fn fade_of(along: vec2<f32>, down: vec2<f32>, z: f32, footprint: f32) -> f32 {
    return clamp(2.0 - z * max(length(along), length(down)) / footprint, 0.0, 1.0);
}

/// The opacity under a fade. The fragment is to be discarded where it is negative.
fn faded_opacity(opacity: f32, fade: f32) -> f32 {
    return 1.0 + fade * (opacity - 1.0);
}

/// How much of a pixel is covered, for alpha to coverage. The width is that of the opacity's change from pixel to
/// pixel, bounded since past the edge of a triangle it is any number.
fn coverage_of(opacity: f32, width: f32) -> f32 {
    return clamp(0.5 + opacity / clamp(width, 1e-6, 10.0), 0.0, 1.0);
}

/// The shift at t, from a map of two layers.
fn shift_at(
    map: texture_2d_array<f32>,
    map_sampler: sampler,
    t: vec2<f32>,
    line: vec3<f32>,
    numbers: Parallax,
) -> vec2<f32> {
    let first = textureSampleLevel(map, map_sampler, t, 0, 0.0);
    let second = textureSampleLevel(map, map_sampler, t, 1, 0.0);
    return shift_of(
        numbers.shift_offset[0] + numbers.shift_scale[0] * first,
        numbers.shift_offset[1] + numbers.shift_scale[1] * second,
        line,
        numbers.limit,
    );
}

/// The opacity at t, from a map of three layers.
fn opacity_at(
    map: texture_2d_array<f32>,
    map_sampler: sampler,
    t: vec2<f32>,
    line: vec3<f32>,
    numbers: Parallax,
) -> f32 {
    let a = textureSampleLevel(map, map_sampler, t, 0, 0.0);
    let b = textureSampleLevel(map, map_sampler, t, 1, 0.0);
    let c = textureSampleLevel(map, map_sampler, t, 2, 0.0);
    return opacity_of(
        numbers.cutout_offset[0] + numbers.cutout_scale[0] * a,
        numbers.cutout_offset[1] + numbers.cutout_scale[1] * b,
        numbers.cutout_offset[2] + numbers.cutout_scale[2] * c,
        line,
    );
}
