//! What of the high-poly's material extensions is lost where only light on a matte surface is fitted, and what no
//! comparison by Parbake's own renderer shows.

use crate::named::named;
use parbake_model::{Material, MaterialExtensions, Specular};

/// An extension, what is lost without it, and whether a material has it with an effect.
type Loss = (&'static str, &'static str, fn(&MaterialExtensions) -> bool);

/// What pictures of Parbake's renderer do not show.
const NOT_RENDERED: [&str; 4] = [
    "KHR_materials_diffuse_transmission",
    "KHR_materials_iridescence",
    "KHR_materials_anisotropy",
    "KHR_materials_dispersion",
];

const LOSSES: [Loss; 10] = [
    ("KHR_materials_clearcoat", "the reflections of the clearcoat", |e| {
        e.clearcoat.is_some_and(|c| c.factor > 0.0)
    }),
    ("KHR_materials_sheen", "the sheen of cloth at grazing angles", |e| {
        e.sheen.is_some_and(|s| s.color != [0.0; 3])
    }),
    ("KHR_materials_transmission", "the refraction, blur and tint of what is behind", |e| {
        e.transmission.is_some_and(|t| t.factor > 0.0)
    }),
    ("KHR_materials_diffuse_transmission", "the scattered light that comes through from behind", |e| {
        e.diffuse_transmission.is_some_and(|d| d.factor > 0.0)
    }),
    ("KHR_materials_volume", "refraction and attenuation inside the volume", |e| {
        e.volume.is_some_and(|v| v.thickness > 0.0)
    }),
    ("KHR_materials_iridescence", "the colours of iridescence", |e| {
        e.iridescence.is_some_and(|i| i.factor > 0.0)
    }),
    ("KHR_materials_anisotropy", "the anisotropy of highlights", |e| {
        e.anisotropy.is_some_and(|a| a.strength > 0.0)
    }),
    ("KHR_materials_specular", "the strength and the colour of reflections", |e| {
        e.specular.is_some_and(|s| s != Specular::default())
    }),
    ("KHR_materials_ior", "the index of refraction, which becomes 1.5", |e| {
        e.ior.is_some_and(|ior| ior != 1.5)
    }),
    ("KHR_materials_dispersion", "the dispersion of refracted light", |e| {
        e.dispersion.is_some_and(|d| d > 0.0)
    }),
];

/// What is lost, an extension at a time: models have many materials.
pub fn lost(materials: &[Material]) -> Vec<String> {
    let of = |&(name, lost, has): &Loss| {
        let mut having = materials.iter().filter(|m| has(&m.extensions)).map(|m| m.name.as_str()).peekable();
        having.peek()?;
        Some(format!(
            "{name} is not written with --shading lambert or --convention paper, which loses {lost}: {}",
            named(having)
        ))
    };
    LOSSES.iter().filter_map(of).collect()
}

/// A word about extensions that figures of Parbake's renderer say nothing of, if a material has some.
pub fn not_compared<'a>(materials: impl IntoIterator<Item = &'a Material> + Clone) -> Option<String> {
    let has = |&&(_, _, has): &&Loss| materials.clone().into_iter().any(|material| has(&material.extensions));
    let names = LOSSES.iter().filter(has).map(|(name, ..)| *name);
    let left_out: Vec<&str> = names.filter(|name| NOT_RENDERED.contains(name)).collect();
    (!left_out.is_empty()).then(|| {
        format!(
            "pictures and figures do not include {}, which Parbake's renderer does not show; `parbake view` does",
            left_out.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{Clearcoat, Iridescence, Sheen, Transmission};

    /// Protects the user from losses without a word, and from words where nothing is lost.
    #[test]
    fn losses_are_told_where_there_are_some() {
        let mut cloth = Material { name: "cloth".into(), ..Material::default() };
        cloth.extensions.sheen = Some(Sheen { color: [1.0; 3], ..Sheen::default() });
        cloth.extensions.specular = Some(Specular::default());
        cloth.extensions.ior = Some(1.5);
        let told = lost(&[cloth, Material::default()]);
        assert!(
            told.len() == 1 && told[0].contains("KHR_materials_sheen") && told[0].contains("cloth"),
            "{told:?}"
        );
    }

    /// Protects whoever reads decibels of thin films and lacquer: they are told what these leave out, and of what is shown nothing.
    #[test]
    fn what_figures_leave_out_is_told() {
        let mut film = Material::default();
        assert_eq!(not_compared([&film]), None);
        film.extensions.iridescence = Some(Iridescence { factor: 1.0, ..Iridescence::default() });
        let told = not_compared([&Material::default(), &film]);
        assert!(told.is_some_and(|text| text.contains("KHR_materials_iridescence")));
        let mut shown = Material::default();
        shown.extensions.clearcoat = Some(Clearcoat { factor: 1.0, ..Clearcoat::default() });
        shown.extensions.transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
        assert_eq!(not_compared([&shown]), None);
    }
}
