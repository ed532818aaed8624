// Passes of depth: shadows, whose viewer is the light, and the camera's prepass, with its normals and motion.
#import bevy_pbr::{
    mesh_view_bindings::view,
    pbr_bindings,
    pbr_functions,
    pbr_prepass_functions::prepass_alpha_discard,
    pbr_types,
    prepass_io::{FragmentOutput, VertexOutput},
}
#ifdef MOTION_VECTOR_PREPASS
#import bevy_pbr::pbr_prepass_functions::calculate_motion_vector
#endif
#ifdef PARALLAX
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
#import parbake::parallax_seen::seen_at
#endif
#endif

/// Discards what is not there; gives the fragment with shifted coordinates.
fn shifted(vertex: VertexOutput) -> VertexOutput {
    var in = vertex;
#ifdef PARALLAX
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
#ifdef PARALLAX_UV_B
    let seen = seen_at(in.uv_b, in.world_position, in.world_normal, in.world_tangent);
#else
    let seen = seen_at(in.uv, in.world_position, in.world_normal, in.world_tangent);
#endif
#ifdef VERTEX_UVS_A
    in.uv += seen.shift;
#endif
#ifdef VERTEX_UVS_B
    in.uv_b += seen.shift;
#endif
    if seen.opacity < 0.0 {
        discard;
    }
#endif
#endif
    let mode = pbr_bindings::material.flags & pbr_types::STANDARD_MATERIAL_FLAGS_ALPHA_MODE_RESERVED_BITS;
    // Alpha to coverage is for borders of cutouts alone.
    if mode != pbr_types::STANDARD_MATERIAL_FLAGS_ALPHA_MODE_ALPHA_TO_COVERAGE {
        prepass_alpha_discard(in);
    }
    return in;
}

#ifdef PREPASS_FRAGMENT
@fragment
fn fragment(vertex: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    let in = shifted(vertex);
    var out: FragmentOutput;
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.frag_depth = in.unclipped_depth;
#endif
#ifdef NORMAL_PREPASS
    out.normal = vec4<f32>(normal_of(in, is_front) * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTOR_PREPASS
    out.motion_vector = calculate_motion_vector(in.world_position, in.previous_world_position);
#endif
    return out;
}
#else
@fragment
fn fragment(vertex: VertexOutput) {
    _ = shifted(vertex);
}
#endif

#ifdef NORMAL_PREPASS
fn normal_of(in: VertexOutput, is_front: bool) -> vec3<f32> {
    let flags = pbr_bindings::material.flags;
    let double_sided = (flags & pbr_types::STANDARD_MATERIAL_FLAGS_DOUBLE_SIDED_BIT) != 0u;
    let normal = pbr_functions::prepare_world_normal(in.world_normal, double_sided, is_front);
#ifdef VERTEX_UVS
#ifdef VERTEX_TANGENTS
#ifdef STANDARD_MATERIAL_NORMAL_MAP
#ifdef STANDARD_MATERIAL_NORMAL_MAP_UV_B
    let uv = (pbr_bindings::material.uv_transform * vec3<f32>(in.uv_b, 1.0)).xy;
#else
    let uv = (pbr_bindings::material.uv_transform * vec3<f32>(in.uv, 1.0)).xy;
#endif
    let bump = textureSampleBias(
        pbr_bindings::normal_map_texture,
        pbr_bindings::normal_map_sampler,
        uv,
        view.mip_bias,
    ).rgb;
    let frame = pbr_functions::calculate_tbn_mikktspace(normal, in.world_tangent);
    return pbr_functions::apply_normal_mapping(flags, frame, double_sided, is_front, bump);
#endif
#endif
#endif
    return normal;
}
#endif
