// What the passes of the material do with the formulas: the line of sight of a fragment, its shift and its opacity.
#define_import_path parbake::parallax_seen

#import bevy_pbr::{
    mesh_view_bindings::view,
    pbr_bindings,
    pbr_functions::calculate_view,
}
#import parbake::parallax::{Parallax, line_of_sight, fade_of, faded_opacity, shift_at, opacity_at}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> numbers: Parallax;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var shift_map: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var shift_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var cutout_map: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(104) var cutout_sampler: sampler;

struct Seen {
    // To be added to the mesh's coordinates.
    shift: vec2<f32>,
    // Below 0 the fragment is to be discarded.
    opacity: f32,
}

/// uv is the mesh's coordinate, normal and tangent the interpolated ones. The viewer is that of the pass: in shadow passes
/// the light.
fn seen_at(uv: vec2<f32>, position: vec4<f32>, normal: vec3<f32>, tangent: vec4<f32>) -> Seen {
    let to_viewer = calculate_view(position, view.clip_from_view[3].w == 1.0);
    let line = line_of_sight(to_viewer, normal, tangent);
    let transform = pbr_bindings::material.uv_transform;
    let t = (transform * vec3<f32>(uv, 1.0)).xy;
    let fade = fade_of(dpdx(t), dpdy(t), line.z, numbers.fade_footprint);
    let moved = fade * shift_at(shift_map, shift_sampler, t, line, numbers);

    var seen: Seen;
    // StandardMaterial transforms coordinates itself, so the shift goes the other way before.
    let a = transform[0].xy;
    let b = transform[1].xy;
    seen.shift = vec2<f32>(moved.x * b.y - moved.y * b.x, moved.y * a.x - moved.x * a.y) / (a.x * b.y - a.y * b.x);
    seen.opacity = 1.0;
#ifdef PARALLAX_CUTOUT
    seen.opacity = faded_opacity(opacity_at(cutout_map, cutout_sampler, t, line, numbers), fade);
#endif
    return seen;
}
