//! Materials that ask for blending or for a cutout where nothing is to be seen through: an exporter's default.
//!
//! Of what is blended, viewers write no depth, so that the triangles of one mesh are drawn over each other in the order
//! of the file: backs show before fronts. What is opaque all over is therefore baked as opaque. A material is, if its
//! factor, its vertices' colours and the texels that its triangles cover let nothing through.
//!
//! Contract: one transparent texel inside a triangle keeps the alpha mode.

use crate::named::named;
use parbake_image::pyramid::taps;
use parbake_model::glam::Vec2;
use parbake_model::{AlphaMode, Image, Material, Mesh, Model, TextureSlot};
use std::borrow::Cow;

/// Opacity from which on nothing shows through.
const OPAQUE: f32 = 0.98;

/// Triangles that cover more texture than this many times its width are asked as the whole image.
const MOST_REPEATS: f32 = 2.0;

/// The materials of a model with the alpha modes that have an effect, and a sentence where that is not as the model
/// has them.
pub fn with_alpha_in_effect(model: &Model) -> (Cow<'_, [Material]>, Option<String>) {
    let asks = |material: &Material| material.alpha_mode != AlphaMode::Opaque;
    if !model.materials.iter().any(asks) {
        return (Cow::Borrowed(&model.materials), None);
    }
    let mut triangles: Vec<Vec<usize>> = vec![Vec::new(); model.materials.len()];
    for (triangle, &material) in model.mesh.triangle_materials.iter().enumerate() {
        if asks(&model.materials[material as usize]) {
            triangles[material as usize].push(triangle);
        }
    }
    let is_opaque: Vec<bool> = model
        .materials
        .iter()
        .zip(&triangles)
        .map(|(material, own)| !own.is_empty() && is_opaque(material, own, model))
        .collect();
    let changed = || model.materials.iter().zip(&is_opaque).filter(|(_, is_opaque)| **is_opaque);
    if changed().next().is_none() {
        return (Cow::Borrowed(&model.materials), None);
    }
    let settled = model.materials.iter().zip(&is_opaque).map(|(own, is_opaque)| match is_opaque {
        true => Material { alpha_mode: AlphaMode::Opaque, ..own.clone() },
        false => own.clone(),
    });
    let names = named(changed().map(|(material, _)| material.name.as_str()));
    let told = format!("set to blend or to cut out, but nothing shows through, so baked as opaque: {names}");
    (Cow::Owned(settled.collect()), Some(told))
}

/// Whether nothing shows through these triangles of this material.
fn is_opaque(material: &Material, triangles: &[usize], model: &Model) -> bool {
    let mesh = &model.mesh;
    let of_vertices = |triangle: &usize| {
        mesh.triangles[*triangle].iter().filter_map(|&i| mesh.colors.get(i as usize)).map(|color| color.w)
    };
    let factor = material.base_color[3] * triangles.iter().flat_map(of_vertices).fold(1.0, f32::min);
    let least = match material.alpha_mode {
        AlphaMode::Mask => material.alpha_cutoff,
        AlphaMode::Blend | AlphaMode::Opaque => OPAQUE,
    };
    let shown = |alpha: u8| f32::from(alpha) / 255.0 * factor >= least;
    let Some(slot) = material.base_color_texture else { return factor >= least };
    let Some(image) = model.images.get(slot.image) else { return factor >= least };
    image.pixels.iter().all(|pixel| shown(pixel[3]))
        || triangles.iter().all(|&triangle| covers(mesh, triangle, &slot, image, &shown))
}

/// Whether all texels that a triangle covers are `shown`.
fn covers(
    mesh: &Mesh,
    triangle: usize,
    slot: &TextureSlot,
    image: &Image,
    shown: &impl Fn(u8) -> bool,
) -> bool {
    let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
    let uvs = mesh.triangles[triangle].map(|i| set.get(i as usize).copied().unwrap_or_default());
    let [a, b, c] = uvs.map(|uv| slot.transform.apply(uv));
    let (right, down) = (b - a, c - a);
    let reach = right.abs().max(down.abs()).max((c - b).abs());
    if !reach.is_finite() || reach.max_element() > MOST_REPEATS {
        return false;
    }
    let texels = reach * Vec2::new(image.width as f32, image.height as f32);
    // Two points a texel, in the middles of as many small triangles.
    let steps = (2.0 * texels.max_element()).ceil().max(1.0) as usize;
    let along = |step: usize| (step as f32 + 1.0 / 3.0) / steps as f32;
    (0..steps).all(|row| {
        (0..steps - row).all(|column| {
            let at =
                taps(a + right * along(column) + down * along(row), image.width, image.height, slot.wrap);
            let nearest = usize::from(at.fx >= 0.5) + 2 * usize::from(at.fy >= 0.5);
            shown(image.pixels[at.index[nearest] as usize][3])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec4;

    /// A blended square on the left half of an image whose right half is transparent.
    fn square() -> Model {
        let uvs = [(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0)].map(|(u, v)| Vec2::new(u, v));
        let mesh = Mesh {
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let slot = TextureSlot { image: 0, ..TextureSlot::default() };
        let material = Material {
            name: "leaf".into(),
            alpha_mode: AlphaMode::Blend,
            base_color_texture: Some(slot),
            ..Material::default()
        };
        let alpha = |texel: usize| if texel % 8 < 4 { 255 } else { 0 };
        let pixels = (0..64).map(|texel| [255, 255, 255, alpha(texel)]).collect();
        let image = Image { name: "leaf".into(), width: 8, height: 8, pixels };
        Model { mesh, materials: vec![material], images: vec![image], ..Model::default() }
    }

    fn mode(model: &Model) -> AlphaMode {
        with_alpha_in_effect(model).0[0].alpha_mode
    }

    /// Protects models whose exporter marks everything as blended: they are baked as what they show.
    #[test]
    fn what_lets_nothing_through_is_opaque() {
        let mut model = square();
        let (materials, told) = with_alpha_in_effect(&model);
        assert_eq!(materials[0].alpha_mode, AlphaMode::Opaque);
        assert!(told.is_some_and(|text| text.ends_with("baked as opaque: \"leaf\"")));
        model.materials[0].alpha_mode = AlphaMode::Mask;
        model.materials[0].alpha_cutoff = 0.5;
        assert_eq!(mode(&model), AlphaMode::Opaque);
        model.materials[0].base_color_texture = None;
        assert_eq!(mode(&model), AlphaMode::Opaque);
        model.materials[0].alpha_mode = AlphaMode::Opaque;
        assert_eq!(with_alpha_in_effect(&model), (Cow::Borrowed(&model.materials[..]), None));
    }

    /// Protects glass, leaves and fading vertices: one texel, a factor or one vertex keeps the mode.
    #[test]
    fn what_lets_something_through_stays() {
        let mut model = square();
        model.images[0].pixels[27][3] = 200;
        assert_eq!(mode(&model), AlphaMode::Blend);
        let mut model = square();
        model.mesh.uvs[1].x = 0.7;
        assert_eq!(mode(&model), AlphaMode::Blend);
        let mut model = square();
        model.materials[0].base_color[3] = 0.9;
        assert_eq!(mode(&model), AlphaMode::Blend);
        let mut model = square();
        model.mesh.colors = vec![Vec4::ONE, Vec4::ONE, Vec4::ONE, Vec4::new(1.0, 1.0, 1.0, 0.5)];
        assert_eq!(mode(&model), AlphaMode::Blend);
        let mut model = square();
        model.mesh.uvs[2] = Vec2::splat(f32::INFINITY);
        assert_eq!(mode(&model), AlphaMode::Blend);
    }
}
