//! Materials without lighting (`KHR_materials_unlit`) beside others that are lit: screens, signs, skies.
//!
//! A bake has one material for each layer, and that is lit or is not. Where all of the high-poly's are unlit, so are
//! those of the bake. Where only some are, these become emission of their base colour on a black surface without
//! reflections, which looks the same under any light.
//!
//! Contract: vertex colours multiply base colours alone, so of a mesh that has some nothing is changed; the warning
//! tells which of both happened.

use crate::named::named;
use parbake_model::{AlphaMode, Material, MaterialExtensions, Mesh, Specular};
use std::borrow::Cow;

/// The materials of a mesh as a bake shows them, and a warning where that is not as the model has them.
pub fn with_unlit_as_emission<'a>(
    materials: &'a [Material],
    mesh: &Mesh,
) -> (Cow<'a, [Material]>, Option<String>) {
    let mut is_used = vec![false; materials.len()];
    for &material in &mesh.triangle_materials {
        is_used[material as usize] = true;
    }
    let used = || materials.iter().zip(&is_used).filter(|(_, is_used)| **is_used).map(|(own, _)| own);
    let unlit: Vec<&Material> = used().filter(|material| material.unlit).collect();
    if unlit.is_empty() || unlit.len() == used().count() {
        return (Cow::Borrowed(materials), None);
    }
    let can_glow = mesh.colors.is_empty();
    let names = named(unlit.iter().map(|material| material.name.as_str()));
    let becomes = match can_glow {
        true => "emission",
        false => "lit, since its vertex colours cannot become emission",
    };
    let told = format!("what is unlit beside lit materials becomes {becomes}: {names}");
    if !can_glow {
        return (Cow::Borrowed(materials), Some(told));
    }
    let glowing = materials.iter().map(|own| if own.unlit { as_emission(own) } else { own.clone() });
    (Cow::Owned(glowing.collect()), Some(told))
}

/// Whether this material was unlit before [`with_unlit_as_emission`].
pub fn was_unlit(material: &Material) -> bool {
    material.extensions == without_reflections() && material.base_color[..3] == [0.0; 3]
}

fn without_reflections() -> MaterialExtensions {
    MaterialExtensions {
        specular: Some(Specular { factor: 0.0, ..Specular::default() }),
        ..MaterialExtensions::default()
    }
}

fn as_emission(unlit: &Material) -> Material {
    let [red, green, blue, opacity] = unlit.base_color;
    Material {
        name: unlit.name.clone(),
        base_color: [0.0, 0.0, 0.0, opacity],
        // Its alpha still counts.
        base_color_texture: unlit.base_color_texture.filter(|_| unlit.alpha_mode != AlphaMode::Opaque),
        emissive: [red, green, blue],
        emissive_texture: unlit.base_color_texture,
        emissive_strength: 1.0,
        metallic: 0.0,
        roughness: 1.0,
        alpha_mode: unlit.alpha_mode,
        alpha_cutoff: unlit.alpha_cutoff,
        double_sided: unlit.double_sided,
        extensions: without_reflections(),
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;
    use parbake_model::Model;

    fn screen_and_case() -> Model {
        let screen = Material {
            name: "screen".into(),
            base_color: [0.2, 0.4, 0.6, 1.0],
            unlit: true,
            ..Material::default()
        };
        let mesh = Mesh { triangle_materials: vec![0, 1], ..Mesh::default() };
        Model { mesh, materials: vec![screen, Material::default()], ..Model::default() }
    }

    /// Protects screens and signs: they show the same colour without light, and the user is told.
    #[test]
    fn what_is_unlit_beside_lit_glows() {
        let model = screen_and_case();
        let (materials, told) = with_unlit_as_emission(&model.materials, &model.mesh);
        assert_eq!((materials[0].emissive, materials[0].unlit), ([0.2, 0.4, 0.6], false));
        assert_eq!(materials[0].base_color, [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(materials[0].extensions.specular.map(|s| s.factor), Some(0.0));
        assert_eq!(materials[1], model.materials[1]);
        assert!(was_unlit(&materials[0]) && !was_unlit(&materials[1]));
        assert!(told.is_some_and(|text| text.ends_with("becomes emission: \"screen\"")));
    }

    /// Protects models that are all of one kind, of which nothing is to be told, and vertex colours.
    #[test]
    fn one_kind_alone_stays() {
        let mut model = screen_and_case();
        model.mesh.triangle_materials = vec![0, 0];
        assert_eq!(
            with_unlit_as_emission(&model.materials, &model.mesh),
            (Cow::Borrowed(&model.materials[..]), None)
        );
        model.mesh.triangle_materials = vec![0, 1];
        model.mesh.colors = vec![Vec4::ONE];
        let (materials, told) = with_unlit_as_emission(&model.materials, &model.mesh);
        assert!(materials[0].unlit && told.is_some_and(|text| text.contains("becomes lit")));
    }
}
