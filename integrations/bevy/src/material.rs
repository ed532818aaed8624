//! The material: Bevy's `StandardMaterial`, whose texture coordinates shift, and whose fragments may not be there.

use crate::format::ParallaxJson;
use bevy::asset::{AssetPath, embedded_path};
use bevy::mesh::MeshVertexBufferLayoutRef;
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError,
};
use bevy::shader::{ShaderDefVal, ShaderRef};

/// A `StandardMaterial` with parallax maps.
pub type ParallaxMaterial = ExtendedMaterial<StandardMaterial, ParallaxExtension>;

/// What the extension adds to a material.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug, Default)]
#[bind_group_data(ParallaxKey)]
pub struct ParallaxExtension {
    /// Scales, offsets and limits.
    #[uniform(100)]
    pub numbers: ParallaxNumbers,
    /// The shift's coefficients: two layers, linear, clamped. Without them nothing shifts and nothing is cut out.
    #[texture(101, dimension = "2d_array")]
    #[sampler(102)]
    pub shift: Option<Handle<Image>>,
    /// The cutout's coefficients: three layers. Without them nothing is cut out.
    #[texture(103, dimension = "2d_array")]
    #[sampler(104)]
    pub cutout: Option<Handle<Image>>,
    /// The coordinate is the second set of the mesh: that of the base colour, or of the normals without one.
    pub is_second_uv: bool,
}

/// The extension's numbers, as `parallax.wgsl` has them.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
pub struct ParallaxNumbers {
    /// Ranges of the shift's channels.
    pub shift_scale: [Vec4; 2],
    /// Values of the shift's channels where 0 is stored.
    pub shift_offset: [Vec4; 2],
    /// Ranges of the cutout's channels.
    pub cutout_scale: [Vec4; 3],
    /// Values of the cutout's channels where 0 is stored.
    pub cutout_offset: [Vec4; 3],
    /// The least cosine that a shift is divided by.
    pub limit: f32,
    /// The footprint of a pixel at which the maps begin to fade.
    pub fade_footprint: f32,
}

/// What shaders are compiled for.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParallaxKey {
    is_active: bool,
    is_cut: bool,
    is_second_uv: bool,
}

impl From<&ParallaxExtension> for ParallaxKey {
    fn from(extension: &ParallaxExtension) -> Self {
        let is_active = extension.shift.is_some();
        Self {
            is_active,
            is_cut: is_active && extension.cutout.is_some(),
            is_second_uv: extension.is_second_uv,
        }
    }
}

impl From<&ParallaxJson> for ParallaxNumbers {
    fn from(json: &ParallaxJson) -> Self {
        let vector = |list: &[f32], i: usize| Vec4::from_slice(&list[4 * i..]);
        let (_, scale, offset) = json.cutout.unwrap_or_default();
        Self {
            shift_scale: [0, 1].map(|i| vector(&json.scale, i)),
            shift_offset: [0, 1].map(|i| vector(&json.offset, i)),
            cutout_scale: [0, 1, 2].map(|i| vector(&scale, i)),
            cutout_offset: [0, 1, 2].map(|i| vector(&offset, i)),
            limit: json.limit,
            fade_footprint: json.fade_footprint,
        }
    }
}

fn embedded(path: std::path::PathBuf) -> ShaderRef {
    AssetPath::from_path_buf(path).with_source("embedded").into()
}

impl MaterialExtension for ParallaxExtension {
    fn fragment_shader() -> ShaderRef {
        embedded(embedded_path!("parallax_material.wgsl"))
    }

    fn deferred_fragment_shader() -> ShaderRef {
        Self::fragment_shader()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        embedded(embedded_path!("parallax_prepass.wgsl"))
    }

    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let ParallaxKey { is_active, is_cut, is_second_uv } = key.bind_group_data;
        let uv = if is_second_uv { Mesh::ATTRIBUTE_UV_1 } else { Mesh::ATTRIBUTE_UV_0 };
        // Without tangents the line of sight cannot be told.
        if !is_active
            || ![Mesh::ATTRIBUTE_NORMAL, Mesh::ATTRIBUTE_TANGENT, uv].iter().all(|&a| layout.0.contains(a))
        {
            return Ok(());
        }
        let mut defs = vec!["PARALLAX".into()];
        if is_cut {
            defs.push("PARALLAX_CUTOUT".into());
        }
        if is_second_uv {
            defs.push("PARALLAX_UV_B".into());
        }
        // Bevy's passes of depth alone have no normals, and the line of sight needs them.
        let frame: ShaderDefVal = "NORMAL_PREPASS_OR_DEFERRED_PREPASS".into();
        let vertex = &mut descriptor.vertex;
        if is_cut
            && vertex.shader_defs.contains(&"PREPASS_PIPELINE".into())
            && !vertex.shader_defs.contains(&frame)
        {
            defs.extend([frame, "VERTEX_NORMALS".into(), "VERTEX_TANGENTS".into()]);
            let attributes =
                [Mesh::ATTRIBUTE_NORMAL.at_shader_location(3), Mesh::ATTRIBUTE_TANGENT.at_shader_location(4)];
            let added = layout.0.get_layout(&attributes)?;
            if let Some(buffer) = vertex.buffers.first_mut() {
                buffer.attributes.extend(added.attributes);
            }
        }
        vertex.shader_defs.extend(defs.iter().cloned());
        if let Some(fragment) = &mut descriptor.fragment {
            fragment.shader_defs.extend(defs);
        }
        Ok(())
    }
}
