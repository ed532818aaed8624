// The material in the main pass, and in the deferred one: Bevy's own, with shifted coordinates, where it is not cut out.
#import bevy_pbr::{
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::alpha_discard,
    pbr_types,
}
#ifdef PREPASS_PIPELINE
#import bevy_pbr::{
    pbr_deferred_functions::deferred_output,
    prepass_io::{FragmentOutput, VertexOutput},
}
#else
#import bevy_pbr::{
    forward_io::{FragmentOutput, VertexOutput},
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
}
#endif
#ifdef PARALLAX
#import parbake::parallax::coverage_of
#import parbake::parallax_seen::seen_at
#endif

@fragment
fn fragment(vertex: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    var in = vertex;
    var coverage = 1.0;
#ifdef PARALLAX
#ifdef PARALLAX_UV_B
    let seen = seen_at(in.uv_b, in.world_position, in.world_normal, in.world_tangent);
#else
    let seen = seen_at(in.uv, in.world_position, in.world_normal, in.world_tangent);
#endif
#ifdef PARALLAX_CUTOUT
#ifdef ALPHA_TO_COVERAGE
    // Before anything is discarded, since it looks at neighbours.
    coverage = coverage_of(seen.opacity, fwidth(seen.opacity));
    let is_there = coverage > 0.0;
#else
    let is_there = seen.opacity >= 0.0;
#endif
#endif
#ifdef VERTEX_UVS_A
    in.uv += seen.shift;
#endif
#ifdef VERTEX_UVS_B
    in.uv_b += seen.shift;
#endif
#endif

    var pbr_input = pbr_input_from_standard_material(in, is_front);

#ifdef PARALLAX_CUTOUT
    // After the material's fetches, which have derivatives.
    if !is_there {
        discard;
    }
#endif
    let mode = pbr_input.material.flags & pbr_types::STANDARD_MATERIAL_FLAGS_ALPHA_MODE_RESERVED_BITS;
    if mode == pbr_types::STANDARD_MATERIAL_FLAGS_ALPHA_MODE_ALPHA_TO_COVERAGE {
        // It was opaque: what alpha its texture has does not count.
        pbr_input.material.base_color.a = coverage;
    }
    pbr_input.material.base_color = alpha_discard(pbr_input.material, pbr_input.material.base_color);

#ifdef PREPASS_PIPELINE
    return deferred_output(in, pbr_input);
#else
    var out: FragmentOutput;
    out.color = main_pass_post_lighting_processing(pbr_input, apply_pbr_lighting(pbr_input));
    return out;
#endif
}
