//! Models and meshes built from any bytes: small ones that keep their contracts, with
//! coordinates on a coarse lattice (where triangles touch and coincide) or of any size.

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::arbitrary;
use parbake_model::glam::{DVec3, Vec2, Vec3, Vec4};
use parbake_model::{AlphaMode, Image, Material, Mesh, Model, TextureSlot, UvTransform, Wrap};

/// A model of at most 16 vertices, 24 triangles, three materials and three pictures,
/// with any attributes. No parallax maps.
///
/// # Errors
/// Where bytes cannot be read as what is wanted; that is no fault.
pub fn model(bytes: &mut Unstructured) -> Result<Model> {
    let images = (0..bytes.int_in_range(0..=3)?).map(|_| image(bytes)).collect::<Result<Vec<_>>>()?;
    let materials =
        (0..bytes.int_in_range(1..=3)?).map(|_| material(bytes, images.len())).collect::<Result<Vec<_>>>()?;
    let mut mesh = mesh(bytes)?;
    for material in &mut mesh.triangle_materials {
        *material = bytes.int_in_range(0..=materials.len() as u32 - 1)?;
    }
    let count = mesh.positions.len();
    if bytes.arbitrary()? {
        mesh.normals = (0..count).map(|_| unit(bytes)).collect::<Result<_>>()?;
        if bytes.arbitrary()? {
            let tangent =
                |n: &Vec3| Ok(n.any_orthonormal_vector().extend(if bytes.arbitrary()? { 1.0 } else { -1.0 }));
            mesh.tangents = mesh.normals.iter().map(tangent).collect::<Result<_>>()?;
        }
    }
    if bytes.arbitrary()? {
        mesh.uvs1 = (0..count).map(|_| uv(bytes)).collect::<Result<_>>()?;
    } else if bytes.arbitrary()? {
        mesh.uvs.clear();
    }
    if bytes.arbitrary()? {
        let color = |_| Ok(Vec4::from([share(bytes)?, share(bytes)?, share(bytes)?, share(bytes)?]));
        mesh.colors = (0..count).map(color).collect::<Result<_>>()?;
    }
    Ok(Model { name: "fuzz".into(), mesh, materials, images, ..Model::default() })
}

/// A mesh of positions, texture coordinates and triangles of one material.
///
/// # Errors
/// As [`model`].
pub fn mesh(bytes: &mut Unstructured) -> Result<Mesh> {
    let count = bytes.int_in_range(3..=16u32)?;
    let triangles = (0..bytes.int_in_range(1..=24)?)
        .map(|_| {
            let mut corner = || bytes.int_in_range(0..=count - 1);
            Ok([corner()?, corner()?, corner()?])
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Mesh {
        positions: (0..count)
            .map(|_| Ok(Vec3::new(number(bytes)?, number(bytes)?, number(bytes)?)))
            .collect::<Result<_>>()?,
        uvs: (0..count).map(|_| uv(bytes)).collect::<Result<_>>()?,
        triangle_materials: vec![0; triangles.len()],
        triangles,
        ..Mesh::default()
    })
}

/// A number on a lattice of eighths, or any finite one.
fn number(bytes: &mut Unstructured) -> Result<f32> {
    if bytes.ratio(7, 8)? {
        return Ok(f32::from(bytes.arbitrary::<i8>()?) / 8.0);
    }
    Ok(Some(f32::from_bits(bytes.arbitrary()?)).filter(|x| x.is_finite()).unwrap_or_default())
}

fn uv(bytes: &mut Unstructured) -> Result<Vec2> {
    Ok(Vec2::new(number(bytes)?, number(bytes)?))
}

/// From 0 to 1.
fn share(bytes: &mut Unstructured) -> Result<f32> {
    Ok(f32::from(bytes.arbitrary::<u16>()?) / 65_535.0)
}

fn unit(bytes: &mut Unstructured) -> Result<Vec3> {
    let v = DVec3::new(number(bytes)?.into(), number(bytes)?.into(), number(bytes)?.into());
    Ok(v.try_normalize().unwrap_or(DVec3::Y).as_vec3())
}

fn image(bytes: &mut Unstructured) -> Result<Image> {
    let (width, height) = (bytes.int_in_range(1..=4)?, bytes.int_in_range(1..=4)?);
    let pixels = (0..width * height).map(|_| bytes.arbitrary()).collect::<Result<_>>()?;
    Ok(Image { name: "picture".into(), width, height, pixels })
}

fn material(bytes: &mut Unstructured, images: usize) -> Result<Material> {
    let letters = bytes.int_in_range(0..=4)?;
    let name = (0..letters).map(|_| bytes.arbitrary::<char>()).collect::<Result<_>>()?;
    let plain: bool = bytes.arbitrary()?;
    let mut base_color = [1.0; 4];
    if !plain {
        for x in &mut base_color {
            *x = share(bytes)?;
        }
    }
    Ok(Material {
        name,
        base_color,
        base_color_texture: slot(bytes, images)?,
        normal_texture: slot(bytes, images)?,
        normal_scale: number(bytes)?,
        alpha_mode: *bytes.choose(&[AlphaMode::Opaque, AlphaMode::Mask, AlphaMode::Blend])?,
        ..Material::default()
    })
}

fn slot(bytes: &mut Unstructured, images: usize) -> Result<Option<TextureSlot>> {
    if images == 0 || bytes.arbitrary()? {
        return Ok(None);
    }
    let image = bytes.int_in_range(0..=images - 1)?;
    if bytes.arbitrary()? {
        return Ok(Some(TextureSlot { image, ..TextureSlot::default() }));
    }
    let mut wrap = || Ok(*bytes.choose(&[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp])?);
    let wrap = [wrap()?, wrap()?];
    let uv_set = bytes.int_in_range(0..=1)?;
    let transform = UvTransform { offset: uv(bytes)?, rotation: number(bytes)?, scale: uv(bytes)? };
    Ok(Some(TextureSlot { image, uv_set, wrap, transform }))
}
